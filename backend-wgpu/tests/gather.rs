//! Images and probes from maps of photons on a device against the CPU: where the device's arithmetic is exact, films are equal to the last bit.

mod adapter;
mod crowd;
mod photon;

use etendue_core::backend::{
    Backend, GatherJob, GivenMap, JobStats, NoControl, PathJob, PhotonStart, Session, image_film_settings,
    probe_film_settings,
};
use etendue_core::film::Film;
use etendue_core::scene::CompiledScene;
use etendue_core::transport::first_shot::{Subdivision, Weights};
use etendue_core::transport::photon::Sequence;
use etendue_cpu::CpuBackend;
use etendue_wgpu::{Mutation, Options};
use photon::{elements, foggy, furnished, named, plain, probes, scene, scenes};
use std::sync::Arc;

const PATH: PathJob = PathJob { seed: 7, block_length: 4, blocks: 1..3, max_depth: u32::MAX };

fn job(scene: &CompiledScene, gather: bool) -> GatherJob {
    let elements = elements(scene);
    let (start, sequence) = (PhotonStart::LIGHTS, Sequence::Sobol);
    GatherJob { path: PATH, photons: 1 << 9, start, sequence, elements, gather }
}

type Read = (Film, JobStats);

fn image(session: &dyn Session, job: &GatherJob) -> Read {
    let mut film = Film::new(image_film_settings(session.scene(), &job.path).unwrap());
    let stats = session.photon_image(job, &NoControl, &mut film).unwrap();
    (film, stats)
}

fn at_probes(session: &dyn Session, job: &GatherJob) -> Read {
    let probes = probes(session.scene());
    let mut film = Film::new(probe_film_settings(session.scene(), &job.path, probes.len()));
    let stats = session.photon_probes(job, &probes, &NoControl, &mut film).unwrap();
    (film, stats)
}

/// Images and probes by both backends, with and without a final gather.
fn same(name: &str, backends: [&dyn Backend; 2], scene: &Arc<CompiledScene>) {
    let [ours, theirs] = backends.map(|b| b.open(scene.clone()).unwrap());
    for gather in [false, true] {
        let job = job(scene, gather);
        let (a, b) = (at_probes(&*ours, &job), at_probes(&*theirs, &job));
        assert!(a == b, "{name}: {} probes, {gather}: {:?} {:?}", a.0.len(), a.1, b.1);
        if scene.camera.is_some() {
            let (a, b) = (image(&*ours, &job), image(&*theirs, &job));
            assert!(a == b, "{name}: image, {gather}: {:?} {:?}", a.1, b.1);
        }
    }
}

#[test]
fn images_and_probes_have_the_bits_of_the_cpu() {
    let Some(device) = adapter::exact_with(Options::default()) else { return };
    let cpu = CpuBackend::new(None).unwrap();
    for (name, scene) in [("furnished", scene(&furnished())), ("stage", named("stage"))] {
        same(name, [&device, &cpu], &scene);
    }
}

#[test]
fn maps_in_media_are_read_with_the_bits_of_the_cpu() {
    let Some(device) = adapter::exact_with(Options::default()) else { return };
    let cpu = CpuBackend::new(None).unwrap();
    same("foggy", [&device, &cpu], &scene(&foggy()));
}

/// All scenes of the suite, and one with all that media can have: minutes.
#[test]
#[ignore = "minutes: the command is in TESTING.md"]
fn all_scenes_are_read_with_the_bits_of_the_cpu() {
    let Some(device) = adapter::exact_with(Options::default()) else { return };
    let cpu = CpuBackend::new(None).unwrap();
    let together = scene(&crowd::all_at_once(true));
    for (name, scene) in scenes().into_iter().chain([("together".into(), together)]) {
        println!("{name}");
        same(&name, [&device, &cpu], &scene);
    }
}

#[test]
fn a_map_that_is_given_is_read_and_forecasts_agree() {
    let Some(device) = adapter::exact_with(Options::default()) else { return };
    let cpu = CpuBackend::new(None).unwrap();
    let scene = named("room");
    let sessions = [device.open(scene.clone()).unwrap(), cpu.open(scene.clone()).unwrap()];
    let settings = elements(&scene);
    let count = sessions[0].elements(&settings).count();
    let values: Vec<[f32; 3]> = (0..count).map(|i| [1.0, i as f32, 0.3 * (i % 7) as f32]).collect();
    for gather in [false, true] {
        let map = GivenMap { elements: settings, values: &values, gather };
        let films = sessions.each_ref().map(|session| {
            let (probes, image) = (probes(&scene), image_film_settings(&scene, &PATH).unwrap());
            let mut films = [Film::new(probe_film_settings(&scene, &PATH, probes.len())), Film::new(image)];
            let stats = [
                session.map_probes(&PATH, &map, &probes, &NoControl, &mut films[0]).unwrap(),
                session.map_image(&PATH, &map, &NoControl, &mut films[1]).unwrap(),
            ];
            (films, stats)
        });
        assert!(films[0] == films[1], "{gather}: {:?} {:?}", films[0].1, films[1].1);
    }
    let wrong = GivenMap { elements: settings, values: &values[1..], gather: false };
    let mut film = Film::new(image_film_settings(&scene, &PATH).unwrap());
    assert!(sessions[0].map_image(&PATH, &wrong, &NoControl, &mut film).is_err());
    let forecasts =
        sessions.each_ref().map(|s| s.forecast(&Subdivision::robust(Weights::EXACT), 1 << 16).unwrap());
    assert_eq!(forecasts[0], forecasts[1]);
}

#[test]
fn mistakes_are_noticed() {
    let scene = scene(&plain());
    let cpu = CpuBackend::new(None).unwrap().open(scene.clone()).unwrap();
    let job = job(&scene, true);
    let expected = at_probes(&*cpu, &job).0;
    for (module, from, to) in [
        ("transport::gather", "(*state).gathers = false;", "(*state).gathers = true;"),
        ("transport::gather", "(*state).stage = k + 1u;", "(*state).stage = k + 2u;"),
        ("illumination::read", "* cell.bary.y", "* cell.bary.z"),
    ] {
        let mutations = vec![Mutation { module, from, to }];
        let Some(device) = adapter::exact_with(Options { mutations, ..Options::default() }) else { return };
        let session = device.open(scene.clone()).unwrap();
        assert_ne!(at_probes(&*session, &job).0, expected, "{module}: {from}");
    }
}
