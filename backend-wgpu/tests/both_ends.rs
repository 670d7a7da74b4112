//! What samples from both ends ask of a device beside the scenes of the suite: all that media can have together, every heuristic, strategies
//! alone, walks that are longer than their states, lamps that reach through boundaries, waves that are cut. To the last bit of the reference.

mod adapter;
mod crowd;

use crowd::all_at_once;
use etendue_conformance::analytic::compiled;
use etendue_conformance::reference::ReferenceBackend;
use etendue_conformance::scenes::{camera, diffuse, material, point_light, probe, room, shape};
use etendue_core::backend::{
    self, Backend, BackendError, BidirectionalJob, JobStats, NoControl, PathJob, Probe,
};
use etendue_core::film::Film;
use etendue_core::scene::{
    CameraDesc, CompiledScene, MaterialKind, MediumDesc, Reflectance, SceneDesc, ShapeDesc, ShapeKind,
};
use etendue_core::transport::bidirectional::{CUTOFF, Heuristic};
use etendue_wgpu::{Mutation, Options, WgpuBackend, wgpu};
use std::sync::Arc;

const HEURISTICS: [Heuristic; 3] = [Heuristic::Power, Heuristic::Balance, Heuristic::Cutoff(CUTOFF)];

fn job(block_length: u32, blocks: u32, max_depth: u32, heuristic: Heuristic) -> BidirectionalJob {
    let path = PathJob { seed: 11, block_length, blocks: 0..blocks, max_depth };
    BidirectionalJob { heuristic, ..BidirectionalJob::new(path) }
}

fn film(
    backend: &dyn Backend,
    scene: &Arc<CompiledScene>,
    probes: Option<&[Probe]>,
    job: &BidirectionalJob,
) -> (Film, JobStats) {
    let session = backend.open(scene.clone()).unwrap();
    let settings = match probes {
        Some(p) => backend::probe_film_settings(scene, &job.path, p.len()),
        None => backend::image_film_settings(scene, &job.path).unwrap(),
    };
    let mut film = Film::new(settings);
    let stats = match probes {
        Some(p) => session.bidirectional_probes(job, p, &NoControl, &mut film).unwrap(),
        None => session.bidirectional_image(job, &NoControl, &mut film).unwrap(),
    };
    (film, stats)
}

/// The same film and rays, and something is lit.
fn agree(
    backend: &WgpuBackend,
    scene: &Arc<CompiledScene>,
    probes: Option<&[Probe]>,
    job: &BidirectionalJob,
) {
    let (ours, theirs) = (film(backend, scene, probes, job), film(&ReferenceBackend, scene, probes, job));
    let what = format!("{:?} {:?} depth {}", job.heuristic, job.only, job.path.max_depth);
    let differing = (0..ours.0.len()).filter(|i| ours.0.mean(*i) != theirs.0.mean(*i)).count();
    let lit = (0..ours.0.len()).filter(|i| theirs.0.mean(*i) != [0.0; 3]).count();
    println!(
        "{what}: {differing} of {} differ, {lit} are lit, {} and {} rays",
        ours.0.len(),
        ours.1.rays,
        theirs.1.rays
    );
    assert!(ours.0 == theirs.0, "{what}");
    assert_eq!(ours.1.rays, theirs.1.rays, "{what}");
    assert!(lit > 0 || job.path.max_depth < 2, "{what}");
}

/// Images and probes of all that media can have, with a lamp that is in the cloud and in the fog.
fn crowd(coloured: bool, heuristics: &[Heuristic]) {
    let Some(backend) = adapter::exact_with(Options::default()) else { return };
    let probes = [
        probe([0.3, 0.2, -1.0], [0.0, 0.0, 1.0]),
        probe([-0.5, 0.2, -0.2], [0.0, 0.6, 0.8]),
        probe([0.05, 0.2, 0.0], [1.0, 0.0, 0.0]),
        probe([-0.5, -0.6, -0.5], [0.0, 1.0, 0.0]),
        probe([0.3, 0.5, -0.3], [0.0, 0.0, -1.0]),
    ];
    let mut desc = all_at_once(coloured);
    desc.shapes.push(shape(ShapeKind::Sphere { center: [-0.9, 0.2, -0.2], radius: 0.08 }, "lamp"));
    let scene = compiled(&desc).unwrap();
    for heuristic in heuristics {
        for max_depth in [0, 1, 2, u32::MAX] {
            agree(&backend, &scene, None, &job(2, 1, max_depth, *heuristic));
        }
        agree(&backend, &scene, Some(&probes), &job(8, 2, u32::MAX, *heuristic));
    }
}

#[test]
fn all_that_media_can_have_has_the_reference_bits() {
    crowd(false, &[Heuristic::Power]);
}

#[test]
#[ignore = "a minute for two more shaders: cargo nextest run -p etendue-wgpu --run-ignored only every_heuristic"]
fn every_heuristic_has_the_reference_bits_in_media() {
    crowd(true, &[Heuristic::Balance, Heuristic::Cutoff(CUTOFF)]);
}

#[test]
fn strategies_alone_have_the_reference_bits() {
    let Some(backend) = adapter::exact_with(Options::default()) else { return };
    let scene = compiled(&furnished(0.8)).unwrap();
    for only in [[0, 2], [1, 2], [2, 1], [2, 2], [3, 2]] {
        let job = BidirectionalJob { only: Some(only), ..job(2, 1, u32::MAX, Heuristic::Power) };
        agree(&backend, &scene, None, &job);
    }
}

/// A closed room of this albedo with a lamp, a mirror and a lamp without size.
fn furnished(albedo: f32) -> SceneDesc {
    SceneDesc {
        meshes: vec![room([0.0; 3], 1.0, "wall")],
        shapes: vec![
            shape(
                ShapeKind::Rectangle { center: [0.0, 0.2, 0.98], u: [0.0, 0.3, 0.0], v: [0.3, 0.0, 0.0] },
                "lamp",
            ),
            shape(ShapeKind::Sphere { center: [0.5, 0.3, -0.6], radius: 0.3 }, "mirror"),
        ],
        materials: vec![
            diffuse("wall", albedo, 0.0),
            diffuse("lamp", 0.2, 6.0),
            material("mirror", MaterialKind::Mirror { albedo: Reflectance::flat([0.9, 0.8, 0.95]) }, 0.0),
        ],
        lights: vec![point_light([-0.5, -0.9, 0.7], 0.7)],
        camera: Some(camera([0.1, -0.95, 0.1], [0.0, 0.2, 0.3], 90.0, [12, 9])),
        ..SceneDesc::default()
    }
}

#[test]
fn walks_may_be_longer_than_their_states() {
    let Some(backend) = adapter::exact_with(Options::default()) else { return };
    let scene = compiled(&furnished(0.999)).unwrap();
    for heuristic in HEURISTICS {
        agree(&backend, &scene, None, &job(1, 1, u32::MAX, heuristic));
    }
}

#[test]
fn lists_of_strategies_are_kept_in_media() {
    let Some(backend) = adapter::exact_with(Options::default()) else { return };
    let mut desc = furnished(0.999);
    desc.shapes.pop();
    desc.media = vec![MediumDesc::new("milk", [0.0, 0.01, 0.02], [3.0, 2.0, 1.0], 0.4)];
    desc.materials.push(material("none", MaterialKind::Null, 0.0));
    desc.shapes.push(ShapeDesc {
        interior: "milk".into(),
        ..shape(ShapeKind::Box { min: [-0.9; 3], max: [0.8, 0.9, 0.7] }, "none")
    });
    agree(&backend, &compiled(&desc).unwrap(), None, &job(2, 1, 24, Heuristic::Cutoff(CUTOFF)));
}

/// The room by a few pixels, which are bright.
fn few_pixels() -> Arc<CompiledScene> {
    let mut scene = furnished(0.7);
    scene.camera = scene.camera.map(|c| CameraDesc { resolution: [3, 2], ..c });
    compiled(&scene).unwrap()
}

#[test]
fn waves_may_be_small() {
    // A binding so small that blocks are cut, and splats are of many blocks.
    let limits = wgpu::Limits { max_storage_buffer_binding_size: 1 << 19, ..wgpu::Limits::default() };
    let options = Options { limits: Some(limits), ..Options::default() };
    let Some(backend) = adapter::exact_with(options) else { return };
    for (block_length, blocks) in [(256, 1), (4, 30)] {
        agree(&backend, &few_pixels(), None, &job(block_length, blocks, u32::MAX, Heuristic::Power));
    }
}

#[test]
fn splats_without_their_carries_show() {
    let module = "wavefront::bidirectional::joints";
    let mutations = vec![Mutation { module, from: "return u32(old + x < old);", to: "return 0u;" }];
    let Some(backend) = adapter::exact_with(Options { mutations, ..Options::default() }) else { return };
    let (scene, job) = (few_pixels(), job(256, 1, 6, Heuristic::Power));
    let [ours, theirs] = [&backend as &dyn Backend, &ReferenceBackend].map(|b| film(b, &scene, None, &job).0);
    assert!(ours != theirs);
}

#[test]
fn what_has_no_room_is_refused() {
    let limits = wgpu::Limits { max_storage_buffer_binding_size: 1 << 17, ..wgpu::Limits::default() };
    let options = Options { limits: Some(limits), ..Options::default() };
    let Some(backend) = adapter::backend_with(options) else { return };
    let scene = compiled(&furnished(0.7)).unwrap();
    let session = backend.open(scene.clone()).unwrap();
    let job = job(4, 1, u32::MAX, Heuristic::Power);
    let mut film = Film::new(backend::image_film_settings(&scene, &job.path).unwrap());
    let refused = session.bidirectional_image(&job, &NoControl, &mut film).unwrap_err();
    assert!(
        matches!(refused, BackendError::LimitExceeded { allowed, .. } if allowed == 1 << 17),
        "{refused}"
    );
}
