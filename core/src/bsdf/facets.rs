//! Microfacets: how the normals of a rough surface are distributed, how they hide each other, and which of them are seen.
//!
//! Two distributions of slopes, isotropic, of scale alpha (theta: the angle of a facet's normal m to the surface's n):
//! - GGX (Trowbridge and Reitz 1975): D = 1 / (pi alpha^2 cos^4 (1 + tan^2 / alpha^2)^2);
//! - Beckmann (1963), Gaussian slopes: D = exp(-tan^2 / alpha^2) / (pi alpha^2 cos^4).
//!
//! Densities are per solid angle of m, Int D cos = 1. A direction v sees the share G1(v) of the facets that face it (Smith 1967): of GGX
//! 2 / (1 + sqrt(1 + alpha^2 tan^2)), of Beckmann the rational fit of B. Walter et al. (2007), 0.35 % off at most. Masking and shadowing are taken for
//! independent, G = G1(wo) G1(wi). Facets are sampled as they are seen, with density D G1(wo) (wo m) / (wo n), G1 exact there.
//!
//! Sources: B. Walter, S. Marschner, H. Li, K. Torrance, "Microfacet Models for Refraction through Rough Surfaces" (2007); E. Heitz and E. d'Eon, "Importance
//! Sampling Microfacet-Based BSDFs using the Distribution of Visible Normals" (2014); J. Dupuy and A. Benyoub, "Sampling Visible GGX Normals with Spherical
//! Caps" (2023); W. Jakob, "An Improved Visible Normal Sampling Routine for the Beckmann Distribution" (2014) for inverting in the domain of erf.

use super::erf::{INV_SQRT_PI, erf, erf_inverse};
use crate::math::{self, INV_PI, Vec3};
use crate::sampling::warp;

/// The least scale of slopes: what is smoother counts as this rough.
pub const ALPHA_MIN: f32 = 1e-4;
/// Steps of the search for a Gaussian slope; three do but near grazing angles.
const STEPS: u32 = 8;

/// A distribution of microfacets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facets {
    alpha: f32,
    beckmann: bool,
}

/// Cosine, and squared sine without cancellation, of the angle between unit vectors.
#[inline]
fn cos_sin2(n: Vec3, v: Vec3) -> (f32, f32) {
    let across = n.cross(v);
    (n.dot(v), across.dot(across))
}

impl Facets {
    /// GGX of this scale.
    pub fn ggx(alpha: f32) -> Self {
        Self { alpha: alpha.max(ALPHA_MIN), beckmann: false }
    }

    /// Beckmann's distribution of this scale.
    pub fn beckmann(alpha: f32) -> Self {
        Self { alpha: alpha.max(ALPHA_MIN), beckmann: true }
    }

    /// D(m) \[1/sr\]; 0 for normals that point down.
    pub fn density(&self, n: Vec3, m: Vec3) -> f32 {
        let (cos, sin2) = cos_sin2(n, m);
        if cos <= 0.0 {
            return 0.0;
        }
        let (alpha2, cos2) = (self.alpha * self.alpha, cos * cos);
        if self.beckmann {
            let e = math::exp(-sin2 / (alpha2 * cos2));
            return if e > 0.0 { e * INV_PI / (alpha2 * cos2 * cos2) } else { 0.0 };
        }
        let k = sin2 / alpha2 + cos2;
        INV_PI / (alpha2 * k * k)
    }

    /// G1(v): the share of the facets facing v that it sees. `v` may be on either side of `n`; its facets are taken to be on the same one.
    pub fn masking(&self, n: Vec3, v: Vec3) -> f32 {
        let cos = math::abs(n.dot(v));
        if cos > 0.0 { (self.masking_over_cos(n, v) * cos).min(1.0) } else { 0.0 }
    }

    /// G1(v) / |cos|: finite at grazing angles, too.
    pub(super) fn masking_over_cos(&self, n: Vec3, v: Vec3) -> f32 {
        let (cos, sin2) = cos_sin2(n, v);
        let cos = math::abs(cos);
        if !self.beckmann {
            return 2.0 / (cos + math::sqrt(cos * cos + self.alpha * self.alpha * sin2));
        }
        let spread = self.alpha * math::sqrt(sin2);
        if cos >= 1.6 * spread {
            return 1.0 / cos;
        }
        let a = cos / spread;
        (3.535 + 2.181 * a) / ((1.0 + a * (2.276 + 2.577 * a)) * spread)
    }

    /// The same of which samples are drawn: exact.
    fn seen_over_cos(&self, n: Vec3, v: Vec3) -> f32 {
        if !self.beckmann {
            return self.masking_over_cos(n, v);
        }
        let (cos, sin2) = cos_sin2(n, v);
        let (cos, spread) = (math::abs(cos), self.alpha * math::sqrt(sin2));
        let a = if spread > 0.0 { cos / spread } else { f32::INFINITY };
        2.0 / (cos * (1.0 + erf(a)) + spread * INV_SQRT_PI * math::exp(-a * a))
    }

    /// Density of [`Self::sample_visible`] per solid angle of m.
    pub fn pdf_visible(&self, n: Vec3, wo: Vec3, m: Vec3) -> f32 {
        self.pdf_over_cos(n, wo, m) * wo.dot(m).max(0.0)
    }

    /// The same over (wo m).
    pub(super) fn pdf_over_cos(&self, n: Vec3, wo: Vec3, m: Vec3) -> f32 {
        self.density(n, m) * self.seen_over_cos(n, wo)
    }

    /// A facet's normal, as often as `wo`, which is above `n`, sees it.
    pub fn sample_visible(&self, n: Vec3, wo: Vec3, u: [f32; 2]) -> Vec3 {
        let (t, b) = math::orthonormal_basis(n);
        let v = math::to_local(wo, t, b, n);
        // On the surface stretched to alpha = 1.
        let v = math::normalize_or(Vec3::new(self.alpha * v.x, self.alpha * v.y, v.z.max(0.0)), Vec3::Z);
        let m = if self.beckmann { sample_gaussian(v, u) } else { sample_cap(v, u) };
        let m = math::normalize_or(Vec3::new(self.alpha * m.x, self.alpha * m.y, m.z), Vec3::Z);
        math::from_local(m, t, b, n)
    }
}

/// GGX of alpha = 1 is a hemisphere, which is seen as a cap of mirror directions.
fn sample_cap(v: Vec3, u: [f32; 2]) -> Vec3 {
    let height = u[0] * (1.0 + v.z);
    let s = math::sqrt_clamped(height * (2.0 - height));
    let (across, along) = warp::sin_cos_turns(u[1]);
    Vec3::new(s * along + v.x, s * across + v.y, (1.0 - u[0]) * (1.0 + v.z))
}

/// Slopes of a Gaussian surface with alpha = 1 as v sees them: towards v, with density proportional to
/// (cos - x sin) exp(-x^2) up to x = cot, by inverting its integral in y = erf x; across, by erf itself.
fn sample_gaussian(v: Vec3, u: [f32; 2]) -> Vec3 {
    let sin = math::sqrt(v.x * v.x + v.y * v.y);
    let (cos, sine) = (v.z, sin * INV_SQRT_PI);
    let sum = |y: f32, x: f32| cos * (1.0 + y) + sine * math::exp(-x * x);
    let cot = if sin > 0.0 { cos / sin } else { f32::INFINITY };
    let top = erf(cot);
    let all = sum(top, cot.min(1e18));
    let u0 = math::clamp(u[0], 1e-6, 1.0 - 1e-6);
    let wanted = u0 * all;
    let (mut low, mut high) = (-1.0, top);
    // What is right at grazing angles.
    let mut y = top - (top + 1.0) * erf(math::sqrt_clamped(-math::ln(u0)));
    for _ in 0..STEPS {
        let x = erf_inverse(y);
        let error = sum(y, x) - wanted;
        if error > 0.0 {
            high = y;
        } else {
            low = y;
        }
        let slope = cos - x * sin;
        if math::abs(error) <= 1e-7 * slope {
            break;
        }
        let next = y - error / slope;
        y = if slope > 0.0 && next > low && next < high { next } else { 0.5 * (low + high) };
    }
    let (x, across) = (erf_inverse(y), erf_inverse(2.0 * u[1] - 1.0));
    let [c, s] = if sin > 0.0 { [v.x / sin, v.y / sin] } else { [1.0, 0.0] };
    Vec3::new(s * across - c * x, -s * x - c * across, 1.0)
}
