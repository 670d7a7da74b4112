//! Branch and bound over boxes of endpoints: proves that a block is best, or says how much better one could be.

use super::lanes::{Eight, Lanes, halves, sum};
use super::palette::{five, widen};
use super::score::{self, Candidate, Mode, Target, candidate};
use super::search::{self, Plan};
use super::{Black, Block, Texels};

/// A block and what is known about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proof {
    /// The best block found.
    pub block: Block,
    /// Its error, as encoding minimises it with the weights scaled by a power of two so that the largest lies in [1, 2)
    /// (or, where all are alike, is 1).
    pub error: f32,
    /// No block of the allowed modes has a smaller error: equal to `error` where that is proved.
    pub bound: f32,
}

/// Encodes a block as [`Quality::Exhaustive`](super::Quality::Exhaustive) does, looking into up to `nodes` boxes of
/// endpoints in all; `None` if no texel counts.
///
/// A box is a range of codes for each channel of both endpoints. Each palette entry then lies in a box of colours, and a
/// texel's distance to the nearest of those is less than to any entry, so that their sum bounds the error of all
/// endpoints in the box. Boxes that cannot be better than the best block are dropped; others are halved along their
/// widest range, the more promising half first. Bounds are rounded like errors and compared with a margin of 2^-20 where
/// weights differ, so that there "best" means best within one part in 10^6; where all are alike they are exact integers.
///
/// The number of boxes that a proof takes grows steeply with how far the texels lie from a line.
#[must_use]
pub fn encode_proved(texels: &Texels, weights: &[f32; 16], black: Black, nodes: u32) -> Option<Proof> {
    let t = Target::new(texels, weights)?;
    let plan = Plan { tries: 16, axes: 8, descend: true, black, nodes: nodes.max(1) };
    let (best, bound) = search::search::<Lanes<8>>(&t, texels, &plan);
    Some(Proof { block: score::block::<Lanes<8>>(&t, &best), error: best.error, bound })
}

/// Ranges of codes: `low[e][c] ..= high[e][c]`.
#[derive(Clone, Copy)]
struct Boxed {
    low: [[u32; 3]; 2],
    high: [[u32; 3]; 2],
}

/// Most boxes that wait at one time: a box is halved 32 times at most, and one half of each waits.
const DEPTH: usize = 40;

/// A bound on the error of all endpoints in a box.
#[inline(always)]
fn bound<V: Eight>(t: &Target, b: &Boxed, mode: Mode) -> f32 {
    let mut d = [[V::splat(0.0); 2]; 4];
    for c in 0..3 {
        let x = halves::<V>(&t.x[c]);
        // Entries grow with both endpoints.
        let low = score::entries([b.low[0][c], b.low[1][c]], c, mode);
        let high = score::entries([b.high[0][c], b.high[1][c]], c, mode);
        for p in 0..4 {
            let (low, high) = (V::splat(low[p]), V::splat(high[p]));
            for h in 0..2 {
                let outside = low.sub(x[h]).max(x[h].sub(high)).max(V::splat(0.0));
                d[p][h] = d[p][h].add(outside.mul(outside));
            }
        }
    }
    let w = halves::<V>(&t.w);
    let least = |h: usize| d[0][h].min(d[1][h]).min(d[2][h].min(d[3][h])).mul(w[h]);
    sum(least(0), least(1))
}

/// The best candidate after a search of up to `nodes` boxes that starts with `best`, and the bound that it leaves.
#[inline(always)]
pub(super) fn branch<V: Eight>(t: &Target, best: Candidate, black: Black, nodes: u32) -> (Candidate, f32) {
    let mut best = best;
    let whole = Boxed { low: [[0; 3]; 2], high: [[31, 63, 31]; 2] };
    // Black holds whatever three colours do.
    let third = if black == Black::Allowed { Mode::Black } else { Mode::Three };
    let margin = if t.alike { 1.0 } else { 1.0 - 1.0 / 1_048_576.0 };
    let mut stack = [(whole, Mode::Four, 0.0_f32); DEPTH];
    stack[1].1 = third;
    let (mut len, mut left) = (2, nodes);
    while len > 0 && left > 0 {
        len -= 1;
        left -= 1;
        let (b, mode, at_least) = stack[len];
        if at_least >= best.error * margin {
            continue;
        }
        // The widest range, in 8-bit units; among equals the first.
        let (mut widest, mut end, mut channel) = (0, 0, 0);
        for e in 0..2 {
            for c in 0..3 {
                let width = widen(b.high[e][c], five(c)) - widen(b.low[e][c], five(c));
                if width > widest {
                    (widest, end, channel) = (width, e, c);
                }
            }
        }
        if widest == 0 {
            let [a, z] = b.low;
            let here = candidate::<V>(t, [[a[0], z[0]], [a[1], z[1]], [a[2], z[2]]], mode);
            if here.error < best.error {
                best = here;
            }
            continue;
        }
        let middle = (b.low[end][channel] + b.high[end][channel]) / 2;
        let (mut lower, mut upper) = (b, b);
        lower.high[end][channel] = middle;
        upper.low[end][channel] = middle + 1;
        let mut halves = [(lower, mode, 0.0), (upper, mode, 0.0)];
        for half in &mut halves {
            // The endpoints may be exchanged: only boxes with some red of the first not below the second's matter.
            let mirrored = half.0.high[0][0] < half.0.low[1][0];
            half.2 = if mirrored { f32::MAX } else { bound::<V>(t, &half.0, mode) };
        }
        if halves[0].2 < halves[1].2 {
            halves.swap(0, 1);
        }
        for half in halves {
            if half.2 < best.error * margin && len < DEPTH {
                stack[len] = half;
                len += 1;
            }
        }
    }
    // What still waits was not looked into.
    let mut proved = best.error;
    for (_, _, at_least) in &stack[..len] {
        proved = crate::math::min(*at_least, proved);
    }
    (best, proved)
}
