//! What the words of a block mean: endpoints, palettes, and the rules by which decoders round.

use super::{Block, Texels};

/// How a decoder computes the two colours between the endpoints.
///
/// The format leaves the rounding open: it states 2/3 and 1/3 (or 1/2) of real numbers. a and b are the endpoints'
/// 8-bit values, a5 and b5 their 5-bit codes. Every rule widens the endpoints by bit replication, `x5 << 3 | x5 >> 2` and
/// `x6 << 2 | x6 >> 4`, which is within 1 of 255 x5 / 31 and 255 x6 / 63 (x5 = 3 gives 24, not 24.68 rounded).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Rule {
    /// The reference: thirds to nearest, `(2a + b + 1) / 3`; halves upward, `(a + b + 1) / 2`.
    Nearest,
    /// Both downward, `(2a + b) / 3` and `(a + b) / 2`: many software decoders.
    Truncated,
    /// `(171 a + 85 b) >> 8`, `(86 a + 170 b) >> 8` and `(a + b + 1) >> 1`: Mesa's llvmpipe and lavapipe, as textures of all pairs of codes show (22.3.6). Of `a + ((b - a) w >> 8)` these are
    /// the weights 85 and 170.
    Mesa,
    /// `(43 a + 21 b + 32) >> 6` and `(a + b + 1) >> 1`: AMD's hardware, as encoders that aim at it document.
    Amd,
    /// Red and blue from the codes, `(2 a5 + b5) 22 / 8` and `(a5 + b5) 33 / 8`; green from d = b - a, `(256 a + trunc(d / 4) + 128 + 80 d) >> 8` and the same with 128 d: NVIDIA's hardware since GeForce
    /// 8, as NVIDIA's texture tools document (I. Castaño, 2008).
    Nvidia,
}

impl Rule {
    /// All rules; the position of one is its code.
    pub const ALL: [Self; 5] = [Self::Nearest, Self::Truncated, Self::Mesa, Self::Amd, Self::Nvidia];

    /// Two parts of a and one of b; a is the first endpoint, or the second where `back` is set. `codes` are 5-bit where `five` is set, else 6-bit.
    #[inline(always)]
    const fn third(self, codes: [u32; 2], five: bool, back: bool) -> u32 {
        let [a, b] = [widen(codes[0], five), widen(codes[1], five)];
        match self {
            Self::Nearest => (2 * a + b + 1) / 3,
            Self::Truncated => (2 * a + b) / 3,
            Self::Mesa if back => (170 * a + 86 * b) >> 8,
            Self::Mesa => (171 * a + 85 * b) >> 8,
            Self::Amd => (43 * a + 21 * b + 32) >> 6,
            Self::Nvidia if five => (2 * codes[0] + codes[1]) * 22 / 8,
            Self::Nvidia => nvidia_green(a, b, 80),
        }
    }

    /// Half of each.
    #[inline(always)]
    const fn half(self, codes: [u32; 2], five: bool) -> u32 {
        let [a, b] = [widen(codes[0], five), widen(codes[1], five)];
        match self {
            Self::Nearest | Self::Amd | Self::Mesa => (a + b).div_ceil(2),
            Self::Truncated => (a + b) / 2,
            Self::Nvidia if five => (codes[0] + codes[1]) * 33 / 8,
            Self::Nvidia => nvidia_green(a, b, 128),
        }
    }
}

/// The sum is never negative: 256 a + 80 d >= 176 a.
#[inline(always)]
const fn nvidia_green(a: u32, b: u32, part: i32) -> u32 {
    let d = b as i32 - a as i32;
    ((256 * a as i32 + d / 4 + 128 + part * d) >> 8) as u32
}

/// A 5-bit or 6-bit code as 8 bits, by bit replication.
#[inline(always)]
pub(crate) const fn widen(code: u32, five: bool) -> u32 {
    if five { code << 3 | code >> 2 } else { code << 2 | code >> 4 }
}

/// The 5-bit or 6-bit code nearest to an 8-bit value: x 31 / 255 or x 63 / 255, rounded (ties do not occur).
#[inline(always)]
pub(super) const fn narrow(value: u32, five: bool) -> u32 {
    if five { (value * 31 + 127) / 255 } else { (value * 63 + 127) / 255 }
}

/// The codes of an endpoint: red, green, blue.
#[inline(always)]
pub(crate) const fn codes(word: u32) -> [u32; 3] {
    [word >> 11 & 31, word >> 5 & 63, word & 31]
}

/// Whether a channel has 5 bits.
#[inline(always)]
pub(super) const fn five(channel: usize) -> bool {
    channel != 1
}

/// The four entries of a block's palette, red, green, blue, alpha: the two endpoints, then what lies between.
///
/// `first > second` as 16-bit words selects the mode of four colours; else entry 2 is the mean and entry 3 is black with
/// alpha 0. Alpha is 255 elsewhere.
#[inline(always)]
pub(super) fn palette(first: u32, second: u32, rule: Rule) -> [[u8; 4]; 4] {
    let (a, b) = (codes(first), codes(second));
    let four = first > second;
    let mut out = [[0, 0, 0, 255], [0, 0, 0, 255], [0, 0, 0, 255], [0, 0, 0, if four { 255 } else { 0 }]];
    for c in 0..3 {
        let (ab, ba) = ([a[c], b[c]], [b[c], a[c]]);
        out[0][c] = widen(a[c], five(c)) as u8;
        out[1][c] = widen(b[c], five(c)) as u8;
        out[2][c] = if four { rule.third(ab, five(c), false) } else { rule.half(ab, five(c)) } as u8;
        out[3][c] = if four { rule.third(ba, five(c), true) as u8 } else { 0 };
    }
    out
}

/// The words of a block: both endpoints (the first in the low half), and the indices (texel 0 in the lowest two bits).
#[inline(always)]
pub(crate) const fn words(block: Block) -> [u32; 2] {
    let [a, b, c, d, e, f, g, h] = block;
    [u32::from_le_bytes([a, b, c, d]), u32::from_le_bytes([e, f, g, h])]
}

/// The bytes of the two words.
#[inline(always)]
pub(super) const fn bytes(words: [u32; 2]) -> Block {
    let ([a, b, c, d], [e, f, g, h]) = (words[0].to_le_bytes(), words[1].to_le_bytes());
    [a, b, c, d, e, f, g, h]
}

/// Decodes by a given rule: red, green, blue, alpha. Every block is legal. Exact integers.
///
/// Alpha is 0 for the black entry of the mode of three colours, else 255.
#[inline]
#[must_use]
pub fn decode_with(block: Block, rule: Rule) -> [[u8; 4]; 16] {
    let [ends, indices] = words(block);
    let palette = palette(ends & 0xffff, ends >> 16, rule);
    core::array::from_fn(|i| palette[(indices >> (2 * i) & 3) as usize])
}

/// Decodes by the reference rule, with alpha: see [`decode_with`].
#[inline]
#[must_use]
pub fn decode_rgba(block: Block) -> [[u8; 4]; 16] {
    decode_with(block, Rule::Nearest)
}

/// Decodes by the reference rule. Every block is legal. Exact integers; the black entry is black.
#[inline]
#[must_use]
pub fn decode(block: Block) -> Texels {
    decode_rgba(block).map(|[r, g, b, _]| [r, g, b])
}
