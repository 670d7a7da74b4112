//! Where walks from lights start, and how likely.

use crate::geometry::{Intersector, Ray};
use crate::light::{self, EnvironmentMap, emit};
use crate::math::{self, PI, Vec3};
use crate::medium::Inside;
use crate::sampling::discrete;
use crate::scene::{CompiledScene, LightKind, LightRecord};
use crate::transport::volume::LightMedia;
pub(super) use crate::transport::volume::is_distant;

/// The start of a walk from a light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Start {
    pub light: u32,
    pub ray: Ray,
    /// Place on the light; of what comes from infinity, unused.
    pub position: Vec3,
    /// Unit normal there; zero for lights without size.
    pub normal: Vec3,
    /// What the walk carries: flux over the chance of the light.
    pub carried: Vec3,
    /// Density of the place, the choice of the light included: per area, or 1 for what has none; of the picture of an environment per solid angle.
    pub pdf_place: f32,
    /// Density of the direction per solid angle; of what comes from infinity, of the place in the beam per area.
    pub pdf_direction: f32,
}

/// What the lights of a scene are to walks.
#[derive(Clone, Debug)]
pub(super) struct Emitters {
    pub sphere: (Vec3, f32),
    media: LightMedia,
}

/// A ray can meet it by chance.
#[inline(always)]
pub(super) fn is_met(light: &LightRecord) -> bool {
    light.area > 0.0 || light.kind == LightKind::Environment as u32
}

/// Density of the place that emission draws on a light, the choice of the light included: per area, or its chance where it has none.
#[inline(always)]
pub(super) fn pdf_place(light: &LightRecord) -> f32 {
    if light.area > 0.0 { light.pmf / light.area } else { light.pmf }
}

/// Density per solid angle at which light sampling and emission draw a direction to the picture of the environment, the choice of the light included.
#[inline(always)]
pub(super) fn pdf_picture(map: &EnvironmentMap, wi: Vec3) -> f32 {
    map.pdf_solid_angle(wi) * map.light_pmf
}

/// By how much light sampling at a point is likelier to draw a place on a light than emission is: 1 but for spheres, of which it draws what is seen.
/// `pdf`: density of the direction there per solid angle, `facing`: cosine at the light over the squared distance.
#[inline(always)]
pub(super) fn preference(light: &LightRecord, pdf: f32, facing: f32) -> f32 {
    if light.kind == LightKind::Sphere as u32 { pdf * facing / pdf_place(light) } else { 1.0 }
}

/// The same for a place on the light seen from `p`.
#[inline]
pub(super) fn preference_at(light: &LightRecord, p: Vec3, place: Vec3) -> f32 {
    if light.kind != LightKind::Sphere as u32 {
        return 1.0;
    }
    let to = place - p;
    let d2 = to.length_squared();
    let wi = math::normalize_or(to, Vec3::ZERO);
    let normal = math::normalize_or(place - Vec3::from_array(light.point), Vec3::ZERO);
    let pdf = light::pdf_solid_angle(light, p, wi, math::sqrt(d2), normal);
    preference(light, pdf, math::abs(wi.dot(normal)) / d2)
}

impl Emitters {
    /// Of a scene; `outside`: the media around it.
    pub(super) fn new<I: Intersector + ?Sized>(
        scene: &CompiledScene,
        intersector: &I,
        outside: Inside,
    ) -> Self {
        Self { sphere: scene.bounding_sphere(), media: LightMedia::new(scene, intersector, outside) }
    }

    /// A start, from a full random number that chooses the light and four in [0, 1). `None` where nothing is sent.
    #[inline(always)]
    pub(super) fn start(&self, scene: &CompiledScene, pick: u32, u: [f32; 4]) -> Option<Start> {
        let index = pick_light(scene, pick)?;
        let light = &scene.lights[index];
        let (emission, _) = emit::emit_entry(scene, index, self.sphere, u);
        let direction = emission.ray.direction;
        let at = Vec3::from_array(light.point);
        let (position, normal) = if light.kind == LightKind::Sphere as u32 {
            let out = math::normalize_or(emission.ray.origin - at, Vec3::ZERO);
            (at + out * light.params[0], out)
        } else if light.area > 0.0 {
            // The ray starts beside the surface along its normal.
            let normal = Vec3::from_array(light.normal);
            (emission.ray.origin - normal * (emission.ray.origin - at).dot(normal), normal)
        } else {
            (at, Vec3::ZERO)
        };
        let (_, radius) = self.sphere;
        let pdf_direction = if is_distant(light) {
            1.0 / (PI * radius * radius)
        } else {
            emit::pdf_direction(light, direction, normal)
        };
        let carried = emission.flux / light.pmf;
        (carried != Vec3::ZERO && carried.is_finite() && pdf_direction > 0.0).then_some(Start {
            light: index as u32,
            ray: emission.ray,
            position,
            normal,
            carried,
            pdf_place: match &scene.environment_map {
                Some(map) if light.kind == LightKind::Environment as u32 => pdf_picture(map, -direction),
                _ => pdf_place(light),
            },
            pdf_direction,
        })
    }

    /// The media in which a start lies.
    pub(super) fn media<I: Intersector + ?Sized>(
        &self,
        scene: &CompiledScene,
        intersector: &I,
        start: &Start,
    ) -> Inside {
        self.media.of(scene, intersector, start.light as usize, start.ray.origin)
    }

    /// What is sent from a light to a vertex that it lights: the density per solid angle, or per area of a beam, by which emission draws it. `wi`: unit direction to the light.
    #[inline(always)]
    pub(super) fn pdf_towards(&self, light: &LightRecord, wi: Vec3, normal: Vec3) -> f32 {
        if is_distant(light) {
            return 1.0 / (PI * self.sphere.1 * self.sphere.1);
        }
        emit::pdf_direction(light, -wi, normal)
    }
}

/// Number of a light that is picked as light sampling picks it.
#[inline(always)]
pub(super) fn pick_light(scene: &CompiledScene, pick: u32) -> Option<usize> {
    let index = if scene.lights.len() == 1 {
        0
    } else {
        discrete::pick_in(&scene.light_cumulative, pick).index as usize
    };
    (index < scene.lights.len()).then_some(index)
}

/// A light, and a place on it seen from `p`.
#[inline(always)]
pub(super) fn sample(
    scene: &CompiledScene,
    p: Vec3,
    pick: u32,
    words: [u32; 2],
) -> Option<(u32, light::LightSample)> {
    let index = pick_light(scene, pick)?;
    Some((index as u32, light::sample_light(scene, &scene.lights[index], p, words)?))
}
