//! Rough boundaries between dielectrics: light is reflected or refracted by microfacets, or into a Phong lobe about either direction.
//!
//! Of facets with normal m, eta the index beyond the surface (seen from `wo`) over that before it (B. Walter et al. 2007, eqs. 20 and 21):
//! reflected f = F D G / (4 |wo n| |wi n|), passed f = (1 - F) D G |wo m| |wi m| / (|wo n| |wi n| (wo m + eta wi m)^2), m along wo + eta wi.
//! This is radiance with `wo` towards the sensor: it is Walter's f over eta^2, so that passing light is multiplied by 1 / eta^2 as at a smooth boundary. From the other end,
//! f(wi, wo) = eta^2 f(wo, wi) where light passes: importance is had by exchanging the arguments.
//!
//! Of source C's lobes F is Fresnel's reflectance at n, and the lobes (n+1) / (2 pi) cos^n lie about the mirror and the refracted direction of `wo`: they lose energy, and are not reciprocal.

use super::facets::Facets;
use super::lobes::BsdfSample;
use super::rough::{Rough, half_vector};
use super::{fresnel, phong};
use crate::math::{self, TAU, Vec3};
use crate::sampling::warp;

/// A rough boundary between dielectrics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Boundary {
    /// Its surface.
    pub rough: Rough,
    /// Index below `n` over that above it, per channel; all is computed for the first.
    pub ratio: Vec3,
    /// Reflectance by Schlick's fit instead of Fresnel's equations.
    pub schlick: bool,
}

/// The boundary as seen from `wo`: n on its side, and the index beyond over that before.
struct Seen {
    n: Vec3,
    ratio: f32,
}

impl Boundary {
    fn seen(&self, n: Vec3, wo: Vec3) -> Seen {
        let ratio = self.ratio.x;
        if wo.dot(n) >= 0.0 { Seen { n, ratio } } else { Seen { n: -n, ratio: 1.0 / ratio } }
    }

    fn fresnel(&self, cos: f32, ratio: f32) -> f32 {
        let cos = cos.clamp(0.0, 1.0);
        if self.schlick { fresnel::schlick(cos, ratio) } else { fresnel::dielectric(cos, ratio) }
    }

    /// f \[1/sr\] and the density of [`Self::sample`] per solid angle.
    pub(super) fn values(&self, n: Vec3, wo: Vec3, wi: Vec3) -> (f32, f32) {
        let Seen { n, ratio } = self.seen(n, wo);
        let (before, after) = (wo.dot(n), wi.dot(n));
        if before == 0.0 || after == 0.0 {
            return (0.0, 0.0);
        }
        let facets = match &self.rough {
            Rough::Facets(facets) => facets,
            Rough::Phong(exponent) => return self.phong(*exponent, (n, ratio), wo, wi),
        };
        if after > 0.0 {
            let m = half_vector(wo, wi);
            return self.reflected(facets, (n, ratio), wo, wi, m);
        }
        let m = math::normalize_or(wo + wi * ratio, Vec3::ZERO);
        let m = if m.dot(n) < 0.0 { -m } else { m };
        self.passed(facets, (n, ratio), wo, wi, m)
    }

    fn reflected(&self, facets: &Facets, (n, ratio): (Vec3, f32), wo: Vec3, wi: Vec3, m: Vec3) -> (f32, f32) {
        let share = self.fresnel(wo.dot(m), ratio);
        let (f, pdf) = facets.reflect(n, wo, wi, m);
        (share * f, share * pdf)
    }

    fn passed(&self, facets: &Facets, (n, ratio): (Vec3, f32), wo: Vec3, wi: Vec3, m: Vec3) -> (f32, f32) {
        let (co, ci) = (wo.dot(m), -wi.dot(m));
        if co <= 0.0 || ci <= 0.0 {
            return (0.0, 0.0);
        }
        let stretch = co - ratio * ci;
        let stretch = stretch * stretch;
        // Indices that are (nearly) the same: all passes straight on, and no density is finite.
        if stretch < 1e-12 {
            return (0.0, 0.0);
        }
        let share = (1.0 - self.fresnel(co, ratio)) * (co * ci / stretch);
        let pdf = share * ratio * ratio * facets.pdf_over_cos(n, wo, m);
        let g = facets.masking_over_cos(n, wo) * facets.masking_over_cos(n, wi);
        (share * facets.density(n, m) * g, pdf)
    }

    fn phong(&self, exponent: f32, (n, ratio): (Vec3, f32), wo: Vec3, wi: Vec3) -> (f32, f32) {
        let share = self.fresnel(wo.dot(n), ratio);
        if wi.dot(n) > 0.0 {
            let f = share * phong::pdf_solid_angle(exponent, n, wo, wi);
            return (f, f);
        }
        let Some(axis) = fresnel::refract(n, wo, ratio) else { return (0.0, 0.0) };
        let cos = wi.dot(axis).clamp(0.0, 1.0);
        let lobe = if cos > 0.0 { (exponent + 1.0) / TAU * math::pow(cos, exponent) } else { 0.0 };
        let pdf = (1.0 - share) * lobe;
        (pdf / (ratio * ratio), pdf)
    }

    /// A direction, reflected or refracted by the reflectance at the facet.
    pub(super) fn sample(&self, n: Vec3, wo: Vec3, u: [f32; 2], lobe: f32) -> Option<BsdfSample> {
        let Seen { n, ratio } = self.seen(n, wo);
        let (wi, (f, pdf), passes) = match &self.rough {
            Rough::Facets(facets) => {
                let m = facets.sample_visible(n, wo, u);
                let cos = wo.dot(m);
                if lobe < self.fresnel(cos, ratio) {
                    let wi = math::reflect(wo, m);
                    (wi, self.reflected(facets, (n, ratio), wo, wi, m), false)
                } else {
                    let wi = fresnel::refract(m, wo, ratio)?;
                    (wi, self.passed(facets, (n, ratio), wo, wi, m), true)
                }
            }
            Rough::Phong(exponent) => {
                let passes = lobe >= self.fresnel(wo.dot(n), ratio);
                let wi = if passes {
                    let axis = fresnel::refract(n, wo, ratio)?;
                    let (t, b) = math::orthonormal_basis(axis);
                    math::from_local(warp::sample_power_cosine(u, *exponent), t, b, axis)
                } else {
                    phong::sample(*exponent, n, wo, u)
                };
                (wi, self.phong(*exponent, (n, ratio), wo, wi), passes)
            }
        };
        let cos = wi.dot(n);
        // What a facet sends to the wrong side is absorbed.
        if cos == 0.0 || (cos < 0.0) != passes || pdf <= 0.0 {
            return None;
        }
        Some(BsdfSample { wi, weight: Vec3::splat(f / pdf * math::abs(cos)), pdf })
    }
}
