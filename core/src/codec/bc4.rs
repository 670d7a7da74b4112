//! Blocks of 4x4 one-channel texels in 8 bytes: the format BC4, unsigned.
//!
//! Bytes 0 and 1 are the endpoints a and b, the other 48 bits 16 indices of 3 bits, texel 0 lowest, row by row. Where
//! a > b the palette is a, b and the six values between, ((7 - k) a + k b) / 7 for k = 1..6; else a, b, four values
//! ((5 - k) a + k b) / 5 for k = 1..4, then 0 and 255. All 2^64 blocks are legal. The format leaves the rounding open;
//! here quotients are rounded to nearest (`+ 3` and `+ 2` before dividing; ties do not occur).
//!
//! Encoding minimises sum_i w_i (x_i - y_i)^2, in units of (1/255)^2. Weights as in [`super::bc1::encode`].

use super::bc1::{Eight, PortableLanes as Lanes};
use crate::math;

/// 16 texels, row by row.
pub type Texels = [u8; 16];
/// 8 bytes.
pub type Block = [u8; 8];

/// How much an encoder tries.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Quality {
    /// [`encode_range_fit`]: the largest and the smallest texel; a weight only says whether a texel counts.
    RangeFit,
    /// From there, and from the texels other than 0 and 255 in the mode that has these, both endpoints move by one as
    /// long as that gains.
    Refined,
    /// All 65 536 pairs of endpoints, those dropped early that cannot be best: the exact optimum where all texels count
    /// alike, else the optimum of f32 sums of 16 terms.
    Exhaustive,
}

impl Quality {
    /// All of them, the quickest first.
    pub const ALL: [Self; 3] = [Self::RangeFit, Self::Refined, Self::Exhaustive];
}

/// The eight entries of a palette.
#[inline(always)]
#[must_use]
pub const fn palette(a: u8, b: u8) -> [u8; 8] {
    let (x, y) = (a as u32, b as u32);
    let mut out = [a, b, 0, 0, 0, 0, 0, 255];
    let n = if a > b { 7 } else { 5 };
    let mut k = 1;
    while k < n {
        out[k as usize + 1] = (((n - k) * x + k * y + n / 2) / n) as u8;
        k += 1;
    }
    out
}

/// Decodes a block. Every block is legal. Exact integers.
#[inline]
#[must_use]
pub fn decode(block: Block) -> Texels {
    let [a, b, ..] = block;
    let palette = palette(a, b);
    let bits = u64::from_le_bytes(block) >> 16;
    core::array::from_fn(|i| palette[(bits >> (3 * i) & 7) as usize])
}

/// A block of endpoints and the nearest index for each texel that counts (the lowest among equals), 0 for the others.
#[inline(always)]
fn block(texels: &Texels, counts: u32, a: u8, b: u8) -> Block {
    let palette = palette(a, b);
    let mut bits = 0_u64;
    for (i, x) in texels.iter().enumerate() {
        let (mut best, mut index) = (u32::MAX, 0);
        for (p, entry) in palette.iter().enumerate() {
            let d = u32::from(x.abs_diff(*entry));
            if d < best {
                (best, index) = (d, p as u64);
            }
        }
        bits |= (index * u64::from(counts >> i & 1)) << (3 * i);
    }
    (u64::from(a) | u64::from(b) << 8 | bits << 16).to_le_bytes()
}

/// Encodes by range fit: a is the largest, b the smallest of the texels that count (bit i of `counts` says so of texel
/// i); each takes the nearest entry, the lowest index among equals. Texels that do not count get index 0. With none that
/// counts the block is all zeros. Exact integers. A constant block is exact.
#[must_use]
pub fn encode_range_fit(texels: &Texels, counts: u32) -> Block {
    let (mut low, mut high, mut any) = (255, 0, false);
    for (i, x) in texels.iter().enumerate() {
        if counts >> i & 1 == 1 {
            (low, high, any) = (low.min(*x), high.max(*x), true);
        }
    }
    if any { block(texels, counts, high, low) } else { [0; 8] }
}

/// Distinct values and their weights, the largest in [1, 2).
struct Target {
    x: [f32; 16],
    w: [f32; 16],
    len: usize,
    counts: u32,
}

impl Target {
    fn new(texels: &Texels, weights: &[f32; 16]) -> Self {
        let clean = weights.map(|w| if w > 0.0 { math::min(w, f32::MAX) } else { 0.0 });
        let largest = clean.iter().fold(0.0, |m, w| math::max(*w, m));
        let k = -math::exponent(largest);
        let alike = clean.iter().all(|w| *w == largest);
        let mut this = Self { x: [0.0; 16], w: [0.0; 16], len: 0, counts: 0 };
        for (i, (x, w)) in texels.iter().zip(clean).enumerate() {
            if w <= 0.0 {
                continue;
            }
            this.counts |= 1 << i;
            let w = if alike { 1.0 } else { math::ldexp(w, k) };
            let x = f32::from(*x);
            match this.x[..this.len].iter().position(|y| *y == x) {
                Some(k) => this.w[k] += w,
                None => {
                    (this.x[this.len], this.w[this.len]) = (x, w);
                    this.len += 1;
                }
            }
        }
        this
    }

    /// The errors of eight pairs of endpoints, one per lane.
    #[inline(always)]
    fn errors<V: Eight>(&self, a: [u8; 8], b: [u8; 8]) -> [f32; 8] {
        let mut entries = [[0.0; 8]; 8];
        for l in 0..8 {
            for (entry, value) in entries.iter_mut().zip(palette(a[l], b[l])) {
                entry[l] = f32::from(value);
            }
        }
        let entries = entries.each_ref().map(V::read);
        let mut sum = V::splat(0.0);
        for (x, w) in self.x[..self.len].iter().zip(&self.w) {
            let x = V::splat(*x);
            let mut least = V::splat(f32::MAX);
            for entry in entries {
                let d = x.sub(entry);
                least = d.mul(d).min(least);
            }
            sum = sum.add(least.mul(V::splat(*w)));
        }
        sum.write()
    }
}

/// Endpoints and the error they reach.
#[derive(Clone, Copy)]
struct Candidate {
    ends: [u8; 2],
    error: f32,
}

/// Moves both endpoints by -1, 0 or 1 to the best pair as long as that gains; the mode stays or changes as it falls.
#[inline(always)]
fn descend<V: Eight>(t: &Target, ends: [u8; 2]) -> Candidate {
    const STEPS: [[i32; 2]; 8] = [[-1, -1], [0, -1], [1, -1], [-1, 0], [1, 0], [-1, 1], [0, 1], [1, 1]];
    let mut best = Candidate { ends, error: t.errors::<V>([ends[0]; 8], [ends[1]; 8])[0] };
    loop {
        let near = |e: usize| STEPS.map(|s| (i32::from(best.ends[e]) + s[e]).clamp(0, 255) as u8);
        let (a, b) = (near(0), near(1));
        let mut next = best;
        for (l, error) in t.errors::<V>(a, b).into_iter().enumerate() {
            if error < next.error {
                next = Candidate { ends: [a[l], b[l]], error };
            }
        }
        if next.error >= best.error {
            return best;
        }
        best = next;
    }
}

/// What every value outside the entries' reach costs at least, in the mode of a > b: the entries lie in [b, a].
fn outside(t: &Target, low: f32, high: f32) -> f32 {
    let mut sum = 0.0;
    for (x, w) in t.x[..t.len].iter().zip(&t.w) {
        let d = math::max(math::max(low - x, x - high), 0.0);
        sum += w * (d * d);
    }
    sum
}

/// The same in the other mode, where 0 and 255 are entries too.
fn outside_six(t: &Target, low: f32, high: f32) -> f32 {
    let mut sum = 0.0;
    for (x, w) in t.x[..t.len].iter().zip(&t.w) {
        let d = math::max(math::max(low - x, x - high), 0.0);
        let d = math::min(d, math::min(*x, 255.0 - x));
        sum += w * (d * d);
    }
    sum
}

#[inline(always)]
fn refined<V: Eight>(t: &Target) -> Candidate {
    let (mut low, mut high, mut inner_low, mut inner_high) = (255.0, 0.0, 255.0, 0.0);
    for x in &t.x[..t.len] {
        (low, high) = (math::min(*x, low), math::max(*x, high));
        if *x > 0.0 && *x < 255.0 {
            (inner_low, inner_high) = (math::min(*x, inner_low), math::max(*x, inner_high));
        }
    }
    let mut best = descend::<V>(t, [high as u8, low as u8]);
    if inner_low <= inner_high {
        let six = descend::<V>(t, [inner_low as u8, inner_high as u8]);
        if six.error < best.error {
            best = six;
        }
    }
    best
}

/// All pairs but those that a bound excludes; the first among equals, after what is known already.
#[inline(always)]
fn exhaustive<V: Eight>(t: &Target) -> Candidate {
    let mut best = refined::<V>(t);
    for a in 0..=255_u8 {
        // For each mode the other endpoint's range, in groups of eight; the last group overlaps the one before.
        for six in [false, true] {
            let (first, last) = if six { (a, 255) } else { (0, a.saturating_sub(1)) };
            let mut start = u32::from(first);
            while start <= u32::from(last) {
                if best.error <= 0.0 {
                    return best;
                }
                let b: [u8; 8] = core::array::from_fn(|l| (start + l as u32).min(u32::from(last)) as u8);
                // The group's widest reach is that of its farthest member: the first below a, the last above.
                let least = if six {
                    outside_six(t, f32::from(a), f32::from(b[7]))
                } else {
                    outside(t, f32::from(b[0]), f32::from(a))
                };
                // Rounded sums of 16 terms are within 2^-19 of each other; where all weigh alike they are exact.
                if least * (1.0 - 1.0 / 524_288.0) < best.error {
                    for (l, error) in t.errors::<V>([a; 8], b).into_iter().enumerate() {
                        if error < best.error {
                            best = Candidate { ends: [a, b[l]], error };
                        }
                    }
                }
                start += 8;
            }
        }
    }
    best
}

/// Encodes a block. Weights as in [`super::bc1::encode`]; with no texel that counts the block is all zeros.
#[must_use]
pub fn encode(texels: &Texels, weights: &[f32; 16], quality: Quality) -> Block {
    encode_as::<Lanes<8>>(texels, weights, quality)
}

/// [`encode`] in the vectors of a backend: the same bits.
#[inline(always)]
#[must_use]
pub fn encode_as<V: Eight>(texels: &Texels, weights: &[f32; 16], quality: Quality) -> Block {
    let t = Target::new(texels, weights);
    if t.counts == 0 {
        return [0; 8];
    }
    let best = match quality {
        Quality::RangeFit => return encode_range_fit(texels, t.counts),
        Quality::Refined => refined::<V>(&t),
        Quality::Exhaustive => exhaustive::<V>(&t),
    };
    let [a, b] = best.ends;
    block(texels, t.counts, a, b)
}

/// What encoding minimises, for any block; in units of (1/255)^2. Weights as [`super::bc1::error`] takes them.
#[must_use]
pub fn error(texels: &Texels, weights: &[f32; 16], block: Block) -> f64 {
    let mut sum = 0.0;
    for ((x, y), w) in texels.iter().zip(decode(block)).zip(weights) {
        let w = if *w > 0.0 { f64::from(math::min(*w, f32::MAX)) } else { 0.0 };
        let d = f64::from(x.abs_diff(y));
        sum += w * d * d;
    }
    sum
}
