//! Rough mirrors: what a perfect reflector of rough surface reflects, and a metal.
//!
//! Of microfacets f = D G / (4 |wo n| |wi n|) about the half vector (R. Cook and K. Torrance 1982); of source C's lobe (n+1) / (2 pi) cos^n about the mirror
//! direction. A metal multiplies it by Fresnel's reflectance at the half vector, which is the same from both ends: f is reciprocal.

use super::facets::Facets;
use super::lobes::BsdfSample;
use super::{fresnel, phong};
use crate::math::{self, Vec3};

/// How a surface is rough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rough {
    /// Microfacets.
    Facets(Facets),
    /// A Phong lobe of this exponent.
    Phong(f32),
}

/// Unit vector half way between two directions.
#[inline]
pub(super) fn half_vector(wo: Vec3, wi: Vec3) -> Vec3 {
    math::normalize_or(wo + wi, wo)
}

impl Rough {
    /// f of a perfect reflector \[1/sr\] and the density of [`Self::sample`] per solid angle; both 0 unless `wo` and `wi` are above `n`.
    pub(super) fn reflect(&self, n: Vec3, wo: Vec3, wi: Vec3) -> (f32, f32) {
        if wo.dot(n) <= 0.0 || wi.dot(n) <= 0.0 {
            return (0.0, 0.0);
        }
        match self {
            Self::Facets(facets) => facets.reflect(n, wo, wi, half_vector(wo, wi)),
            Self::Phong(exponent) => {
                let f = phong::pdf_solid_angle(*exponent, n, wo, wi);
                (f, f)
            }
        }
    }

    /// A direction, which may be below the surface: there it is absorbed.
    pub(super) fn sample(&self, n: Vec3, wo: Vec3, u: [f32; 2]) -> Vec3 {
        match self {
            Self::Facets(facets) => math::reflect(wo, facets.sample_visible(n, wo, u)),
            Self::Phong(exponent) => phong::sample(*exponent, n, wo, u),
        }
    }
}

impl Facets {
    /// f of perfect reflectors \[1/sr\] at facets of normal `m`, and the density per solid angle of the directions that they reflect to.
    pub(super) fn reflect(&self, n: Vec3, wo: Vec3, wi: Vec3, m: Vec3) -> (f32, f32) {
        let pdf = 0.25 * self.pdf_over_cos(n, wo, m);
        let g = self.masking_over_cos(n, wo) * self.masking_over_cos(n, wi);
        (0.25 * self.density(n, m) * g, pdf)
    }
}

/// A rough metal of refractive index eta + i k per channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metal {
    /// Its surface.
    pub rough: Rough,
    /// Real part.
    pub eta: Vec3,
    /// Imaginary part.
    pub k: Vec3,
}

impl Metal {
    fn reflectance(&self, wo: Vec3, wi: Vec3) -> Vec3 {
        let cos = wo.dot(half_vector(wo, wi)).clamp(0.0, 1.0);
        fresnel::conductor_rgb(cos, self.eta, self.k)
    }

    pub(super) fn eval(&self, n: Vec3, wo: Vec3, wi: Vec3) -> Vec3 {
        let (f, _) = self.rough.reflect(n, wo, wi);
        if f > 0.0 { self.reflectance(wo, wi) * f } else { Vec3::ZERO }
    }

    pub(super) fn sample(&self, n: Vec3, wo: Vec3, u: [f32; 2]) -> Option<BsdfSample> {
        if wo.dot(n) <= 0.0 {
            return None;
        }
        let wi = self.rough.sample(n, wo, u);
        let (f, pdf) = self.rough.reflect(n, wo, wi);
        // The ratio first: both are large where a surface is nearly smooth.
        (pdf > 0.0).then(|| BsdfSample { wi, weight: self.reflectance(wo, wi) * (f / pdf * wi.dot(n)), pdf })
    }
}
