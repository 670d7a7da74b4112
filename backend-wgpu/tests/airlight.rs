//! Images with summed airlight on a device against the scalar CPU backend, to the last bit.

mod adapter;
mod crowd;

use crowd::all_at_once;
use etendue_conformance::analytic::compiled;
use etendue_conformance::scenes::{camera, diffuse, material, point_light, room, shape};
use etendue_core::backend::{Backend, BackendError, NoControl, PathJob, Session, image_film_settings};
use etendue_core::film::Film;
use etendue_core::scene::{
    CompiledScene, LightDesc, MaterialKind, MediumDesc, SceneDesc, ShapeDesc, ShapeKind,
};
use etendue_core::transport::volume::{NODES_MAX, Rule, SingleScatter};
use etendue_wgpu::{Mutation, Options, WgpuBackend};
use std::sync::Arc;

const RULES: [Rule; 3] = [Rule::Trapezoid, Rule::PlainTrapezoid, Rule::Equiangular];

fn film(session: &dyn Session, job: &PathJob, single: SingleScatter) -> Result<(Film, u64), BackendError> {
    let mut film = Film::new(image_film_settings(session.scene(), job).unwrap());
    let stats = session.airlight_image(job, single, &NoControl, &mut film)?;
    Ok((film, stats.rays))
}

fn agree(backend: &WgpuBackend, scene: &Arc<CompiledScene>, job: &PathJob, single: SingleScatter) {
    let cpu = etendue_cpu::CpuBackend::new(Some(1)).unwrap();
    let [ours, theirs] =
        [backend as &dyn Backend, &cpu].map(|b| film(&*b.open(scene.clone()).unwrap(), job, single).unwrap());
    let lit = (0..theirs.0.len()).filter(|i| theirs.0.mean(*i) != [0.0; 3]).count();
    let differing = (0..theirs.0.len()).filter(|i| ours.0.mean(*i) != theirs.0.mean(*i)).count();
    println!(
        "{single:?} depth {}: {differing} of {} differ, {lit} are lit, {} rays",
        job.max_depth,
        ours.0.len(),
        ours.1
    );
    assert!(ours.0 == theirs.0, "{single:?}");
    assert_eq!(ours.1, theirs.1, "{single:?}");
    assert!(lit > 0 || job.max_depth < 2);
}

/// A ball of fog in a room, with a lamp in it, one outside, and one at infinity, which reaches nothing but counts its nodes.
fn foggy() -> SceneDesc {
    let fog = MediumDesc::new("fog", [0.02, 0.05, 0.1], [0.9, 1.4, 0.6], 0.3);
    SceneDesc {
        meshes: vec![room([0.0; 3], 1.0, "wall")],
        shapes: vec![ShapeDesc {
            interior: "fog".into(),
            ..shape(ShapeKind::Sphere { center: [0.1, 0.2, 0.0], radius: 0.6 }, "none")
        }],
        materials: vec![diffuse("wall", 0.5, 0.0), material("none", MaterialKind::Null, 0.0)],
        media: vec![fog],
        lights: vec![
            point_light([0.2, 0.3, 0.1], 0.7),
            point_light([-0.5, -0.9, 0.7], 0.9),
            LightDesc::Directional { direction: [0.1, 0.2, -1.0], irradiance: [1.0, 2.0, 3.0] },
        ],
        camera: Some(camera([0.1, -0.95, 0.1], [0.0, 0.2, -0.1], 90.0, [16, 12])),
        ..SceneDesc::default()
    }
}

#[test]
fn every_rule_has_the_cpu_bits() {
    let Some(backend) = adapter::exact_with(Options::default()) else { return };
    let scene = compiled(&foggy()).unwrap();
    for rule in RULES {
        for (nodes, max_depth) in [(1, u32::MAX), (5, u32::MAX), (3, 2)] {
            let job = PathJob { seed: 5, block_length: 2, blocks: 0..2, max_depth };
            agree(&backend, &scene, &job, SingleScatter { rule, nodes });
        }
    }
    let session = backend.open(scene).unwrap();
    let job = PathJob { seed: 5, block_length: 2, blocks: 0..1, max_depth: 3 };
    for nodes in [0, NODES_MAX + 1] {
        let refused = film(&*session, &job, SingleScatter { rule: Rule::Trapezoid, nodes }).unwrap_err();
        assert!(matches!(refused, BackendError::BadJob { .. }), "{refused}");
    }
}

#[test]
#[ignore = "half a minute: cargo nextest run -p etendue-wgpu --run-ignored only all_that_airlight"]
fn all_that_airlight_can_meet_has_the_cpu_bits() {
    let Some(backend) = adapter::exact_with(Options::default()) else { return };
    let scene = compiled(&all_at_once(true)).unwrap();
    for rule in RULES {
        let job = PathJob { seed: 5, block_length: 2, blocks: 0..2, max_depth: 6 };
        agree(&backend, &scene, &job, SingleScatter { rule, nodes: 4 });
    }
}

fn notice(mistakes: &[[&'static str; 3]]) {
    let scene = compiled(&foggy()).unwrap();
    let job = PathJob { seed: 5, block_length: 2, blocks: 0..1, max_depth: 4 };
    let single = SingleScatter { rule: Rule::Equiangular, nodes: 2 };
    let cpu = etendue_cpu::CpuBackend::new(Some(1)).unwrap();
    let right = film(&*cpu.open(scene.clone()).unwrap(), &job, single).unwrap();
    for [module, from, to] in mistakes {
        let mutations = vec![Mutation { module, from, to }];
        let Some(backend) = adapter::exact_with(Options { mutations, ..Options::default() }) else { return };
        let found = film(&*backend.open(scene.clone()).unwrap(), &job, single).unwrap();
        assert!(found.0 != right.0, "{module}: {to:?} for {from:?}");
    }
}

#[test]
fn a_mistake_shows() {
    notice(&[["transport::volume", "(*state).depth == 1u && vertex.in_medium", "false"]]);
}

#[test]
#[ignore = "half a minute: cargo nextest run -p etendue-wgpu --run-ignored only mistakes_show"]
fn mistakes_show() {
    notice(&[
        ["transport::volume::airlight", "shift + AIRLIGHT_TURN * number", "shift"],
        ["transport::volume::airlight", "end.beyond.crossed += 1u;", ""],
        ["transport::volume::airlight::rule", "off / foot.distance", "off"],
    ]);
}
