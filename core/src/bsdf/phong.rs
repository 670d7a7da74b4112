//! The Phong lobe of source C: f = specular (n+1) / (2 pi) max(0, cos a)^n, a the angle to the mirror direction.
//!
//! Normalised over the sphere of directions and not over the cosine-weighted hemisphere, it loses energy at every
//! angle: at normal incidence it reflects (n+1)/(n+2) of `specular`, at grazing far less. It is kept as the source's
//! lobe. Source: Phong 1975; normalisation as in source C (B. Phong, modified after Lafortune and Willems 1994).

use crate::math::{self, TAU, Vec3};
use crate::sampling::warp;

/// Unit mirror direction of `wo` about `n`.
#[inline(always)]
pub fn mirror_direction(n: Vec3, wo: Vec3) -> Vec3 {
    n * (2.0 * wo.dot(n)) - wo
}

/// f \[1/sr\] for a direction `wi` on the side of `n`; 0 below.
#[inline]
pub fn eval(specular: Vec3, exponent: f32, n: Vec3, wo: Vec3, wi: Vec3) -> Vec3 {
    if wi.dot(n) > 0.0 { specular * pdf_solid_angle(exponent, n, wo, wi) } else { Vec3::ZERO }
}

/// Density of [`sample`] per solid angle, over the whole sphere: samples below the surface carry nothing.
#[inline]
pub fn pdf_solid_angle(exponent: f32, n: Vec3, wo: Vec3, wi: Vec3) -> f32 {
    let cos = wi.dot(mirror_direction(n, wo)).clamp(0.0, 1.0);
    if cos > 0.0 { (exponent + 1.0) / TAU * math::pow(cos, exponent) } else { 0.0 }
}

/// A direction about the mirror direction with density (n+1) / (2 pi) cos^n.
#[inline]
pub fn sample(exponent: f32, n: Vec3, wo: Vec3, u: [f32; 2]) -> Vec3 {
    let local = warp::sample_power_cosine(u, exponent);
    let axis = mirror_direction(n, wo);
    let (t, b) = math::orthonormal_basis(axis);
    t * local.x + b * local.y + axis * local.z
}
