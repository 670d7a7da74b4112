//! The lightest-vertex form: total, accurate to the last bit or so, without branches.
//!
//! The lightest vertex, of weight `w0`, is the apex; `w1` and `w2` are the weights of the next two vertices in cyclic order. The distance
//! `s` from the apex and its complement `c = 1 - s` (the apex's barycentric) have, with V = w1 + w2, T = V - 2 w0 >= 0 and
//! S = w0 + V, the distributions
//!
//! ```text
//! P(s)     S = s^2 (3 w0 + T s)
//! (1 - P)  S = c (3 V - 3 (V - w0) c + T c^2)
//! ```
//!
//! The second form is solved where c < 1/8, the first elsewhere: each is well-conditioned there for both s and c.
//! A guess within 12 % (from the exponents alone, or a quotient) is bettered by Halley's method. The last step starts from an
//! approximation cut to 12 bits, so that its powers are exact, and forms the residual in pairs of floats: the sum of start and step is then
//! rounded once, and so is its complement. The number of steps is fixed and every choice is a selection, so that lanes give the bits of
//! scalars; nothing but `+ - * /` and integer operations on bits is used, square roots included, so that loops over slices vectorise on every target.
//!
//! Along the segment at s the density is linear, from a = w0 c + w1 s to b = w0 c + w2 s, and
//! t = eta (a + b) / (a + sqrt(a^2 (1 - eta) + b^2 eta)) (no cancellation; t and 1 - t exchange with a and b).

use crate::math::{ONE_MINUS_EPSILON, max, min, two_prod, two_sum};

/// 2^48 and its inverse: what small numbers are scaled by, so that their squares stay normal.
const UP: f32 = 281_474_976_710_656.0;
const DOWN: f32 = 1.0 / UP;
/// Below this (2^-40) the first number is scaled.
const SMALL: f32 = 1.0 / 1_099_511_627_776.0;
/// What stands in for a denominator of 0, whose numerator is 0 too; no other is below 2^-28.
const TINY: f32 = 1.0 / 1_152_921_504_606_846_976.0;
/// The complement is solved for where it is below this.
const FAR: f32 = 0.125;

/// The weights by place about the apex, scaled by a power of two so that the largest is in [1, 4), and where they come from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rotated {
    /// The weights of the apex and of the two vertices that follow it.
    pub(super) w: [f32; 3],
    /// Whether the apex is vertex 0.
    pub(super) first: bool,
    /// Whether the apex is vertex 1 (if it is not vertex 0).
    pub(super) second: bool,
}

/// The power of two that takes a positive normal `x` into [1, 2), or into [2, 4) from 2^127; 2^127 for 0.
#[inline(always)]
fn scale_of(x: f32) -> f32 {
    let exponent = (x.to_bits() & 0x7f80_0000) as i32;
    let field = 0x7f00_0000 - exponent;
    f32::from_bits((if field > 0x0080_0000 { field } else { 0x0080_0000 }) as u32)
}

/// The weights made valid: negative and NaN count as 0, infinity as `f32::MAX`.
#[inline(always)]
fn valid(weights: [f32; 3]) -> [f32; 3] {
    let [a, b, c] = weights;
    [min(max(a, 0.0), f32::MAX), min(max(b, 0.0), f32::MAX), min(max(c, 0.0), f32::MAX)]
}

/// The weights made valid and scaled by a power of two, the largest to [1, 4); three zeros count as three ones.
#[inline(always)]
pub(super) fn scaled(weights: [f32; 3]) -> [f32; 3] {
    scaled_valid(valid(weights))
}

#[inline(always)]
fn scaled_valid([a, b, c]: [f32; 3]) -> [f32; 3] {
    let largest = max(max(a, b), c);
    // 2^24 makes every subnormal normal; both products are exact.
    let lift = if largest < f32::MIN_POSITIVE { 16_777_216.0 } else { 1.0 };
    let scale = scale_of(largest * lift);
    // All zeros: 1 is added to each.
    let flat = if largest > 0.0 { 0.0 } else { 1.0 };
    [a * lift * scale + flat, b * lift * scale + flat, c * lift * scale + flat]
}

/// Scales and rotates: the apex is the lightest vertex, of equal ones that of least index.
#[inline(always)]
pub(super) fn rotated(weights: [f32; 3]) -> Rotated {
    // Before they are scaled: next to a huge one, small weights may become equal.
    let [a, b, c] = valid(weights);
    let first = (a <= b) & (a <= c);
    let second = b <= c;
    let [a, b, c] = scaled_valid([a, b, c]);
    let w0 = if first {
        a
    } else if second {
        b
    } else {
        c
    };
    let w1 = if first {
        b
    } else if second {
        c
    } else {
        a
    };
    let w2 = if first {
        c
    } else if second {
        a
    } else {
        b
    };
    Rotated { w: [w0, w1, w2], first, second }
}

impl Rotated {
    /// Index of the apex.
    #[inline(always)]
    pub(super) fn apex(self) -> usize {
        if self.first {
            0
        } else if self.second {
            1
        } else {
            2
        }
    }

    /// Values by place about the apex as values by vertex.
    #[inline(always)]
    pub(super) fn back(self, x: [f32; 3]) -> [f32; 3] {
        let [x0, x1, x2] = x;
        let (first, second) = (self.first, self.second);
        [
            if first {
                x0
            } else if second {
                x2
            } else {
                x1
            },
            if first {
                x1
            } else if second {
                x0
            } else {
                x2
            },
            if first {
                x2
            } else if second {
                x1
            } else {
                x0
            },
        ]
    }

    /// Values by vertex as values by place about the apex.
    #[inline(always)]
    pub(super) fn forth(self, x: [f32; 3]) -> [f32; 3] {
        let [x0, x1, x2] = x;
        let (first, second) = (self.first, self.second);
        [
            if first {
                x0
            } else if second {
                x1
            } else {
                x2
            },
            if first {
                x1
            } else if second {
                x2
            } else {
                x0
            },
            if first {
                x2
            } else if second {
                x0
            } else {
                x1
            },
        ]
    }
}

/// A number of [0, 1]; NaN counts as 0, -0 as 0.
#[inline(always)]
pub(super) fn unit(x: f32) -> f32 {
    min(max(x, 0.0), 1.0)
}

/// `x` to its 12 leading bits, to nearest.
#[inline(always)]
fn twelve_bits(x: f32) -> f32 {
    f32::from_bits(x.to_bits().wrapping_add(0x800) & 0xffff_f000)
}

/// A third of `x`, for `x` of any sign, within 4 units.
#[inline(always)]
fn third(x: i32) -> i32 {
    let y = x >> 2;
    let y = y + (y >> 2);
    let y = y + (y >> 4);
    y + (y >> 8)
}

/// The z > 0 of z^2 (al + be z) = xi within 12 %, for al, be >= 0 (one of them positive) and a normal xi > 0.
///
/// The bits of a float are 2^23 times its binary logarithm, to 0.086. If one term were alone, log z were
/// (log xi - log al) / 2 or (log xi - log be) / 3; the lesser is right but for at most log2 0.755, where both are equal.
#[inline(always)]
fn guess(al: f32, be: f32, xi: f32) -> f32 {
    /// The logarithm of 1, times 2^23.
    const ONE: i32 = 0x3f80_0000;
    /// What is taken away where both are equal: log2 0.755, and half the mean error of the logarithms.
    const DIP: i32 = (0.44 * 8_388_608.0) as i32;
    let bits = |x: f32| x.to_bits() as i32;
    let square = (bits(xi) - bits(al)) >> 1;
    let cube = third(bits(xi) - bits(be));
    let apart = square - cube;
    let apart = if apart < 0 { -apart } else { apart };
    let dip = DIP - (apart >> 2) - (apart >> 4);
    let dip = if dip > 0 { dip } else { 0 };
    let least = if square < cube { square } else { cube };
    f32::from_bits((least + ONE - dip) as u32)
}

/// One step of Halley's method: what to add to x, where the residual `r`, the slope `p` and half the second derivative `q` are known.
#[inline(always)]
fn halley(r: f32, p: f32, q: f32) -> f32 {
    (r * p) / (p * p + r * q)
}

/// Distance from the apex and its complement, of the first random number.
#[inline(always)]
pub(super) fn distance(w: [f32; 3], xi: f32) -> [f32; 2] {
    let [w0, w1, w2] = w;
    // V and S with what their roundings lost; T = V - 2 w0 likewise; 3 w0.
    let (v, v_low) = two_sum(w1, w2);
    let sum = v + w0;
    let sum_low = ((v - sum) + w0) + v_low;
    let t = v - 2.0 * w0;
    let t_low = ((v - t) - 2.0 * w0) + v_low;
    let w3 = 3.0 * w0;
    let w3_low = (2.0 * w0 - w3) + w0;
    let v3 = 3.0 * v;
    let v3_low = ((2.0 * v - v3) + v) + 3.0 * v_low;
    let less = 3.0 * (v - w0);

    const EDGE: f32 = 1.0 - FAR;
    let far = xi * sum > (EDGE * EDGE) * (w3 + t * EDGE);

    // From the apex: in z = s up, so that squares stay normal.
    let (up, down) = if xi < SMALL { (UP, DOWN) } else { (1.0, 1.0) };
    let scaled_xi = xi * up * up;
    let rhs = scaled_xi * sum;
    let z = guess(w3, t * down, rhs);
    let tz = t * (z * down);
    let z = z + halley(rhs - z * z * (w3 + tz), z * (2.0 * w3 + 3.0 * tz), w3 + 3.0 * tz);
    let z = twelve_bits(z);
    let x = z * down;
    let t_high = f32::from_bits(t.to_bits() & 0xffff_f000);
    let (g, g_low) = two_sum(w3, t_high * x);
    let g_low = g_low + (w3_low + (t - t_high) * x + t_low * x);
    let tx = t * x;

    // From the far side.
    let rest = 1.0 - xi;
    let c_rhs = rest * sum;
    let c = twelve_bits((c_rhs * v3) / (v3 * v3 - 1.05 * (less * c_rhs)));
    let kc = (t * c - less) * c;
    let h = v3 + kc;
    let h_low = ((v3 - h) + kc) + v3_low;
    let tc = t * c;

    let start = if far { c } else { x };
    let back = if far { 1.0 } else { down };
    let (r, r_low) = two_prod(if far { rest } else { scaled_xi }, sum);
    let power = if far { c } else { z * z };
    let factor = if far { h } else { g };
    let (m, m_low) = two_prod(power, factor);
    let residual = (r - m)
        + ((r_low - m_low)
            + ((if far { rest } else { scaled_xi }) * sum_low - power * (if far { h_low } else { g_low })));
    let slope = if far { v3 - c * (2.0 * less - 3.0 * tc) } else { z * (2.0 * w3 + 3.0 * tx) };
    let curve = if far { 3.0 * tc - less } else { w3 + 3.0 * tx };
    let step = halley(residual, slope, curve) * back;
    let near = start + step;
    let other = (1.0 - start) - step;
    let s = if far { other } else { near };
    let c = if far { near } else { other };
    let at_apex = xi <= 0.0;
    [if at_apex { 0.0 } else { s }, if at_apex { 1.0 } else { c }]
}

/// Square root within 1 ulp, of `x` in [2^-100, 2^100] or 0, from products alone.
#[inline(always)]
fn root(x: f32) -> f32 {
    let half = 0.5 * x;
    let y = f32::from_bits(0x5f37_5a86_u32.wrapping_sub(x.to_bits() >> 1));
    let y = y * (1.5 - half * y * y);
    let y = y * (1.5 - half * y * y);
    let r = x * y;
    r + (0.5 * y) * (x - r * r)
}

/// The two shares of the segment at `s`: that of the vertex after the apex, and that of the one after it; their sum is `s`.
#[inline(always)]
pub(super) fn along(w: [f32; 3], s: f32, c: f32, eta: f32) -> [f32; 2] {
    let [w0, w1, w2] = w;
    let apex = w0 * c;
    let (a, b) = (apex + w1 * s, apex + w2 * s);
    // The larger comes to [2^48, 2^49): squares stay normal whatever s and eta.
    let scale = scale_of(max(a, b));
    let (a, b) = (a * scale * UP, b * scale * UP);
    let rest = 1.0 - eta;
    let whole = a + b;
    let d = root(a * a * rest + b * b * eta);
    // The share below 1/2 is formed, the other is what it leaves.
    let early = 4.0 * (eta * whole) <= 3.0 * a + b;
    let bottom = (if early { a } else { b }) + d;
    let share = (if early { eta } else { rest }) * whole / max(bottom, TINY);
    let small = s * min(share, 1.0);
    let large = s - small;
    [if early { large } else { small }, if early { small } else { large }]
}

/// See [`super::sample`].
#[inline(always)]
pub(super) fn sample(weights: [f32; 3], u: [f32; 2]) -> [f32; 3] {
    second_half(weights, first_half(weights, u[0]), u[1])
}

/// Distance from the apex and its complement: the first half of [`sample`].
#[inline(always)]
pub(super) fn first_half(weights: [f32; 3], u: f32) -> [f32; 2] {
    distance(rotated(weights).w, unit(u))
}

/// The rest of [`sample`]. It rotates anew: that costs less than the registers to remember it.
#[inline(always)]
pub(super) fn second_half(weights: [f32; 3], distance: [f32; 2], u: f32) -> [f32; 3] {
    let r = rotated(weights);
    let [s, c] = distance;
    let [b1, b2] = along(r.w, s, c, unit(u));
    r.back([c, b1, b2])
}

/// See [`super::pdf`].
#[inline(always)]
pub(super) fn pdf(weights: [f32; 3], bary: [f32; 3]) -> f32 {
    let [w0, w1, w2] = scaled(weights);
    let [b0, b1, b2] = bary;
    let inside = (b0 >= 0.0) & (b1 >= 0.0) & (b2 >= 0.0);
    let value = 3.0 * (w0 * unit(b0) + w1 * unit(b1) + w2 * unit(b2)) / (w0 + w1 + w2);
    if inside { min(value, 3.0) } else { 0.0 }
}

/// See [`super::invert`].
#[inline(always)]
pub(super) fn invert(weights: [f32; 3], bary: [f32; 3]) -> [f32; 2] {
    let r = rotated(weights);
    let ([w0, w1, w2], [b0, b1, b2]) = (r.w, r.forth(bary.map(unit)));
    let (v, t) = (w1 + w2, (w1 - w0) + (w2 - w0));
    let (sum, rest) = (w0 + v, b1 + b2);
    let whole = max(b0 + rest, f32::MIN_POSITIVE);
    let (s, c) = (rest / whole, b0 / whole);
    // From the end with less of the density behind, and s last: its square may underflow before the share does.
    let share = s * (s * (3.0 * w0 + t * s) / sum);
    let other = c * (3.0 * v + c * (t * c - 3.0 * (v - w0))) / sum;
    let xi = if share <= 0.5 { share } else { 1.0 - other };
    let along = max(rest, f32::MIN_POSITIVE);
    let (early, late) = (b1 / along, b2 / along);
    let apex = w0 * c;
    let (a, b) = (apex + w1 * s, apex + w2 * s);
    let ends = max(a + b, TINY * TINY);
    let from_start = late * ((a * (1.0 + early) + b * late) / ends);
    let from_end = early * ((b * (1.0 + late) + a * early) / ends);
    let eta = if from_start <= 0.5 { from_start } else { 1.0 - from_end };
    let at_apex = rest <= 0.0;
    [min(max(xi, 0.0), ONE_MINUS_EPSILON), if at_apex { 0.0 } else { min(max(eta, 0.0), ONE_MINUS_EPSILON) }]
}
