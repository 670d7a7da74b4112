//! A place where light is scattered: on a surface or in a medium.

use super::way::Way;
use super::with_unit_direction;
use crate::bsdf::BsdfSample;
use crate::geometry::{Ray, SurfacePoint};
use crate::light::{self, LightSample};
use crate::math::{self, Vec3};
use crate::medium::{Inside, phase};
use crate::transport::Surface;

/// Where light is scattered.
pub(in crate::transport) enum Vertex<'a> {
    /// A surface, and what lies beyond it.
    Surface(&'a Surface, Inside),
    Medium {
        position: Vec3,
        wo: Vec3,
        g: f32,
    },
}

/// Light can leave a surface in this direction: above both of its normals, or below both where it transmits.
#[inline(always)]
fn goes(s: &Surface, wi: Vec3) -> bool {
    let (flat, shading) = (wi.dot(s.geometric), wi.dot(s.shading));
    flat > 0.0 && shading > 0.0 || flat < 0.0 && shading < 0.0 && s.lobes.transmits()
}

impl Vertex<'_> {
    /// What a direction that leaves is in; `here`: what the arriving ray was in.
    #[inline(always)]
    pub(in crate::transport) fn media(&self, here: Inside, wi: Vec3) -> Inside {
        match self {
            Self::Surface(s, beyond) if wi.dot(s.geometric) < 0.0 => *beyond,
            _ => here,
        }
    }

    /// See [`crate::bsdf::Lobes::index_ratio_squared`].
    #[inline(always)]
    pub(in crate::transport) fn index_ratio_squared(&self, wi: Vec3) -> f32 {
        match self {
            Self::Surface(s, _) => s.lobes.index_ratio_squared(s.shading, s.wo, wi),
            Self::Medium { .. } => 1.0,
        }
    }

    #[inline(always)]
    pub(in crate::transport) fn position(&self) -> Vec3 {
        match self {
            Self::Surface(s, _) => s.point.position,
            Self::Medium { position, .. } => *position,
        }
    }

    /// f cos, or the phase function, and the density of a direction.
    #[inline(always)]
    pub(in crate::transport) fn scattering(&self, wi: Vec3) -> (Vec3, f32) {
        match self {
            Self::Surface(s, _) => {
                if !goes(s, wi) {
                    return (Vec3::ZERO, 0.0);
                }
                let cos = math::abs(wi.dot(s.shading));
                (s.lobes.eval(s.shading, s.wo, wi) * cos, s.lobes.pdf_solid_angle(s.shading, s.wo, wi))
            }
            Self::Medium { wo, g, .. } => {
                let p = phase::eval(*g, *wo, wi);
                (Vec3::splat(p), p)
            }
        }
    }

    /// A direction.
    #[inline(always)]
    pub(in crate::transport) fn sample<const SHADING: bool>(
        &self,
        u: [f32; 2],
        lobe: f32,
    ) -> Option<BsdfSample> {
        match self {
            Self::Surface(s, _) => {
                let found = s.lobes.sample(s.shading, s.wo, u, lobe)?;
                // An interpolated normal can send light to the wrong side; such directions carry nothing.
                (!SHADING || goes(s, found.wi)).then_some(found)
            }
            Self::Medium { wo, g, .. } => {
                let wi = phase::sample(*g, *wo, u);
                Some(BsdfSample { wi, weight: Vec3::ONE, pdf: phase::eval(*g, *wo, wi) })
            }
        }
    }

    /// Start of a ray into a direction.
    #[inline(always)]
    pub(in crate::transport) fn leave(&self, wi: Vec3) -> Vec3 {
        match self {
            Self::Surface(s, _) => s.leave(wi),
            Self::Medium { position, .. } => *position,
        }
    }

    /// What lies between the vertex and the start of a ray from it \[m\].
    #[inline(always)]
    pub(in crate::transport) fn lead(&self, origin: Vec3, wi: Vec3) -> f32 {
        match self {
            Self::Surface(s, _) => s.lead(origin, wi),
            Self::Medium { .. } => 0.0,
        }
    }

    /// The ray to a place on a light.
    #[inline(always)]
    pub(in crate::transport) fn towards(&self, sample: &LightSample) -> Ray {
        match self {
            Self::Surface(s, _) => light::shadow_ray(sample, &s.point, s.geometric),
            Self::Medium { position, .. } => {
                let point = SurfacePoint { position: *position, extent: 0.0 };
                light::shadow_ray(sample, &point, Vec3::ZERO)
            }
        }
    }

    /// The way to a place on a light, through the media that the vertex has on that side.
    #[inline(always)]
    pub(in crate::transport) fn way(&self, sample: &LightSample, inside: Inside) -> Way {
        let ray = with_unit_direction(self.towards(sample));
        let left = if sample.distant {
            f32::INFINITY
        } else {
            math::sqrt((sample.point - self.position()).length_squared())
        };
        let lead = self.lead(ray.origin, ray.direction);
        Way { ray, lead, left, inside, crossed: 0 }
    }

    /// Light sampling can contribute.
    #[inline(always)]
    pub(in crate::transport) fn has_density(&self) -> bool {
        match self {
            Self::Surface(s, _) => s.lobes.has_density(),
            Self::Medium { .. } => true,
        }
    }
}
