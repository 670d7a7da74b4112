//! Which entries are kept as they are.

use alloc::vec;
use alloc::vec::Vec;

/// Marks the largest of `keys`, a share of all of them rounded to a whole number; the first among equals, and none that is not above 0.
pub(super) fn largest(keys: &[f32], share: f32) -> Vec<bool> {
    let mut kept = vec![false; keys.len()];
    let positive = keys.iter().filter(|x| **x > 0.0).count();
    // Negative and NaN shares become 0.
    let wanted = (f64::from(share) * keys.len() as f64 + 0.5) as usize;
    let wanted = wanted.min(positive);
    if wanted == 0 {
        return kept;
    }
    // Bits of positive floats are in the order of the floats: first the upper half of the least that is kept, then all of it.
    let bits = || keys.iter().filter(|x| **x > 0.0).map(|x| x.to_bits());
    let (upper, above) = last(bits().map(|b| b >> 16), wanted);
    let (lower, more) = last(bits().filter(|b| b >> 16 == upper).map(|b| b & 0xffff), wanted - above);
    let least = upper << 16 | lower;
    let mut equals = wanted - above - more;
    for (kept, key) in kept.iter_mut().zip(keys) {
        if *key > 0.0 {
            let bits = key.to_bits();
            *kept = bits > least || (bits == least && equals > 0);
            if bits == least {
                equals = equals.saturating_sub(1);
            }
        }
    }
    kept
}

/// The `wanted`-th largest of numbers below 2^16, and how many are larger.
fn last(numbers: impl Iterator<Item = u32>, wanted: usize) -> (u32, usize) {
    let mut counts = vec![0_usize; 1 << 16];
    for x in numbers {
        counts[x as usize & 0xffff] += 1;
    }
    let mut above = 0;
    for (x, count) in counts.iter().enumerate().rev() {
        if above + count >= wanted {
            return (x as u32, above);
        }
        above += count;
    }
    (0, above)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::counter::Counter;

    #[test]
    fn the_largest_are_those_that_sorting_finds() {
        let numbers = Counter::new(2);
        // Many equals, many zeros.
        let keys: Vec<f32> = (0..1000)
            .map(|i| {
                let x = numbers.unit(i, 0, 0);
                if x < 0.3 { 0.0 } else { ((x * 50.0) as u32) as f32 + (i % 2) as f32 * 1e-5 }
            })
            .collect();
        for share in [0.0, 0.0004, 0.001, 0.04, 0.5, 0.7, 1.0, 2.0, -1.0, f32::NAN] {
            let mut order: Vec<usize> = (0..keys.len()).filter(|i| keys[*i] > 0.0).collect();
            order.sort_by(|a, b| keys[*b].total_cmp(&keys[*a]).then(a.cmp(b)));
            let count = (f64::from(share) * 1000.0 + 0.5) as usize;
            let mut expected = vec![false; keys.len()];
            order.iter().take(count).for_each(|i| expected[*i] = true);
            assert_eq!(largest(&keys, share), expected, "{share}");
        }
    }
}
