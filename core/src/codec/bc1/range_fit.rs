//! Range fit in integers: the published baseline, and what a shader does bit for bit.

use super::palette::{bytes, five, narrow, palette};
use super::{Block, Rule, Texels};

/// Encodes by range fit: the endpoints are the two outermost texels, each texel takes its nearest palette entry.
///
/// Bit i of `counts` says whether texel i counts; others are "don't care" and get index 0. With none that counts the
/// block is all zeros (black).
///
/// Steps, all exact in 32-bit integers:
/// 1. the widest channel m (the lowest among equals) and the extents e_c = max - min;
/// 2. the axis v_c = e_c, or -e_c where the covariance of c and m is negative: the diagonal of the bounding box along
///    which the texels lie;
/// 3. the texels of smallest and largest v . x (the first among equals) are the endpoints, narrowed to 5, 6, 5 bits by
///    rounding to nearest;
/// 4. the larger word goes first (the mode of four colours; equal words give index 0 everywhere);
/// 5. the index of least squared distance to the palette of [`Rule::Nearest`], the lowest among equals.
///
/// Source: J. M. P. van Waveren, "Real-Time DXT Compression", 2006 (bounding box); the choice of the diagonal by the
/// covariance from his and I. Castaño's "Real-Time YCoCg-DXT Compression", 2007. Without their inset.
#[must_use]
pub fn encode_range_fit(texels: &Texels, counts: u32) -> Block {
    bytes(range_fit_words(texels, counts))
}

#[inline(always)]
pub(super) fn range_fit_words(texels: &Texels, counts: u32) -> [u32; 2] {
    let counted = |i: usize| counts >> i & 1 == 1;
    let (mut low, mut high, mut sum, mut n) = ([255_i32; 3], [0_i32; 3], [0_i32; 3], 0_i32);
    for (_, texel) in texels.iter().enumerate().filter(|(i, _)| counted(*i)) {
        for c in 0..3 {
            let x = i32::from(texel[c]);
            (low[c], high[c], sum[c]) = (low[c].min(x), high[c].max(x), sum[c] + x);
        }
        n += 1;
    }
    if n == 0 {
        return [0, 0];
    }
    let extent = [high[0] - low[0], high[1] - low[1], high[2] - low[2]];
    let mut widest = 0;
    for c in 1..3 {
        if extent[c] > extent[widest] {
            widest = c;
        }
    }
    // n^2 times the covariance: at most 2^8 * 2^16.
    let mut products = [0_i32; 3];
    for (_, texel) in texels.iter().enumerate().filter(|(i, _)| counted(*i)) {
        for c in 0..3 {
            products[c] += i32::from(texel[c]) * i32::from(texel[widest]);
        }
    }
    let mut axis = extent;
    for c in 0..3 {
        if n * products[c] < sum[c] * sum[widest] {
            axis[c] = -extent[c];
        }
    }
    let (mut ends, mut least, mut most) = ([[0_u8; 3]; 2], i32::MAX, i32::MIN);
    for (_, texel) in texels.iter().enumerate().filter(|(i, _)| counted(*i)) {
        let t = axis[0] * i32::from(texel[0]) + axis[1] * i32::from(texel[1]) + axis[2] * i32::from(texel[2]);
        if t < least {
            (least, ends[0]) = (t, *texel);
        }
        if t > most {
            (most, ends[1]) = (t, *texel);
        }
    }
    let word = |end: [u8; 3]| {
        let [r, g, b] = [0, 1, 2].map(|c| narrow(u32::from(end[c]), five(c)));
        r << 11 | g << 5 | b
    };
    let (a, b) = (word(ends[0]), word(ends[1]));
    let (first, second) = if a > b { (a, b) } else { (b, a) };
    let indices = if first > second { nearest_indices(texels, counts, first, second, 4) } else { 0 };
    [first | second << 16, indices]
}

/// The nearest of the first `entries` palette entries for each texel that counts (the lowest among equals), 0 for others.
#[inline(always)]
pub(super) fn nearest_indices(texels: &Texels, counts: u32, first: u32, second: u32, entries: usize) -> u32 {
    let palette = palette(first, second, Rule::Nearest);
    let mut indices = 0;
    for (i, texel) in texels.iter().enumerate() {
        let (mut best, mut index) = (u32::MAX, 0);
        for (p, entry) in palette.iter().enumerate().take(entries) {
            let d = distance(*texel, [entry[0], entry[1], entry[2]]);
            if d < best {
                (best, index) = (d, p as u32);
            }
        }
        indices |= (index * (counts >> i & 1)) << (2 * i);
    }
    indices
}

/// Squared distance, summed over the channels.
#[inline(always)]
pub(super) fn distance(a: [u8; 3], b: [u8; 3]) -> u32 {
    let d = |c: usize| u32::from(a[c].abs_diff(b[c]));
    d(0) * d(0) + d(1) * d(1) + d(2) * d(2)
}
