//! The exact error of a block's endpoints, and the search among their neighbours.

use super::palette::{bytes, five, widen};
use super::{Block, Texels};

/// What the search works on: 8-bit values as floats, channel by channel, and weights in [0, 1].
#[derive(Clone, Copy)]
pub(super) struct Target {
    pub(super) x: [[f32; 16]; 3],
    pub(super) w: [f32; 16],
    /// All weights are 1.
    pub(super) alike: bool,
}

impl Target {
    /// Weights as [`super::encode`] describes them; `None` if all are zero.
    #[inline(always)]
    pub(super) fn new(texels: &Texels, weights: &[f32; 16]) -> Option<Self> {
        let clean = |w: f32| if w > 0.0 { crate::math::min(w, f32::MAX) } else { 0.0 };
        let mut largest = 0.0_f32;
        for w in weights {
            largest = crate::math::max(clean(*w), largest);
        }
        if largest <= 0.0 {
            return None;
        }
        // To [1, 2) by a power of two, so that nothing overflows; the quotient would round otherwise.
        let k = -crate::math::exponent(largest);
        let w = weights.map(|w| crate::math::ldexp(clean(w), k));
        let alike = weights.iter().all(|x| *x == weights[0]);
        let mut this = Self { x: [[0.0; 16]; 3], w: if alike { [1.0; 16] } else { w }, alike };
        for (i, texel) in texels.iter().enumerate() {
            for c in 0..3 {
                this.x[c][i] = f32::from(texel[c]);
            }
        }
        Some(this)
    }

    /// Which texels count, as bits.
    #[inline(always)]
    pub(super) fn counts(&self) -> u32 {
        self.w.iter().enumerate().fold(0, |bits, (i, w)| bits | u32::from(*w > 0.0) << i)
    }
}

/// How the entries between the endpoints are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mode {
    /// Thirds.
    Four,
    /// The mean.
    Three,
    /// The mean, and black.
    Black,
}

/// Codes of both endpoints per channel, first and second in any order; a mode; and the error they reach.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    pub(super) codes: [[u32; 2]; 3],
    pub(super) mode: Mode,
    /// Sum over the texels of weight times squared distance to the nearest entry.
    pub(super) error: f32,
}

/// A channel of the palette, by [`super::Rule::Nearest`]: the two endpoints, then what lies between (from first to second).
#[inline(always)]
pub(super) fn entries([a, b]: [u32; 2], channel: usize, mode: Mode) -> [f32; 4] {
    let (a, b) = (widen(a, five(channel)), widen(b, five(channel)));
    let (p, q) = match mode {
        Mode::Four => ((2 * a + b + 1) / 3, (a + 2 * b + 1) / 3),
        Mode::Three => ((a + b + 1) / 2, a),
        Mode::Black => ((a + b + 1) / 2, 0),
    };
    [a as i32 as f32, b as i32 as f32, p as i32 as f32, q as i32 as f32]
}

/// The sum of 16 numbers, in a fixed order: halves are added lane by lane.
#[inline(always)]
pub(super) fn sum(x: [f32; 16]) -> f32 {
    let mut a = [0.0; 8];
    for i in 0..8 {
        a[i] = x[i] + x[i + 8];
    }
    let b = [a[0] + a[4], a[1] + a[5], a[2] + a[6], a[3] + a[7]];
    (b[0] + b[2]) + (b[1] + b[3])
}

/// Squared distances in one channel from each of the four entries.
#[inline(always)]
fn squares(x: &[f32; 16], entries: [f32; 4]) -> [[f32; 16]; 4] {
    let mut out = [[0.0; 16]; 4];
    for (out, entry) in out.iter_mut().zip(entries) {
        for i in 0..16 {
            let d = x[i] - entry;
            out[i] = d * d;
        }
    }
    out
}

/// The sum over the texels of weight times the least of four numbers.
#[inline(always)]
fn least(t: &Target, d: &[[f32; 16]; 4]) -> f32 {
    use crate::math::min;
    let mut out = [0.0; 16];
    for i in 0..16 {
        out[i] = t.w[i] * min(min(d[0][i], d[1][i]), min(d[2][i], d[3][i]));
    }
    sum(out)
}

#[inline(always)]
fn add(a: &[[f32; 16]; 4], b: &[[f32; 16]; 4]) -> [[f32; 16]; 4] {
    let mut out = *a;
    for (out, b) in out.iter_mut().zip(b) {
        for i in 0..16 {
            out[i] += b[i];
        }
    }
    out
}

/// The squared distances of every texel from every entry.
#[inline(always)]
fn distances(t: &Target, codes: [[u32; 2]; 3], mode: Mode) -> [[f32; 16]; 4] {
    let of = |c: usize| squares(&t.x[c], entries(codes[c], c, mode));
    add(&add(&of(0), &of(1)), &of(2))
}

/// The error of endpoints: exact where all texels count alike (integers below 2^24).
#[inline(always)]
pub(super) fn candidate(t: &Target, codes: [[u32; 2]; 3], mode: Mode) -> Candidate {
    Candidate { codes, mode, error: least(t, &distances(t, codes, mode)) }
}

/// For each texel the nearest entry, the first among equals.
#[inline(always)]
pub(super) fn nearest(t: &Target, codes: [[u32; 2]; 3], mode: Mode) -> [u32; 16] {
    let d = distances(t, codes, mode);
    let mut out = [0; 16];
    for i in 0..16 {
        let (mut best, mut index) = (d[0][i], 0);
        for (p, d) in d.iter().enumerate().skip(1) {
            if d[i] < best {
                (best, index) = (d[i], p as u32);
            }
        }
        out[i] = index;
    }
    out
}

/// Moves the endpoints, channel by channel, to the best of their neighbours until none is better.
///
/// A step changes the codes of one channel by -1, 0 or 1 each; the best of the eight is taken. Every step lowers the
/// error, so that it ends.
#[inline(always)]
pub(super) fn descend(t: &Target, from: Candidate) -> Candidate {
    let mut best = from;
    let mut parts = [[[0.0; 16]; 4]; 3];
    for (c, part) in parts.iter_mut().enumerate() {
        *part = squares(&t.x[c], entries(best.codes[c], c, best.mode));
    }
    // Channels in turn until all three have been found without a better neighbour.
    let (mut c, mut still) = (0, 0);
    while still < 3 && best.error > 0.0 {
        let rest = add(&parts[(c + 1) % 3], &parts[(c + 2) % 3]);
        let last = if five(c) { 31 } else { 63 };
        let (centre, before) = (best.codes[c], best.error);
        for step in [0, 1, 2, 3, 5, 6, 7, 8_u32] {
            let [a, b] = [(centre[0] + step % 3).wrapping_sub(1), (centre[1] + step / 3).wrapping_sub(1)];
            if a > last || b > last {
                continue;
            }
            let error = least(t, &add(&rest, &squares(&t.x[c], entries([a, b], c, best.mode))));
            if error < best.error {
                (best.error, best.codes[c]) = (error, [a, b]);
            }
        }
        if best.error < before {
            parts[c] = squares(&t.x[c], entries(best.codes[c], c, best.mode));
            still = 0;
        } else {
            still += 1;
        }
        c = (c + 1) % 3;
    }
    best
}

/// Writes a candidate as a block. Texels that do not count get the index of the endpoint that is written first.
#[inline(always)]
pub(super) fn block(t: &Target, best: Candidate) -> Block {
    let [r, g, b] = best.codes;
    let word = |e: usize| r[e] << 11 | g[e] << 5 | b[e];
    let (first, second) = (word(0), word(1));
    // In which order the endpoints must stand; equal ones are the same colour in every mode.
    let swap = if best.mode == Mode::Four { first < second } else { first > second };
    let index = nearest(t, best.codes, best.mode);
    let mut bits = 0;
    for (i, index) in index.into_iter().enumerate() {
        let index = match (best.mode, index) {
            (Mode::Three, 3) => 0,
            (Mode::Four, index) if first == second => index & 0,
            (_, index) => index,
        };
        let turned = match (best.mode, index) {
            (Mode::Four, index) => index ^ 1,
            (_, index @ (0 | 1)) => index ^ 1,
            (_, index) => index,
        };
        let index = if swap { turned } else { index };
        bits |= (if t.w[i] > 0.0 { index } else { 0 }) << (2 * i);
    }
    let ends = if swap { second | first << 16 } else { first | second << 16 };
    bytes([ends, bits])
}
