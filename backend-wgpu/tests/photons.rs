//! Illumination maps by photons on a device against the CPU: where the device's arithmetic is exact, films are equal to the last bit.

mod adapter;
mod crowd;
mod photon;

use etendue_core::backend::{Backend, BackendError, NoControl, PhotonJob, PhotonStart, Session};
use etendue_core::film::Film;
use etendue_core::scene::{CompiledScene, ShapeKind};
use etendue_core::transport::first_shot::{Subdivision, Weights};
use etendue_core::transport::photon::Sequence;
use etendue_cpu::CpuBackend;
use etendue_wgpu::{Mutation, Options, WgpuBackend, wgpu};
use photon::{After, film, foggy, furnished, job, named, never_wait, plain, scene, scenes};
use std::ops::Range;
use std::sync::Arc;

const SEQUENCES: [Sequence; 3] = [Sequence::Sobol, Sequence::Random, Sequence::Sorted];
const DIRECT: PhotonStart = PhotonStart::Lights { registers_direct: true, survives_first: false };

fn surfaces() -> [PhotonStart; 2] {
    let exact = Subdivision::robust(Weights::EXACT);
    [
        PhotonStart::Surfaces { subdivision: exact, weights: Weights::EXACT },
        PhotonStart::Surfaces { subdivision: Subdivision::published(), weights: Weights::Density },
    ]
}

/// The maps of a scene by both backends: whether anything is in them, and what differs.
fn compare(device: &WgpuBackend, scene: &Arc<CompiledScene>, jobs: &[PhotonJob]) -> (usize, Vec<String>) {
    let cpu = CpuBackend::new(None).unwrap().open(scene.clone()).unwrap();
    let ours = device.open(scene.clone()).unwrap();
    let (mut lit, mut wrong) = (0, Vec::new());
    for job in jobs {
        let (mut a, mut b) = (film(scene, job), film(scene, job));
        let expected = match cpu.illumination(job, &NoControl, &mut b) {
            Ok(stats) => stats,
            Err(e) => {
                // Round shapes have no pieces, say: both say so.
                let found = ours.illumination(job, &NoControl, &mut a);
                assert_eq!(found.unwrap_err().to_string(), e.to_string());
                continue;
            }
        };
        let found = ours.illumination(job, &NoControl, &mut a).unwrap();
        lit += (0..a.len()).filter(|i| a.mean(*i) != [0.0; 3]).count();
        if a != b || found != expected {
            let differing: Vec<usize> = (0..a.len()).filter(|i| a.mean(*i) != b.mean(*i)).collect();
            let at = differing.first().map(|i| (i, a.mean(*i), b.mean(*i)));
            let (start, sequence, count) = (&job.start, job.sequence, differing.len());
            wrong.push(format!("{start:?} {sequence:?}: {found:?} {expected:?}; {count} differ, {at:?}"));
        }
    }
    (lit, wrong)
}

/// Jobs of each sequence and start; random photons have a limit of hits.
fn jobs(scene: &CompiledScene, starts: &[PhotonStart], sequences: &[Sequence]) -> Vec<PhotonJob> {
    let mut jobs = Vec::new();
    for sequence in sequences {
        for start in starts {
            let max_hits = if *sequence == Sequence::Random { 5 } else { u32::MAX };
            jobs.push(PhotonJob { start: *start, max_hits, ..job(scene, *sequence, 3..5) });
        }
    }
    jobs
}

fn same(scene: &Arc<CompiledScene>, starts: &[PhotonStart], sequences: &[Sequence]) {
    let Some(device) = adapter::exact_with(Options::default()) else { return };
    let (lit, wrong) = compare(&device, scene, &jobs(scene, starts, sequences));
    assert!(lit > 50, "{lit}");
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn photons_from_lights_have_the_bits_of_the_cpu() {
    same(&scene(&furnished()), &[PhotonStart::LIGHTS, DIRECT], &SEQUENCES);
}

#[test]
fn photons_from_surfaces_have_the_bits_of_the_cpu() {
    same(&named("stage"), &surfaces(), &[Sequence::Sobol, Sequence::Sorted]);
}

#[test]
fn photons_in_media_have_the_bits_of_the_cpu() {
    same(&scene(&foggy()), &[PhotonStart::LIGHTS], &[Sequence::Sorted]);
}

/// All scenes of the suite, and one with all that media can have: minutes.
#[test]
#[ignore = "minutes: the command is in TESTING.md"]
fn all_scenes_have_the_bits_of_the_cpu() {
    let Some(device) = adapter::exact_with(Options::default()) else { return };
    let mut all = scenes();
    for coloured in [false, true] {
        let mut desc = crowd::all_at_once(coloured);
        all.push((format!("together {coloured}"), scene(&desc)));
        // Photons start on triangles alone.
        desc.shapes.retain(|s| !matches!(s.kind, ShapeKind::Sphere { .. } | ShapeKind::Disk { .. }));
        all.push((format!("flat {coloured}"), scene(&desc)));
    }
    let starts = [PhotonStart::LIGHTS, DIRECT, surfaces()[0], surfaces()[1]];
    let (mut lit, mut wrong) = (0, Vec::new());
    for (name, scene) in all {
        let (some, differing) = compare(&device, &scene, &jobs(&scene, &starts, &SEQUENCES));
        lit += some;
        println!("{name}: {} differ", differing.len());
        wrong.extend(differing.into_iter().map(|w| format!("{name}: {w}")));
    }
    assert!(lit > 50_000, "{lit}");
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn mistakes_are_noticed() {
    let scene = scene(&plain());
    let cpu = CpuBackend::new(None).unwrap().open(scene.clone()).unwrap();
    let in_order = PhotonJob { start: PhotonStart::LIGHTS, ..job(&scene, Sequence::Sorted, 0..1) };
    let mut expected = film(&scene, &in_order);
    cpu.illumination(&in_order, &NoControl, &mut expected).unwrap();
    for (module, from, to) in [
        ("wavefront::photons::order", "if sum < chance", "if sum >= chance"),
        ("wavefront::photons::order", "places[order_digit(key)] = place + 1u;", "places[0] = place + 1u;"),
        ("geometry::hilbert", "corner ^= hilbert_rotate_left", "corner = hilbert_rotate_left"),
        (
            "transport::photon::replicate",
            "photon_rounded(digits53, 29u, false)",
            "photon_rounded(digits53 + vec2(1u << 29u, 0u), 29u, false)",
        ),
        ("transport::photon", "carried / math_max_number", "0.9f * carried / math_max_number"),
        ("wavefront::photons", "photon.hits > 0u || photon.registers_first", "true"),
    ] {
        let mutations = vec![Mutation { module, from, to }];
        let Some(device) = adapter::exact_with(Options { mutations, ..Options::default() }) else { return };
        let session = device.open(scene.clone()).unwrap();
        let mut found = film(&scene, &in_order);
        // A sort that has gone wrong may name photons that are not there, and a device says so.
        if session.illumination(&in_order, &NoControl, &mut found).is_ok() {
            assert_ne!(found, expected, "{module}: {from}");
        }
    }
}

#[test]
fn any_split_of_replicates_merges_to_the_same_bits() {
    let Some(device) = adapter::backend() else { return };
    let scene = scene(&plain());
    let session = device.open(scene.clone()).unwrap();
    let run = |replicates: Range<u32>| {
        let job = job(&scene, Sequence::Sorted, replicates);
        let mut film = film(&scene, &job);
        session.illumination(&job, &NoControl, &mut film).unwrap();
        film
    };
    let whole = run(0..4);
    for cut in [1, 3] {
        let mut parts = run(cut..4);
        parts.merge(&run(0..cut)).unwrap();
        assert_eq!(parts, whole, "{cut}");
    }
}

#[test]
fn waves_may_be_many() {
    // More photons than a software device walks at a time.
    let Some(device) = adapter::exact_with(Options::default()) else { return };
    let scene = scene(&plain());
    let many = |sequence| PhotonJob { photons: 1 << 16, max_hits: 3, ..job(&scene, sequence, 0..1) };
    let (lit, wrong) = compare(&device, &scene, &[many(Sequence::Sobol), many(Sequence::Sorted)]);
    assert!(lit > 50 && wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn a_cancelled_job_leaves_the_film_as_it_was() {
    let Some(device) = adapter::backend() else { return };
    let scene = scene(&plain());
    let session = device.open(scene.clone()).unwrap();
    for sequence in [Sequence::Sobol, Sequence::Sorted] {
        let mut film = film(&scene, &job(&scene, sequence, 0..1));
        session.illumination(&job(&scene, sequence, 0..1), &NoControl, &mut film).unwrap();
        let before = film.clone();
        for calls in [1, 3] {
            let found = session.illumination(&job(&scene, sequence, 1..9), &After::calls(calls), &mut film);
            assert!(matches!(found, Err(BackendError::Cancelled)), "{found:?}");
            assert_eq!(film, before);
        }
    }
}

#[test]
fn a_task_never_waits() {
    let Some(device) = adapter::backend() else { return };
    let scene = scene(&plain());
    let session = device.open_scene(scene.clone()).unwrap();
    let job = job(&scene, Sequence::Sorted, 0..3);
    let mut task = session.illumination_task(&job).unwrap();
    let last = never_wait(|| task.step(false));
    assert!(last == 3 * u64::from(job.photons));
    let mut by_job = film(&scene, &job);
    session.illumination(&job, &NoControl, &mut by_job).unwrap();
    assert_eq!(task.finish().0, by_job);
}

#[test]
fn what_does_not_fit_is_an_error() {
    let limits = wgpu::Limits { max_storage_buffer_binding_size: 1 << 14, ..Default::default() };
    let Some(small) = adapter::backend_with(Options { limits: Some(limits), ..Default::default() }) else {
        return;
    };
    let scene = scene(&plain());
    let session = small.open(scene.clone()).unwrap();
    let job = job(&scene, Sequence::Sobol, 0..1);
    let mut none = film(&scene, &job);
    let found = session.illumination(&job, &NoControl, &mut none);
    assert!(matches!(found, Err(BackendError::LimitExceeded { .. })), "{found:?}");
    let odd = PhotonJob { photons: 1000, ..job.clone() };
    let found = session.illumination(&odd, &NoControl, &mut none);
    assert!(matches!(found, Err(BackendError::BadJob { .. })), "{found:?}");
    let other = PhotonJob { seed: 1, ..job.clone() };
    let mut other = Film::clone(&film(&scene, &other));
    let found = session.illumination(&job, &NoControl, &mut other);
    assert!(matches!(found, Err(BackendError::Film(_))), "{found:?}");
}
