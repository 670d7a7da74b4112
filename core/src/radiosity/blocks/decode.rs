//! Blocks to numbers: palettes by one look into a table, without a division.
//!
//! Every palette entry is a weighted sum of two endpoints, rounded. The table has the value of each weighted sum that can be.

use super::SIDE;
use super::parts::Format;
use crate::codec::{bc1, bc4};
use alloc::boxed::Box;

/// Entries of the table; indices are cut to it.
pub(super) const LOOKUP: usize = 4096;
/// Entries of a block.
pub(super) const ENTRIES: usize = SIDE * SIDE;

/// Halves of BC1 follow its thirds, 2 a + b up to 765; then comes black.
const HALVES: usize = 766;
const BLACK: usize = HALVES + 511;
/// Fifths of BC4 follow its sevenths.
const FIFTHS: usize = 7 * 255 + 1;

/// The table of a format.
pub(super) fn lookup(format: Format, values: &[f32]) -> Box<[f32; LOOKUP]> {
    let mut table = Box::new([0.0; LOOKUP]);
    let value = |code: usize| values.get(code).copied().unwrap_or(0.0);
    match format {
        Format::Bc1 => {
            for sum in 0..HALVES {
                table[sum] = value((sum + 1) / 3);
            }
            for sum in 0..511 {
                table[HALVES + sum] = value(sum.div_ceil(2));
            }
            table[BLACK] = value(0);
        }
        Format::Bc4 => {
            for sum in 0..FIFTHS {
                table[sum] = value((sum + 3) / 7);
            }
            for sum in 0..=5 * 255 {
                table[FIFTHS + sum] = value((sum + 2) / 5);
            }
        }
    }
    table
}

/// Bits of the indices of BC1.
const LOW: [u32; ENTRIES] = {
    let mut bits = [0; ENTRIES];
    let mut i = 0;
    while i < ENTRIES {
        bits[i] = 1 << (2 * i);
        i += 1;
    }
    bits
};

/// The three channels of a BC1 block, row by row.
#[inline(always)]
fn three(table: &[f32; LOOKUP], block: bc1::Block) -> [[f32; ENTRIES]; 3] {
    let [ends, indices] = bc1::words(block);
    let (first, second) = (ends & 0xffff, ends >> 16);
    let four = first > second;
    let (a, b) = (bc1::codes(first), bc1::codes(second));
    let mut out = [[0.0; ENTRIES]; 3];
    let (mut low, mut high) = ([false; ENTRIES], [false; ENTRIES]);
    for i in 0..ENTRIES {
        low[i] = indices & LOW[i] != 0;
        high[i] = indices & (LOW[i] << 1) != 0;
    }
    for c in 0..3 {
        let (a, b) = (bc1::widen(a[c], c != 1) as usize, bc1::widen(b[c], c != 1) as usize);
        let look = |at: usize| table[at % LOOKUP];
        let p = [
            look(3 * a),
            look(3 * b),
            look(if four { 2 * a + b } else { HALVES + a + b }),
            look(if four { a + 2 * b } else { BLACK }),
        ];
        for i in 0..ENTRIES {
            let ends = if low[i] { p[1] } else { p[0] };
            let between = if low[i] { p[3] } else { p[2] };
            out[c][i] = if high[i] { between } else { ends };
        }
    }
    out
}

/// The one channel of a BC4 block, row by row.
#[inline(always)]
fn one(table: &[f32; LOOKUP], block: bc4::Block) -> [f32; ENTRIES] {
    let (a, b) = (usize::from(block[0]), usize::from(block[1]));
    let mut palette = [0.0; 8];
    let look = |at: usize| table[at % LOOKUP];
    (palette[0], palette[1]) = (look(7 * a), look(7 * b));
    if a > b {
        for k in 1..7 {
            palette[k + 1] = look((7 - k) * a + k * b);
        }
    } else {
        for k in 1..5 {
            palette[k + 1] = look(FIFTHS + (5 - k) * a + k * b);
        }
        (palette[6], palette[7]) = (look(FIFTHS), look(FIFTHS + 5 * 255));
    }
    let bits = u64::from_le_bytes(block) >> 16;
    core::array::from_fn(|i| palette[(bits >> (3 * i) & 7) as usize])
}

/// A block of V channels: BC1 for three, BC4 for one.
#[inline(always)]
pub(super) fn decode<const V: usize>(table: &[f32; LOOKUP], block: [u8; 8]) -> [[f32; ENTRIES]; V] {
    let mut out = [[0.0; ENTRIES]; V];
    if V == 3 {
        let planes = three(table, block);
        out.iter_mut().zip(planes).for_each(|(out, plane)| *out = plane);
    } else if V == 1 {
        out[0] = one(table, block);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::counter::Counter;

    fn block(numbers: &Counter, k: u32) -> [u8; 8] {
        let mut block: [u8; 8] = core::array::from_fn(|d| (numbers.unit(k, 0, d as u32) * 256.0) as u8);
        // Equal ends, too.
        if k.is_multiple_of(8) {
            (block[2], block[3]) = (block[0], block[1]);
        }
        block
    }

    #[test]
    fn blocks_decode_to_the_values_of_their_codes() {
        let numbers = Counter::new(11);
        let values: [f32; 256] = core::array::from_fn(|c| c as f32 * c as f32);
        let (t1, t4) = (lookup(Format::Bc1, &values), lookup(Format::Bc4, &values));
        for k in 0..20_000 {
            let block = block(&numbers, k);
            let (texels, found) = (bc1::decode(block), decode::<3>(&t1, block));
            for i in 0..ENTRIES {
                for c in 0..3 {
                    assert_eq!(found[c][i], values[usize::from(texels[i][c])]);
                }
            }
            let (texels, [found]) = (bc4::decode(block), decode::<1>(&t4, block));
            assert!((0..ENTRIES).all(|i| found[i] == values[usize::from(texels[i])]), "{block:?}");
        }
    }
}
