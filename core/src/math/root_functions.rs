//! Square root and cube root.

use super::bits::upper8;

/// Square root, correctly rounded (the machine's own instruction where there is one). sqrt(-0) = -0.
///
/// Precondition: `x` >= 0. A negative `x` gives NaN; where rounding can make it so, use [`sqrt_clamped`].
#[inline(always)]
#[must_use]
pub fn sqrt(x: f32) -> f32 {
    // Both are correctly rounded. libm has it as inline assembly, which the compiler can neither move nor make vectors of.
    #[cfg(feature = "std")]
    #[allow(clippy::disallowed_methods, reason = "this is the door")]
    {
        x.sqrt()
    }
    #[cfg(not(feature = "std"))]
    libm::sqrtf(x)
}

/// Square root in f64, correctly rounded; for the host. A negative `x` gives NaN.
#[inline(always)]
#[must_use]
pub fn sqrt64(x: f64) -> f64 {
    #[cfg(feature = "std")]
    #[allow(clippy::disallowed_methods, reason = "this is the door")]
    {
        x.sqrt()
    }
    #[cfg(not(feature = "std"))]
    libm::sqrt(x)
}

/// Square root of the larger of `x` and 0, correctly rounded: never NaN (NaN counts as 0).
#[inline(always)]
#[must_use]
pub fn sqrt_clamped(x: f32) -> f32 {
    sqrt(if x > 0.0 { x } else { 0.0 })
}

/// Cube root, odd to the bit, for every finite `x`, subnormals included; accuracy in [`ACCURACY`](super::ACCURACY).
/// Zero gives zero of the same sign, infinity gives infinity, NaN gives NaN.
///
/// y = |x|^(-1/3) from the bits (exponent divided by -3) and two Newton steps without division; t = x y^2 is then
/// right to 2^-15, and one last Newton step whose residual x - t^3 is formed exactly from the upper 8 bits of t ends it.
#[inline]
#[must_use]
pub fn cbrt(x: f32) -> f32 {
    let a = x.abs();
    // Small arguments are scaled by 2^48 (the result by 2^-16), or the residual would be subnormal.
    let (v, back) = if a < 8.0e-19 { (a * 281_474_976_710_656.0, 1.0 / 65_536.0) } else { (a, 1.0) };
    const THIRD: f32 = 1.0 / 3.0;
    let y = f32::from_bits(0x54a2_1d2a - v.to_bits() / 3);
    let y = y + y * THIRD * (1.0 - (v * y) * y * y);
    let y = y + y * THIRD * (1.0 - (v * y) * y * y);
    let y2 = y * y;
    let t = v * y2;
    let upper = upper8(t);
    let lower = t - upper;
    let residual = (v - upper * upper * upper) - lower * (3.0 * (upper * t) + lower * lower);
    let root = (t + residual * (y2 * THIRD)) * back;
    if a > 0.0 && a < f32::INFINITY { f32::copysign(root, x) } else { x }
}
