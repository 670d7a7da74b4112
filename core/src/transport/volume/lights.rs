//! Which media lights send into, and what comes straight from them to a place.

use super::CROSSINGS_MAX;
use super::boundaries::{Here, inside_at};
use super::way::{Followed, Way, lead};
use super::with_unit_direction;
use crate::geometry::{Aabb, BoxTree, Intersector, Ray};
use crate::light::emit;
use crate::math::{self, Vec3};
use crate::medium::Inside;
use crate::scene::{CompiledScene, LightKind, LightRecord, NO_INDEX, material_flags};
use crate::transport::surface_at;
use alloc::vec::Vec;

/// At infinity.
#[inline(always)]
pub(in crate::transport) fn is_distant(light: &LightRecord) -> bool {
    light.kind == LightKind::Directional as u32 || light.kind == LightKind::Environment as u32
}

/// The media that the lights of a scene send into.
#[derive(Clone, Debug, Default)]
pub struct LightMedia {
    /// Of each light, where that is the same all over it; empty for scenes without media.
    inside: Vec<Option<Inside>>,
    outside: Inside,
}

/// What comes straight from a light to a place.
#[derive(Clone, Copy, Debug)]
pub struct Straight {
    /// What is left of it per channel: media, panes and films on the way, and 0 where it is hidden.
    pub left: Vec3,
    /// The chance that a walk which draws its flights and what panes do would have come through: the product of the means over the channels.
    pub chance: f32,
    /// The media in which it arrives.
    pub inside: Inside,
}

impl LightMedia {
    /// Of a scene; `outside`: the media around it.
    pub fn new<I: Intersector + ?Sized>(scene: &CompiledScene, intersector: &I, outside: Inside) -> Self {
        let mut out = Self { inside: Vec::new(), outside };
        if !scene.needs.media {
            return out;
        }
        let sphere = scene.bounding_sphere();
        let primitives = scene.primitives();
        let holds = |id: &u32| scene.surfaces[*id as usize].media != 0;
        let boundaries =
            BoxTree::new((0..primitives.count() as u32).filter(holds).map(|id| (primitives.bounds(id), id)));
        for light in &scene.lights {
            let start = emit::emit(light, sphere, [0.37, 0.41, 0.5, 0.25]).ray.origin;
            let bounds = if light.primitive == NO_INDEX {
                Aabb { lo: start, hi: start }
            } else {
                let pair = light.kind == LightKind::Parallelogram as u32;
                let first = primitives.bounds(light.primitive);
                if pair { first.union(primitives.bounds(light.primitive + 1)) } else { first }
            };
            let same = light.area <= 0.0 || !boundaries.touches(&bounds);
            let inside =
                if is_distant(light) { outside } else { inside_at(scene, intersector, outside, start) };
            out.inside.push(same.then_some(inside));
        }
        out
    }

    /// The media that a light sends into, wherever on it; `None` where that has to be found out for each place. Without media it is what lies around the scene.
    pub fn all_over(&self, light: usize) -> Option<Inside> {
        self.inside.get(light).copied().unwrap_or(Some(self.outside))
    }

    /// What lies around the scene.
    pub fn outside(&self) -> Inside {
        self.outside
    }

    /// The media in which a photon of entry `index` of what emits starts at `origin`.
    pub fn of<I: Intersector + ?Sized>(
        &self,
        scene: &CompiledScene,
        intersector: &I,
        index: usize,
        origin: Vec3,
    ) -> Inside {
        match self.inside.get(index) {
            Some(Some(inside)) => *inside,
            None if emit::glow(scene, index).is_none() => self.outside,
            _ => inside_at(scene, intersector, self.outside, origin),
        }
    }

    /// What comes from light `index`, one without size, along the ray that leads from a place on a surface with this unit normal to it; and the rays that it took to find out.
    pub fn straight<I: Intersector + ?Sized>(
        &self,
        scene: &CompiledScene,
        intersector: &I,
        index: usize,
        ray: &Ray,
        (position, normal): (Vec3, Vec3),
    ) -> (Straight, u64) {
        let ray = with_unit_direction(*ray);
        let at_light = self.of(scene, intersector, index, ray.origin);
        let (inside, mut rays) = media_back(scene, intersector, &ray, at_light);
        let mut out = Straight { left: Vec3::ZERO, chance: 0.0, inside: Inside::NOTHING };
        let Some(inside) = inside else {
            out.inside = inside_at(scene, intersector, self.outside, ray.origin);
            return (out, rays);
        };
        out.inside = inside;
        let before = lead((position, normal), ray.origin, ray.direction);
        let left = if ray.t_max < f32::MAX { before + ray.t_max } else { f32::INFINITY };
        let mut way = Way { ray, lead: before, left, inside, crossed: 0 };
        let (mut through, mut chance) = (Vec3::ONE, 1.0);
        // One ray has found nothing on the way: it need not be asked again.
        let mut free = rays == 1;
        loop {
            let hit = if free { None } else { intersector.closest_hit(&way.ray) };
            rays += u64::from(!free);
            free = false;
            let followed = way.follow::<true, true, true>(scene, hit, |t, c| {
                through *= t;
                chance *= c;
            });
            match followed {
                Followed::Part if through != Vec3::ZERO => {}
                Followed::Whole => {
                    (out.left, out.chance) = (through, chance);
                    return (out, rays);
                }
                _ => return (out, rays),
            }
        }
    }
}

/// The media in which a ray to a light starts, from those at the light; `None` where something is in the way. And the rays that it took.
fn media_back<I: Intersector + ?Sized>(
    scene: &CompiledScene,
    intersector: &I,
    ray: &Ray,
    at_light: Inside,
) -> (Option<Inside>, u64) {
    let (mut ray, mut rays, mut crossed) = (*ray, 0, Vec::new());
    loop {
        rays += 1;
        let Some(hit) = intersector.closest_hit(&ray) else { break };
        let here = Here::new(scene, &ray, hit, true);
        let passes = scene.material_of(here.met.primitive).flags & material_flags::PASSES != 0;
        if !passes || rays > u64::from(CROSSINGS_MAX) {
            return (None, rays);
        }
        let Some(surface) = surface_at::<false, false, false>(scene, &ray, &here.met) else {
            return (None, rays);
        };
        crossed.extend_from_slice(here.crossed());
        let origin = surface.leave(ray.direction);
        if ray.t_max < f32::MAX {
            ray.t_max = math::max(ray.t_max - (origin - ray.origin).dot(ray.direction), 0.0);
        }
        ray.origin = origin;
    }
    let inside = crossed.iter().rev().fold(at_light, |inside, c| inside.across(c.media, !c.from_front));
    (Some(inside), rays)
}
