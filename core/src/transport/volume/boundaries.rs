//! What lies where a boundary is crossed, and in what a point lies.

use super::CROSSINGS_MAX;
use crate::geometry::{Hit, Intersector, Ray, SurfacePoint, offset_origin};
use crate::math::{self, Vec3};
use crate::medium::Inside;
use crate::scene::{CompiledScene, material_flags};
use crate::transport::paths::ProbeStart;
use crate::transport::{resolve_probe, surface_at};
use alloc::vec::Vec;

/// Most surfaces that are told apart where they lie upon each other.
const TOGETHER_MAX: usize = 8;

/// A boundary that a ray crosses.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossed {
    primitive: u32,
    pub(super) media: u32,
    pub(super) from_front: bool,
}

/// All that a ray meets within the step that it takes off a surface.
pub(super) struct Here {
    /// A surface before a film, a film before a boundary.
    pub(super) met: Hit,
    crossed: [Crossed; TOGETHER_MAX],
    count: usize,
}

impl Here {
    /// At a hit; what lies with it is looked for where `together`.
    pub(super) fn new(scene: &CompiledScene, ray: &Ray, hit: Hit, together: bool) -> Self {
        let crossed = |hit: &Hit| {
            let surface = surface_at::<false, false, false>(scene, ray, hit)?;
            let media = scene.surfaces.get(hit.primitive as usize).map_or(0, |s| s.media);
            Some((surface, Crossed { primitive: hit.primitive, media, from_front: surface.from_front }))
        };
        let nothing = Crossed { primitive: hit.primitive, media: 0, from_front: true };
        let mut here = Self { met: hit, crossed: [nothing; TOGETHER_MAX], count: 0 };
        let Some((surface, first)) = crossed(&hit) else { return here };
        (here.crossed[0], here.count) = (first, 1);
        if !together || scene.crossings.is_empty() {
            return here;
        }
        // Surfaces before films, films before boundaries.
        let rank = |primitive: u32| match scene.material_of(primitive).flags {
            f if f & material_flags::NULL != 0 => 0,
            f if f & material_flags::THIN != 0 => 1,
            _ => 2,
        };
        let (near, far) = (surface.leave(-ray.direction), surface.leave(ray.direction));
        let gap = Ray { origin: near, direction: far - near, t_max: 1.0 };
        scene.crossings.all_hits(&scene.primitives(), &gap, |other| {
            let other = Hit { t: hit.t, ..other };
            if other.primitive == hit.primitive || here.count >= TOGETHER_MAX {
                return;
            }
            if rank(other.primitive) > rank(here.met.primitive) {
                here.met = other;
            }
            let Some((_, new)) = crossed(&other) else { return };
            // Neighbours at an edge of one boundary are one crossing.
            let same = |c: &Crossed| {
                c.from_front == new.from_front
                    && c.media == new.media
                    && share_a_corner(scene, c.primitive, new.primitive)
            };
            if !here.crossed().iter().any(same) {
                here.crossed[here.count] = new;
                here.count += 1;
            }
        });
        here
    }

    pub(super) fn crossed(&self) -> &[Crossed] {
        &self.crossed[..self.count]
    }
}

/// Triangles that have a corner in common.
fn share_a_corner(scene: &CompiledScene, a: u32, b: u32) -> bool {
    let primitives = scene.primitives();
    match (primitives.vertices(a), primitives.vertices(b)) {
        (Some(a), Some(b)) => a.iter().any(|p| b.contains(p)),
        _ => false,
    }
}

/// What a straight way goes through at a hit, and the media beyond it.
///
/// A ray leaves a surface from a place a little beyond it, and would miss what lies just there: the face of the next volume, or a wall that volume fills a room up to. So all that lies within that
/// step counts: media of all boundaries are crossed, and a surface among them is what is met.
#[inline(always)]
pub(in crate::transport) fn resolve(
    scene: &CompiledScene,
    ray: &Ray,
    hit: Hit,
    inside: Inside,
) -> (Hit, Inside) {
    let media = scene.surfaces.get(hit.primitive as usize).map_or(0, |s| s.media);
    let passes = scene.material_of(hit.primitive).flags & material_flags::PASSES != 0;
    if media == 0 && !passes {
        return (hit, inside);
    }
    resolve_boundary(scene, ray, hit, inside, passes)
}

fn resolve_boundary(
    scene: &CompiledScene,
    ray: &Ray,
    hit: Hit,
    inside: Inside,
    passes: bool,
) -> (Hit, Inside) {
    let here = Here::new(scene, ray, hit, passes);
    (here.met, here.crossed().iter().fold(inside, |inside, c| inside.across(c.media, c.from_front)))
}

/// What is around a scene, and what its camera stands in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Surroundings {
    /// What lies beyond all boundaries: the medium that the camera is said to stand in, where no boundary holds it.
    pub outside: Inside,
    /// What the camera stands in.
    pub camera: Inside,
}

impl Surroundings {
    /// Of a scene.
    pub fn of<I: Intersector + ?Sized>(scene: &CompiledScene, intersector: &I) -> Self {
        let Some(camera) = scene.camera.as_ref().filter(|_| scene.needs.volume()) else {
            return Self::default();
        };
        let found = inside_at(scene, intersector, Inside::NOTHING, Vec3::from_array(camera.position));
        let said = Inside::of(scene.camera_medium);
        if said.is_nothing() {
            return Self { outside: Inside::NOTHING, camera: found };
        }
        if found.is_nothing() {
            return Self { outside: said, camera: said };
        }
        let agree = found.current(scene) == said.current(scene);
        Self { outside: Inside::NOTHING, camera: if agree { found } else { said } }
    }
}

/// Starts of the paths of probes, each on its surface.
pub fn probe_starts<I: Intersector + ?Sized>(
    scene: &CompiledScene,
    intersector: &I,
    outside: Inside,
    probes: &[(Vec3, Vec3)],
) -> Vec<ProbeStart> {
    let start = |(position, normal): &(Vec3, Vec3)| {
        let point = resolve_probe(scene, intersector, *position, *normal);
        let inside = inside_of_probe(scene, intersector, outside, (&point, *normal));
        ProbeStart { point, normal: *normal, inside }
    };
    probes.iter().map(start).collect()
}

/// The media in front of a probe.
pub fn inside_of_probe<I: Intersector + ?Sized>(
    scene: &CompiledScene,
    intersector: &I,
    outside: Inside,
    (point, normal): (&SurfacePoint, Vec3),
) -> Inside {
    if !scene.needs.volume() {
        return Inside::NOTHING;
    }
    inside_at(scene, intersector, outside, offset_origin(point, normal, normal))
}

/// The media that a point lies in, found by the boundaries on a way out of the scene: what surfaces say of their sides, and what is outside.
pub fn inside_at<I: Intersector + ?Sized>(
    scene: &CompiledScene,
    intersector: &I,
    outside: Inside,
    point: Vec3,
) -> Inside {
    // A direction that scenes do not have: along no axis and no diagonal.
    let direction = math::normalize_or(Vec3::new(0.352_71, 0.803_11, -0.480_17), Vec3::Y);
    let mut ray = Ray { origin: point, direction, t_max: f32::MAX };
    let mut crossed: Vec<Crossed> = Vec::new();
    for _ in 0..CROSSINGS_MAX {
        let Some(hit) = intersector.closest_hit(&ray) else { break };
        let Some(surface) = surface_at::<false, false, false>(scene, &ray, &hit) else { break };
        let here = Here::new(scene, &ray, hit, true);
        crossed.extend_from_slice(here.crossed());
        ray.origin = surface.leave(direction);
    }
    crossed.iter().rev().fold(outside, |inside, c| inside.across(c.media, !c.from_front))
}
