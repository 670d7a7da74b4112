//! The published order: from a row to the one most like it.

use alloc::vec::Vec;

/// Bytes after which a sum that is too large is given up.
const CHUNK: usize = 256;

/// Sum of the absolute differences of bytes, over the shorter length.
#[inline(always)]
pub fn distance(a: &[u8], b: &[u8]) -> u64 {
    below(a, b, u64::MAX).unwrap_or(u64::MAX)
}

/// The same, unless it is not below a limit.
#[inline(always)]
fn below(a: &[u8], b: &[u8], limit: u64) -> Option<u64> {
    let mut sum = 0_u64;
    for (a, b) in a.chunks(CHUNK).zip(b.chunks(CHUNK)) {
        // At most 256 x 255.
        sum += u64::from(a.iter().zip(b).map(|(a, b)| u32::from(a.abs_diff(*b))).sum::<u32>());
        if sum >= limit {
            return None;
        }
    }
    Some(sum)
}

fn row(codes: &[u8], width: usize, row: u32) -> &[u8] {
    codes.get(row as usize * width..).and_then(|rest| rest.get(..width)).unwrap_or(&[])
}

/// Bytes of a group, of which the sum is known.
const GROUP: usize = 32;

/// Sums of groups of bytes, row after row. Rows differ by no less than their sums do.
fn group_sums(codes: &[u8], width: usize) -> Vec<u16> {
    let sum = |group: &[u8]| group.iter().map(|x| u16::from(*x)).sum();
    codes.chunks(width.max(1)).flat_map(|row| row.chunks(GROUP).map(sum)).collect()
}

/// Whether sums of groups differ by less than a limit.
#[inline(always)]
fn may_be_below(a: &[u16], b: &[u16], limit: u64) -> bool {
    // At most 65536 x 3 / 32 sums of 32 x 255.
    u64::from(a.iter().zip(b).map(|(a, b)| u32::from(a.abs_diff(*b))).sum::<u32>()) < limit
}

/// One pass: row after row, the one below that is nearest by the sum of absolute differences changes places with the next; the first among equals. Rows have `width` bytes, and `order` says where which is.
///
/// n^2 / 2 comparisons, first of sums of groups of 32 bytes, then of bytes until they are no better than the best so far: the result is that of whole comparisons.
#[inline(always)]
pub fn greedy(codes: &[u8], width: usize, order: &mut [u32]) {
    let sums = group_sums(codes, width);
    let groups = width.div_ceil(GROUP);
    let of = |row: u32| sums.get(row as usize * groups..).and_then(|s| s.get(..groups)).unwrap_or(&[]);
    for here in 0..order.len().saturating_sub(1) {
        let (current, current_sums) = (row(codes, width, order[here]), of(order[here]));
        let (mut best, mut at) = (u64::MAX, here + 1);
        for (k, other) in order.iter().enumerate().skip(here + 1) {
            if may_be_below(current_sums, of(*other), best)
                && let Some(sum) = below(current, row(codes, width, *other), best)
            {
                (best, at) = (sum, k);
            }
        }
        order.swap(here + 1, at);
    }
}

/// Sum of the distances from each row to the next in an order: what [`greedy`] makes small, where both are of rows.
pub fn neighbour_distance(codes: &[u8], width: usize, order: &[u32]) -> u64 {
    order.windows(2).map(|pair| distance(row(codes, width, pair[0]), row(codes, width, pair[1]))).sum()
}
