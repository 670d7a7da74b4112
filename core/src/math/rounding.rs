//! Rounding to integers and choosing between values: all exact.

/// Above this every f32 is an integer.
const ALL_INTEGERS: f32 = 8_388_608.0;

/// `x` without its fraction (toward zero). Exact; keeps the sign of a zero; infinities and NaN are returned as they are.
#[inline]
#[must_use]
pub fn trunc(x: f32) -> f32 {
    if x.abs() < ALL_INTEGERS { f32::copysign((x as i32) as f32, x) } else { x }
}

/// The largest integer not above `x`. Exact; keeps the sign of a zero; infinities and NaN are returned as they are.
#[inline]
#[must_use]
pub fn floor(x: f32) -> f32 {
    let t = trunc(x);
    if t > x { t - 1.0 } else { t }
}

/// The smallest integer not below `x`. Exact; ceil of (-1, -0] is -0; infinities and NaN are returned as they are.
#[inline]
#[must_use]
pub fn ceil(x: f32) -> f32 {
    let t = trunc(x);
    if t < x { t + 1.0 } else { t }
}

/// The nearest integer, halves away from zero. Exact; keeps the sign; infinities and NaN are returned as they are.
#[inline]
#[must_use]
pub fn round(x: f32) -> f32 {
    let t = trunc(x);
    // The difference is exact, unlike x + 1/2 for the largest float below 1/2.
    if (x - t).abs() >= 0.5 { t + f32::copysign(1.0, x) } else { t }
}

/// `x - floor(x)`, in [0, 1): exact but where the difference rounds to 1 (-2^-25 <= x < 0), which gives 1 - 2^-24.
/// NaN for infinities and NaN.
#[inline]
#[must_use]
pub fn fract(x: f32) -> f32 {
    let d = x - floor(x);
    if d >= 1.0 { super::ONE_MINUS_EPSILON } else { d }
}

/// |x|: clears the sign bit.
#[inline(always)]
#[must_use]
pub fn abs(x: f32) -> f32 {
    x.abs()
}

/// The magnitude of `x` with the sign bit of `sign`.
#[inline(always)]
#[must_use]
pub fn copysign(x: f32, sign: f32) -> f32 {
    x.copysign(sign)
}

/// `if a < b { a } else { b }`: one instruction; `b` if either is NaN or both are zeros.
#[inline(always)]
#[must_use]
pub fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// `if a > b { a } else { b }`: one instruction; `b` if either is NaN or both are zeros.
#[inline(always)]
#[must_use]
pub fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// `min(max(x, low), high)`: `low` for NaN. With low > high it is `high`: no panic.
#[inline(always)]
#[must_use]
pub fn clamp(x: f32, low: f32, high: f32) -> f32 {
    min(max(x, low), high)
}
