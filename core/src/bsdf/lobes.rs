//! The sum of lobes at one surface point.

use super::{diffuse, phong};
use crate::math::{self, Vec3};

/// Everything that a surface point reflects: albedo / pi, a Phong lobe, or a perfect mirror.
///
/// The mirror is alone: a material either is one or has the other two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lobes {
    /// Diffuse albedo per channel; of a mirror, its reflectance.
    pub albedo: Vec3,
    /// Specular coefficient of the Phong lobe per channel.
    pub specular: Vec3,
    /// Exponent of the Phong lobe.
    pub exponent: f32,
    /// A perfect mirror.
    pub mirror: bool,
}

/// A sampled direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfSample {
    /// Unit direction.
    pub wi: Vec3,
    /// f cos / pdf per channel: what the throughput is multiplied by.
    pub weight: Vec3,
    /// Density per solid angle of all lobes together; 0 marks a direction without density (a mirror).
    pub pdf: f32,
}

impl Lobes {
    /// A diffuse surface.
    pub fn diffuse(albedo: Vec3) -> Self {
        Self { albedo, specular: Vec3::ZERO, exponent: 0.0, mirror: false }
    }

    /// Light sampling can contribute: some lobe has a density.
    #[inline(always)]
    pub fn has_density(&self) -> bool {
        !self.mirror
    }

    /// Light passes: directions on the other side can be sampled.
    #[inline(always)]
    pub fn transmits(&self) -> bool {
        false
    }

    /// Probability of choosing the diffuse lobe: its share of the mean reflectance.
    #[inline]
    pub(crate) fn diffuse_share(&self) -> f32 {
        let (d, s) = (math::mean(self.albedo), math::mean(self.specular));
        if d + s > 0.0 { d / (d + s) } else { 1.0 }
    }

    /// f(wo, wi) \[1/sr\] per channel, the mirror left out (it has no value at any direction).
    #[inline(always)]
    pub fn eval(&self, n: Vec3, wo: Vec3, wi: Vec3) -> Vec3 {
        if self.mirror {
            return Vec3::ZERO;
        }
        let f = diffuse::eval(self.albedo, n, wi);
        if self.specular == Vec3::ZERO {
            return f;
        }
        f + phong::eval(self.specular, self.exponent, n, wo, wi)
    }

    /// Density per solid angle with which [`Self::sample`] draws `wi`; 0 for a mirror.
    #[inline(always)]
    pub fn pdf_solid_angle(&self, n: Vec3, wo: Vec3, wi: Vec3) -> f32 {
        if self.mirror {
            return 0.0;
        }
        if self.specular == Vec3::ZERO {
            return diffuse::pdf_solid_angle(n, wi);
        }
        let share = self.diffuse_share();
        share * diffuse::pdf_solid_angle(n, wi)
            + (1.0 - share) * phong::pdf_solid_angle(self.exponent, n, wo, wi)
    }

    /// A direction in proportion to the lobes. `u` chooses the direction, `lobe` the lobe, all in [0, 1).
    /// `None` where the light is absorbed: a black surface or a direction below it.
    #[inline(always)]
    pub fn sample(&self, n: Vec3, wo: Vec3, u: [f32; 2], lobe: f32) -> Option<BsdfSample> {
        if self.mirror {
            let wi = phong::mirror_direction(n, wo);
            return (wi.dot(n) > 0.0).then_some(BsdfSample { wi, weight: self.albedo, pdf: 0.0 });
        }
        if self.specular == Vec3::ZERO {
            let wi = diffuse::sample(n, u);
            let pdf = diffuse::pdf_solid_angle(n, wi);
            return (pdf > 0.0).then_some(BsdfSample { wi, weight: self.albedo, pdf });
        }
        let wi = if lobe < self.diffuse_share() {
            diffuse::sample(n, u)
        } else {
            phong::sample(self.exponent, n, wo, u)
        };
        let cos = wi.dot(n);
        let pdf = self.pdf_solid_angle(n, wo, wi);
        if cos > 0.0 && pdf > 0.0 {
            let weight = self.eval(n, wo, wi) * (cos / pdf);
            return Some(BsdfSample { wi, weight, pdf });
        }
        None
    }
}
