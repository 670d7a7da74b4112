//! Cluster fit: the best split of the texels, in their order along an axis, into runs that share an entry.
//!
//! With step q_i = 0..3 (or 0..2) of texel i, the best endpoints are those of the regression of the colours on q, and
//! what the regression explains of the variance is |sum w q (x - mean)|^2 / S_qq with S_qq = sum w q^2 - (sum w q)^2 / W.
//! q is the number of run starts at or before the texel, so that the first sum is a sum of one prefix sum per start,
//! and S_qq depends on the weights alone: a table where all texels count alike. So every split costs a few operations,
//! and 816 splits into four runs are tried as 16 lanes of the last start.

use super::lanes::{Lanes, Vector};
use super::least_squares::axis;
use super::palette::five;
use super::score::{Candidate, Mode, Target, candidate, sum};
use crate::math;

/// Sums over the texels that count.
pub(super) struct Moments {
    total: f32,
    pub(super) mean: [f32; 3],
    /// Principal axis, of any length; zeros if there is but one colour.
    pub(super) axis: [f32; 3],
}

#[inline(always)]
pub(super) fn moments(t: &Target) -> Moments {
    let weighted = |f: &dyn Fn(usize) -> f32| {
        let mut x = [0.0; 16];
        for (i, x) in x.iter_mut().enumerate() {
            *x = t.w[i] * f(i);
        }
        sum(x)
    };
    let total = sum(t.w);
    let mut mean = [0.0; 3];
    for (c, mean) in mean.iter_mut().enumerate() {
        *mean = weighted(&|i| t.x[c][i]) / total;
    }
    let covariance = |a: usize, b: usize| Lanes([weighted(&|i| (t.x[a][i] - mean[a]) * (t.x[b][i] - mean[b]))]);
    let axis = axis([
        covariance(0, 0),
        covariance(0, 1),
        covariance(0, 2),
        covariance(1, 1),
        covariance(1, 2),
        covariance(2, 2),
    ]);
    Moments { total, mean, axis: axis.map(|x| x.bits()[0]).map(f32::from_bits) }
}

/// The texels in their order along an axis.
pub(super) struct Order {
    /// Which texel stands at a place.
    pub(super) texel: [u8; 16],
    /// Before place k: sums of w (x - mean).
    before: [[f32; 16]; 3],
    /// From place k on: sums of w.
    after: [f32; 16],
    /// Sum of w.
    total: f32,
    alike: bool,
}

#[inline(always)]
pub(super) fn order(t: &Target, m: &Moments, axis: [f32; 3]) -> Order {
    let mut at = [0.0; 16];
    for (i, at) in at.iter_mut().enumerate() {
        *at = axis[0] * t.x[0][i] + axis[1] * t.x[1][i] + axis[2] * t.x[2][i];
    }
    // The place of a texel is how many stand before it; among equals the lower index does.
    let mut place = [0_u32; 16];
    for j in 0..16 {
        let x = at[j];
        for i in 0..16 {
            place[i] += u32::from(if j < i { x <= at[i] } else { x < at[i] });
        }
    }
    let mut texel = [0_u8; 16];
    for (i, place) in place.iter().enumerate() {
        texel[(place & 15) as usize] = i as u8;
    }
    let mut out = Order { texel, before: [[0.0; 16]; 3], after: [m.total; 16], total: m.total, alike: t.alike };
    for k in 1..16 {
        let i = usize::from(texel[k - 1] & 15);
        for c in 0..3 {
            out.before[c][k] = out.before[c][k - 1] + t.w[i] * (t.x[c][i] - m.mean[c]);
        }
        out.after[k] = out.after[k - 1] - t.w[i];
    }
    out
}

/// 1 / S_qq of the runs that start at i <= j <= k (none before 0), for weights after each; 0 where it makes no sense.
#[inline(always)]
const fn inverse4(after: &[f32; 16], total: f32, i: usize, j: usize, k: usize) -> f32 {
    let q = after[i] + after[j] + after[k];
    let qq = after[i] + 3.0 * after[j] + 5.0 * after[k];
    let s = qq - q * q / total;
    if i <= j && j <= k && s > 1e-4 { 1.0 / s } else { 0.0 }
}

/// The same for three runs.
#[inline(always)]
const fn inverse3(after: &[f32; 16], total: f32, i: usize, k: usize) -> f32 {
    let q = after[i] + after[k];
    let s = after[i] + 3.0 * after[k] - q * q / total;
    if i <= k && s > 1e-4 { 1.0 / s } else { 0.0 }
}

const UNIT: [f32; 16] = {
    let mut after = [0.0; 16];
    let mut k = 0;
    while k < 16 {
        after[k] = 16.0 - k as f32;
        k += 1;
    }
    after
};

/// `inverse4` of unit weights for all i and j, by the lane k.
static INVERSE4: [[[f32; 16]; 16]; 16] = {
    let mut out = [[[0.0; 16]; 16]; 16];
    let mut n = 0;
    while n < 4096 {
        let (i, j, k) = (n >> 8, n >> 4 & 15, n & 15);
        out[i][j][k] = inverse4(&UNIT, 16.0, i, j, k);
        n += 1;
    }
    out
};

static INVERSE3: [[f32; 16]; 16] = {
    let mut out = [[0.0; 16]; 16];
    let mut n = 0;
    while n < 256 {
        let (i, k) = (n >> 4, n & 15);
        out[i][k] = inverse3(&UNIT, 16.0, i, k);
        n += 1;
    }
    out
};

/// The best split for each place of the last start: what it explains, and i << 4 | j.
pub(super) struct Splits {
    pub(super) gain: [f32; 16],
    pub(super) starts: [u32; 16],
}

#[inline(always)]
fn take(splits: &mut Splits, o: &Order, base: [f32; 3], inverse: &[f32; 16], starts: u32) {
    for k in 0..16 {
        let v = [base[0] + o.before[0][k], base[1] + o.before[1][k], base[2] + o.before[2][k]];
        let gain = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) * inverse[k];
        let better = gain > splits.gain[k];
        splits.gain[k] = if better { gain } else { splits.gain[k] };
        splits.starts[k] = if better { starts } else { splits.starts[k] };
    }
}

/// All splits into four runs (some may be empty).
#[inline(always)]
pub(super) fn split4(o: &Order) -> Splits {
    let mut splits = Splits { gain: [0.0; 16], starts: [0; 16] };
    for i in 0..16 {
        for j in i..16 {
            let base = [0, 1, 2].map(|c: usize| o.before[c][i] + o.before[c][j]);
            let starts = (i << 4 | j) as u32;
            if o.alike {
                take(&mut splits, o, base, &INVERSE4[i][j], starts);
            } else {
                let mut inverse = [0.0; 16];
                for (k, x) in inverse.iter_mut().enumerate() {
                    *x = inverse4(&o.after, o.total, i, j, k);
                }
                take(&mut splits, o, base, &inverse, starts);
            }
        }
    }
    splits
}

/// All splits into three runs.
#[inline(always)]
pub(super) fn split3(o: &Order) -> Splits {
    let mut splits = Splits { gain: [0.0; 16], starts: [0; 16] };
    for i in 0..16 {
        let base = [0, 1, 2].map(|c: usize| o.before[c][i]);
        if o.alike {
            take(&mut splits, o, base, &INVERSE3[i], (i << 4) as u32);
        } else {
            let mut inverse = [0.0; 16];
            for (k, x) in inverse.iter_mut().enumerate() {
                *x = inverse3(&o.after, o.total, i, k);
            }
            take(&mut splits, o, base, &inverse, (i << 4) as u32);
        }
    }
    splits
}

/// The lane of largest gain, the lowest among equals; `None` if none gains.
#[inline(always)]
pub(super) fn best(gain: &[f32; 16]) -> Option<usize> {
    let (mut most, mut lane) = (0.0, None);
    for (k, gain) in gain.iter().enumerate() {
        if *gain > most {
            (most, lane) = (*gain, Some(k));
        }
    }
    lane
}

/// The step of each texel under lane `k` of the splits.
#[inline(always)]
pub(super) fn steps(o: &Order, splits: &Splits, k: usize, mode: Mode) -> [f32; 16] {
    let (i, j) = ((splits.starts[k & 15] >> 4) as usize, (splits.starts[k & 15] & 15) as usize);
    let mut q = [0.0; 16];
    for (place, texel) in o.texel.iter().enumerate() {
        let from = |start: usize| if place >= start { 1.0 } else { 0.0 };
        q[usize::from(texel & 15)] = from(i) + from(k) + if mode == Mode::Four { from(j) } else { 0.0 };
    }
    q
}

/// Steps of the texels under a candidate's own nearest entries; those nearest to black get weight 0.
#[inline(always)]
pub(super) fn steps_of(index: &[u32; 16], mode: Mode) -> [f32; 16] {
    let table = if mode == Mode::Four { [0.0, 3.0, 1.0, 2.0] } else { [0.0, 2.0, 1.0, 0.0] };
    index.map(|p| table[(p & 3) as usize])
}

/// The endpoints that suit given steps best, on the grid of codes: in each channel the codes around the regression's
/// first endpoint are tried, each with the second that is best for it, by the exact quadratic error of the steps.
#[inline(always)]
pub(super) fn refit(t: &Target, q: &[f32; 16], mode: Mode) -> Candidate {
    let most = if mode == Mode::Four { 3.0 } else { 2.0 };
    let mut terms = [[0.0; 16]; 9];
    for i in 0..16 {
        let (w, b) = (t.w[i], q[i]);
        let a = most - b;
        terms[0][i] = w * a * a;
        terms[1][i] = w * a * b;
        terms[2][i] = w * b * b;
        for c in 0..3 {
            terms[3 + c][i] = w * a * t.x[c][i];
            terms[6 + c][i] = w * b * t.x[c][i];
        }
    }
    let mut s = [0.0; 9];
    for (s, terms) in s.iter_mut().zip(terms) {
        *s = sum(terms);
    }
    let [aa, ab, bb] = [s[0], s[1], s[2]];
    let determinant = aa * bb - ab * ab;
    let mut codes = [[0; 2]; 3];
    for c in 0..3 {
        let levels = if five(c) { 31.0 } else { 63.0 };
        // In units of codes: x = 255 / levels * code.
        let scale = levels / 255.0 * most;
        let (ax, bx) = (s[3 + c] * scale, s[6 + c] * scale);
        let clamp = |x: f32| math::clamp(x, 0.0, levels);
        let first = if determinant > 1e-3 * aa * bb {
            clamp((ax * bb - bx * ab) / determinant)
        } else {
            clamp((ax + bx) / (aa + 2.0 * ab + bb))
        };
        let (mut least, floor) = (f32::MAX, math::floor(first));
        for k in [-1.0, 0.0, 1.0, 2.0_f32] {
            let a = clamp(floor + k);
            let b = if bb > 0.0 { clamp(math::floor((bx - ab * a) / bb + 0.5)) } else { a };
            let error = a * (aa * a - 2.0 * ax) + b * (bb * b - 2.0 * bx) + 2.0 * ab * a * b;
            if error < least {
                least = error;
                codes[c] = [a as u32, b as u32];
            }
        }
    }
    candidate(t, codes, mode)
}
