//! `x^y = 2^(y log2 x)`, the logarithm and the product kept in two floats.

use super::bits::{is_positive_normal, nearest, normalised, scale, split_around_one, upper12};
use super::exp_ln::exp2_minus_one;
use super::rounding::clamp;

/// log2 of 2^shift x, x positive and normal, as upper + lower: the upper part has 12 bits, the sum is right to about 2^-35 relative.
///
/// With s = f / (2 + f): ln(1+f) = 2 artanh s = (2/3) s (3 + s^2 + s^4 Q(s^2)). The 3 is exact and s^4 Q is small,
/// so that only s, the bracket and their product need two pieces each.
#[inline(always)]
fn log2_in_two(x: f32, shift: i32) -> (f32, f32) {
    /// 2 / (3 ln 2), and its 12-bit upper part with the rest.
    const C: f32 = 0.961_796_7;
    const C_UPPER: f32 = 0.961_669_9;
    const C_LOWER: f32 = 1.267_720_5e-4;

    let (k, m) = split_around_one(x);
    let k = (k + shift) as f32;
    let f = m - 1.0;
    // s = f / (m + 1): the upper piece, then the remainder of the division by it.
    let divisor = m + 1.0;
    let inverse = 1.0 / divisor;
    let s = f * inverse;
    let s_upper = upper12(s);
    let divisor_upper = upper12(divisor);
    let divisor_lower = m - (divisor_upper - 1.0);
    let s_lower = ((f - s_upper * divisor_upper) - s_upper * divisor_lower) * inverse;

    let square_upper = s_upper * s_upper;
    let square = s * s;
    let q = 0.600_002_3 + square * (0.428_206_32 + square * 0.351_295_92);
    let rest = square * square * q + s_lower * (s_upper + s);
    let bracket_upper = upper12(3.0 + square_upper + rest);
    let bracket_lower = rest - ((bracket_upper - 3.0) - square_upper);

    let large = s_upper * bracket_upper;
    let small = s_lower * bracket_upper + bracket_lower * s;
    let product_upper = upper12(large + small);
    let product_lower = small - (product_upper - large);

    let large = C_UPPER * product_upper;
    let small = C_LOWER * product_upper + product_lower * C;
    let upper = upper12((large + small) + k);
    let lower = small - ((upper - k) - large);
    (upper, lower)
}

/// `x` to the power `y`, for `x` >= 0. The relative error does not grow with the exponent of the result: it is
/// the one stated in [`ACCURACY`](super::ACCURACY) from the smallest subnormal to f32::MAX, for Phong exponents
/// of 1e5 as for gamma curves.
///
/// pow(x, 0) = 1 for every x, also 0; pow(1, y) = 1; pow(x, 1) need not be `x` to the last bit.
/// pow(0, y) = 0 for y > 0 and infinity for y < 0. Above f32::MAX the value is infinity, below 2^-150 it is 0.
///
/// Outside the domain: negative `x` counts as 0. pow(infinity, y) is infinity for y > 0 and 0 for y < 0. NaN in either argument gives NaN,
/// but for y = 0.
#[inline]
#[must_use]
pub fn pow(x: f32, y: f32) -> f32 {
    if is_positive_normal(x) && !y.is_nan() { pow_normal(x, 0, y) } else { unusual(x, y) }
}

/// (2^shift x)^y for x positive and normal, y not NaN.
#[inline(always)]
fn pow_normal(x: f32, shift: i32, y: f32) -> f32 {
    /// |log2 x| >= 2^-24 for x other than 1, so that beyond 2^40 nothing changes, and no product overflows.
    const Y_LIMIT: f32 = 1.099_511_6e12;

    let (upper, lower) = log2_in_two(x, shift);
    let y = clamp(y, -Y_LIMIT, Y_LIMIT);
    let y_upper = upper12(y);
    let product = y_upper * upper;
    let small = (y - y_upper) * upper + y * lower;
    // Out of range only one piece is kept, which then gives infinity or 0.
    let out = (product + small).abs() > 151.0;
    let product = if out { clamp(product, -151.0, 151.0) } else { product };
    let small = if out { 0.0 } else { small };
    let (k, kf) = nearest(product + small);
    let difference = product - kf;
    let r = difference + small;
    let lost = small - (r - difference);
    scale(1.0 + exp2_minus_one(r, lost), k)
}

#[cold]
fn unusual(x: f32, y: f32) -> f32 {
    if y == 0.0 {
        1.0
    } else if x.is_nan() || y.is_nan() {
        f32::NAN
    } else if x > 0.0 && x < f32::MIN_POSITIVE {
        pow_normal(normalised(x), -23, y)
    } else if (x <= 0.0) == (y > 0.0) {
        0.0
    } else {
        f32::INFINITY
    }
}
