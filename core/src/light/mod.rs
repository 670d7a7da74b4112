//! Lights as seen from a point: choose one, choose a place on it, and say with which density.
//!
//! A sample carries the radiance that would arrive \[W m^-2 sr^-1\] already divided by its density per solid angle at
//! the receiving point, so that the estimate of reflected radiance is `contribution * f * cos`. For lights without
//! size the radiance is a delta function and the quotient is intensity / distance^2 or the irradiance. All surface
//! lights emit from their front only.

pub mod emit;
mod environment;

pub use environment::{EnvironmentMap, EnvironmentSample};

use crate::geometry::{Ray, SurfacePoint, offset_origin, segment};
use crate::math::{self, TAU, Vec3};
use crate::sampling::{discrete, warp};
use crate::scene::{CompiledScene, LightKind, LightRecord};
use crate::transport::mis;

/// A place on a light, seen from a receiving point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSample {
    /// Unit direction towards the light.
    pub wi: Vec3,
    /// Radiance / pdf per channel, the choice of the light included.
    pub contribution: Vec3,
    /// Density per solid angle, the choice of the light included; 0 marks a light without size.
    pub pdf: f32,
    /// The place on the light \[m\]; for a directional light, unused.
    pub point: Vec3,
    /// Unit normal of the light there; zero for lights without size.
    pub normal: Vec3,
    /// Extent of the surface about `point`, for the offset of the ray's end \[m\].
    pub extent: f32,
    /// The light is at infinity.
    pub distant: bool,
}

/// Picks a light of a scene and a place on it, by three full 32-bit random numbers: the light, the place.
/// `None` where the chosen light sends nothing to `p`.
#[inline(always)]
pub fn sample_lights(scene: &CompiledScene, p: Vec3, [pick, u, v]: [u32; 3]) -> Option<LightSample> {
    let lights = &scene.lights;
    let index =
        if lights.len() == 1 { 0 } else { discrete::pick_in(&scene.light_cumulative, pick).index as usize };
    sample_light(scene, lights.get(index)?, p, [u, v])
}

/// A place on one light of a scene as seen from `p`, by two full 32-bit random numbers; the density includes the light's pick probability. As [`sample`], and pictures of environments too.
#[inline(always)]
pub fn sample_light(
    scene: &CompiledScene,
    light: &LightRecord,
    p: Vec3,
    words: [u32; 2],
) -> Option<LightSample> {
    if light.kind == LightKind::Environment as u32 {
        return sample_environment(scene, light, p, words);
    }
    sample(light, p, words.map(math::u32_to_unit))
}

#[inline(never)]
fn sample_environment(
    scene: &CompiledScene,
    light: &LightRecord,
    p: Vec3,
    words: [u32; 2],
) -> Option<LightSample> {
    let s = scene.environment_map.as_ref()?.sample(words);
    let pdf = s.pdf * light.pmf;
    let contribution = s.radiance / pdf;
    (pdf > 0.0 && pdf <= f32::MAX && contribution.is_finite()).then_some(LightSample {
        wi: s.wi,
        contribution,
        pdf,
        point: p,
        normal: Vec3::ZERO,
        extent: 0.0,
        distant: true,
    })
}

/// Radiance \[W m^-2 sr^-1\] that arrives along a ray that leaves the scene in a unit direction, drawn with density `pdf` per solid angle (0: nothing competed with it): the
/// constant environment, and the picture by its weight against light sampling. `share`: what the density of light sampling is multiplied by.
#[inline(always)]
pub fn escaped(scene: &CompiledScene, direction: Vec3, pdf: f32, share: f32) -> Vec3 {
    let uniform = Vec3::from_array(scene.environment);
    match &scene.environment_map {
        None => uniform,
        Some(map) => uniform + pictured(map, direction, pdf, share),
    }
}

#[inline(never)]
fn pictured(map: &EnvironmentMap, direction: Vec3, pdf: f32, share: f32) -> Vec3 {
    let (radiance, other) = map.meet(direction);
    if pdf > 0.0 { radiance * mis::power_heuristic(pdf, other * map.light_pmf * share) } else { radiance }
}

/// Smoothstep of source C's spot between the cosines of its cone and of its falloff.
#[inline]
fn spot_falloff(cos: f32, params: [f32; 2]) -> f32 {
    let [cone, full] = params;
    if cos >= full {
        return 1.0;
    }
    if cos <= cone {
        return 0.0;
    }
    let x = (cos - cone) / (full - cone);
    x * x * (3.0 - 2.0 * x)
}

/// A place on one light as seen from `p`; the density includes the light's pick probability.
#[inline(always)]
pub fn sample(light: &LightRecord, p: Vec3, u: [f32; 2]) -> Option<LightSample> {
    let radiance = Vec3::from_array(light.radiance);
    let at = Vec3::from_array(light.point);
    let (e1, e2) = (Vec3::from_array(light.edge1), Vec3::from_array(light.edge2));
    let normal = Vec3::from_array(light.normal);
    if light.kind == LightKind::Parallelogram as u32 {
        let point = at + e1 * u[0] + e2 * u[1];
        return surface_sample(light, p, point, normal);
    }
    if light.kind == LightKind::Triangle as u32 {
        let [_, b1, b2] = warp::sample_triangle(u);
        return surface_sample(light, p, at + e1 * b1 + e2 * b2, normal);
    }
    if light.kind == LightKind::Sphere as u32 {
        return sample_sphere_light(light, p, u);
    }
    if light.kind == LightKind::Disk as u32 {
        let [dx, dy] = warp::sample_disk(u);
        let (t, b) = math::orthonormal_basis(normal);
        let point = at + (t * dx + b * dy) * light.params[0];
        return surface_sample(light, p, point, normal);
    }
    if light.kind == LightKind::Directional as u32 {
        return Some(LightSample {
            wi: -normal,
            contribution: radiance * (1.0 / light.pmf),
            pdf: 0.0,
            point: p,
            normal: Vec3::ZERO,
            extent: 0.0,
            distant: true,
        });
    }
    if light.kind == LightKind::Environment as u32 {
        // Its picture is the scene's: see `sample_light`.
        return None;
    }
    // Point and spot.
    let to = at - p;
    let d2 = to.dot(to);
    if !(f32::MIN_POSITIVE..=f32::MAX).contains(&d2) {
        return None;
    }
    let wi = to / math::sqrt(d2);
    let falloff =
        if light.kind == LightKind::Spot as u32 { spot_falloff(-wi.dot(e1), light.params) } else { 1.0 };
    let contribution = radiance * (falloff / (d2 * light.pmf));
    (falloff > 0.0 && contribution.is_finite()).then_some(LightSample {
        wi,
        contribution,
        pdf: 0.0,
        point: at,
        normal: Vec3::ZERO,
        extent: 0.0,
        distant: false,
    })
}

/// A uniformly chosen place on a flat light, as a sample per solid angle.
#[inline(always)]
fn surface_sample(light: &LightRecord, p: Vec3, point: Vec3, normal: Vec3) -> Option<LightSample> {
    let to = point - p;
    let d2 = to.dot(to);
    if !(f32::MIN_POSITIVE..=f32::MAX).contains(&d2) {
        return None;
    }
    let wi = to / math::sqrt(d2);
    let cos = -wi.dot(normal);
    if cos <= 0.0 {
        return None;
    }
    let pdf = light.pmf * d2 / (light.area * cos);
    let contribution = Vec3::from_array(light.radiance) * (light.area * cos / (d2 * light.pmf));
    (pdf > 0.0 && pdf <= f32::MAX && contribution.is_finite()).then_some(LightSample {
        wi,
        contribution,
        pdf,
        point,
        normal,
        extent: extent(light),
        distant: false,
    })
}

/// Largest distance between two points of a surface light, within a factor of two \[m\].
#[inline(always)]
fn extent(light: &LightRecord) -> f32 {
    if light.kind == LightKind::Sphere as u32 || light.kind == LightKind::Disk as u32 {
        return light.params[0];
    }
    let longest = |e: [f32; 3]| e[0].abs().max(e[1].abs()).max(e[2].abs());
    longest(light.edge1).max(longest(light.edge2))
}

/// 1 - cos of the half-angle under which a sphere of radius r is seen from distance sqrt(d2) > r, without
/// cancellation for small angles: sin^2 / (1 + cos).
#[inline]
fn cone_of_sphere(r: f32, d2: f32) -> f32 {
    warp::one_minus_cos_of_sin_squared((r * r / d2).min(1.0))
}

/// Density per solid angle of directions uniform in a cone.
#[inline]
fn cone_density(one_minus_cos_max: f32) -> f32 {
    1.0 / (TAU * one_minus_cos_max)
}

/// A direction uniform in the cone under which a sphere is seen (Shirley, Wang and Zimmerman 1996).
#[inline]
fn sample_sphere_light(light: &LightRecord, p: Vec3, u: [f32; 2]) -> Option<LightSample> {
    let center = Vec3::from_array(light.point);
    let r = light.params[0];
    let to = center - p;
    let d2 = to.dot(to);
    // Within the sphere its front cannot be seen.
    if !(d2 > r * r && d2 <= f32::MAX) {
        return None;
    }
    let one_minus_cos_max = cone_of_sphere(r, d2);
    let local = warp::sample_cone(u, one_minus_cos_max);
    let axis = to / math::sqrt(d2);
    let (t, b) = math::orthonormal_basis(axis);
    let wi = t * local.x + b * local.y + axis * local.z;
    // The near intersection, from the half chord about the foot of the centre on the ray.
    let foot = to.dot(wi);
    let off = to - wi * foot;
    let half = math::sqrt((r * r - off.dot(off)).max(0.0));
    let point = p + wi * (foot - half).max(0.0);
    let normal = math::normalize_or(point - center, Vec3::ZERO);
    let pdf = light.pmf * cone_density(one_minus_cos_max);
    (pdf > 0.0 && pdf <= f32::MAX).then_some(LightSample {
        wi,
        contribution: Vec3::from_array(light.radiance) * (1.0 / pdf),
        pdf,
        point,
        normal,
        extent: r,
        distant: false,
    })
}

/// Density per solid angle at `p` with which [`sample_lights`] draws the direction `wi` (unit) that meets a surface
/// light at distance `distance` where its unit normal is `normal`; 0 from behind.
#[inline(always)]
pub fn pdf_solid_angle(light: &LightRecord, p: Vec3, wi: Vec3, distance: f32, normal: Vec3) -> f32 {
    if light.kind == LightKind::Sphere as u32 {
        let to = Vec3::from_array(light.point) - p;
        let (r, d2) = (light.params[0], to.dot(to));
        return if d2 > r * r { light.pmf * cone_density(cone_of_sphere(r, d2)) } else { 0.0 };
    }
    let cos = -wi.dot(normal);
    if cos > 0.0 && light.area > 0.0 {
        (light.pmf * distance * distance / (light.area * cos)).min(f32::MAX)
    } else {
        0.0
    }
}

/// The shadow ray of a sample, from a surface point with its unit normal `ng` on the receiving side. Both ends are
/// offset, so that neither the surface left nor the light itself is in the way.
#[inline(always)]
pub fn shadow_ray(sample: &LightSample, from: &SurfacePoint, ng: Vec3) -> Ray {
    if sample.distant {
        return Ray { origin: offset_origin(from, ng, sample.wi), direction: sample.wi, t_max: f32::MAX };
    }
    // The rounding of the ray test scales with the length of the segment as well.
    let distance = (sample.point - from.position).length();
    let origin = offset_origin(&from.within(distance), ng, sample.wi);
    let end = if sample.normal == Vec3::ZERO {
        sample.point
    } else {
        let p = SurfacePoint { position: sample.point, extent: sample.extent }.within(distance);
        offset_origin(&p, sample.normal, -sample.wi)
    };
    segment(origin, end)
}
