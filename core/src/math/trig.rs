//! Sine, cosine, tangent: argument in radians.

use super::bits::nearest;

/// Largest |x| that [`sin_cos`] reduces: 2^10 pi, rounded down.
const LIMIT: f32 = 3216.0;

/// pi/2 in four pieces of 13, 13, 13 and 24 bits: a multiple n <= 2^11 of each of the first three is exact.
const HALF_PI_1: f32 = 1.570_556_6;
const HALF_PI_2: f32 = 2.396_702_8e-4;
const HALF_PI_3: f32 = 1.589_069_1e-8;
const HALF_PI_4: f32 = 2.563_344e-12;
const TWO_OVER_PI: f32 = core::f32::consts::FRAC_2_PI;

/// x = n pi/2 + r + lower with |r| <= pi/4 (and an ulp): (n, r, lower).
#[inline(always)]
fn reduce(x: f32) -> (i32, f32, f32) {
    // Written so that NaN passes.
    let x = if x.abs() > LIMIT { 0.0 } else { x };
    let (n, nf) = nearest(x * TWO_OVER_PI);
    // Each subtraction is exact where it cancels; elsewhere what it loses is carried in e2 and e3.
    let r1 = x - nf * HALF_PI_1;
    let n2 = nf * HALF_PI_2;
    let r2 = r1 - n2;
    let e2 = (r1 - r2) - n2;
    let n3 = nf * HALF_PI_3;
    let r3 = r2 - n3;
    let e3 = (r2 - r3) - n3;
    let lost = (e2 + e3) - nf * HALF_PI_4;
    let r = r3 + lost;
    (n, r, (r3 - r) + lost)
}

/// sin(r + lower) for |r| <= pi/4: r + r^3 S(r^2), 2^-27.8 relative.
#[inline(always)]
fn sin_reduced(r: f32, lower: f32, z: f32) -> f32 {
    let s = -0.166_666_54 + z * (0.008_332_106 + z * -1.950_788_3e-4);
    r + (r * z * s + lower)
}

/// cos(r + lower) for |r| <= pi/4: 1 - r^2/2 + r^4 C(r^2), 2^-33 relative.
#[inline(always)]
fn cos_reduced(r: f32, lower: f32, z: f32) -> f32 {
    let c = 0.041_666_646 + z * (-0.001_388_730_8 + z * 2.443_210_2e-5);
    let half = 0.5 * z;
    let w = 1.0 - half;
    w + (((1.0 - w) - half) + (z * z * c - r * lower))
}

/// (sin x, cos x), `x` in radians, |x| <= 3216 (2^10 pi rounded down); accuracy in [`ACCURACY`](super::ACCURACY).
///
/// Reduction by pi/2 in four pieces (after Cody and Waite, 1980), then a polynomial of degree 7 for the sine and
/// 8 for the cosine. sin is odd and cos even to the bit (but sin -0 = +0); both stay in [-1, 1]; sin_cos 0 = (0, 1).
///
/// Outside the domain: |x| > 3216 counts as 0 and gives (0, 1); so does infinity. NaN gives NaN.
#[inline]
#[must_use]
pub fn sin_cos(x: f32) -> (f32, f32) {
    let (n, r, lower) = reduce(x);
    let z = r * r;
    let s = sin_reduced(r, lower, z);
    let c = cos_reduced(r, lower, z);
    // Swapped for odd n, by bits: a branch on n would be mispredicted half of the time.
    let n = n as u32;
    let (s, c) = (s.to_bits(), c.to_bits());
    let swap = (s ^ c) & 0_u32.wrapping_sub(n & 1);
    let sin_sign = (n & 2) << 30;
    let cos_sign = (n.wrapping_add(1) & 2) << 30;
    (f32::from_bits(s ^ swap ^ sin_sign), f32::from_bits(c ^ swap ^ cos_sign))
}

/// (sin x, cos x) for |x| <= pi/4 (and an ulp), without reduction: the bits of [`sin_cos`] there.
#[inline]
#[must_use]
pub fn sin_cos_quarter(x: f32) -> (f32, f32) {
    let z = x * x;
    (sin_reduced(x, 0.0, z), cos_reduced(x, 0.0, z))
}

/// sin x: the first value of [`sin_cos`], to the bit.
#[inline]
#[must_use]
pub fn sin(x: f32) -> f32 {
    sin_cos(x).0
}

/// cos x: the second value of [`sin_cos`], to the bit.
#[inline]
#[must_use]
pub fn cos(x: f32) -> f32 {
    sin_cos(x).1
}

/// tan x = sin x / cos x; domain and behaviour outside it as [`sin_cos`]. No f32 is a pole: the value is finite.
#[inline]
#[must_use]
pub fn tan(x: f32) -> f32 {
    let (s, c) = sin_cos(x);
    s / c
}
