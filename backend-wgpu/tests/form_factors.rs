//! Rows of form factors on a device against the CPU's, which they equal where the device's arithmetic is exact.

mod adapter;

use etendue_conformance::analytic::compiled;
use etendue_conformance::scenes::{
    camera, diffuse, environment, floor, mesh, point_light, room, shape, sphere,
};
use etendue_core::backend::{Arithmetic, Backend, BackendError, Control, FormFactorJob, NoControl, Session};
use etendue_core::radiosity::form_factors::Row;
use etendue_core::radiosity::patches::{PatchMap, PatchSettings};
use etendue_core::scene::{CompiledScene, LightDesc, SceneDesc, ShapeKind};
use etendue_cpu::CpuBackend;
use etendue_wgpu::{Mutation, Options, wgpu};
use std::ops::{ControlFlow, Range};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};

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
        lights: vec![
            point_light([0.1, 0.2, 0.8], 3.0),
            LightDesc::Spot {
                position: [-0.5, -0.5, 0.9],
                direction: [0.4, 0.6, -1.0],
                intensity: [5.0, 2.0, 0.1],
                cone_deg: 50.0,
                falloff_deg: 20.0,
            },
        ],
        camera: Some(camera([0.6, -0.7, 0.3], [-0.4, 0.2, -0.8], 60.0, [32, 24])),
        ..SceneDesc::default()
    }
}

/// A room without a lid, and a lamp in it: what leaves finds a way to the walls' outsides.
fn court() -> SceneDesc {
    let mut desc = furnished();
    let walls = &mut desc.meshes[0];
    let heights: Vec<f32> = walls.positions.iter().map(|p| p[2]).collect();
    walls.triangles.retain(|t| t.iter().any(|v| heights[*v as usize] < 0.9));
    desc
}

/// A block in the open, part of it below the ground.
fn yard() -> SceneDesc {
    SceneDesc {
        shapes: vec![
            shape(ShapeKind::Rectangle { center: [0.0; 3], u: [3.0, 0.0, 0.0], v: [0.0, 2.0, 0.0] }, "wall"),
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
    for (desc, count, rays) in
        [(furnished(), 60, 512), (furnished(), 700, 64), (court(), 200, 64), (yard(), 300, 256)]
    {
        let scene = scene(&desc);
        let (ours, theirs) = (open(&device, &scene), open(&cpu(), &scene));
        let map = patches(&*theirs, count);
        if is_exact {
            assert!(patches(&*ours, count).patches == map.patches, "{count}");
        }
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

#[test]
fn mistakes_are_noticed() {
    let scene = scene(&yard());
    let theirs = open(&cpu(), &scene);
    let map = patches(&*theirs, 100);
    let all = job(128, 0..u32::MAX);
    let expected = theirs.form_factors(&map, &all, &NoControl).unwrap();
    for (module, from, to) in [
        ("wavefront::rows", "- base <= ray - base", "- base < ray - base"),
        ("radiosity::form_factors::rays", "sobol_bits2(first, 1u).x", "sobol_bits2(first, 0u).x"),
        ("radiosity::form_factors::rays", "math_dot(ray.direction, front) <= 0.0f", "true"),
        (
            "radiosity::form_factors::rays",
            "if hit.primitive == TREE_NOTHING { return RAYS_ESCAPED; }",
            "if hit.primitive == TREE_NOTHING { return RAYS_LOST; }",
        ),
        ("radiosity::patches", "select(front, -front, is_back)", "front"),
        ("radiosity::patches", "lists.cumulative + first", "lists.cumulative"),
        ("illumination::elements", "element >= map.per_side)", "false)"),
        ("illumination::lattice", "fx + fy > 1.0f && i", "fx + fy > 0.9f && i"),
    ] {
        let mutations = vec![Mutation { module, from, to }];
        let Some(device) = adapter::exact_with(Options { mutations, ..Options::default() }) else { return };
        let found = open(&device, &scene).form_factors(&map, &all, &NoControl).unwrap();
        assert!(found != expected, "{module}: {from}");
    }
}

#[test]
fn any_range_of_patches_gives_the_rows_of_the_whole() {
    let Some(device) = adapter::backend() else { return };
    // So little room that a patch has more rays than one submission.
    let limits = wgpu::Limits { max_compute_workgroups_per_dimension: 16, ..Default::default() };
    let options = Options { limits: Some(limits), ..Options::default() };
    let Some(narrow) = adapter::backend_with(options) else { return };
    let scene = scene(&furnished());
    let session = open(&device, &scene);
    let map = patches(&*session, 60);
    let rows =
        |session: &dyn Session, range| session.form_factors(&map, &job(1024, range), &NoControl).unwrap();
    let whole = rows(&*session, 0..u32::MAX);
    assert!(whole.iter().any(|r| r.rays > 16 * 64));
    let n = map.patches.len() as u32;
    assert!(rows(&*open(&narrow, &scene), 0..n) == whole);
    assert!([rows(&*session, 0..7), rows(&*session, 7..n)].concat() == whole);
    assert!(rows(&*session, n..n + 3).is_empty() && rows(&*session, 5..5).is_empty());
}

/// Cancels after some calls, and sees that what is told grows.
struct After(AtomicU32, AtomicU64);

impl Control for After {
    fn advance(&self, done: u64, total: u64) -> ControlFlow<()> {
        assert!(done <= total && done >= self.1.swap(done, Ordering::Relaxed));
        let left = self.0.fetch_sub(1, Ordering::Relaxed);
        if left <= 1 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

#[test]
fn progress_is_told_and_a_job_can_be_cancelled() {
    let Some(device) = adapter::backend() else { return };
    let scene = scene(&furnished());
    let session = open(&device, &scene);
    let map = patches(&*session, 60);
    let control = |calls| After(AtomicU32::new(calls), AtomicU64::new(0));
    let patient = control(u32::MAX);
    let rows = session.form_factors(&map, &job(1024, 0..u32::MAX), &patient).unwrap();
    assert_eq!(patient.1.into_inner(), rows.len() as u64);
    for calls in [1, 2] {
        let found = session.form_factors(&map, &job(4096, 0..u32::MAX), &control(calls));
        assert!(matches!(found, Err(BackendError::Cancelled)), "{found:?}");
    }
}

#[test]
fn what_does_not_fit_is_an_error() {
    let limits = wgpu::Limits { max_storage_buffer_binding_size: 1 << 14, ..Default::default() };
    let options = Options { limits: Some(limits), ..Options::default() };
    let Some(small) = adapter::backend_with(options) else { return };
    let room = scene(&furnished());
    let session = open(&small, &room);
    let (few, many) = (patches(&*session, 60), patches(&*session, 3000));
    // What rays met comes back in parts.
    let rows = session.form_factors(&few, &job(256, 0..u32::MAX), &NoControl).unwrap();
    assert!(rows.iter().map(|r| r.rays).sum::<u32>() > (1 << 14) / 4);
    let found = session.form_factors(&many, &job(256, 0..u32::MAX), &NoControl);
    assert!(matches!(found, Err(BackendError::LimitExceeded { .. })), "{found:?}");

    let other = open(&small, &scene(&yard()));
    let found = other.form_factors(&few, &job(256, 0..u32::MAX), &NoControl);
    assert!(matches!(found, Err(BackendError::BadJob { .. })), "{found:?}");
    let mut round = yard();
    round.shapes.extend([sphere([0.2, 0.1, 2.0], 0.4, "wall"), floor(-1.0, 1.5, "wall")]);
    let found = open(&small, &scene(&round)).patches(&PatchSettings { count: 100, seed: 0 });
    assert!(matches!(found, Err(BackendError::SceneNeeds { method: "radiosity", .. })), "{found:?}");
}
