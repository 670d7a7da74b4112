//! Products with tiles, all channels at once.

use super::decode::{Codes, PAIR, PAIRS, decode, for_codes, mean_of, twice};
use super::lists::{CHUNK, Lists, Place};
use super::{ENTRIES, Kind, Planes, SIDE, Tiles, kinds_start, tile_rows};
use alloc::vec::Vec;

/// Sum of eight lanes.
#[inline(always)]
fn pairwise(s: &[f32]) -> f32 {
    s.first_chunk::<SIDE>().map_or(0.0, |s| ((s[0] + s[4]) + (s[2] + s[6])) + ((s[1] + s[5]) + (s[3] + s[7])))
}

/// What a row of tiles reads and adds up.
///
/// Sums of a row run in eight lanes, one per column of a tile; two rows are side by side, so that a register of sixteen holds both.
#[repr(align(64))]
struct RowSums<const C: usize> {
    sums: [[[f32; PAIR]; C]; PAIRS],
    /// x of the row's patches, each eight times.
    x: [[[f32; PAIR]; C]; PAIRS],
    /// What tiles of one mean send to each row of theirs.
    flat: Planes<C>,
    /// Sum of x over the row's patches: what such tiles send to each column, but for the mean.
    total: [f32; C],
}

impl<const C: usize> RowSums<C> {
    #[inline(always)]
    fn new(x: &Planes<C>) -> Self {
        Self {
            sums: [[[0.0; PAIR]; C]; PAIRS],
            x: core::array::from_fn(|p| x.map(|x| core::array::from_fn(|k| x[2 * p + k / SIDE]))),
            flat: [[0.0; SIDE]; C],
            total: x.map(|x| pairwise(&x)),
        }
    }

    /// Adds the products of tiles of one kind to the row and to their columns. A column's sums run within a tile over its even and its odd rows; both, and then the unit of
    /// the tile, come last.
    #[inline(always)]
    fn multiply<K: Codes>(
        &mut self,
        (places, payload): (&[Place], &[u8]),
        x: &[Planes<C>],
        columns: &mut [Planes<C>],
    ) {
        for place in places {
            let codes = K::open(payload.get(place.start as usize..).unwrap_or(&[]));
            let column = place.column as usize;
            let (Some(codes), Some(x), Some(y)) = (codes, x.get(column), columns.get_mut(column)) else {
                return;
            };
            let unit = codes.unit();
            let mut scaled = [[0.0; PAIR]; C];
            for c in 0..C {
                let x = twice(x[c]);
                for k in 0..PAIR {
                    scaled[c][k] = unit * x[k];
                }
            }
            let mut sent = [[0.0; PAIR]; C];
            for p in 0..PAIRS {
                let q = codes.pair(p);
                for c in 0..C {
                    for k in 0..PAIR {
                        self.sums[p][c][k] += q[k] * scaled[c][k];
                    }
                    for k in 0..PAIR {
                        let more = q[k] * self.x[p][c][k];
                        sent[c][k] = if p == 0 { more } else { sent[c][k] + more };
                    }
                }
            }
            // Channel by channel, or the compiler would seek registers across channels.
            for (y, sent) in y.iter_mut().zip(&sent) {
                let mut sum = *y;
                for k in 0..SIDE {
                    sum[k] += unit * (sent[k] + sent[k + SIDE]);
                }
                *y = sum;
            }
        }
    }

    /// The same for tiles of one mean.
    #[inline(always)]
    fn multiply_means(
        &mut self,
        (places, payload): (&[Place], &[u8]),
        x: &[Planes<C>],
        columns: &mut [Planes<C>],
    ) {
        for place in places {
            let mean = mean_of(payload.get(place.start as usize..).unwrap_or(&[]));
            let column = place.column as usize;
            let (Some(x), Some(y)) = (x.get(column), columns.get_mut(column)) else { return };
            for c in 0..C {
                let sent = mean * self.total[c];
                for k in 0..SIDE {
                    self.flat[c][k] += mean * x[c][k];
                    y[c][k] += sent;
                }
            }
        }
    }

    /// The tile on the diagonal, which is whole: it gives its row all.
    #[inline(always)]
    fn multiply_own(&mut self, kind: Kind, bytes: &[u8], x: &Planes<C>) {
        let tile = decode(kind, bytes);
        for (sums, rows) in self.sums.iter_mut().zip(tile.as_chunks::<2>().0) {
            for c in 0..C {
                for k in 0..PAIR {
                    sums[c][k] += rows[k / SIDE][k % SIDE] * x[c][k % SIDE];
                }
            }
        }
    }

    /// Sums of the row.
    #[inline(always)]
    fn fold(&self) -> Planes<C> {
        core::array::from_fn(|c| {
            let flat = pairwise(&self.flat[c]);
            core::array::from_fn(|k| pairwise(&self.sums[k / 2][c][k % 2 * SIDE..]) + flat)
        })
    }
}

/// Room for products: none is asked for while they run.
#[derive(Clone, Debug, Default)]
pub struct Scratch<const C: usize> {
    /// What stripes add to columns, one after the other or each by itself.
    pub columns: Vec<Planes<C>>,
}

/// Rows of tiles of a stripe: the part of a product that one thread does. Its sums are complete in themselves, so that stripes in order give the same bits however they were shared out.
pub const STRIPE_ROWS: usize = 64;

impl Tiles {
    /// y = S x for a stripe: rows of tiles from `first` on, as many as `y` has. What these rows add to columns before and in the stripe is *added* to `columns`, as long as all rows up to the last of the stripe.
    /// `x`, `y` and `columns` hold runs of eight patches; `x` has all of them, with zeros beyond the last patch. Finite results need |x| below 10^33.
    ///
    /// The order of sums: 256 columns after 256 columns, in them kind after kind, in those column after column; the diagonal last.
    #[inline(always)]
    pub fn stripe<const C: usize>(
        &self,
        first: usize,
        x: &[Planes<C>],
        y: &mut [Planes<C>],
        columns: &mut [Planes<C>],
    ) {
        let mut lists = Lists::new();
        for (k, y) in y.iter_mut().enumerate() {
            let row = first + k;
            let (Some(own), Some(start)) = (x.get(row), self.rows.get(row)) else { return };
            let (kinds, payload) = (self.kinds.get(kinds_start(row)..).unwrap_or(&[]), &self.payload[..]);
            let (mut sums, mut start) = (RowSums::new(own), *start);
            for from in (0..row).step_by(CHUNK) {
                start = lists.fill(kinds, (from, row), start);
                for kind in Kind::ALL {
                    let tiles = (lists.of(kind), payload);
                    for_codes!(kind, Found => sums.multiply::<Found>(tiles, x, columns), {
                        if kind == Kind::Mean {
                            sums.multiply_means(tiles, x, columns);
                        }
                    });
                }
            }
            sums.multiply_own(self.kind(row, row), payload.get(start as usize..).unwrap_or(&[]), own);
            *y = sums.fold();
        }
    }

    /// y = S x, channels in runs of eight patches: stripe after stripe, which is what every schedule must equal.
    pub fn apply<const C: usize>(&self, x: &[Planes<C>], y: &mut [Planes<C>], scratch: &mut Scratch<C>) {
        let rows = tile_rows(self.n).min(y.len());
        scratch.columns.resize(rows, [[0.0; SIDE]; C]);
        for first in (0..rows).step_by(STRIPE_ROWS) {
            let end = rows.min(first + STRIPE_ROWS);
            scratch.columns[..end].fill([[0.0; SIDE]; C]);
            self.stripe(first, x, &mut y[first..end], &mut scratch.columns[..end]);
            add_columns(y, &scratch.columns[..end]);
        }
    }

    /// Entry (i, j).
    pub fn entry(&self, i: usize, j: usize) -> f32 {
        let (i, j) = (i.max(j), i.min(j));
        let (row, column) = (i / SIDE, j / SIDE);
        let Some(start) = self.rows.get(row) else { return 0.0 };
        let before: usize = (0..column).map(|c| self.kind(row, c).bytes()).sum();
        let kind = self.kind(row, column);
        let payload = self.payload.get(*start as usize + before..).unwrap_or(&[]);
        if kind == Kind::Empty { 0.0 } else { decode(kind, payload)[i % SIDE][j % SIDE] }
    }

    /// Calls `f(i, j, S(i, j))` for all entries of the half that are not 0, i >= j.
    pub fn for_each(&self, mut f: impl FnMut(usize, usize, f32)) {
        for row in 0..tile_rows(self.n) {
            let mut payload = self.payload.get(self.rows[row] as usize..).unwrap_or(&[]);
            for column in 0..=row {
                let kind = self.kind(row, column);
                let (bytes, rest) = payload.split_at_checked(kind.bytes()).unwrap_or((&[], &[]));
                payload = rest;
                if kind == Kind::Empty {
                    continue;
                }
                let tile = decode(kind, bytes);
                for k in 0..ENTRIES {
                    let (i, j) = (SIDE * row + k / SIDE, SIDE * column + k % SIDE);
                    let value = tile[k / SIDE][k % SIDE];
                    if i < self.n && j <= i && value != 0.0 {
                        f(i, j, value);
                    }
                }
            }
        }
    }
}

/// Adds what a stripe gave to columns to the sums so far.
#[inline(always)]
pub fn add_columns<const C: usize>(y: &mut [Planes<C>], columns: &[Planes<C>]) {
    for (y, add) in y.iter_mut().zip(columns) {
        for c in 0..C {
            for k in 0..SIDE {
                y[c][k] += add[c][k];
            }
        }
    }
}
