//! Which sides of surfaces light can get to at all.
//!
//! Solids have insides, and as patches these would be half of all numbers for nothing. Diffuse walks from where light and eyes are mark what they
//! meet. Walks from infinity are few, and miss what is small in a large scene: where light comes from there, what they have not met is asked whether it sees
//! the sky ([`look`]). What lies among what is met counts too if it sees more of that than of anything else; the rest is asked for no further.

use super::rays::side_of;
use crate::bsdf::diffuse;
use crate::geometry::{Intersector, Ray, SurfacePoint, hit_point_with, offset_origin};
use crate::illumination::{ElementPlace, Elements};
use crate::light::emit;
use crate::math::{self, Vec3};
use crate::sampling::numbers::Numbers;
use crate::scene::{CompiledScene, NO_INDEX};
use crate::transport::surface_at;

/// Most hits of a walk.
pub const HITS: u32 = 24;
const START_GROUP: u32 = 0;
const PICK_GROUP: u32 = 1;
const WALK_GROUP: u32 = 2;
/// Rays of an element that looks around itself.
const LOOKS: u32 = 16;

/// Where walks begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum From {
    /// Lights and the camera, each alike.
    Inside,
    /// All around the scene.
    Infinity,
}

/// Walks to be taken, the first ones of a sequence of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Walks {
    /// Where they begin.
    pub from: From,
    /// Seed and replicate of their numbers ([`Numbers::sobol`]).
    pub numbers: (u64, u32),
    /// How many.
    pub count: u32,
}

/// Lights, and the camera if there is one: where walks from inside begin.
pub fn begins(scene: &CompiledScene) -> u32 {
    scene.lights.len() as u32 + u32::from(scene.camera.is_some())
}

/// Whether a scene has something to begin walks at, infinity aside.
pub fn has_inside(scene: &CompiledScene) -> bool {
    begins(scene) > 0
}

/// Whether light comes from infinity.
pub fn has_infinity(scene: &CompiledScene) -> bool {
    scene.needs.environment
        || scene.lights.iter().any(|l| l.kind == crate::scene::LightKind::Directional as u32)
}

fn start(scene: &CompiledScene, from: From, numbers: &Numbers) -> Option<Ray> {
    let sphere = scene.bounding_sphere();
    let u = numbers.group4(START_GROUP);
    if from == From::Infinity {
        return Some(emit::emit_environment(Vec3::ONE, sphere, u).ray);
    }
    let [pick, ..] = numbers.bits4(PICK_GROUP);
    let pick = ((u64::from(pick) * u64::from(begins(scene))) >> 32) as usize;
    match (scene.lights.get(pick), &scene.camera) {
        (Some(light), _) => Some(emit::emit(light, sphere, u).ray),
        (None, Some(camera)) => {
            let [x, y] = [u[0] * camera.width as f32, u[1] * camera.height as f32].map(|x| x as u32);
            Some(camera.sample_ray(x, y, [u[2], u[3]], [0.5, 0.5]))
        }
        (None, None) => None,
    }
}

/// Kind of an element for its patch: what emits is apart from what does not, and what lies right before another surface (nearer than `near` along its normal), as the wall behind a
/// picture does, from what can be seen. In one patch each would send the other's light.
#[inline(always)]
pub fn kind<I: Intersector + ?Sized>(
    scene: &CompiledScene,
    intersector: &I,
    elements: &Elements,
    (element, primitive, place): (u32, u32, &ElementPlace),
    near: f32,
) -> u8 {
    let Some(record) = scene.surfaces.get(primitive as usize) else { return 0 };
    let light =
        if elements.is_back(element) || record.light == NO_INDEX { 0 } else { 1 + (record.light % 7) as u8 };
    let point =
        SurfacePoint { position: place.position, extent: 2.0 * math::sqrt(elements.area(element as usize)) };
    let origin = offset_origin(&point, place.normal, place.normal);
    let covered = intersector.occluded(&Ray { origin, direction: place.normal, t_max: near });
    light << 1 | u8::from(covered)
}

/// One walk: `mark` gets each element side that it meets. True where it leaves the scene.
#[inline(always)]
pub fn walk<I: Intersector + ?Sized>(
    scene: &CompiledScene,
    intersector: &I,
    elements: &Elements,
    from: From,
    numbers: &Numbers,
    mut mark: impl FnMut(u32),
) -> bool {
    let Some(mut ray) = start(scene, from, numbers) else { return false };
    for hits in 0..HITS {
        let Some(hit) = intersector.closest_hit(&ray) else { return true };
        let Some(element) = side_of(scene, elements, &ray, &hit) else { return false };
        mark(element);
        let Some(surface) = surface_at::<false, false, false>(scene, &ray, &hit) else { return false };
        let [u, v, ..] = numbers.group4(WALK_GROUP + hits);
        let direction = diffuse::sample(surface.geometric, [u, v]);
        let origin = offset_origin(&surface.point, surface.geometric, direction);
        ray = Ray { origin, direction, t_max: f32::INFINITY };
    }
    false
}

/// What rays from an element side of a triangle meet: how many a side that `met` knows, how many another side, how many nothing.
///
/// To ask whether any meets a known side would not do for an element that walks have missed: an element of a floor that lies partly under a box is known, and seen by all of the box's inside.
#[inline(always)]
pub fn look<I: Intersector + ?Sized>(
    scene: &CompiledScene,
    intersector: &I,
    elements: &Elements,
    (element, triangle): (u32, u32),
    numbers: &Numbers,
    met: impl Fn(u32) -> bool,
) -> [u32; 3] {
    let (Some(vertices), Some(record)) =
        (scene.primitives().vertices(triangle), scene.surfaces.get(triangle as usize))
    else {
        return [0; 3];
    };
    let front = Vec3::from_array(record.normal);
    let normal = if elements.is_back(element) { -front } else { front };
    let mut counts = [0; 3];
    for k in 0..LOOKS {
        let [a, b, u, v] = numbers.group4(k);
        let [b1, b2] = elements.bary_on(triangle, element, [a, b]);
        let direction = diffuse::sample(normal, [u, v]);
        let origin = offset_origin(&hit_point_with(vertices, b1, b2, record.sliver), normal, direction);
        let ray = Ray { origin, direction, t_max: f32::INFINITY };
        let what = match intersector.closest_hit(&ray) {
            None => 2,
            Some(hit) => usize::from(!side_of(scene, elements, &ray, &hit).is_some_and(&met)),
        };
        counts[what] += 1;
    }
    counts
}
