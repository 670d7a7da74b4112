//! All that a scene with media can have, together: images and probes on a device against the scalar reference, to the last bit.

mod adapter;
mod crowd;

use crowd::all_at_once;
use etendue_conformance::analytic::{Estimator, compiled, render};
use etendue_conformance::reference::ReferenceBackend;
use etendue_conformance::scenes::probe;
use etendue_core::backend::{Backend, NoControl, PathJob, image_film_settings};
use etendue_core::film::Film;
use etendue_core::scene::CameraDesc;
use etendue_wgpu::{Options, wgpu};

fn job(max_depth: u32) -> PathJob {
    PathJob { seed: 11, block_length: 4, blocks: 0..2, max_depth }
}

#[test]
fn all_that_media_can_have_has_the_reference_bits() {
    let Some(backend) = adapter::exact_with(Options::default()) else { return };
    // On walls, in mid-air within media, and within glass.
    let probes = [
        probe([0.3, 0.2, -1.0], [0.0, 0.0, 1.0]),
        probe([-0.5, 0.2, -0.2], [0.0, 0.6, 0.8]),
        probe([0.05, 0.2, 0.0], [1.0, 0.0, 0.0]),
        probe([-0.5, -0.6, -0.5], [0.0, 1.0, 0.0]),
        probe([0.3, 0.5, -0.3], [0.0, 0.0, -1.0]),
    ];
    for coloured in [false, true] {
        let scene = compiled(&all_at_once(coloured)).unwrap();
        for (max_depth, probes) in
            [0, 1, 2, 7, u32::MAX].map(|d| (d, None)).into_iter().chain([(u32::MAX, Some(&probes[..]))])
        {
            let job = job(max_depth);
            let ours = render(&backend, Estimator::Path, &scene, probes, &job).unwrap();
            let theirs = render(&ReferenceBackend, Estimator::Path, &scene, probes, &job).unwrap();
            let lit = (0..theirs.len()).filter(|i| theirs.mean(*i) != [0.0; 3]).count();
            let differing = (0..ours.len()).filter(|i| ours.mean(*i) != theirs.mean(*i)).count();
            println!(
                "depth {max_depth}: {differing} of {} differ, {lit} are lit ({})",
                ours.len(),
                scene.needs
            );
            assert!(ours == theirs);
            assert!(lit > 0 || max_depth < 2);
        }
    }
}

#[test]
fn waves_may_be_small() {
    // A binding so small that each block is cut.
    let limits = wgpu::Limits { max_storage_buffer_binding_size: 1 << 17, ..wgpu::Limits::default() };
    let options = Options { limits: Some(limits), ..Options::default() };
    let Some(backend) = adapter::exact_with(options) else { return };
    let mut scene = all_at_once(false);
    scene.camera = scene.camera.map(|c| CameraDesc { resolution: [2, 2], ..c });
    let scene = compiled(&scene).unwrap();
    let job = PathJob { block_length: 1024, blocks: 0..1, ..job(u32::MAX) };
    let (ours, theirs) = [&backend as &dyn Backend, &ReferenceBackend]
        .map(|backend| {
            let mut film = Film::new(image_film_settings(&scene, &job).unwrap());
            let stats = backend.open(scene.clone()).unwrap().path_image(&job, &NoControl, &mut film).unwrap();
            (film, stats.rays)
        })
        .into();
    assert!(ours == theirs);
}
