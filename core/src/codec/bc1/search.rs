//! The searches behind the higher qualities: where they start, and what they try.

use super::cluster::{self, Moments, Splits, moments, order, refit, split3, split4, steps, steps_of};
use super::palette::{codes, five, narrow};
use super::range_fit::range_fit_words;
use super::score::{Candidate, Mode, Target, candidate, descend, nearest};
use super::single;
use super::{Black, Texels};

/// Rounds in which endpoints and indices are fitted to each other in turn.
const ROUNDS: usize = 4;

/// The better of two; the first among equals.
#[inline(always)]
pub(super) fn better(a: Candidate, b: Candidate) -> Candidate {
    if b.error < a.error { b } else { a }
}

/// Endpoints for the nearest entries, entries for those endpoints, until nothing is gained.
#[inline(always)]
fn settle(t: &Target, mut best: Candidate) -> Candidate {
    for _ in 0..ROUNDS {
        if best.error <= 0.0 {
            break;
        }
        let index = nearest(t, best.codes, best.mode);
        let q = steps_of(&index, best.mode);
        let next = if best.mode == Mode::Black {
            let mut rest = *t;
            for i in 0..16 {
                rest.w[i] = if index[i] == 3 { 0.0 } else { t.w[i] };
            }
            if rest.counts() == 0 {
                break;
            }
            candidate(t, refit(&rest, &q, Mode::Three).codes, Mode::Black)
        } else {
            refit(t, &q, best.mode)
        };
        if next.error < best.error {
            best = next;
        } else {
            break;
        }
    }
    best
}

/// The words of a block as a candidate (which the caller knows to use no black).
#[inline(always)]
pub(super) fn from_words(t: &Target, ends: u32) -> Candidate {
    let (a, b) = (codes(ends & 0xffff), codes(ends >> 16));
    let mode = if ends & 0xffff > ends >> 16 { Mode::Four } else { Mode::Three };
    candidate(t, [[a[0], b[0]], [a[1], b[1]], [a[2], b[2]]], mode)
}

/// The best representation of one colour: the entry two thirds or half along hits it, channel by channel.
#[inline(always)]
pub(super) fn flat(t: &Target, colour: [f32; 3]) -> Candidate {
    let x = colour.map(|x| crate::math::floor(x + 0.5) as u32 & 255);
    let of = |mode: Mode| candidate(t, [0, 1, 2].map(|c| single::ends(x[c], five(c), mode)), mode);
    better(of(Mode::Four), of(Mode::Three))
}

/// What the range fit and one colour reach: no quality above is worse.
#[inline(always)]
fn simple(t: &Target, texels: &Texels, mean: [f32; 3]) -> Candidate {
    let range = from_words(t, range_fit_words(texels, t.counts())[0]);
    better(range, flat(t, mean))
}

/// Texels that are to be black: nearer to it than to the mean of the others, found in three rounds.
#[inline(always)]
fn without_black(t: &Target) -> Option<Target> {
    let mut rest = *t;
    for _ in 0..3 {
        let mean = moments(&rest).mean;
        let length = mean[0] * mean[0] + mean[1] * mean[1] + mean[2] * mean[2];
        for i in 0..16 {
            let dot = mean[0] * t.x[0][i] + mean[1] * t.x[1][i] + mean[2] * t.x[2][i];
            rest.w[i] = if 2.0 * dot < length { 0.0 } else { t.w[i] };
        }
        rest.alike = false;
        if rest.counts() == 0 {
            return None;
        }
    }
    (rest.counts() != t.counts()).then_some(rest)
}

/// The best splits of an order, as candidates.
struct Found {
    four: Splits,
    three: Splits,
}

#[inline(always)]
fn try_lane(t: &Target, o: &cluster::Order, splits: &Splits, k: usize, mode: Mode) -> Candidate {
    refit(t, &steps(o, splits, k, mode), mode)
}

/// Three runs of the texels that are not black, and black.
#[inline(always)]
fn black(t: &Target) -> Option<Candidate> {
    let rest = without_black(t)?;
    let m = moments(&rest);
    let o = order(&rest, &m, m.axis);
    let splits = split3(&o);
    let three = match cluster::best(&splits.gain) {
        Some(k) => try_lane(&rest, &o, &splits, k, Mode::Three),
        None => flat(&rest, m.mean),
    };
    Some(candidate(t, three.codes, Mode::Black))
}

/// Cluster fit along the principal axis.
#[inline(always)]
pub(super) fn cluster(t: &Target, texels: &Texels, allowed: Black) -> Candidate {
    let m = moments(t);
    let mut best = simple(t, texels, m.mean);
    if best.error <= 0.0 {
        return best;
    }
    let o = order(t, &m, m.axis);
    let (four, three) = (split4(&o), split3(&o));
    if let Some(k) = cluster::best(&four.gain) {
        best = better(best, settle(t, try_lane(t, &o, &four, k, Mode::Four)));
    }
    if let Some(k) = cluster::best(&three.gain) {
        best = better(best, settle(t, try_lane(t, &o, &three, k, Mode::Three)));
    }
    if allowed == Black::Allowed {
        if let Some(found) = black(t) {
            best = better(best, settle(t, found));
        }
    }
    best
}

/// The best of the lanes, tried in order of gain, each descended from.
#[inline(always)]
fn descend_lanes(t: &Target, m: &Moments, axis: [f32; 3], tries: usize, mut best: Candidate) -> Candidate {
    let o = order(t, m, axis);
    let mut found = Found { four: split4(&o), three: split3(&o) };
    for turn in 0..2 * tries {
        let (splits, mode) = if turn % 2 == 0 { (&mut found.four, Mode::Four) } else { (&mut found.three, Mode::Three) };
        let Some(k) = cluster::best(&splits.gain) else { continue };
        splits.gain[k] = 0.0;
        if best.error <= 0.0 {
            break;
        }
        best = better(best, descend(t, settle(t, try_lane(t, &o, splits, k, mode))));
    }
    best
}

/// The direction from the first endpoint to the second.
#[inline(always)]
fn direction(c: &Candidate) -> [f32; 3] {
    [0, 1, 2].map(|k| {
        let [a, b] = c.codes[k];
        (b as i32 - a as i32) as f32 * if five(k) { 255.0 / 31.0 } else { 255.0 / 63.0 }
    })
}

/// Cluster fit, then descent among the codes; the axis follows the best endpoints, as often as it gains, up to `axes` times.
#[inline(always)]
pub(super) fn refine(t: &Target, texels: &Texels, allowed: Black, tries: usize, axes: usize) -> Candidate {
    let m = moments(t);
    let mut best = cluster(t, texels, allowed);
    if best.error <= 0.0 {
        return best;
    }
    best = descend(t, best);
    best = better(best, descend(t, flat(t, m.mean)));
    let mut axis = m.axis;
    for _ in 0..axes {
        let next = descend_lanes(t, &m, axis, tries, best);
        let gained = next.error < best.error;
        best = next;
        if !gained || best.error <= 0.0 {
            break;
        }
        axis = direction(&best);
    }
    if allowed == Black::Allowed && best.error > 0.0 {
        if let Some(found) = black(t) {
            best = better(best, descend(t, settle(t, found)));
        }
    }
    let _ = narrow;
    best
}
