//! Plastic: a diffuse body under a clear coat of a dielectric, smooth or rough.
//!
//! f = coat + T(wo) T(wi) b / pi. The coat reflects as a mirror or a rough one, by Fresnel's reflectance; T is what of a direction's light passes it, 1 - F where it is smooth.
//! b = rho / ((1 - Ri) eta^2) is the body's albedo rho with all that goes back and forth between body and coat, of which the coat reflects Ri inwards; (1 - rho Ri) instead of (1 - Ri)
//! where colours deepen by it. Reciprocal, and without loss where the coat is smooth and rho = 1: then T(w) b Int T cos / pi = T(w).
//!
//! Source: the plastics of Mitsuba 3 (W. Jakob et al. 2022), whose tables of rough coats are followed: T by what single facets refract (64 cosines there, [`TABLE`] here), Ri as the mean of
//! 2 R cos over the 64 cosines i / 63, which is about 1.5 % less than its integral.

use super::facets::Facets;
use super::lobes::BsdfSample;
use super::rough::{Rough, half_vector};
use super::{diffuse, fresnel, phong};
use crate::math::{self, INV_PI, Vec3};

/// Entries of a table of transmittances, at the cosines (i / (TABLE - 1))^2.
pub const TABLE: usize = 16;
/// Facets seen by a direction, over which transmittances are summed.
const SEEN: [u32; 2] = [48, 24];

/// The clear coat of a plastic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coat {
    /// Its index.
    pub ior: f32,
    /// Its surface; `None` is smooth.
    pub rough: Option<Rough>,
    /// Mean transmittance of diffuse light from outside.
    pub mean: f32,
    /// Transmittance of a coat of microfacets.
    pub transmittance: [f32; TABLE],
}

/// What is computed of a coat once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoatTable {
    /// Reflectance of diffuse light from within.
    pub internal: f32,
    /// Mean transmittance of diffuse light from outside.
    pub mean: f32,
    /// Transmittance from outside, see [`TABLE`].
    pub transmittance: [f32; TABLE],
}

/// Directions at mid-points in both angles of what `wo` at this cosine sees; the half with positive azimuths.
fn over_facets(cos: f32, mut value: impl FnMut(Vec3, [f32; 2]) -> f32) -> f32 {
    let wo = Vec3::new(math::sqrt_clamped((1.0 - cos) * (1.0 + cos)), 0.0, cos);
    let mut sum = math::Compensated::<f32>::new(0.0);
    let [rows, columns] = SEEN;
    for i in 0..rows {
        // u = 1 - x^2, closely where facets are steep: what these send is hidden more and more, which equal steps of u would overlook by up to 0.2 %.
        let x = (i as f32 + 0.5) / rows as f32;
        for j in 0..columns {
            let u = [(1.0 - x) * (1.0 + x), 0.5 * (j as f32 + 0.5) / columns as f32];
            sum.add(2.0 * x * value(wo, u));
        }
    }
    sum.value() / (rows * columns) as f32
}

/// Share of the light of a direction that facets reflect once.
fn reflected(facets: &Facets, cos: f32, ratio: f32) -> f32 {
    over_facets(cos, |wo, u| {
        let m = facets.sample_visible(Vec3::Z, wo, u);
        let wi = math::reflect(wo, m);
        if wi.z <= 0.0 {
            return 0.0;
        }
        fresnel::dielectric(wo.dot(m).clamp(0.0, 1.0), ratio) * facets.masking(Vec3::Z, wi)
    })
}

/// Share that they refract once.
fn refracted(facets: &Facets, cos: f32, ratio: f32) -> f32 {
    over_facets(cos, |wo, u| {
        let m = facets.sample_visible(Vec3::Z, wo, u);
        let share = 1.0 - fresnel::dielectric(wo.dot(m).clamp(0.0, 1.0), ratio);
        match fresnel::refract(m, wo, ratio) {
            Some(wi) if wi.z < 0.0 => share * facets.masking(Vec3::Z, wi),
            _ => 0.0,
        }
    })
}

/// 2 Int x(cos) cos d(cos) at mid-points.
fn mean_over_cosines(x: impl Fn(f32) -> f32) -> f32 {
    const STEPS: u32 = 8192;
    let mut sum = math::Compensated::<f32>::new(0.0);
    for i in 0..STEPS {
        let cos = (i as f32 + 0.5) / STEPS as f32;
        sum.add(x(cos) * cos);
    }
    2.0 * sum.value() / STEPS as f32
}

impl CoatTable {
    /// Of a coat of this index and surface.
    pub fn new(ior: f32, rough: Option<Rough>) -> Self {
        let Some(Rough::Facets(facets)) = rough else {
            let internal = mean_over_cosines(|cos| fresnel::dielectric(cos, 1.0 / ior));
            let mean = mean_over_cosines(|cos| 1.0 - fresnel::dielectric(cos, ior));
            return Self { internal, mean, transmittance: [0.0; TABLE] };
        };
        let mut transmittance = [0.0; TABLE];
        for (i, t) in transmittance.iter_mut().enumerate() {
            let x = i as f32 / (TABLE - 1) as f32;
            *t = refracted(&facets, (x * x).max(1e-6), ior);
        }
        let mut internal = 0.0;
        for i in 0..64 {
            let cos = (i as f32 / 63.0).max(1e-6);
            internal += reflected(&facets, cos, 1.0 / ior) * cos / 32.0;
        }
        let mean = mean_over_cosines(|cos| look_up(&transmittance, cos));
        Self { internal: internal.min(1.0), mean, transmittance }
    }

    /// Albedo of the body with what goes back and forth under the coat, over eta^2: the b above.
    pub fn body(internal: f32, ior: f32, albedo: Vec3, nonlinear: bool) -> Vec3 {
        let kept = if nonlinear { albedo * internal } else { Vec3::splat(internal) };
        let left = (Vec3::ONE - kept).max(Vec3::splat(f32::EPSILON));
        albedo / (left * (ior * ior))
    }
}

/// Cubic interpolation (Catmull and Rom) in the square root of the cosine, in \[0, 1\].
fn look_up(table: &[f32; TABLE], cos: f32) -> f32 {
    let x = math::sqrt_clamped(cos.min(1.0)) * (TABLE - 1) as f32;
    let cell = (x as usize).min(TABLE - 2);
    let f = x - cell as f32;
    let at = |i: usize| table[i.min(TABLE - 1)];
    let (b, c) = (at(cell), at(cell + 1));
    // Beyond the ends as if the curve went straight on.
    let a = if cell > 0 { at(cell - 1) } else { 2.0 * b - c };
    let d = if cell + 2 < TABLE { at(cell + 2) } else { 2.0 * c - b };
    let k1 = 0.5 * (c - a);
    let k2 = a - 2.5 * b + 2.0 * c - 0.5 * d;
    let k3 = 0.5 * (d - a) + 1.5 * (b - c);
    math::clamp(b + f * (k1 + f * (k2 + f * k3)), 0.0, 1.0)
}

impl Coat {
    /// A mirror's direction can be sampled beside the body.
    #[inline]
    pub(super) fn is_smooth(&self) -> bool {
        self.rough.is_none()
    }

    /// Share of the light of a direction that passes the coat.
    pub fn transmittance(&self, cos: f32) -> f32 {
        match self.rough {
            Some(Rough::Facets(_)) => look_up(&self.transmittance, cos.max(0.0)),
            _ => 1.0 - fresnel::dielectric(cos.clamp(0.0, 1.0), self.ior),
        }
    }

    /// Albedo of the body alone, seen through the coat in diffuse light.
    pub(super) fn diffuse_albedo(&self, body: Vec3, cos: f32) -> Vec3 {
        body * (self.transmittance(cos) * self.mean)
    }

    /// Chance of a direction from the body: its share of what is reflected.
    fn body_share(&self, body: Vec3, cos: f32) -> f32 {
        let (d, s) = (math::mean(self.diffuse_albedo(body, cos)), 1.0 - self.transmittance(cos));
        if d + s > 0.0 { d / (d + s) } else { 1.0 }
    }

    /// f \[1/sr\], and the density of [`Self::sample`] per solid angle; a mirror's direction has neither.
    pub(super) fn values(&self, body: Vec3, n: Vec3, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        let (before, after) = (wo.dot(n), wi.dot(n));
        if before <= 0.0 || after <= 0.0 {
            return (Vec3::ZERO, 0.0);
        }
        let share = self.body_share(body, before);
        let mut f = body * (self.transmittance(before) * self.transmittance(after) * INV_PI);
        let mut pdf = share * diffuse::pdf_solid_angle(n, wi);
        if let Some(rough) = &self.rough {
            let (value, density) = rough.reflect(n, wo, wi);
            let cos = wo.dot(half_vector(wo, wi)).clamp(0.0, 1.0);
            f += Vec3::splat(value * fresnel::dielectric(cos, self.ior));
            pdf += (1.0 - share) * density;
        }
        (f, pdf)
    }

    /// A direction from the body or from the coat.
    pub(super) fn sample(&self, body: Vec3, n: Vec3, wo: Vec3, u: [f32; 2], lobe: f32) -> Option<BsdfSample> {
        let cos = wo.dot(n);
        if cos <= 0.0 {
            return None;
        }
        let share = self.body_share(body, cos);
        let wi = if lobe < share {
            diffuse::sample(n, u)
        } else if let Some(rough) = &self.rough {
            rough.sample(n, wo, u)
        } else {
            let reflectance = fresnel::dielectric(cos.clamp(0.0, 1.0), self.ior);
            let weight = Vec3::splat(reflectance / (1.0 - share));
            let wi = phong::mirror_direction(n, wo);
            return (wi.dot(n) > 0.0).then_some(BsdfSample { wi, weight, pdf: 0.0 });
        };
        let (f, pdf) = self.values(body, n, wo, wi);
        (pdf > 0.0).then(|| BsdfSample { wi, weight: f * (wi.dot(n) / pdf), pdf })
    }
}
