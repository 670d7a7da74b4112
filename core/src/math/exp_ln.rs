//! Exponential and logarithm, base e and 2.
//!
//! Coefficients: minimax in relative error over the reduced range (Remez exchange), rounded to f32 one by one
//! from the lowest order, the rest refitted each time.

use super::bits::{is_positive_normal, nearest, normalised, scale, split_around_one, upper12};

/// ln 2 = LN2_UPPER + LN2_LOWER; the upper part has 15 bits, so that its product with an exponent is exact.
const LN2_UPPER: f32 = 0.693_145_75;
const LN2_LOWER: f32 = 1.428_606_8e-6;
/// ln 2 = LN_2_UPPER12 + LN_2_REST; the upper part has 12 bits, so that its product with 12 more is exact.
const LN_2_UPPER12: f32 = 0.69311523;
const LN_2_REST: f32 = 3.1946183e-05;
/// 1 / ln 2 = INV_LN2_UPPER + INV_LN2_LOWER; the upper part has 12 bits.
const INV_LN2: f32 = core::f32::consts::LOG2_E;
const INV_LN2_UPPER: f32 = 1.442_382_8;
const INV_LN2_LOWER: f32 = 3.122_284e-4;

/// (ln(1+f) - f + f^2/2) / f^3 on [sqrt(1/2) - 1, sqrt 2 - 1], 2^-29.3 relative to ln(1+f).
#[inline(always)]
fn ln_tail(f: f32, f2: f32) -> f32 {
    let f4 = f2 * f2;
    let a = 0.333_333_13 + f * -0.250_001_67;
    let b = 0.200_022_24 + f * -0.166_593_58;
    let c = 0.142_095_57 + f * -0.125_499_64;
    let d = 0.121_092_886 + f * -0.109_145_71;
    (a + f2 * b) + f4 * ((c + f2 * d) + f4 * 0.053_352_15)
}

/// Natural logarithm, for every `x` > 0, subnormals included; accuracy in [`ACCURACY`](super::ACCURACY).
///
/// x = 2^k m with m in [sqrt(1/2), sqrt 2), f = m - 1 (exact): ln x = k ln 2 + f - f^2/2 + f^3 P(f).
/// ln 1 = 0 exactly.
///
/// Outside the domain: `x` <= 0 counts as 0 and gives -infinity; infinity gives infinity; NaN gives NaN.
#[inline]
#[must_use]
pub fn ln(x: f32) -> f32 {
    if is_positive_normal(x) { ln_normal(x, 0) } else { unusual(x, ln_normal) }
}

#[inline(always)]
fn ln_normal(x: f32, shift: i32) -> f32 {
    let (k, m) = split_around_one(x);
    let k = (k + shift) as f32;
    let f = m - 1.0;
    let f2 = f * f;
    let tail = f * f2 * ln_tail(f, f2) + k * LN2_LOWER;
    k * LN2_UPPER + (f - (0.5 * f2 - tail))
}

/// Binary logarithm, for every `x` > 0, subnormals included; exact for powers of two; accuracy in
/// [`ACCURACY`](super::ACCURACY).
///
/// As [`ln`], the sum multiplied by 1/ln 2 in two pieces so that the product adds no error of its own.
///
/// Outside the domain: `x` <= 0 counts as 0 and gives -infinity; infinity gives infinity; NaN gives NaN.
#[inline]
#[must_use]
pub fn log2(x: f32) -> f32 {
    if is_positive_normal(x) { log2_normal(x, 0) } else { unusual(x, log2_normal) }
}

#[inline(always)]
fn log2_normal(x: f32, shift: i32) -> f32 {
    let (k, m) = split_around_one(x);
    let f = m - 1.0;
    let f2 = f * f;
    let half_square = 0.5 * f2;
    let tail = f * f2 * ln_tail(f, f2);
    let upper = upper12(f - half_square);
    let lower = ((f - upper) - half_square) + tail;
    let small = (lower + upper) * INV_LN2_LOWER + lower * INV_LN2_UPPER;
    let large = upper * INV_LN2_UPPER;
    let k = (k + shift) as f32;
    // k + large, and what that sum loses (|k| is 0 or > |large|).
    let sum = k + large;
    let lost = if k == 0.0 { 0.0 } else { large - (sum - k) };
    sum + (lost + small)
}

/// The logarithm of what is not positive and normal.
#[cold]
fn unusual(x: f32, logarithm: impl Fn(f32, i32) -> f32) -> f32 {
    if x <= 0.0 {
        f32::NEG_INFINITY
    } else if x < f32::MIN_POSITIVE {
        logarithm(normalised(x), -23)
    } else {
        x
    }
}

/// Natural exponential; accuracy in [`ACCURACY`](super::ACCURACY), subnormal results included.
///
/// x = k ln 2 + r, |r| <= ln 2 / 2: e^x = 2^k (1 + r + r^2 Q(r)). exp 0 = 1 exactly.
///
/// Above 88.722_84 the value is infinity; below -103.972_08 it is 0; NaN gives NaN.
#[inline]
#[must_use]
pub fn exp(x: f32) -> f32 {
    // Written so that NaN passes.
    let x = if x > 89.0 { 89.0 } else { x };
    let x = if x < -104.0 { -104.0 } else { x };
    let (k, kf) = nearest(x * INV_LN2);
    let upper = x - kf * LN2_UPPER;
    let lower = kf * LN2_LOWER;
    let r = upper - lower;
    let r2 = r * r;
    let q =
        (0.499_999_94 + r * 0.166_665_17) + r2 * ((0.041_668_28 + r * 0.008_369_248) + r2 * 0.001_382_074_4);
    // r is taken in its two pieces again, so that its rounding does not count.
    scale(1.0 + (upper + (r2 * q - lower)), k)
}

/// 2^r - 1 for |r| <= 1/2 (and a little), plus `lower` (tiny) times ln 2: relative error of 2^r below 2^-28.
#[inline(always)]
pub(super) fn exp2_minus_one(r: f32, lower: f32) -> f32 {
    let r2 = r * r;
    let q = (0.240_226_48 + r * 0.055_503_584)
        + r2 * ((0.009_618_455 + r * 0.001_339_233_8) + r2 * 1.535_492_8e-4);
    // The product with ln 2 in pieces: its large part is exact.
    let upper = upper12(r);
    upper * LN_2_UPPER12 + (r2 * q + (r * LN_2_REST + ((r - upper) + lower) * LN_2_UPPER12))
}

/// Two to the power `x`; exact for integers -149..=127; accuracy in [`ACCURACY`](super::ACCURACY), subnormal
/// results included.
///
/// From 128 the value is infinity; up to -150 it is 0; NaN gives NaN.
#[inline]
#[must_use]
pub fn exp2(x: f32) -> f32 {
    let x = if x > 129.0 { 129.0 } else { x };
    let x = if x < -151.0 { -151.0 } else { x };
    let (k, kf) = nearest(x);
    scale(1.0 + exp2_minus_one(x - kf, 0.0), k)
}
