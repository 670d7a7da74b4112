//! Eight floats at a time: what the tests of [`super::lanes`] are written in, and the portable form of it.
//!
//! Every operation is core's own on each lane, so all forms give the same bits; only [`Fused`] rounds differently, and only
//! boxes are tested with it.

use super::layout::WIDTH;
use core::mem::MaybeUninit;

/// Eight floats in memory, aligned for loads and stores of whole registers, and so that the compiler aligns what it keeps on
/// the stack beside them.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub(super) struct Eight(pub(super) [f32; WIDTH]);

/// Eight floats. Not every processor has every form: see [`super::isa`].
pub(super) trait Floats: Copy {
    /// A truth a lane.
    type Mask: Copy;
    /// The same in each lane.
    fn splat(x: f32) -> Self;
    /// Eight in a row.
    fn load(row: &[f32; WIDTH]) -> Self;
    /// To memory.
    fn store(self, to: &mut Eight);
    /// Sum.
    fn add(self, other: Self) -> Self;
    /// Difference.
    fn sub(self, other: Self) -> Self;
    /// Product.
    fn mul(self, other: Self) -> Self;
    /// Quotient.
    fn div(self, other: Self) -> Self;
    /// The lesser; `other` where either is NaN.
    fn min(self, other: Self) -> Self;
    /// The greater; `other` where either is NaN.
    fn max(self, other: Self) -> Self;
    /// Magnitude.
    fn abs(self) -> Self;
    /// Less; false for NaN.
    fn lt(self, other: Self) -> Self::Mask;
    /// At most; false for NaN.
    fn le(self, other: Self) -> Self::Mask;
    /// Both.
    fn both(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// Either.
    fn either(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// The truth of lane i as bit i.
    fn bits(mask: Self::Mask) -> u32;
    /// The same truth in every lane.
    fn all(truth: bool) -> Self::Mask;
    /// `a` where true, else `b`.
    fn pick(mask: Self::Mask, a: Self, b: Self) -> Self;
    /// Writes the words of the set bits to the front of `to`, the highest first; what comes after them may be overwritten.
    fn gather(words: &[u32; WIDTH], bits: u32, to: &mut [MaybeUninit<u32>; WIDTH]);
}

/// Floats with a fused product.
pub(super) trait Fused: Floats {
    /// `self * factor + term`, rounded once.
    fn mul_add(self, factor: Self, term: Self) -> Self;
    /// The least of the lanes whose bits are set; infinity where none is.
    fn least_of(self, bits: u32) -> f32;
    /// A bit for each lane where `self`, not negative, is at most `other` and `ULPS` units in its last place.
    fn at_most_and_ulps<const ULPS: i32>(self, other: Self) -> u32;
}

/// One lane after the other, for the compiler to make of it what the machine has.
#[derive(Clone, Copy)]
pub(super) struct Portable([f32; WIDTH]);

impl Portable {
    #[inline(always)]
    fn with(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        let mut out = [0.0; WIDTH];
        for ((out, a), b) in out.iter_mut().zip(self.0).zip(other.0) {
            *out = f(a, b);
        }
        Self(out)
    }

    #[inline(always)]
    fn test(self, other: Self, f: impl Fn(f32, f32) -> bool) -> [u32; WIDTH] {
        let mut out = [0; WIDTH];
        for ((out, a), b) in out.iter_mut().zip(self.0).zip(other.0) {
            *out = if f(a, b) { u32::MAX } else { 0 };
        }
        out
    }
}

impl Floats for Portable {
    type Mask = [u32; WIDTH];

    #[inline(always)]
    fn splat(x: f32) -> Self {
        Self([x; WIDTH])
    }

    #[inline(always)]
    fn load(row: &[f32; WIDTH]) -> Self {
        Self(*row)
    }

    #[inline(always)]
    fn store(self, to: &mut Eight) {
        to.0 = self.0;
    }

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.with(other, |a, b| a + b)
    }

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.with(other, |a, b| a - b)
    }

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.with(other, |a, b| a * b)
    }

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.with(other, |a, b| a / b)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.with(other, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.with(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.map(f32::abs))
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Self::Mask {
        self.test(other, |a, b| a < b)
    }

    #[inline(always)]
    fn le(self, other: Self) -> Self::Mask {
        self.test(other, |a, b| a <= b)
    }

    #[inline(always)]
    fn both(mut a: Self::Mask, b: Self::Mask) -> Self::Mask {
        for (a, b) in a.iter_mut().zip(b) {
            *a &= b;
        }
        a
    }

    #[inline(always)]
    fn either(mut a: Self::Mask, b: Self::Mask) -> Self::Mask {
        for (a, b) in a.iter_mut().zip(b) {
            *a |= b;
        }
        a
    }

    #[inline(always)]
    fn bits(mask: Self::Mask) -> u32 {
        mask.iter().enumerate().fold(0, |bits, (i, m)| bits | (m & 1 << i))
    }

    #[inline(always)]
    fn all(truth: bool) -> Self::Mask {
        [if truth { u32::MAX } else { 0 }; WIDTH]
    }

    #[inline(always)]
    fn pick(mask: Self::Mask, a: Self, b: Self) -> Self {
        let mut out = [0.0; WIDTH];
        for (i, out) in out.iter_mut().enumerate() {
            *out = if mask[i] != 0 { a.0[i] } else { b.0[i] };
        }
        Self(out)
    }

    #[inline(always)]
    fn gather(words: &[u32; WIDTH], mut bits: u32, to: &mut [MaybeUninit<u32>; WIDTH]) {
        for to in to {
            let Some(slot) = bits.checked_ilog2() else { break };
            bits &= !(1 << slot);
            to.write(words[slot as usize & (WIDTH - 1)]);
        }
    }
}
