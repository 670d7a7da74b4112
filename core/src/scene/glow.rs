//! Where media that emit light lie, for photons that start in them.

use super::compiled::CompiledScene;
use crate::geometry::Aabb;
use alloc::vec::Vec;

/// A medium that emits, and a box around all that is filled with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glow {
    /// Number of the medium, counted from 1.
    pub medium: u16,
    /// The bounds of its boundaries.
    pub bounds: Aabb,
}

/// All of a scene, in the order of its media.
pub(super) fn glows(scene: &CompiledScene) -> Vec<Glow> {
    let primitives = scene.primitives();
    let mut out = Vec::new();
    for (number, medium) in (1_u16..).zip(&scene.media) {
        if medium.emission == [0.0; 3] {
            continue;
        }
        let holds = |media: u32| media as u16 == number || (media >> 16) as u16 == number;
        let bounds = (0_u32..)
            .zip(&scene.surfaces)
            .filter(|(_, s)| holds(s.media))
            .fold(Aabb::EMPTY, |bounds, (id, _)| bounds.union(primitives.bounds(id)));
        if bounds.lo.cmple(bounds.hi).all() {
            out.push(Glow { medium: number, bounds });
        }
    }
    out
}

/// Some medium that emits may reach to infinity: it is in front of a boundary, or is what the camera stands in beyond them all.
pub(super) fn unbounded(scene: &CompiledScene) -> bool {
    let emits = |number: u16| {
        number != 0 && scene.media.get(usize::from(number) - 1).is_some_and(|m| m.emission != [0.0; 3])
    };
    let beyond = scene.surfaces.iter().any(|s| emits((s.media >> 16) as u16));
    // The camera may well stand within a boundary: then it says nothing new.
    let held = scene.surfaces.iter().any(|s| s.media as u16 == scene.camera_medium);
    beyond || emits(scene.camera_medium) && !held
}
