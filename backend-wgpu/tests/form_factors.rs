//! Rows of form factors on a device against the CPU's, which they equal where the device's arithmetic is exact.

mod adapter;

use etendue_conformance::analytic::compiled;
use etendue_conformance::scenes::{diffuse, environment, floor, mesh, point_light, room, shape, sphere};
use etendue_core::backend::{Arithmetic, Backend, BackendError, Control, FormFactorJob, NoControl, Session};
use etendue_core::radiosity::form_factors::Row;
use etendue_core::radiosity::patches::{PatchMap, PatchSettings};
use etendue_core::scene::{CompiledScene, SceneDesc, ShapeKind};
use etendue_cpu::CpuBackend;
use etendue_wgpu::{Mutation, Options, wgpu};
use std::ops::{ControlFlow, Range};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

fn job(rays: u32, patches: Range<u32>) -> FormFactorJob {
    FormFactorJob { seed: 0x1234_5678_9abc, rays, patches }
}

/// A closed room with a lamp, a screen that is seen from both sides, a block on the floor and a triangle too thin for an element of its own.
fn furnished() -> SceneDesc {
    let rectangle = |center, u, v, name| shape(ShapeKind::Rectangle { center, u, v }, name);
    let thin = mesh(
        vec![[-0.9, -0.9, -0.5], [0.9, -0.9, -0.5], [0.0, -0.9, -0.5 + 1e-7], [0.0, -0.2, 0.6]],
        vec![[0, 1, 2], [0, 1, 3]],
        "wall",
    );
    SceneDesc {
        meshes: vec![room([0.0; 3], 1.0, "wall"), thin],
        shapes: vec![
            rectangle([0.3, 0.2, -0.2], [0.3, 0.1, 0.0], [0.0, 0.1, 0.5], "wall"),
            rectangle([0.1, -0.2, 0.98], [0.2, 0.0, 0.0], [0.0, -0.3, 0.0], "lamp"),
            shape(ShapeKind::Box { min: [-0.7, 0.1, -1.0], max: [-0.2, 0.6, -0.4] }, "wall"),
        ],
        materials: vec![diffuse("wall", 0.6, 0.0), diffuse("lamp", 0.1, 8.0)],
        lights: vec![point_light([0.1, 0.2, 0.8], 3.0)],
        ..SceneDesc::default()
    }
}

/// A block in the open, part of it below the ground.
fn yard() -> SceneDesc {
    SceneDesc {
        shapes: vec![
            shape(
                ShapeKind::Rectangle { center: [0.0; 3], u: [3.0, 0.0, 0.0], v: [0.0, 2.0, 0.0] },
                "wall",
            ),
            shape(ShapeKind::Box { min: [-0.5, -0.4, -0.3], max: [0.6, 0.5, 1.2] }, "wall"),
        ],
        materials: vec![diffuse("wall", 0.5, 0.0)],
        lights: vec![environment(1.0)],
        ..SceneDesc::default()
    }
}

fn scene(desc: &SceneDesc) -> Arc<CompiledScene> {
    compiled(desc).unwrap()
}

fn open(backend: &dyn Backend, scene: &Arc<CompiledScene>) -> Box<dyn Session> {
    backend.open(scene.clone()).unwrap()
}

fn cpu() -> CpuBackend {
    CpuBackend::new(None).unwrap()
}

fn patches(session: &dyn Session, count: u32) -> PatchMap {
    session.patches(&PatchSettings { count, seed: 5 }).unwrap()
}

/// Share of a row's rays that met something else than those of another.
fn difference(a: &Row, b: &Row) -> f64 {
    assert_eq!(a.rays, b.rays);
    let count = |row: &Row, patch: u32| row.met.iter().find(|m| m.0 == patch).map_or(0, |m| m.1);
    let of: Vec<u32> = a.met.iter().chain(&b.met).map(|m| m.0).collect();
    let sum: u32 = of.into_iter().map(|p| count(a, p).abs_diff(count(b, p))).sum();
    f64::from(sum + a.escaped.abs_diff(b.escaped) + a.lost.abs_diff(b.lost)) / f64::from(a.rays)
}

#[test]
fn rows_are_those_of_the_cpu() {
    let Some(device) = adapter::backend() else { return };
    let is_exact = device.arithmetic() == Arithmetic::Ieee;
    let mut sums = [0; 3];
    for (desc, count, rays) in [(furnished(), 60, 512), (furnished(), 700, 64), (yard(), 300, 256)] {
        let scene = scene(&desc);
        let (ours, theirs) = (open(&device, &scene), open(&cpu(), &scene));
        let map = patches(&*theirs, count);
        let same = patches(&*ours, count);
        assert_eq!(same.patches, map.patches);
        let all = job(rays, 0..u32::MAX);
        let found = ours.form_factors(&map, &all, &NoControl).unwrap();
        let expected = theirs.form_factors(&map, &all, &NoControl).unwrap();
        assert_eq!(found.len(), map.patches.len());
        if is_exact {
            assert!(found == expected);
        } else {
            // A ray that passes an edge may meet it.
            let mean = found.iter().zip(&expected).map(|(a, b)| difference(a, b)).sum::<f64>();
            assert!(mean / (found.len() as f64) < 0.01, "{mean}");
        }
        for row in &expected {
            let met: u32 = row.met.iter().map(|m| m.1).sum();
            sums = [sums[0] + met, sums[1] + row.escaped, sums[2] + row.lost];
        }
    }
    println!("met, escaped, lost: {sums:?}");
    assert!(sums[0] > 50_000 && sums[1] > 10_000 && sums[2] > 0, "{sums:?}");
}
