//! Matrix products in one fixed order.
//!
//! **The order.** An element of C <- C + A B adds to what it was, for each block of [`BLOCK`] = 256 terms in turn, the
//! block's own sum, which starts at 0 and adds a_ik b_kj for increasing k; each product is rounded before it is added (no
//! fma). It depends on the inner length only: not on tiles, threads or registers. [`multiply_add_reference`] says the
//! same in scalar code and is what the fast forms are tested against, bit for bit.
//!
//! **Error.** With u = 2^-24 at most (min(n, 256) + n/256 + 1) u (|C| + |A| |B|) to first order. Measured, relative L2 for
//! form factors: about 1 u (the table of the module above).

use super::super::lanes::Real;
use alloc::vec;
use alloc::vec::Vec;

/// Terms of a block.
pub const BLOCK: usize = 256;

/// A matrix within a slice: row i starts at `i * stride`.
#[derive(Clone, Copy, Debug)]
pub struct View<'a, T> {
    /// From its first entry on; rows that the slice does not hold whole count as zeros.
    pub entries: &'a [T],
    /// From row to row.
    pub stride: usize,
    /// Rows.
    pub rows: usize,
    /// Columns; at most `stride`.
    pub columns: usize,
}

impl<'a, T: Real> View<'a, T> {
    /// Row i; empty beyond the last one and where the slice does not hold it whole.
    #[inline(always)]
    pub fn row(&self, i: usize) -> &'a [T] {
        // Beyond the last row nothing starts.
        let from = if i < self.rows { i.saturating_mul(self.stride) } else { usize::MAX };
        self.entries.get(from..from.saturating_add(self.columns)).unwrap_or(&[])
    }
}

/// Where a product is added: row i starts at `i * stride + column`.
#[derive(Debug)]
pub struct Target<'a, T> {
    /// Whole rows.
    pub entries: &'a mut [T],
    /// From row to row, not 0.
    pub stride: usize,
    /// First column of the product; columns that do not fit in `stride` are left out, and so are rows that `entries` does
    /// not hold whole.
    pub column: usize,
}

/// What forms products: [`Portable`], or a backend with its own registers and threads. All give the same bits.
pub trait Multiply {
    /// C <- C + A B in the module's order.
    fn multiply_add(&self, c: Target<'_, f32>, a: View<'_, f32>, b: View<'_, f32>);

    /// The same in f64, for the host only.
    fn multiply_add_wide(&self, c: Target<'_, f64>, a: View<'_, f64>, b: View<'_, f64>);
}

/// f32 or f64: picks the method of [`Multiply`].
pub trait Element: Real {
    /// Rounds.
    fn from_f64(x: f64) -> Self;
    /// Exactly.
    fn to_f64(self) -> f64;
    /// C <- C + A B.
    fn multiply_add<M: Multiply + ?Sized>(m: &M, c: Target<'_, Self>, a: View<'_, Self>, b: View<'_, Self>);
}

impl Element for f32 {
    fn from_f64(x: f64) -> Self {
        x as f32
    }
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
    fn multiply_add<M: Multiply + ?Sized>(m: &M, c: Target<'_, Self>, a: View<'_, Self>, b: View<'_, Self>) {
        m.multiply_add(c, a, b);
    }
}

impl Element for f64 {
    fn from_f64(x: f64) -> Self {
        x
    }
    fn to_f64(self) -> f64 {
        self
    }
    fn multiply_add<M: Multiply + ?Sized>(m: &M, c: Target<'_, Self>, a: View<'_, Self>, b: View<'_, Self>) {
        m.multiply_add_wide(c, a, b);
    }
}

/// C <- C + A B as the order says it, an element at a time.
pub fn multiply_add_reference<T: Real>(c: Target<'_, T>, a: View<'_, T>, b: View<'_, T>) {
    for i in 0..a.rows {
        if c.entries.len() < (i + 1) * c.stride {
            break;
        }
        for j in 0..b.columns.min(c.stride.saturating_sub(c.column)) {
            let slot = &mut c.entries[i * c.stride + c.column + j];
            for first in (0..a.columns).step_by(BLOCK) {
                let mut sum = T::ZERO;
                for k in first..(first + BLOCK).min(a.columns) {
                    let at =
                        |m: &View<'_, T>, i: usize, j: usize| m.row(i).get(j).copied().unwrap_or_default();
                    sum = sum + at(&a, i, k) * at(&b, k, j);
                }
                *slot = *slot + sum;
            }
        }
    }
}

/// B cut into panels of N columns: block after block of terms, panel after panel, term after term; zeros fill the last.
#[derive(Clone, Debug)]
pub struct Packed<T, const N: usize> {
    entries: Vec<T>,
    terms: usize,
    columns: usize,
}

impl<T: Real, const N: usize> Packed<T, N> {
    /// Packs B.
    pub fn new(b: &View<'_, T>) -> Self {
        let panels = b.columns.div_ceil(N);
        let mut entries = vec![T::ZERO; panels * N * b.rows];
        for first in (0..b.rows).step_by(BLOCK) {
            let depth = BLOCK.min(b.rows - first);
            let block = &mut entries[first * panels * N..][..depth * panels * N];
            for k in 0..depth {
                for (panel, from) in b.row(first + k).chunks(N).enumerate() {
                    block[(panel * depth + k) * N..][..from.len()].copy_from_slice(from);
                }
            }
        }
        Self { entries, terms: b.rows, columns: b.columns }
    }

    /// Columns of B.
    pub fn columns(&self) -> usize {
        self.columns
    }
}

/// Rows that are packed together: a few tiles that stay in the second-level cache.
pub const ROWS: usize = 48;

/// The product of M rows of a block with one panel: M N sums in registers.
#[inline(always)]
fn tile<T: Real, const M: usize, const N: usize>(a: &[T], b: &[T]) -> [[T; N]; M] {
    let mut sums = [[T::ZERO; N]; M];
    for (a, b) in a.as_chunks::<M>().0.iter().zip(b.as_chunks::<N>().0) {
        for r in 0..M {
            for c in 0..N {
                sums[r][c] = sums[r][c] + a[r] * b[c];
            }
        }
    }
    sums
}

/// C <- C + A B for the rows of one chunk of C (at most [`ROWS`] make good use of the cache), in tiles of M x N.
///
/// `first_row` is the row of A that belongs to the first row in `c`.
#[inline(always)]
pub fn multiply_rows<T: Real, const M: usize, const N: usize>(
    c: Target<'_, T>,
    a: &View<'_, T>,
    first_row: usize,
    b: &Packed<T, N>,
) {
    let rows = (c.entries.len() / c.stride.max(1)).min(a.rows.saturating_sub(first_row));
    let panels = b.columns.div_ceil(N);
    let tiles = rows.div_ceil(M);
    let terms = a.columns.min(b.terms);
    let mut packed = vec![T::ZERO; tiles * M * BLOCK.min(terms)];
    let zeros = [T::ZERO; BLOCK];
    for first in (0..terms).step_by(BLOCK) {
        let depth = BLOCK.min(terms - first);
        // Tile after tile, term after term; rows beyond the last one are zeros and are not written back.
        for (t, to) in packed.chunks_mut(M * depth).take(tiles).enumerate() {
            let from: [&[T]; M] = core::array::from_fn(|r| {
                let row = if t * M + r < rows { a.row(first_row + t * M + r) } else { &[] };
                row.get(first..first + depth).unwrap_or(&zeros[..depth])
            });
            for (k, to) in to.as_chunks_mut::<M>().0.iter_mut().enumerate() {
                for r in 0..M {
                    to[r] = from[r][k];
                }
            }
        }
        let block = &b.entries[first * panels * N..][..depth * panels * N];
        for panel in 0..panels {
            let b_panel = &block[panel * depth * N..][..depth * N];
            let from = c.column.saturating_add(panel * N);
            // What does not fit beside the first column is left out.
            let width = N.min(b.columns - panel * N).min(c.stride.saturating_sub(from));
            if width == 0 {
                break;
            }
            for t in 0..tiles {
                let sums: [[T; N]; M] = tile(&packed[t * M * depth..][..M * depth], b_panel);
                for (r, sums) in sums.iter().enumerate().take(rows - t * M) {
                    let to = &mut c.entries[(t * M + r) * c.stride + from..][..width];
                    if let Ok(to) = <&mut [T; N]>::try_from(&mut *to) {
                        for l in 0..N {
                            to[l] = to[l] + sums[l];
                        }
                    } else {
                        to.iter_mut().zip(sums).for_each(|(to, sum)| *to = *to + *sum);
                    }
                }
            }
        }
    }
}

/// One thread, and the registers that every build has.
#[derive(Clone, Copy, Debug, Default)]
pub struct Portable;

impl Portable {
    fn run<T: Real, const M: usize, const N: usize>(c: Target<'_, T>, a: View<'_, T>, b: View<'_, T>) {
        let packed = Packed::<T, N>::new(&b);
        let (stride, column) = (c.stride.max(1), c.column);
        for (chunk, entries) in c.entries.chunks_mut(ROWS * stride).enumerate() {
            multiply_rows::<T, M, N>(Target { entries, stride, column }, &a, chunk * ROWS, &packed);
        }
    }
}

impl Multiply for Portable {
    fn multiply_add(&self, c: Target<'_, f32>, a: View<'_, f32>, b: View<'_, f32>) {
        Self::run::<f32, 4, 8>(c, a, b);
    }

    fn multiply_add_wide(&self, c: Target<'_, f64>, a: View<'_, f64>, b: View<'_, f64>) {
        Self::run::<f64, 4, 4>(c, a, b);
    }
}
