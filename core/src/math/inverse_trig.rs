//! Arc sine, arc cosine, arc tangent: results in radians.

use super::bits::upper12;
use super::consts::{HALF_PI, HALF_PI_LOW, PI, PI_LOW};
use super::root_functions::sqrt;

/// (asin(sqrt z) - sqrt z) / sqrt z for 0 <= z <= 1/4: z P(z), 2^-31.7 relative to asin.
#[inline(always)]
fn asin_tail(z: f32) -> f32 {
    let z2 = z * z;
    let a = 0.166_666_6 + z * 0.075_005_22;
    let b = 0.044_513_382 + z * 0.031_838_845;
    let c = 0.014_316_901 + z * 0.037_691_906;
    z * (a + z2 * (b + z2 * c))
}

/// [-1, 1], and NaN stays NaN.
#[inline(always)]
fn clamp_to_unit(x: f32) -> f32 {
    let x = if x > 1.0 { 1.0 } else { x };
    if x < -1.0 { -1.0 } else { x }
}

/// Arc cosine, in [0, pi] (f32 pi); accuracy in [`ACCURACY`](super::ACCURACY). Exact at 1 (0), at -1 and at 0 (rounded pi and pi/2).
///
/// |x| <= 1/2: pi/2 - asin x. Otherwise with z = (1 - |x|) / 2, exact: 2 asin(sqrt z), or pi minus that.
/// `x` outside [-1, 1] counts as the nearer end: a dot product of two unit vectors needs no care. NaN gives NaN.
#[inline]
#[must_use]
pub fn acos(x: f32) -> f32 {
    let x = clamp_to_unit(x);
    let a = x.abs();
    if a <= 0.5 {
        let tail = x * asin_tail(x * x);
        HALF_PI - (x - (HALF_PI_LOW - tail))
    } else {
        let z = 0.5 - 0.5 * a;
        let s = sqrt(z);
        let tail = s * asin_tail(z);
        if x > 0.0 { 2.0 * (s + tail) } else { PI - (2.0 * s - (PI_LOW - 2.0 * tail)) }
    }
}

/// Arc sine, in [-pi/2, pi/2]; accuracy in [`ACCURACY`](super::ACCURACY). Odd to the bit.
///
/// `x` outside [-1, 1] counts as the nearer end. NaN gives NaN.
#[inline]
#[must_use]
pub fn asin(x: f32) -> f32 {
    let x = clamp_to_unit(x);
    let a = x.abs();
    if a <= 0.5 {
        x + x * asin_tail(x * x)
    } else {
        let z = 0.5 - 0.5 * a;
        let s = sqrt(z);
        let tail = s * asin_tail(z);
        // `lost` is what the first difference loses.
        let difference = HALF_PI - 2.0 * s;
        let lost = (HALF_PI - difference) - 2.0 * s;
        let y = difference - ((2.0 * tail - HALF_PI_LOW) - lost);
        f32::copysign(y, x)
    }
}

/// (atan q - q) / q for 0 <= q <= 1, from q^2 = z: z P(z), 2^-28.5 relative to atan.
#[inline(always)]
fn atan_tail(z: f32) -> f32 {
    let z2 = z * z;
    let z4 = z2 * z2;
    let a = -0.333_333 + z * 0.199_985_3;
    let b = -0.142_640_16 + z * 0.109_508_775;
    let c = -0.083_992_78 + z * 0.057_880_387;
    let d = -0.031_095_307 + z * 0.010_867_341;
    z * ((a + z2 * b) + z4 * ((c + z2 * d) + z4 * -0.001_782_405_9))
}

/// What the rounding of q = small / large has lost, to a few bits: (small - q large) / large.
#[inline(always)]
fn lost_in_quotient(q: f32, small: f32, large: f32) -> f32 {
    // Each product of the pieces is exact, and the differences cancel exactly.
    let (q_upper, l_upper) = (upper12(q), upper12(large));
    let remainder = ((small - q_upper * l_upper) - (q - q_upper) * l_upper) - q * (large - l_upper);
    // Below, products would be subnormal; infinities have no remainder.
    if small > 1.0e-24 && large < f32::INFINITY { remainder / large } else { 0.0 }
}

/// The angle of the vector (x, y) against the x axis, in [-pi, pi] (f32 pi); accuracy in [`ACCURACY`](super::ACCURACY). Odd in `y` to
/// the bit.
///
/// atan2(0, 0) = 0, whatever the signs of the zeros. atan2(0, x) is 0 for x > 0 and pi for x < 0; atan2(-0, x < 0) is
/// -pi. Two infinities count as equal (atan2(1, 1), which is pi/4 less an ulp, and its
/// reflections). NaN gives NaN.
#[inline]
#[must_use]
pub fn atan2(y: f32, x: f32) -> f32 {
    let (ay, ax) = (y.abs(), x.abs());
    let steep = ay > ax;
    let (small, large) = if steep { (ax, ay) } else { (ay, ax) };
    // Equal also means both infinite; both zero is the angle 0.
    let q = if small == large { if large == 0.0 { 0.0 } else { 1.0 } } else { small / large };
    let tail = q * atan_tail(q * q) + lost_in_quotient(q, small, large);
    // The angle is base +- (q + tail): base in two pieces, and `lost` what the first sum loses.
    let left = x < 0.0;
    let (base, base_low) = if steep {
        (HALF_PI, HALF_PI_LOW)
    } else if left {
        (PI, PI_LOW)
    } else {
        (0.0, 0.0)
    };
    let (q, tail) = if steep == left { (q, tail) } else { (-q, -tail) };
    let sum = base + q;
    let lost = (base - sum) + q;
    let angle = sum + (lost + (tail + base_low));
    f32::copysign(angle, y)
}

/// Arc tangent, in [-pi/2, pi/2]: `atan2(x, 1)`, to the bit.
#[inline]
#[must_use]
pub fn atan(x: f32) -> f32 {
    atan2(x, 1.0)
}
