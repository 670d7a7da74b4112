//! Paths that end by chance bring what paths bring that don't.

#![allow(clippy::disallowed_methods, reason = "statistics in f64")]

use super::Paths;
use super::back::Roulette;
use super::bidirectional::{Bidirectional, Heuristic, Settings, State};
use super::path::PathTracer;
use super::photon::PhotonTracer;
use super::volume::{Surroundings, VolumeTracer};
use crate::geometry::{Bvh2, Intersector};
use crate::light::emit;
use crate::medium::Inside;
use crate::sampling::counter::Counter;
use crate::scene::*;
use std::vec::Vec;

/// Standard errors that two means may be apart (Welch): another seed fails one of the dozen comparisons with a probability of 2e-4.
const LIMIT: f64 = 4.3;
/// Means are known within this part: a roulette that adds 5 % would be seen by 6 standard errors at least.
const KNOWN: f64 = 6e-3;
/// Edges of the longest paths: without a roulette nothing else ends those of a bright room.
const DEPTH: u32 = 20;

fn material(name: &str, albedo: f32, emission: f32) -> MaterialDesc {
    MaterialDesc {
        name: name.into(),
        kind: MaterialKind::Diffuse { albedo: Reflectance::flat([albedo, 0.9 * albedo, 0.8 * albedo]) },
        two_sided: true,
        emission: [emission; 3],
    }
}

/// A closed bright room with a lamp below its ceiling; with fog in it.
fn room(foggy: bool) -> (CompiledScene, Inside) {
    let fog = if foggy { "fog" } else { "" };
    let wall = |center: [f32; 3], u: [f32; 3], v: [f32; 3], material: &str| ShapeDesc {
        kind: ShapeKind::Rectangle { center, u, v },
        material: material.into(),
        interior: fog.into(),
        exterior: fog.into(),
    };
    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let desc = SceneDesc {
        camera: Some(CameraDesc {
            position: [0.1, 0.2, 0.9],
            look_at: [0.0, -0.4, -1.0],
            up: y,
            fov_x_deg: 60.0,
            resolution: [1, 1],
            lens_radius: 0.0,
            focus_distance: 1.0,
            medium: fog.into(),
        }),
        materials: [material("wall", 0.9, 0.0), material("lamp", 0.9, 4.0)].into(),
        media: if foggy {
            [MediumDesc::new("fog", [0.02; 3], [0.8, 1.0, 1.2], 0.4)].into()
        } else {
            Vec::new()
        },
        shapes: [
            wall([0.0, -1.0, 0.0], z, x, "wall"),
            wall([0.0, 1.0, 0.0], x, z, "wall"),
            wall([0.0, 0.0, -1.0], x, y, "wall"),
            wall([0.0, 0.0, 1.0], y, x, "wall"),
            wall([-1.0, 0.0, 0.0], y, z, "wall"),
            wall([1.0, 0.0, 0.0], z, y, "wall"),
            wall([0.2, 0.9, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, 0.5], "lamp"),
        ]
        .into(),
        ..SceneDesc::default()
    };
    let (scene, report) = compile(&desc).unwrap();
    assert!(report.cleanups.is_empty());
    (scene, if foggy { Inside::of(1) } else { Inside::NOTHING })
}

/// Mean of the middle channel and its standard error, from independent blocks.
fn mean_of(blocks: u32, mut block: impl FnMut(u32) -> f64) -> [f64; 2] {
    let values: Vec<f64> = (0..blocks).map(&mut block).collect();
    let n = f64::from(blocks);
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (n - 1.0);
    [mean, (variance / n).sqrt()]
}

fn agree(what: &str, on: [f64; 2], off: [f64; 2]) {
    let z = (on[0] - off[0]).abs() / on[1].hypot(off[1]);
    assert!(z <= LIMIT, "{what}: {on:?} with and {off:?} without, {z:.1} standard errors");
    assert!(on[1] <= KNOWN * off[0] && off[1] <= KNOWN * off[0], "{what}: {on:?} {off:?}");
}

/// Samples of a block.
const LENGTH: u32 = 1024;

fn paths<T: Paths, I: Intersector>(tracer: &T, tree: &I, seed: u64, blocks: u32) -> [f64; 2] {
    mean_of(blocks, |block| tracer.pixel_block(tree, [0, 0], seed, block, LENGTH).0[1])
}

#[test]
fn paths_bring_the_same_without_roulette() {
    let (scene, _) = room(false);
    let tree = Bvh2::new(scene.primitives());
    let on = PathTracer::<false, false, false>::new(&scene, DEPTH);
    let mut off = on;
    off.roulette = Roulette::OFF;
    agree("room", paths(&on, &tree, 1, 64), paths(&off, &tree, 2, 32));
    let (scene, inside) = room(true);
    let tree = Bvh2::new(scene.primitives());
    let on = VolumeTracer::<false, false, false>::new(&scene, DEPTH, inside);
    let mut off = on;
    off.roulette = Roulette::OFF;
    agree("fog", paths(&on, &tree, 1, 64), paths(&off, &tree, 2, 32));
}

fn both<const VOLUME: bool>(foggy: bool, roulette: Roulette, seed: u64, blocks: u32) -> [f64; 2] {
    let (scene, camera) = room(foggy);
    let tree = Bvh2::new(scene.primitives());
    let settings = Settings { roulette, ..Settings::new(DEPTH, Heuristic::Power, None) };
    let surroundings = Surroundings { camera, outside: Inside::NOTHING };
    let tracer = Bidirectional::<VOLUME, false, false>::new(&scene, &tree, settings, surroundings);
    let mut state = State::default();
    mean_of(blocks, |block| {
        let mut landed = 0.0;
        let names = (seed, block, LENGTH);
        let (mean, _) =
            tracer.pixel_block(&mut state, &tree, [0, 0], names, |_, value| landed += f64::from(value.y));
        mean[1] + landed / f64::from(LENGTH)
    })
}

#[test]
fn walks_from_both_ends_bring_the_same_without_roulette() {
    let (on, off) = (Roulette::ON, Roulette::OFF);
    agree("room", both::<false>(false, on, 1, 12), both::<false>(false, off, 2, 12));
    agree("fog", both::<true>(true, on, 1, 12), both::<true>(true, off, 2, 12));
}

/// Flux that arrives at the room's walls, of one lamp.
fn arrivals(scene: &CompiledScene, gamble: bool, seed: u64, blocks: u32) -> [f64; 2] {
    let tree = Bvh2::new(scene.primitives());
    let tracer = PhotonTracer::<(), false, false, false>::new(scene, DEPTH);
    let numbers = Counter::new(seed);
    mean_of(blocks, |block| {
        let mut sum = 0.0;
        for i in 0..LENGTH {
            let mut at = 0;
            let mut unit = || {
                at += 1;
                numbers.unit(block, i, at)
            };
            let emission =
                emit::emit_entry(scene, 0, scene.bounding_sphere(), [unit(), unit(), unit(), unit()]).0;
            let mut photon = super::photon::Photon::new(emission.ray, emission.flux);
            while let Some(hit) = tree.closest_hit(&photon.ray) {
                let Some((surface, arrival)) = tracer.land(&photon, &hit) else { break };
                sum += arrival.map_or(0.0, |a| f64::from(a.flux.y));
                let chance = tracer.scatter(&mut photon, &surface, [unit(), unit()], unit());
                if chance <= 0.0 {
                    break;
                }
                if gamble {
                    if unit() >= chance {
                        break;
                    }
                    photon.flux /= chance;
                }
            }
        }
        sum / f64::from(LENGTH)
    })
}

#[test]
fn photons_bring_the_same_without_roulette() {
    let (scene, _) = room(false);
    agree("photons", arrivals(&scene, true, 1, 128), arrivals(&scene, false, 2, 8));
}

/// The switch is what it is called: no path ends before its depth where nothing is absorbed.
#[test]
fn without_roulette_nothing_is_left_to_chance() {
    let (scene, _) = room(false);
    let tree = Bvh2::new(scene.primitives());
    let mut tracer = PathTracer::<false, false, false>::new(&scene, DEPTH);
    let rays =
        |tracer: &PathTracer<'_, false, false, false>| tracer.pixel_block(&tree, [0, 0], 3, 0, LENGTH).1;
    let on = rays(&tracer);
    tracer.roulette = Roulette::OFF;
    let off = rays(&tracer);
    assert!(4 * off > 5 * on && off > u64::from(LENGTH * DEPTH), "{off} rays, {on} with roulette");
}
