//! The searches behind the higher qualities: where they start, and what they try.

use super::branch::branch;
use super::cluster::{Moments, moments, order, refit, split};
use super::lanes::Eight;
use super::palette::{codes, five};
use super::range_fit::range_fit_words;
use super::score::{Candidate, Codes, Mode, Target, candidate, descend, nearest};
use super::{Black, Texels, single};

/// Rounds in which endpoints and indices are fitted to each other in turn.
const ROUNDS: usize = 4;

/// How much a search tries.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plan {
    /// Splits per mode and axis.
    pub(super) tries: usize,
    /// Axes: the principal one, then the direction of the best endpoints, as long as that gains.
    pub(super) axes: usize,
    /// Whether endpoints move among their neighbours.
    pub(super) descend: bool,
    pub(super) black: Black,
    /// Boxes of endpoints that branch and bound may look into.
    pub(super) nodes: u32,
}

/// The plan of [`super::Quality::Refined`].
pub(super) const REFINED: Plan = Plan { tries: 2, axes: 2, descend: true, black: Black::Allowed, nodes: 0 };

/// What an attempt starts from.
enum Start {
    /// Steps of the texels, and the weights of those that are not black.
    Steps([f32; 16], [f32; 16]),
    Codes(Codes),
}

/// From a start, endpoints for the steps and steps for the endpoints in turn until nothing is gained; then descent.
#[inline(always)]
fn attempt<V: Eight>(t: &Target, start: Start, mode: Mode, plan: &Plan, best: &mut Candidate) {
    let mut here = Candidate { codes: [[0; 2]; 3], mode, error: f32::MAX };
    let (mut q, mut w, mut given) = match start {
        Start::Steps(q, w) => (q, w, None),
        Start::Codes(codes) => ([0.0; 16], t.w, Some(codes)),
    };
    let values = if mode == Mode::Four { [0.0, 3.0, 1.0, 2.0] } else { [0.0, 2.0, 1.0, -1.0] };
    for _ in 0..ROUNDS {
        let codes = match given.take() {
            Some(codes) => codes,
            None => refit::<V>(t, &w, &q, mode),
        };
        let (steps, error) = nearest::<V>(t, &codes, mode, values);
        if error >= here.error {
            break;
        }
        here = Candidate { codes, mode, error };
        let mut any = false;
        for (i, step) in steps.as_flattened().iter().enumerate() {
            // -1 stands for black.
            let black = *step < 0.0;
            q[i] = if black { 0.0 } else { *step };
            w[i] = if black { 0.0 } else { t.w[i] };
            any |= w[i] > 0.0;
        }
        if error <= 0.0 || !any {
            break;
        }
    }
    if plan.descend {
        here = descend::<V>(t, here);
    }
    if here.error < best.error {
        *best = here;
    }
}

/// The endpoints between which an entry lies nearest to a colour.
#[inline(always)]
fn flat(colour: [f32; 3], mode: Mode) -> Codes {
    let of = |c: usize| single::ends((colour[c] + 0.5) as u32, five(c), mode);
    [of(0), of(1), of(2)]
}

/// Weights without the texels that are to be black: nearer to it than to the mean of the others, in three rounds.
/// `None` if there are none or all are.
#[inline(always)]
fn without_black<V: Eight>(t: &Target, mean: [f32; 3]) -> Option<(Target, Moments)> {
    let mut rest = *t;
    let mut m = Moments::of_mean(mean);
    for _ in 0..3 {
        let mean = m.mean;
        let length = mean[0] * mean[0] + mean[1] * mean[1] + mean[2] * mean[2];
        let (mut any, mut all) = (false, true);
        for i in 0..16 {
            let dot = mean[0] * t.x[0][i] + mean[1] * t.x[1][i] + mean[2] * t.x[2][i];
            let dark = 2.0 * dot < length;
            any |= dark & (t.w[i] > 0.0);
            rest.w[i] = if dark { 0.0 } else { t.w[i] };
            all &= rest.w[i] <= 0.0;
        }
        if all || !any {
            return None;
        }
        rest.alike = false;
        m = moments::<V>(&rest);
    }
    Some((rest, m))
}

/// The direction from the first endpoint to the second.
#[inline(always)]
fn direction(c: &Candidate) -> [f32; 3] {
    let of = |k: usize| {
        let [a, b] = c.codes[k];
        (b as i32 - a as i32) as f32 * if five(k) { 255.0 / 31.0 } else { 255.0 / 63.0 }
    };
    [of(0), of(1), of(2)]
}

/// The best endpoints that a plan finds (never worse than the range fit or one colour), and a bound that no block of the
/// allowed modes goes below: 0 where none was sought.
#[inline(always)]
pub(super) fn search<V: Eight>(t: &Target, texels: &Texels, plan: &Plan) -> (Candidate, f32) {
    let mut best = Candidate { codes: [[0; 2]; 3], mode: Mode::Four, error: f32::MAX };
    // A search that goes on to branch and bound begins with the refined one: its axes may lead elsewhere.
    for plan in &[Plan { black: plan.black, ..REFINED }, *plan][usize::from(plan.nodes == 0)..] {
        gather::<V>(t, texels, plan, &mut best);
    }
    if plan.nodes > 0 && best.error > 0.0 {
        branch::<V>(t, best, plan.black, plan.nodes)
    } else {
        (best, 0.0)
    }
}

/// Tries what a plan says; replaces `best` where it finds better.
#[inline(always)]
fn gather<V: Eight>(t: &Target, texels: &Texels, plan: &Plan, best: &mut Candidate) {
    let whole = moments::<V>(t);
    let ends = range_fit_words(texels, t.counts())[0];
    let (a, b) = (codes(ends & 0xffff), codes(ends >> 16));
    let range = [[a[0], b[0]], [a[1], b[1]], [a[2], b[2]]];
    let range = candidate::<V>(t, range, Mode::Four);
    if range.error < best.error {
        *best = range;
    }
    let dark = if plan.black == Black::Allowed { without_black::<V>(t, whole.mean) } else { None };
    // Round 0 is black and three runs of the others; the rest of the rounds have an axis each for all texels.
    let mut axis = whole.axis;
    for round in usize::from(dark.is_none())..=plan.axes {
        let before = best.error;
        let (target, m) = match &dark {
            Some((rest, m)) if round == 0 => (rest, m),
            _ => (t, &whole),
        };
        let o = order::<V>(target, m, if round == 0 { m.axis } else { axis });
        let modes: &[Mode] = if round == 0 { &[Mode::Black] } else { &[Mode::Four, Mode::Three] };
        for mode in modes {
            let four = *mode == Mode::Four;
            let mut splits = split::<V>(&o, four);
            // One colour first, where it was not tried before.
            for turn in usize::from(round > 1)..=plan.tries {
                if best.error <= 0.0 {
                    return;
                }
                let start = if turn == 0 {
                    Start::Codes(flat(m.mean, *mode))
                } else {
                    match splits.take(&o, four) {
                        Some(q) => Start::Steps(q, target.w),
                        None => break,
                    }
                };
                attempt::<V>(t, start, *mode, plan, best);
            }
        }
        if round > 0 {
            if best.error >= before {
                break;
            }
            axis = direction(best);
        }
    }
}
