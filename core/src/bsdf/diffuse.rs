//! Lambert's law: f = albedo / pi (Lambert 1760). Reflects `albedo` of the irradiance, exactly.

use crate::math::{self, INV_PI, Vec3};
use crate::sampling::warp;

/// f \[1/sr\] for a direction `wi` on the side of `n`; 0 below.
#[inline(always)]
pub fn eval(albedo: Vec3, n: Vec3, wi: Vec3) -> Vec3 {
    if wi.dot(n) > 0.0 { albedo * INV_PI } else { Vec3::ZERO }
}

/// Density of [`sample`] per solid angle: cos / pi, 0 below the surface.
#[inline(always)]
pub fn pdf_solid_angle(n: Vec3, wi: Vec3) -> f32 {
    (wi.dot(n) * INV_PI).max(0.0)
}

/// A direction about `n` with density cos / pi.
#[inline(always)]
pub fn sample(n: Vec3, u: [f32; 2]) -> Vec3 {
    let local = warp::sample_cosine_hemisphere(u);
    let (t, b) = math::orthonormal_basis(n);
    t * local.x + b * local.y + n * local.z
}
