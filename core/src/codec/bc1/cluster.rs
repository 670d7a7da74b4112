//! Cluster fit: the best split of the texels, in their order along an axis, into runs that share an entry.
//!
//! With step q_i = 0..3 (or 0..2) of texel i, the best endpoints are those of the regression of the colours on q, and
//! what the regression explains of the variance is |sum w q (x - mean)|^2 / S_qq with S_qq = sum w q^2 - (sum w q)^2 / W.
//! q is the number of run starts at or before the texel, so that the first sum is a sum of one prefix sum per start,
//! and S_qq depends on the weights alone: a table where all texels count alike. So every split costs a few operations,
//! and 816 splits into four runs are tried as lanes of the last start.

use super::lanes::{Eight, Lanes, halves, sum};
use super::least_squares::axis;
use super::palette::five;
use super::score::{Codes, Mode, Target};

/// Sums over the texels that count.
pub(super) struct Moments {
    total: f32,
    pub(super) mean: [f32; 3],
    /// Principal axis, of any length; zeros if there is but one colour.
    pub(super) axis: [f32; 3],
}

impl Moments {
    /// A mean alone.
    #[inline(always)]
    pub(super) fn of_mean(mean: [f32; 3]) -> Self {
        Self { total: 0.0, mean, axis: [0.0; 3] }
    }
}

#[inline(always)]
pub(super) fn moments<V: Eight>(t: &Target) -> Moments {
    let w = halves::<V>(&t.w);
    let total = sum(w[0], w[1]);
    let mut mean = [0.0; 3];
    let mut centred = [w; 3];
    for c in 0..3 {
        let x = halves::<V>(&t.x[c]);
        mean[c] = sum(w[0].mul(x[0]), w[1].mul(x[1])) / total;
        centred[c] = [x[0].sub(V::splat(mean[c])), x[1].sub(V::splat(mean[c]))];
    }
    let mut covariance = [Lanes([0.0]); 6];
    for (k, (a, b)) in [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].into_iter().enumerate() {
        let of = |h: usize| w[h].mul(centred[a][h]).mul(centred[b][h]);
        covariance[k] = Lanes([sum(of(0), of(1))]);
    }
    let [x, y, z] = axis(covariance);
    Moments { total, mean, axis: [x.0[0], y.0[0], z.0[0]] }
}

/// The texels in their order along an axis.
pub(super) struct Order {
    /// The place of each texel.
    place: [f32; 16],
    /// Before place k: sums of w (x - mean).
    before: [[f32; 16]; 3],
    /// From place k on: sums of w.
    after: [f32; 16],
    /// Sum of w.
    total: f32,
    alike: bool,
}

#[inline(always)]
pub(super) fn order<V: Eight>(t: &Target, m: &Moments, axis: [f32; 3]) -> Order {
    let mut at = [V::splat(0.0); 2];
    for c in 0..3 {
        let x = halves::<V>(&t.x[c]);
        for h in 0..2 {
            at[h] = at[h].add(x[h].mul(V::splat(axis[c])));
        }
    }
    let flat = [at[0].write(), at[1].write()];
    // The place of a texel is how many stand before it; among equals the lower index does, which the second sum adds.
    let mut place = [V::splat(0.0); 2];
    let (zero, one) = (V::splat(0.0), V::splat(1.0));
    for x in flat.as_flattened() {
        for h in 0..2 {
            place[h] = place[h].add(at[h].pick(V::splat(*x), one, zero));
        }
    }
    let mut places = [0.0; 16];
    places[..8].copy_from_slice(&place[0].write());
    places[8..].copy_from_slice(&place[1].write());
    // Equal positions have equal counts: the next free place of a run of equals is its count plus those already seated.
    let mut seated = [0_u8; 16];
    let mut texel = [0_u8; 16];
    for (i, place) in places.iter_mut().enumerate() {
        let count = *place as usize & 15;
        let at = (count + usize::from(seated[count])) & 15;
        seated[count] += 1;
        texel[at] = i as u8;
        *place = at as i32 as f32;
    }
    let mut out =
        Order { place: places, before: [[0.0; 16]; 3], after: [m.total; 16], total: m.total, alike: t.alike };
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

/// The best split for each place of the last start: what it explains, and 16 i + j as a float.
pub(super) struct Splits {
    pub(super) gain: [f32; 16],
    starts: [f32; 16],
}

/// All splits into four runs, or three where `four` is not set (some may be empty).
#[inline(always)]
pub(super) fn split<V: Eight>(o: &Order, four: bool) -> Splits {
    let before = [halves::<V>(&o.before[0]), halves::<V>(&o.before[1]), halves::<V>(&o.before[2])];
    let zero = V::splat(0.0);
    let (mut gain, mut starts) = ([zero; 2], [zero; 2]);
    for i in 0..16 {
        // With three runs there is no second start.
        for j in i..if four { 16 } else { i + 1 } {
            let mut weighted = [0.0; 16];
            let inverse = if o.alike {
                if four { &INVERSE4[i][j] } else { &INVERSE3[i] }
            } else {
                for (k, x) in weighted.iter_mut().enumerate() {
                    *x = if four {
                        inverse4(&o.after, o.total, i, j, k)
                    } else {
                        inverse3(&o.after, o.total, i, k)
                    };
                }
                &weighted
            };
            let inverse = halves::<V>(inverse);
            let mut base = [zero; 3];
            for c in 0..3 {
                base[c] = V::splat(o.before[c][i] + if four { o.before[c][j] } else { 0.0 });
            }
            let which = V::splat((16 * i + j) as i32 as f32);
            let here = |h: usize| {
                let v = [base[0].add(before[0][h]), base[1].add(before[1][h]), base[2].add(before[2][h])];
                v[0].mul(v[0]).add(v[1].mul(v[1])).add(v[2].mul(v[2])).mul(inverse[h])
            };
            // The last start is not before j.
            if j < 8 {
                let low = here(0);
                starts[0] = low.pick(gain[0], which, starts[0]);
                gain[0] = low.max(gain[0]);
            }
            let high = here(1);
            starts[1] = high.pick(gain[1], which, starts[1]);
            gain[1] = high.max(gain[1]);
        }
    }
    let join = |x: [V; 2]| {
        let mut out = [0.0; 16];
        out[..8].copy_from_slice(&x[0].write());
        out[8..].copy_from_slice(&x[1].write());
        out
    };
    Splits { gain: join(gain), starts: join(starts) }
}

impl Splits {
    /// Takes the split of largest gain out (the lowest lane among equals): the step of each texel.
    #[inline(always)]
    pub(super) fn take(&mut self, o: &Order, four: bool) -> Option<[f32; 16]> {
        let (mut most, mut lane) = (0.0, None);
        for (k, gain) in self.gain.iter().enumerate() {
            if *gain > most {
                (most, lane) = (*gain, Some(k));
            }
        }
        let k = lane?;
        self.gain[k] = 0.0;
        let starts = self.starts[k] as u32;
        let (i, j) = ((starts >> 4) as i32 as f32, (starts & 15) as i32 as f32);
        let k = k as i32 as f32;
        let mut q = [0.0; 16];
        for (q, place) in q.iter_mut().zip(o.place) {
            let from = |start: f32| if place >= start { 1.0 } else { 0.0 };
            *q = from(i) + from(k) + if four { from(j) } else { 0.0 };
        }
        Some(q)
    }
}

/// The endpoints that suit given steps best, on the grid of codes: in each channel the codes around the regression's
/// first endpoint are tried, each with the second that is best for it, by the exact quadratic error of the steps.
///
/// `w` may leave out texels that have their entry elsewhere; it must not be all zeros.
#[inline(always)]
pub(super) fn refit<V: Eight>(t: &Target, w: &[f32; 16], q: &[f32; 16], mode: Mode) -> Codes {
    let most = if mode == Mode::Four { 3.0 } else { 2.0 };
    let (w, q) = (halves::<V>(w), halves::<V>(q));
    let a = [V::splat(most).sub(q[0]), V::splat(most).sub(q[1])];
    let (wa, wq) = ([w[0].mul(a[0]), w[1].mul(a[1])], [w[0].mul(q[0]), w[1].mul(q[1])]);
    let dot = |x: [V; 2], y: [V; 2]| sum(x[0].mul(y[0]), x[1].mul(y[1]));
    let (aa, ab, bb) = (dot(wa, a), dot(wa, q), dot(wq, q));
    let determinant = aa * bb - ab * ab;
    let (one_sided, inverse) = (determinant <= 1e-3 * aa * bb, 1.0 / determinant);
    let inverse_b = 1.0 / bb;
    // One channel per lane from here on, in units of codes: x = 255 / levels * code.
    let (mut ax, mut bx, mut levels) = ([0.0; 8], [0.0; 8], [0.0; 8]);
    for c in 0..3 {
        levels[c] = if five(c) { 31.0 } else { 63.0 };
        let x = halves::<V>(&t.x[c]);
        let scale = levels[c] / 255.0 * most;
        (ax[c], bx[c]) = (dot(wa, x) * scale, dot(wq, x) * scale);
    }
    let (ax, bx, levels) = (V::read(&ax), V::read(&bx), V::read(&levels));
    let (zero, splat) = (V::splat(0.0), V::splat);
    let clamp = |x: V| x.max(zero).min(levels);
    let first = if one_sided {
        ax.add(bx).mul(splat(1.0 / (aa + 2.0 * ab + bb)))
    } else {
        ax.mul(splat(bb)).sub(bx.mul(splat(ab))).mul(splat(inverse))
    };
    let floor = clamp(clamp(first).sub(splat(0.5))).round();
    let (mut least, mut a, mut b) = (splat(f32::MAX), zero, zero);
    for k in [-1.0, 0.0, 1.0, 2.0] {
        let x = clamp(floor.add(splat(k)));
        let y = if bb > 0.0 { clamp(bx.sub(splat(ab).mul(x)).mul(splat(inverse_b))).round() } else { x };
        let error = x.mul(splat(aa).mul(x).sub(ax).sub(ax)).add(y.mul(splat(bb).mul(y).sub(bx).sub(bx)));
        let error = error.add(splat(2.0 * ab).mul(x).mul(y));
        a = least.pick(error, x, a);
        b = least.pick(error, y, b);
        least = error.min(least);
    }
    let (a, b) = (a.write(), b.write());
    let mut codes = [[0; 2]; 3];
    for c in 0..3 {
        codes[c] = [a[c] as u32, b[c] as u32];
    }
    codes
}
