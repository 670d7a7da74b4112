//! Counting the thresholds up to a number with one look into a table.
//!
//! The floats between the lowest and the highest threshold are cut into buckets by the upper bits of their
//! representation, fine enough that no bucket holds two thresholds. With L low bits left, a bucket that starts after n
//! thresholds and has one more at low bits r stores `(n << L) + (2^L - r)`. Adding the low bits of a number carries into
//! bit L exactly if they reach r, so that the sum's upper bits are the count: the comparison with the threshold, without a
//! comparison.

use crate::math;

/// Room for the buckets of any table of [`super::LogOffset`].
///
/// With steps of s in the logarithm, L is the largest that will do; with L + 1 some bucket of ratio 1 + rho has two
/// thresholds, so 2^(22-L) < 1/(e^s - 1) < 1/s. A range of width w < 255 s then has at most
/// 2^(23-L) min(w/ln 2 + 0.087, 2 w) < 1020 buckets, and two for its ends (the rounding of the thresholds adds 2^-11 of
/// that). Seldom more than 740 are in use.
const ROOM: usize = 1024;

/// The table.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Buckets {
    /// The float below the lowest threshold.
    low: f32,
    /// The highest threshold.
    high: f32,
    /// Low bits per bucket, L.
    shift: u32,
    /// Bucket of `low`.
    first: u32,
    entries: [u32; ROOM],
}

impl Buckets {
    /// The table of thresholds that never decrease, all positive and normal.
    pub(super) fn new(thresholds: &[f32; 255]) -> Self {
        let (low, high) = (thresholds[0].next_down(), thresholds[254]);
        let mut buckets = Self { low, high, shift: 0, first: low.to_bits(), entries: [0; ROOM] };
        for shift in (0..=22).rev() {
            if buckets.fill(thresholds, shift) {
                break;
            }
        }
        buckets
    }

    /// Fills the table; false if a bucket would hold two thresholds.
    fn fill(&mut self, thresholds: &[f32; 255], shift: u32) -> bool {
        let (first, last) = (self.low.to_bits() >> shift, self.high.to_bits() >> shift);
        (self.shift, self.first) = (shift, first);
        let mut below = 0_usize;
        for (entry, bucket) in self.entries.iter_mut().zip(first..=last) {
            let start = bucket << shift;
            let until = |end: u32, from: usize| {
                from + thresholds[from..].iter().take_while(|t| t.to_bits() <= end).count()
            };
            below = until(start, below);
            let within = until(start + ((1 << shift) - 1), below);
            let carry = match within - below {
                0 => 0,
                1 => (1 << shift) - (thresholds[below].to_bits() - start),
                _ => return false,
            };
            *entry = ((below as u32) << shift) + carry;
            below = within;
        }
        true
    }

    /// How many thresholds are not above each `x`; 0 for NaN.
    ///
    /// In lanes, the looks into the table apart from the arithmetic, which then runs in wide registers.
    #[inline(always)]
    pub(super) fn counts<const N: usize>(&self, x: &[f32; N]) -> [u8; N] {
        let mask = (1 << self.shift) - 1;
        let mut bits = [0_u32; N];
        for (b, x) in bits.iter_mut().zip(x) {
            *b = math::clamp(*x, self.low, self.high).to_bits();
        }
        let mut entries = [0_u32; N];
        for (e, b) in entries.iter_mut().zip(&bits) {
            let bucket = (b >> self.shift).wrapping_sub(self.first);
            // The mask spares the check of the bounds; it changes nothing.
            *e = self.entries[bucket as usize & (ROOM - 1)];
        }
        let mut out = [0_u8; N];
        for ((o, e), b) in out.iter_mut().zip(&entries).zip(&bits) {
            *o = ((e + (b & mask)) >> self.shift) as u8;
        }
        out
    }

    /// Buckets in use.
    #[cfg(test)]
    pub(super) fn used(&self) -> u32 {
        (self.high.to_bits() >> self.shift) - self.first + 1
    }
}

#[cfg(test)]
mod tests {
    use super::super::{LogOffset, MIN_WIDTH};

    #[test]
    fn every_table_has_room() {
        // Widths in small ratios, mantissas of the largest number around the octave.
        let mut most = 0;
        let mut width = MIN_WIDTH;
        while width < 80.0 {
            for m in 0..64_u32 {
                let max = f32::from_bits(0x3f80_0000 + (m << 17));
                let q = LogOffset::try_new(width, max).expect("in range");
                most = most.max(q.buckets.used());
            }
            width *= 1.037;
        }
        assert!((700..=1022).contains(&most), "{most} buckets");
    }
}
