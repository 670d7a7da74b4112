//! Several floats that work as one.

use super::palette::bytes;
use super::{Block, Texels};

/// Several f32 with the same operation in each: an array here, a register in a backend.
///
/// Every operation is the IEEE one in each lane, so that all implementations give the same bits.
pub trait Vector: Copy {
    /// As many 32-bit words.
    type Words: Copy;
    /// As many blocks.
    type Blocks: Copy;

    /// The same number in each lane.
    fn splat(x: f32) -> Self;
    /// `self + other`.
    fn add(self, other: Self) -> Self;
    /// `self - other`.
    fn sub(self, other: Self) -> Self;
    /// `self * other`.
    fn mul(self, other: Self) -> Self;
    /// `self / other`.
    fn div(self, other: Self) -> Self;
    /// `if self < other { self } else { other }`.
    fn min(self, other: Self) -> Self;
    /// `if self > other { self } else { other }`.
    fn max(self, other: Self) -> Self;
    /// The nearest integer, halves to even; 0 <= self < 2^22.
    fn round(self) -> Self;
    /// `if self > other { yes } else { no }`.
    fn pick(self, other: Self, yes: Self, no: Self) -> Self;
    /// The bits of each float.
    fn bits(self) -> Self::Words;
    /// Words below 2^24 as floats.
    fn float(words: Self::Words) -> Self;
    /// Bytes 4k to 4k + 3 of each block's texels, little-endian, for k in 0..12.
    fn load(blocks: &Self::Blocks) -> [Self::Words; 12];

    /// The same word in each lane.
    fn word(x: u32) -> Self::Words;
    /// `a & b`.
    fn and(a: Self::Words, b: Self::Words) -> Self::Words;
    /// `a | b`.
    fn or(a: Self::Words, b: Self::Words) -> Self::Words;
    /// `a ^ b`.
    fn xor(a: Self::Words, b: Self::Words) -> Self::Words;
    /// `a << BITS`.
    fn left<const BITS: i32>(a: Self::Words) -> Self::Words;
    /// `a >> BITS`.
    fn right<const BITS: i32>(a: Self::Words) -> Self::Words;
}

/// A [`Vector`] of eight.
pub trait Eight: Vector<Blocks = [Texels; 8]> {
    /// The lanes from memory.
    fn read(x: &[f32; 8]) -> Self;
    /// The lanes to memory.
    fn write(self) -> [f32; 8];
    /// The blocks of which these are the two words.
    fn blocks(words: [Self::Words; 2]) -> [Block; 8];
}

impl Eight for Lanes<8> {
    #[inline(always)]
    fn read(x: &[f32; 8]) -> Self {
        Self(*x)
    }
    #[inline(always)]
    fn write(self) -> [f32; 8] {
        self.0
    }
    #[inline(always)]
    fn blocks([ends, indices]: [[u32; 8]; 2]) -> [Block; 8] {
        let mut out = [[0; 8]; 8];
        for (l, out) in out.iter_mut().enumerate() {
            *out = bytes([ends[l], indices[l]]);
        }
        out
    }
}

/// The sum of 16 numbers, in a fixed order: halves are added lane by lane.
#[inline(always)]
pub(super) fn sum<V: Eight>(low: V, high: V) -> f32 {
    let a = low.add(high).write();
    let b = [a[0] + a[4], a[1] + a[5], a[2] + a[6], a[3] + a[7]];
    (b[0] + b[2]) + (b[1] + b[3])
}

/// Both halves of 16 numbers.
#[inline(always)]
pub(super) fn halves<V: Eight>(x: &[f32; 16]) -> [V; 2] {
    match x.as_chunks() {
        ([low, high], _) => [V::read(low), V::read(high)],
        // 16 numbers are two chunks of eight.
        _ => [V::splat(0.0); 2],
    }
}

/// [`Vector`] as an array.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lanes<const L: usize>(pub(super) [f32; L]);

/// Adding it rounds a number of [0, 2^22) to an integer, halves to even.
const SHIFT: f32 = 12_582_912.0;

impl<const L: usize> Lanes<L> {
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        let mut out = self.0;
        for (x, y) in out.iter_mut().zip(other.0) {
            *x = f(*x, y);
        }
        Self(out)
    }
}

#[inline(always)]
fn zip<const L: usize>(mut a: [u32; L], b: [u32; L], f: impl Fn(u32, u32) -> u32) -> [u32; L] {
    for (x, y) in a.iter_mut().zip(b) {
        *x = f(*x, y);
    }
    a
}

impl<const L: usize> Vector for Lanes<L> {
    type Words = [u32; L];
    type Blocks = [Texels; L];

    #[inline(always)]
    fn splat(x: f32) -> Self {
        Self([x; L])
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |x, y| x + y)
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |x, y| x - y)
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |x, y| x * y)
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.zip(other, |x, y| x / y)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.zip(other, crate::math::min)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, crate::math::max)
    }
    #[inline(always)]
    fn round(self) -> Self {
        Self(self.0.map(|x| x + SHIFT - SHIFT))
    }
    #[inline(always)]
    fn pick(self, other: Self, yes: Self, no: Self) -> Self {
        let mut out = self.0;
        for (i, x) in out.iter_mut().enumerate() {
            *x = if *x > other.0[i] { yes.0[i] } else { no.0[i] };
        }
        Self(out)
    }
    #[inline(always)]
    fn bits(self) -> [u32; L] {
        self.0.map(f32::to_bits)
    }
    #[inline(always)]
    fn float(words: [u32; L]) -> Self {
        Self(words.map(|w| w as i32 as f32))
    }
    #[inline(always)]
    fn load(blocks: &[Texels; L]) -> [[u32; L]; 12] {
        let mut out = [[0; L]; 12];
        for (l, block) in blocks.iter().enumerate() {
            let (words, _) = block.as_flattened().as_chunks::<4>();
            for (out, word) in out.iter_mut().zip(words) {
                out[l] = u32::from_le_bytes(*word);
            }
        }
        out
    }
    #[inline(always)]
    fn word(x: u32) -> [u32; L] {
        [x; L]
    }
    #[inline(always)]
    fn and(a: [u32; L], b: [u32; L]) -> [u32; L] {
        zip(a, b, |x, y| x & y)
    }
    #[inline(always)]
    fn or(a: [u32; L], b: [u32; L]) -> [u32; L] {
        zip(a, b, |x, y| x | y)
    }
    #[inline(always)]
    fn xor(a: [u32; L], b: [u32; L]) -> [u32; L] {
        zip(a, b, |x, y| x ^ y)
    }
    #[inline(always)]
    fn left<const BITS: i32>(a: [u32; L]) -> [u32; L] {
        a.map(|x| x << BITS)
    }
    #[inline(always)]
    fn right<const BITS: i32>(a: [u32; L]) -> [u32; L] {
        a.map(|x| x >> BITS)
    }
}
