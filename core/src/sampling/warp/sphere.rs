//! Densities of directions, per steradian, about the axis +z.

use super::super::ONE_MINUS_EPSILON;
use super::planar::{concentric, invert_disk};
use super::{PI, one_minus_exp_neg, sin_cos_turns, turns, unit};
use crate::math::{self, Vec3};

/// The direction at azimuth `turn` (in turns) with the given sine and cosine of its angle to +z.
#[inline(always)]
fn direction(turn: f32, sin_theta: f32, cos_theta: f32) -> Vec3 {
    let (s, c) = sin_cos_turns(turn);
    Vec3::new(c * sin_theta, s * sin_theta, cos_theta)
}

/// Squared sine of the angle to +z.
#[inline(always)]
fn sin_squared(w: Vec3) -> f32 {
    w.x * w.x + w.y * w.y
}

/// 1 - cos of the angle between the unit vector `w` and +z, without cancellation in the upper hemisphere: sin^2 / (1 + cos).
#[inline(always)]
fn one_minus_cos(w: Vec3) -> f32 {
    if w.z > 0.0 { sin_squared(w) / (1.0 + w.z) } else { 1.0 - w.z }
}

/// `-ln(cos)` of the angle between the unit vector `w` (z > 0) and +z, to a few ulp also near the axis, where cos itself rounds to 1.
///
/// There `-ln(1 - s) / 2 = atanh(y)` with s = sin^2, y = s / (2 - s) <= 1/7: five terms, 4e-10 relative.
#[inline]
fn neg_ln_cos(w: Vec3) -> f32 {
    let s = sin_squared(w);
    if s < 0.25 {
        let y = s / (2.0 - s);
        let q = y * y;
        y * (1.0 + q * (1.0 / 3.0 + q * (1.0 / 5.0 + q * (1.0 / 7.0 + q * (1.0 / 9.0)))))
    } else {
        -math::ln(w.z)
    }
}

/// A direction uniform over the sphere: z = 1 - 2 `u[0]`.
#[inline]
pub fn sample_sphere(u: [f32; 2]) -> Vec3 {
    // 1 - u is exact for multiples of 2^-24, and u (1 - u) free of cancellation at both poles.
    direction(u[1], 2.0 * math::sqrt(u[0] * (1.0 - u[0])), 1.0 - 2.0 * u[0])
}

/// Density of [`sample_sphere`] per steradian: 1 / (4 pi) for every direction.
#[inline]
pub const fn pdf_solid_angle_sphere(_w: Vec3) -> f32 {
    0.25 / PI
}

/// The `u` of [`sample_sphere`]; round trip to 4 ulp of 1 (2.4e-7).
#[inline]
pub fn invert_sphere(w: Vec3) -> [f32; 2] {
    let u0 = if w.z > 0.0 { 0.5 * one_minus_cos(w) } else { 0.5 - 0.5 * w.z };
    [unit(u0), turns(w.x, w.y)]
}

/// A direction uniform over the hemisphere z > 0: z = 1 - `u[0]` >= 2^-24.
#[inline]
pub fn sample_hemisphere(u: [f32; 2]) -> Vec3 {
    direction(u[1], math::sqrt(u[0] * (2.0 - u[0])), 1.0 - u[0])
}

/// Density of [`sample_hemisphere`] per steradian: 1 / (2 pi) where z > 0, else 0.
#[inline]
pub fn pdf_solid_angle_hemisphere(w: Vec3) -> f32 {
    if w.z > 0.0 { 0.5 / PI } else { 0.0 }
}

/// The `u` of [`sample_hemisphere`]; round trip to 4 ulp of 1 (2.4e-7).
#[inline]
pub fn invert_hemisphere(w: Vec3) -> [f32; 2] {
    [unit(one_minus_cos(w)), turns(w.x, w.y)]
}

/// A direction with density proportional to its cosine: the concentric disk lifted to the hemisphere (Malley's method); z >= 3.4e-4.
#[inline]
pub fn sample_cosine_hemisphere(u: [f32; 2]) -> Vec3 {
    let ([x, y], radius) = concentric(u);
    // From the radius, not from x and y, whose rounding could make the height zero.
    Vec3::new(x, y, math::sqrt((1.0 - radius) * (1.0 + radius)))
}

/// Density of [`sample_cosine_hemisphere`] per steradian: max(z, 0) / pi.
#[inline]
pub fn pdf_solid_angle_cosine_hemisphere(w: Vec3) -> f32 {
    w.z.max(0.0) * (1.0 / PI)
}

/// The `u` of [`sample_cosine_hemisphere`]; round trip to 4 ulp of 1 (2.4e-7).
#[inline]
pub fn invert_cosine_hemisphere(w: Vec3) -> [f32; 2] {
    invert_disk([w.x, w.y])
}

/// `1 - cos` of the angle whose squared sine is `sin_squared` (clamped to [0, 1]), for angles up to a right one: s / (1 + sqrt(1 - s)).
///
/// The cone of a sphere of radius r seen from distance d > r has sin^2 = r^2 / d^2.
#[inline]
pub fn one_minus_cos_of_sin_squared(sin_squared: f32) -> f32 {
    let s = sin_squared.clamp(0.0, 1.0);
    s / (1.0 + math::sqrt(1.0 - s))
}

/// A direction uniform over the cone about +z whose half angle has `1 - cos = one_minus_cos_max`, in (0, 2]: 1 - z = `u[0]` that.
///
/// Taking 1 - cos keeps tiny cones (down to 1e-30; the sun's is 1.1e-5) as accurate as wide ones.
#[inline]
pub fn sample_cone(u: [f32; 2], one_minus_cos_max: f32) -> Vec3 {
    let h = u[0] * one_minus_cos_max;
    direction(u[1], math::sqrt(h * (2.0 - h)), 1.0 - h)
}

/// Density of [`sample_cone`] per steradian: 1 / (2 pi `one_minus_cos_max`) inside, else 0.
///
/// The rim counts as inside within 2^-20 of the cone's size, as sampled directions are rounded. 0 for a cone of no size.
#[inline]
pub fn pdf_solid_angle_cone(one_minus_cos_max: f32, w: Vec3) -> f32 {
    let inside = one_minus_cos(w) <= one_minus_cos_max * (1.0 + 1.0 / 1_048_576.0);
    if inside && one_minus_cos_max > 0.0 { (0.5 / PI / one_minus_cos_max).min(f32::MAX) } else { 0.0 }
}

/// The `u` of [`sample_cone`]; round trip to 8 ulp of 1 (4.8e-7). `[0, azimuth]` for a cone of no size.
#[inline]
pub fn invert_cone(one_minus_cos_max: f32, w: Vec3) -> [f32; 2] {
    let u0 = if one_minus_cos_max > 0.0 { one_minus_cos(w) / one_minus_cos_max } else { 0.0 };
    [unit(u0), turns(w.x, w.y)]
}

/// A direction with density proportional to cos^`exponent` of its angle to +z, `exponent >= 0`: cos = (1 - `u[0]`)^(1 / (exponent + 1)).
///
/// The lobe of Phong's model about its axis. Accurate for any exponent: with t = -2 ln(1 - `u[0]`) / (exponent + 1), cos = exp(-t/2) and
/// sin^2 = 1 - exp(-t), formed without cancellation.
#[inline]
pub fn sample_power_cosine(u: [f32; 2], exponent: f32) -> Vec3 {
    let t = -math::ln(1.0 - u[0].min(ONE_MINUS_EPSILON)) / (exponent.max(0.0) + 1.0);
    direction(u[1], math::sqrt(one_minus_exp_neg(2.0 * t)), math::exp(-t))
}

/// Density of [`sample_power_cosine`] per steradian: (exponent + 1) / (2 pi) cos^exponent where z > 0, else 0.
#[inline]
pub fn pdf_solid_angle_power_cosine(exponent: f32, w: Vec3) -> f32 {
    if w.z > 0.0 {
        let n = exponent.max(0.0);
        (n + 1.0) * (0.5 / PI) * math::exp(-n * neg_ln_cos(w))
    } else {
        0.0
    }
}

/// The `u` of [`sample_power_cosine`]; round trip to 16 ulp of 1 (9.6e-7). `[1 - 2^-24, azimuth]` where z <= 0.
#[inline]
pub fn invert_power_cosine(exponent: f32, w: Vec3) -> [f32; 2] {
    let u0 = if w.z > 0.0 { one_minus_exp_neg((exponent.max(0.0) + 1.0) * neg_ln_cos(w)) } else { 1.0 };
    [unit(u0), turns(w.x, w.y)]
}
