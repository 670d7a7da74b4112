//! The product, a stripe of rows at a time.

use super::decode::{ENTRIES, LOOKUP, decode};
use super::parts::{Entries, Format, row_start};
use super::{BlockOperator, SIDE, block_rows};

/// Three channels of four patches.
pub type Quad = [[f32; SIDE]; 3];

/// What a product is formed with, in two layouts.
#[derive(Clone, Copy, Debug)]
pub struct Sent<'a> {
    /// Runs of four patches, zeros beyond the last: for blocks.
    pub quads: &'a [Quad],
    /// Patch by patch, the fourth number unused: for kept entries.
    pub flat: &'a [[f32; 4]],
}

/// An f16 that is finite, in units of 2^-112: exact.
#[inline(always)]
pub(super) fn small_f16(bits: u16) -> f32 {
    let bits = u32::from(bits);
    f32::from_bits((bits & 0x8000) << 16 | (bits & 0x7fff) << 13)
}

/// 2^112.
pub(super) const F16_SCALE: f32 = f32::from_bits((127 + 112) << 23);

/// Kept entries of one kind.
trait Entry {
    /// Column, and value without the common unit.
    fn entry<const V: usize>(&self, at: usize) -> (usize, [f32; V]);
}

struct Full<'a>(&'a [u32], &'a [f32]);
struct Short<'a>(&'a [u16], &'a [u16], f32);

impl Entry for Full<'_> {
    #[inline(always)]
    fn entry<const V: usize>(&self, at: usize) -> (usize, [f32; V]) {
        let values = self.1.as_chunks::<V>().0.get(at).copied().unwrap_or([0.0; V]);
        (self.0.get(at).map_or(usize::MAX, |c| *c as usize), values)
    }
}

impl Entry for Short<'_> {
    #[inline(always)]
    fn entry<const V: usize>(&self, at: usize) -> (usize, [f32; V]) {
        let values = self.1.as_chunks::<V>().0.get(at).copied().unwrap_or([0; V]);
        (self.0.get(at).map_or(usize::MAX, |c| usize::from(*c)), values.map(|v| small_f16(v) * self.2))
    }
}

/// Channel c of V values.
#[inline(always)]
fn pick<const V: usize, T: Copy>(values: &[T; V], c: usize) -> T {
    values[c % V]
}

impl BlockOperator {
    /// y = X x for a stripe: rows of blocks from `first` on, as many as `y` has. Where half is stored, what they add to columns before and in the stripe is *added* to `columns`, as long as all
    /// rows up to the last of the stripe; else `columns` is not touched. `sent` has all patches, in the order of rows and already scaled.
    #[inline(always)]
    pub fn stripe(&self, first: usize, sent: Sent<'_>, y: &mut [Quad], columns: &mut [Quad]) {
        match &self.parts.entries {
            Entries::Full { columns: at, values } => {
                self.formats(first, sent, y, columns, &Full(at, values));
            }
            Entries::Short { columns: at, values, unit } => {
                self.formats(first, sent, y, columns, &Short(at, values, F16_SCALE * unit));
            }
        }
    }

    #[inline(always)]
    fn formats<E: Entry>(
        &self,
        first: usize,
        sent: Sent<'_>,
        y: &mut [Quad],
        columns: &mut [Quad],
        kept: &E,
    ) {
        match (self.parts.format, self.parts.half) {
            (Format::Bc1, false) => self.rows::<3, false, E>(first, sent, y, columns, kept),
            (Format::Bc1, true) => self.rows::<3, true, E>(first, sent, y, columns, kept),
            (Format::Bc4, false) => self.rows::<1, false, E>(first, sent, y, columns, kept),
            (Format::Bc4, true) => self.rows::<1, true, E>(first, sent, y, columns, kept),
        }
    }

    #[inline(always)]
    fn rows<const V: usize, const HALF: bool, E: Entry>(
        &self,
        first: usize,
        sent: Sent<'_>,
        y: &mut [Quad],
        columns: &mut [Quad],
        kept: &E,
    ) {
        let rows = block_rows(self.len());
        for (k, y) in y.iter_mut().enumerate() {
            let row = first + k;
            let Some(xr) = sent.quads.get(row) else { return };
            let blocks = self.parts.blocks.get(row_start(HALF, rows, row)..).unwrap_or(&[]);
            let blocks = blocks.get(..if HALF { row + 1 } else { rows }).unwrap_or(&[]);
            let mut sums = [[0.0; ENTRIES]; 3];
            for (column, (block, xc)) in blocks.iter().zip(sent.quads).enumerate() {
                if *block == [0; 8] {
                    continue;
                }
                let values = decode::<V>(&self.lookup, *block);
                add_rows(&mut sums, &values, xc);
                if HALF
                    && column < row
                    && let Some(to) = columns.get_mut(column)
                {
                    add_to_columns(to, &values, xr);
                }
            }
            for c in 0..3 {
                let s = &sums[c];
                for r in 0..SIDE {
                    y[c][r] = (s[4 * r] + s[4 * r + 2]) + (s[4 * r + 1] + s[4 * r + 3]);
                }
            }
            for r in 0..SIDE {
                let sum = self.kept_row::<V, HALF, E>(SIDE * row + r, sent.flat, columns, kept);
                for c in 0..3 {
                    y[c][r] += sum[c];
                }
            }
        }
    }

    /// The sums of a row's kept entries; adds to columns.
    #[inline(always)]
    fn kept_row<const V: usize, const HALF: bool, E: Entry>(
        &self,
        row: usize,
        x: &[[f32; 4]],
        columns: &mut [Quad],
        kept: &E,
    ) -> [f32; 3] {
        let mut sums = [[0.0_f32; 4]; 2];
        let (Some(start), Some(end)) = (self.parts.starts.get(row), self.parts.starts.get(row + 1)) else {
            return [0.0; 3];
        };
        let here = x.get(row).copied().unwrap_or_default();
        for (k, at) in (*start as usize..*end as usize).enumerate() {
            let (column, values) = kept.entry::<V>(at);
            let x = x.get(column).copied().unwrap_or_default();
            let sum = &mut sums[k % 2];
            for c in 0..3 {
                sum[c] += pick(&values, c) * x[c];
            }
            if HALF
                && column / SIDE < row / SIDE
                && let Some(to) = columns.get_mut(column / SIDE)
            {
                for c in 0..3 {
                    to[c][column % SIDE] += pick(&values, c) * here[c];
                }
            }
        }
        [0, 1, 2].map(|c| sums[0][c] + sums[1][c])
    }

    /// Entry of the matrix between two patches, scales included: what a product multiplies by. Slow.
    pub fn entry(&self, to: usize, from: usize) -> [f32; 3] {
        let row_of = |patch: usize| {
            if self.parts.order.is_empty() {
                Some(patch)
            } else {
                self.parts.order.iter().position(|p| *p as usize == patch)
            }
        };
        match (row_of(to), row_of(from)) {
            (Some(row), Some(column)) if row.max(column) < self.len() => self.at(row, column),
            _ => [0.0; 3],
        }
    }

    /// Entry in a row and a column, scales included.
    pub(super) fn at(&self, row: usize, column: usize) -> [f32; 3] {
        let scale = self.into[column / SIDE][column % SIDE] * self.out[row / SIDE][row % SIDE];
        let (blocks, kept) = (self.block_entry(row, column), self.kept_entry(row, column));
        [0, 1, 2].map(|c| scale * (blocks[c] + kept[c]))
    }

    /// What is stored at (row, column): the other half is where it is.
    fn stored(&self, row: usize, column: usize) -> (usize, usize) {
        if self.parts.half && column / SIDE > row / SIDE { (column, row) } else { (row, column) }
    }

    /// What blocks give.
    pub(super) fn block_entry(&self, row: usize, column: usize) -> [f32; 3] {
        let (row, column) = self.stored(row, column);
        let at = row_start(self.parts.half, block_rows(self.len()), row / SIDE) + column / SIDE;
        let (block, k) = (self.parts.blocks[at], row % SIDE * SIDE + column % SIDE);
        let table: &[f32; LOOKUP] = &self.lookup;
        match self.parts.format {
            Format::Bc1 => decode::<3>(table, block).map(|plane| plane[k]),
            Format::Bc4 => [decode::<1>(table, block)[0][k]; 3],
        }
    }

    /// What is kept.
    fn kept_entry(&self, row: usize, column: usize) -> [f32; 3] {
        let (row, column) = self.stored(row, column);
        let range = self.parts.starts[row] as usize..self.parts.starts[row + 1] as usize;
        let (first, v) = (range.start, self.parts.format.channels());
        match &self.parts.entries {
            Entries::Full { columns, values } => match columns[range].binary_search(&(column as u32)) {
                Ok(k) => [0, 1, 2].map(|c| values[v * (first + k) + c % v]),
                Err(_) => [0.0; 3],
            },
            Entries::Short { columns, values, unit } => {
                match columns[range].binary_search(&(column as u16)) {
                    Ok(k) => {
                        [0, 1, 2].map(|c| small_f16(values[v * (first + k) + c % v]) * (F16_SCALE * unit))
                    }
                    Err(_) => [0.0; 3],
                }
            }
        }
    }
}

#[inline(always)]
fn add_rows<const V: usize>(sums: &mut [[f32; ENTRIES]; 3], values: &[[f32; ENTRIES]; V], x: &Quad) {
    for c in 0..3 {
        let values = &values[c % V];
        for l in 0..ENTRIES {
            sums[c][l] += values[l] * x[c][l % SIDE];
        }
    }
}

#[inline(always)]
fn add_to_columns<const V: usize>(columns: &mut Quad, values: &[[f32; ENTRIES]; V], x: &Quad) {
    for c in 0..3 {
        let values = &values[c % V];
        let mut sums = [[0.0; SIDE]; SIDE];
        for r in 0..SIDE {
            for k in 0..SIDE {
                sums[r][k] = values[SIDE * r + k] * x[c][r];
            }
        }
        for k in 0..SIDE {
            columns[c][k] += (sums[0][k] + sums[1][k]) + (sums[2][k] + sums[3][k]);
        }
    }
}
