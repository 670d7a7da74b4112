//! Products with tiles, all channels at once.

use super::encode::scale_of;
use super::{ENTRIES, Kind, Planes, SIDE, Tiles, half, tile_rows};
use alloc::vec::Vec;

/// A decoded tile, row by row.
pub(super) type Tile = [[f32; SIDE]; SIDE];

/// Words of a part: one per column, from `bytes` bytes each.
#[inline(always)]
fn words<const BYTES: usize>(payload: &[u8]) -> [u32; SIDE] {
    let mut words = [0; SIDE];
    if let Some(bytes) = payload.first_chunk::<32>()
        && BYTES == 4
    {
        for (k, w) in words.iter_mut().enumerate() {
            *w = u32::from_le_bytes([bytes[4 * k], bytes[4 * k + 1], bytes[4 * k + 2], bytes[4 * k + 3]]);
        }
    } else if let Some(bytes) = payload.first_chunk::<16>()
        && BYTES == 2
    {
        for (k, w) in words.iter_mut().enumerate() {
            *w = u32::from(u16::from_le_bytes([bytes[2 * k], bytes[2 * k + 1]]));
        }
    } else if let Some(bytes) = payload.first_chunk::<8>()
        && BYTES == 1
    {
        for (k, w) in words.iter_mut().enumerate() {
            *w = u32::from(bytes[k]);
        }
    }
    words
}

#[inline(always)]
fn one<const A: usize>(payload: &[u8], root_step: f32) -> Tile {
    let a = words::<A>(payload);
    let mask = (1 << A as u32) - 1;
    let mut tile = [[0.0; SIDE]; SIDE];
    for (r, row) in tile.iter_mut().enumerate() {
        for k in 0..SIDE {
            let q = (a[k] >> (A * r) as u32) & mask;
            let t = q as i32 as f32 * root_step;
            row[k] = t * t;
        }
    }
    tile
}

#[inline(always)]
fn two<const A: usize, const B: usize>(payload: &[u8], root_step: f32) -> Tile {
    let (a, b) = (words::<A>(payload), words::<B>(payload.get(8 * A..).unwrap_or(&[])));
    let masks = [(1 << A as u32) - 1, (1 << B as u32) - 1];
    let mut tile = [[0.0; SIDE]; SIDE];
    for (r, row) in tile.iter_mut().enumerate() {
        for k in 0..SIDE {
            let q = ((a[k] >> (A * r) as u32) & masks[0]) << B as u32 | (b[k] >> (B * r) as u32) & masks[1];
            let t = q as i32 as f32 * root_step;
            row[k] = t * t;
        }
    }
    tile
}

#[inline(always)]
fn floats(payload: &[u8]) -> Tile {
    let mut tile = [[0.0; SIDE]; SIDE];
    for (x, bytes) in tile.as_flattened_mut().iter_mut().zip(payload.as_chunks::<4>().0) {
        *x = f32::from_le_bytes(*bytes);
    }
    tile
}

#[inline(always)]
fn halves(payload: &[u8]) -> Tile {
    let mut tile = [[0.0; SIDE]; SIDE];
    for (x, bytes) in tile.as_flattened_mut().iter_mut().zip(payload.as_chunks::<2>().0) {
        *x = half::to_f32(u16::from_le_bytes(*bytes));
    }
    tile
}

/// The entries of a tile that is not empty, from its bytes.
#[inline(always)]
pub fn decode(kind: Kind, payload: &[u8]) -> Tile {
    match kind {
        Kind::F16 => return halves(payload),
        Kind::F32 => return floats(payload),
        _ => {}
    }
    let Some((scale, codes)) = payload.split_first_chunk::<2>() else { return [[0.0; SIDE]; SIDE] };
    let scale = scale_of(u16::from_le_bytes(*scale));
    let step = |top: f32| crate::math::sqrt_clamped(scale) / top;
    match kind {
        Kind::Empty | Kind::F16 | Kind::F32 => [[0.0; SIDE]; SIDE],
        Kind::Mean => [[scale; SIDE]; SIDE],
        Kind::Bits1 => one::<1>(codes, step(1.0)),
        Kind::Bits2 => one::<2>(codes, step(3.0)),
        Kind::Bits3 => two::<2, 1>(codes, step(7.0)),
        Kind::Bits4 => one::<4>(codes, step(15.0)),
        Kind::Bits6 => two::<4, 2>(codes, step(63.0)),
        Kind::Bits8 => two::<4, 4>(codes, step(255.0)),
    }
}

/// Adds a tile's products to its rows and, unless it is on the diagonal, to its columns. Sums of a row run in eight lanes, one per column of the tile; those of a column are added up
/// within the tile first, in pairs.
#[inline(always)]
fn multiply<const C: usize>(
    tile: &Tile,
    x: [&Planes<C>; 2],
    rows: &mut [[[f32; SIDE]; SIDE]; C],
    columns: Option<&mut Planes<C>>,
) {
    let [xr, xc] = x;
    for c in 0..C {
        for r in 0..SIDE {
            for k in 0..SIDE {
                rows[c][r][k] += tile[r][k] * xc[c][k];
            }
        }
    }
    let Some(columns) = columns else { return };
    for c in 0..C {
        let mut sums = [[0.0; SIDE]; 2];
        for r in 0..SIDE {
            for k in 0..SIDE {
                sums[r % 2][k] += tile[r][k] * xr[c][r];
            }
        }
        for k in 0..SIDE {
            columns[c][k] += sums[0][k] + sums[1][k];
        }
    }
}

/// Where registers are stored whole: split over two lines of the cache they take twice the time.
#[repr(align(64))]
struct Aligned<T>(T);

/// Sum of eight lanes.
#[inline(always)]
fn pairwise(s: &[f32; SIDE]) -> f32 {
    ((s[0] + s[4]) + (s[2] + s[6])) + ((s[1] + s[5]) + (s[3] + s[7]))
}

/// The mean of a tile that is one.
#[inline(always)]
fn mean_of(payload: &[u8]) -> f32 {
    payload.first_chunk::<2>().map_or(0.0, |scale| scale_of(u16::from_le_bytes(*scale)))
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
    /// `x`, `y` and `columns` hold runs of eight patches; `x` has all of them, with zeros beyond the last patch.
    #[inline(always)]
    pub fn stripe<const C: usize>(
        &self,
        first: usize,
        x: &[Planes<C>],
        y: &mut [Planes<C>],
        columns: &mut [Planes<C>],
    ) {
        for (k, y) in y.iter_mut().enumerate() {
            let row = first + k;
            let (Some(xr), Some(start)) = (x.get(row), self.rows.get(row)) else { return };
            let mut payload = self.payload.get(*start as usize..).unwrap_or(&[]);
            let mut sums = Aligned([[[0.0; SIDE]; SIDE]; C]);
            // Tiles of one mean send the same to each row, and to each column of theirs.
            let (mut flat, total) = ([[0.0; SIDE]; C], xr.map(|x| pairwise(&x)));
            for (column, xc) in x.iter().enumerate().take(row + 1) {
                let kind = self.kind(row, column);
                if kind == Kind::Empty {
                    continue;
                }
                let (bytes, rest) = payload.split_at_checked(kind.bytes()).unwrap_or((&[], &[]));
                payload = rest;
                if kind == Kind::Mean {
                    let mean = mean_of(bytes);
                    for (flat, x) in flat.iter_mut().zip(xc) {
                        for k in 0..SIDE {
                            flat[k] += mean * x[k];
                        }
                    }
                    if column < row
                        && let Some(columns) = columns.get_mut(column)
                    {
                        for (columns, total) in columns.iter_mut().zip(&total) {
                            let sent = mean * total;
                            columns.iter_mut().for_each(|y| *y += sent);
                        }
                    }
                    continue;
                }
                let tile = decode(kind, bytes);
                let target = if column < row { columns.get_mut(column) } else { None };
                multiply(&tile, [xr, xc], &mut sums.0, target);
            }
            for c in 0..C {
                let flat = pairwise(&flat[c]);
                for (y, sums) in y[c].iter_mut().zip(&sums.0[c]) {
                    *y = pairwise(sums) + flat;
                }
            }
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
