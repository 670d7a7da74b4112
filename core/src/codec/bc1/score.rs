//! The exact error of a block's endpoints, and the descent among their neighbours.

use super::lanes::{Eight, halves, sum};
use super::palette::{bytes, five, widen};
use super::{Block, Texels};
use crate::math;

/// What the search works on: 8-bit values as floats, channel by channel, and weights.
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
        let mut w = [0.0; 16];
        let mut largest = 0.0_f32;
        for (w, given) in w.iter_mut().zip(weights) {
            // Zero for NaN too.
            *w = if *given > 0.0 { math::min(*given, f32::MAX) } else { 0.0 };
            largest = math::max(*w, largest);
        }
        if largest <= 0.0 {
            return None;
        }
        let mut alike = true;
        for w in w {
            alike &= w == largest;
        }
        // The largest to [1, 2) by a power of two, so that nothing overflows or vanishes.
        let k = -math::exponent(largest);
        for w in &mut w {
            *w = if alike { 1.0 } else { math::ldexp(*w, k) };
        }
        // What does not count takes the colour of the first that does, so that it changes nothing at all.
        let mut first = texels[0];
        for (texel, w) in texels.iter().zip(w).rev() {
            first = if w > 0.0 { *texel } else { first };
        }
        let mut x = [[0.0; 16]; 3];
        for (i, texel) in texels.iter().enumerate() {
            let texel = if w[i] > 0.0 { texel } else { &first };
            for c in 0..3 {
                x[c][i] = f32::from(texel[c]);
            }
        }
        Some(Self { x, w, alike })
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

/// Codes of both endpoints per channel, in any order.
pub(super) type Codes = [[u32; 2]; 3];

/// Endpoints, a mode, and the error they reach.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    pub(super) codes: Codes,
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
        Mode::Three => ((a + b).div_ceil(2), a),
        Mode::Black => ((a + b).div_ceil(2), 0),
    };
    [a as i32 as f32, b as i32 as f32, p as i32 as f32, q as i32 as f32]
}

/// The squared distances of every texel from every entry.
#[inline(always)]
fn distances<V: Eight>(t: &Target, codes: &Codes, mode: Mode) -> [[V; 2]; 4] {
    let mut out = [[V::splat(0.0); 2]; 4];
    for (c, codes) in codes.iter().enumerate() {
        let x = halves::<V>(&t.x[c]);
        for (out, entry) in out.iter_mut().zip(entries(*codes, c, mode)) {
            for (out, x) in out.iter_mut().zip(x) {
                let d = x.sub(V::splat(entry));
                *out = out.add(d.mul(d));
            }
        }
    }
    out
}

/// What each texel's nearest entry stands for (the first among equals): `values[p]` for entry p; and the error.
///
/// The error is exact where all texels count alike (integers below 2^24).
#[inline(always)]
pub(super) fn nearest<V: Eight>(
    t: &Target,
    codes: &Codes,
    mode: Mode,
    values: [f32; 4],
) -> ([[f32; 8]; 2], f32) {
    let d = distances::<V>(t, codes, mode);
    let w = halves::<V>(&t.w);
    let (mut value, mut error) = ([[0.0; 8]; 2], w);
    for h in 0..2 {
        let (mut best, mut out) = (d[0][h], V::splat(values[0]));
        for p in 1..4 {
            out = best.pick(d[p][h], V::splat(values[p]), out);
            best = d[p][h].min(best);
        }
        value[h] = out.write();
        error[h] = w[h].mul(best);
    }
    (value, sum(error[0], error[1]))
}

/// The error of endpoints.
#[inline(always)]
pub(super) fn candidate<V: Eight>(t: &Target, codes: Codes, mode: Mode) -> Candidate {
    let (_, error) = nearest::<V>(t, &codes, mode, [0.0; 4]);
    Candidate { codes, mode, error }
}

/// The codes of one channel moved by -1, 0 or 1 each, as eight lanes: the neighbours of a pair.
const STEPS: [[i32; 2]; 8] = [[-1, -1], [0, -1], [1, -1], [-1, 0], [1, 0], [-1, 1], [0, 1], [1, 1]];

/// Moves the endpoints, channel by channel, to the best of their neighbours until none is better.
///
/// The eight neighbours of one channel's pair of codes are tried at once, one per lane; what the other channels
/// contribute is kept. Every move lowers the error (as summed texel by texel), so that it ends.
#[inline(always)]
pub(super) fn descend<V: Eight>(t: &Target, from: Candidate) -> Candidate {
    let mut best = from;
    // Squared distances per channel, entry and texel.
    let mut parts = [[[0.0_f32; 16]; 4]; 3];
    let (mut c, mut still, mut changed) = (0, 0, 7_u32);
    while still < 3 && best.error > 0.0 {
        for k in 0..3 {
            if changed >> k & 1 == 1 {
                let x = halves::<V>(&t.x[k]);
                for (part, entry) in parts[k].iter_mut().zip(entries(best.codes[k], k, best.mode)) {
                    let d = [x[0].sub(V::splat(entry)), x[1].sub(V::splat(entry))];
                    part[..8].copy_from_slice(&d[0].mul(d[0]).write());
                    part[8..].copy_from_slice(&d[1].mul(d[1]).write());
                }
            }
        }
        changed = 0;
        let last = if five(c) { 31 } else { 63 };
        let centre = best.codes[c];
        let mut lane_entries = [[0.0_f32; 8]; 4];
        for (l, step) in STEPS.iter().enumerate() {
            // A code beyond the end counts as the end: that neighbour is another one or the pair itself.
            let near = [0, 1].map(|e: usize| (centre[e] as i32 + step[e]).clamp(0, last) as u32);
            let of = entries(near, c, best.mode);
            for p in 0..4 {
                lane_entries[p][l] = of[p];
            }
        }
        let e = [0, 1, 2, 3].map(|p: usize| V::read(&lane_entries[p]));
        let (p, q) = (&parts[(c + 1) % 3], &parts[(c + 2) % 3]);
        let mut errors = V::splat(0.0);
        for i in 0..16 {
            let x = V::splat(t.x[c][i]);
            let mut nearest = V::splat(f32::MAX);
            for k in 0..4 {
                let d = x.sub(e[k]);
                nearest = d.mul(d).add(V::splat(p[k][i] + q[k][i])).min(nearest);
            }
            errors = errors.add(nearest.mul(V::splat(t.w[i])));
        }
        let before = best.error;
        for (error, step) in errors.write().into_iter().zip(STEPS) {
            if error < best.error {
                best.error = error;
                best.codes[c] = [0, 1].map(|e: usize| (centre[e] as i32 + step[e]).clamp(0, last) as u32);
            }
        }
        if best.error < before {
            changed = 1 << c;
            still = 0;
        } else {
            still += 1;
            c = (c + 1) % 3;
        }
    }
    best
}

/// Writes a candidate as a block. Texels that do not count get the index of the endpoint that is written first.
#[inline(always)]
pub(super) fn block<V: Eight>(t: &Target, best: &Candidate) -> Block {
    let [r, g, b] = best.codes;
    let word = |e: usize| r[e] << 11 | g[e] << 5 | b[e];
    let (first, second) = (word(0), word(1));
    // In which order the endpoints must stand; equal ones are the same colour in every mode.
    let swap = if best.mode == Mode::Four { first < second } else { first > second };
    // Between four colours, or between the endpoints of three, exchanging the ends flips the low bit.
    let values = match (best.mode, swap) {
        (Mode::Four, _) if first == second => [0.0; 4],
        (Mode::Four, true) => [1.0, 0.0, 3.0, 2.0],
        (_, true) => [1.0, 0.0, 2.0, 3.0],
        (_, false) => [0.0, 1.0, 2.0, 3.0],
    };
    let (index, _) = nearest::<V>(t, &best.codes, best.mode, values);
    let mut bits = 0;
    for (i, index) in index.as_flattened().iter().enumerate() {
        bits |= if t.w[i] > 0.0 { (*index as u32 & 3) << (2 * i) } else { 0 };
    }
    bytes([if swap { second | first << 16 } else { first | second << 16 }, bits])
}
