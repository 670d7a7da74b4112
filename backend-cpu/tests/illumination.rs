//! Illumination maps by photons from the lights: closed forms, the path tracer, and the bits.

#![allow(clippy::disallowed_methods, reason = "truth in f64")]

mod rooms;

use etendue_core::backend::{
    BackendError, Control, NoControl, PathJob, PhotonJob, PhotonStart, Probe, Session, direct_film_settings,
    illumination_film_settings, probe_film_settings,
};
use etendue_core::film::Film;
use etendue_core::illumination::{Basis, ElementSettings, Elements, Sides};
use etendue_core::scene::{LightDesc, SceneDesc, ShapeKind};
use etendue_core::transport::first_shot::{FirstShotError, Subdivision, Weights};
use etendue_core::transport::photon::Sequence;
use etendue_cpu::CpuSession;
use rooms::{diffuse, room, session, shape};
use std::ops::ControlFlow;

/// The room with a box, a sphere, a lamp and three lights without size, all colours different.
fn furnished() -> SceneDesc {
    let mut desc = room([0.6, 0.5, 0.3], [0.0; 3]);
    desc.materials.push(diffuse("lamp", [0.2; 3], [4.0, 5.0, 6.0]));
    desc.materials.push(diffuse("dark", [0.1, 0.2, 0.7], [0.0; 3]));
    desc.shapes.push(shape(
        ShapeKind::Rectangle { center: [0.2, 0.97, 0.1], u: [0.0, 0.0, 0.2], v: [0.3, 0.0, 0.0] },
        "lamp",
    ));
    desc.shapes.push(shape(ShapeKind::Box { min: [-0.7, -0.99, -0.6], max: [-0.2, -0.3, 0.0] }, "dark"));
    desc.shapes.push(shape(ShapeKind::Sphere { center: [0.5, -0.6, 0.4], radius: 0.3 }, "x+"));
    desc.lights.push(LightDesc::Point { position: [-0.4, 0.5, 0.5], intensity: [1.0, 0.8, 0.6] });
    desc.lights.push(LightDesc::Spot {
        position: [0.6, 0.7, -0.5],
        direction: [-0.5, -1.0, 0.3],
        intensity: [3.0, 3.0, 2.0],
        cone_deg: 35.0,
        falloff_deg: 20.0,
    });
    desc
}

fn elements(session: &CpuSession) -> Elements {
    Elements::new(session.scene(), ElementSettings::default())
}

fn element_areas(session: &CpuSession) -> Vec<f32> {
    let elements = elements(session);
    (0..elements.count()).map(|i| elements.area(i)).collect()
}

fn empty_map(session: &CpuSession, job: &PhotonJob) -> Film {
    let elements = Elements::new(session.scene(), job.elements);
    Film::new(illumination_film_settings(session.scene(), &elements, job).unwrap())
}

fn map(session: &CpuSession, job: &PhotonJob) -> Film {
    let mut film = empty_map(session, job);
    let stats = session.illumination(job, &NoControl, &mut film).unwrap();
    let photons = u64::from(job.photons) * u64::from(job.replicates.end - job.replicates.start);
    assert!(stats.paths == photons && stats.rays > 0);
    assert_eq!((film.invalid(), film.saturated()), (0, 0));
    film
}

const JOB: PhotonJob = PhotonJob {
    seed: 3,
    photons: 1 << 14,
    replicates: 0..16,
    max_hits: u32::MAX,
    start: PhotonStart::Lights { registers_direct: true, survives_first: false },
    sequence: Sequence::Sobol,
    elements: ELEMENTS,
};

/// Absorbed by chance at every hit, direct light not counted.
const LIGHTS: PhotonStart = PhotonStart::Lights { registers_direct: false, survives_first: false };

const ELEMENTS: ElementSettings =
    ElementSettings { basis: Basis::Constant, sides: Sides::Together, largest: f32::INFINITY };

const SEQUENCES: [Sequence; 3] = [Sequence::Random, Sequence::Sobol, Sequence::Sorted];

fn on_surfaces(subdivision: Subdivision, weights: Weights) -> PhotonStart {
    PhotonStart::Surfaces { subdivision, weights }
}

#[test]
fn a_glowing_room_has_the_same_irradiance_everywhere() {
    for (rho, sequence) in [0.0_f32, 0.5, 0.9].into_iter().flat_map(|r| SEQUENCES.map(|s| (r, s))) {
        let session = session(&room([rho; 3], [1.0, 2.0, 0.5]), None);
        let film = map(&session, &PhotonJob { sequence, ..JOB });
        let truth = std::f64::consts::PI / (1.0 - f64::from(rho));
        for element in 0..film.len() {
            let (mean, error) = (film.mean(element), film.standard_error(element).unwrap());
            for (c, scale) in [1.0, 2.0, 0.5].into_iter().enumerate() {
                let z = (mean[c] - scale * truth).abs() / error[c];
                // Sixteen replicates, 12 triangles, 3 rooms, 3 sequences: Student's t at alpha = 1e-4 altogether.
                assert!(z <= 7.3, "rho {rho}, element {element}: {} against {}", mean[c], scale * truth);
                assert!(error[c] <= 0.02 * scale * truth, "rho {rho}: {}", error[c]);
            }
        }
    }
}

/// Mean and standard error of the flux that arrives, from replicates: elements are not independent.
fn arriving_flux(session: &CpuSession, job: &PhotonJob) -> [(f64, f64); 3] {
    let areas = element_areas(session);
    let mut totals = Vec::new();
    for r in job.replicates.clone() {
        let film = map(session, &PhotonJob { replicates: r..r + 1, ..job.clone() });
        let flux = [0, 1, 2]
            .map(|c| areas.iter().enumerate().map(|(i, a)| film.mean(i)[c] * f64::from(*a)).sum::<f64>());
        totals.push(flux);
    }
    let n = totals.len() as f64;
    [0, 1, 2].map(|c| {
        let mean = totals.iter().map(|t| t[c]).sum::<f64>() / n;
        let variance = totals.iter().map(|t| (t[c] - mean).powi(2)).sum::<f64>() / (n - 1.0) / n;
        (mean, variance.sqrt())
    })
}

#[test]
fn flux_is_conserved_bounce_by_bounce() {
    let mut desc = room([0.7, 0.4, 0.1], [0.0; 3]);
    desc.lights.push(LightDesc::Point { position: [0.3, 0.2, -0.4], intensity: [1.0, 1.0, 2.0] });
    let session = session(&desc, None);
    let emitted = [1.0, 1.0, 2.0].map(|i| 4.0 * std::f64::consts::PI * i);
    let albedo = [0.7_f64, 0.4, 0.1];
    for registers_direct in [true, false] {
        for max_hits in [1, 2, 3, u32::MAX] {
            let job = PhotonJob {
                start: PhotonStart::Lights { registers_direct, survives_first: false },
                max_hits,
                ..JOB
            };
            let found = arriving_flux(&session, &job);
            for c in 0..3 {
                let from = u32::from(!registers_direct);
                // Sum of albedo^k from the first registered arrival to the last.
                let last = max_hits.min(200);
                let truth: f64 = (from..last).map(|k| emitted[c] * albedo[c].powi(k as i32)).sum();
                let (mean, error) = found[c];
                assert!(
                    (mean - truth).abs() <= 6.2 * error + 2e-6 * truth.max(emitted[c]),
                    "direct {registers_direct}, hits {max_hits}, channel {c}: {mean} +- {error}, truth {truth}"
                );
                assert!(error <= 0.02 * emitted[c]);
            }
        }
    }
}

/// Irradiance averaged over a triangle by the path tracer: mean and standard error per channel, from probes spread over it.
fn by_paths(session: &CpuSession, element: u32, max_depth: u32) -> [(f64, f64); 3] {
    let scene = session.scene();
    let v = scene.primitives().vertices(element).unwrap();
    let normal = scene.surfaces[element as usize].normal;
    let side = 16;
    let mut probes = Vec::new();
    // Points of a grid folded into the triangle, shifted off its cells' corners.
    for i in 0..side * side {
        let (mut a, mut b) = (
            ((i % side) as f32 + 0.37) / side as f32,
            ((i / side) as f32 + ((i * 7 % side) as f32 + 0.5) / side as f32) / side as f32,
        );
        if a + b > 1.0 {
            (a, b) = (1.0 - a, 1.0 - b);
        }
        let p = v[0] + (v[1] - v[0]) * a + (v[2] - v[0]) * b;
        probes.push(Probe { position: p.to_array(), normal });
    }
    let job = PathJob { seed: 5, block_length: 256, blocks: 0..4, max_depth };
    let mut film = Film::new(probe_film_settings(scene, &job, probes.len()));
    session.path_probes(&job, &probes, &NoControl, &mut film).unwrap();
    let n = probes.len() as f64;
    [0, 1, 2].map(|c| {
        let mean = (0..probes.len()).map(|i| film.mean(i)[c]).sum::<f64>() / n;
        let variance = (0..probes.len()).map(|i| film.variance(i).unwrap()[c]).sum::<f64>() / (n * n);
        (mean, variance.sqrt())
    })
}

#[test]
fn photons_and_paths_agree_on_a_furnished_room() {
    let session = session(&furnished(), None);
    let film = map(&session, &PhotonJob { photons: 1 << 16, ..JOB });
    let areas = element_areas(&session);
    // The walls: triangles that are seen from one side alone. Their integral over a grid of points is good to 1 %.
    for (element, area) in areas.iter().enumerate().take(12) {
        assert!(*area > 1.9);
        let (mean, error) = (film.mean(element), film.standard_error(element).unwrap());
        for (c, (truth, noise)) in by_paths(&session, element as u32, u32::MAX).into_iter().enumerate() {
            let allowed = 4.5 * error[c].hypot(noise) + 0.01 * truth;
            assert!(
                (mean[c] - truth).abs() <= allowed,
                "element {element}, channel {c}: {} by photons, {truth} by paths, {allowed} allowed",
                mean[c]
            );
        }
    }
}

/// The furnished room without its sphere: photons start on triangles.
fn flat_furnished() -> SceneDesc {
    let mut desc = furnished();
    desc.shapes.retain(|s| !matches!(s.kind, ShapeKind::Sphere { .. }));
    desc
}

#[test]
fn pairs_reflect_what_lights_send() {
    let session = session(&flat_furnished(), None);
    let scene = session.scene();
    // The flux that leaves after the first hit, counted at the surfaces.
    let job = PathJob { seed: 1, block_length: 256, blocks: 0..16, max_depth: 1 };
    let mut film = Film::new(direct_film_settings(scene, &elements(&session), &job));
    session.direct_irradiance(&job, &ELEMENTS, &NoControl, &mut film).unwrap();
    let areas = element_areas(&session);
    let (mut truth, mut variance) = ([0.0_f64; 3], [0.0_f64; 3]);
    for (i, area) in areas.iter().enumerate() {
        let albedo = scene.material_of(i as u32).albedo;
        let (mean, var) = (film.mean(i), film.variance(i).unwrap());
        for c in 0..3 {
            let k = f64::from(*area) * f64::from(albedo[c]);
            truth[c] += k * mean[c];
            variance[c] += k * k * var[c];
        }
    }
    for (subdivision, tolerance) in [
        (Subdivision::robust(Weights::Density), 0.005),
        (Subdivision::published(), 0.05),
        (Subdivision::None, 0.7),
    ] {
        let shot = session.first_shot(&subdivision, Weights::Density).unwrap();
        let (found, truth) = (shot.reflected(), truth.iter().sum::<f64>() / 3.0);
        let allowed = tolerance * truth + 4.5 * variance.iter().sum::<f64>().sqrt();
        assert!((found - truth).abs() <= allowed, "{subdivision:?}: {found} of {truth}, {allowed} allowed");
        assert!(shot.survival() > 0.2 && shot.survival() < 0.6 && shot.pairs() >= 24, "{}", shot.survival());
    }
}

#[test]
fn photons_from_surfaces_and_from_lights_agree() {
    let session = session(&flat_furnished(), None);
    let job = PhotonJob { photons: 1 << 16, start: LIGHTS, ..JOB };
    let lights = map(&session, &job);
    let surfaces = map(
        &session,
        &PhotonJob {
            seed: 9,
            start: on_surfaces(Subdivision::robust(Weights::Density), Weights::Density),
            ..job
        },
    );
    for element in 0..12 {
        let (a, b) = (lights.mean(element), surfaces.mean(element));
        let (da, db) = (lights.standard_error(element).unwrap(), surfaces.standard_error(element).unwrap());
        for c in 0..3 {
            // The density is piecewise linear: 2 % for what it misses.
            let allowed = 4.5 * da[c].hypot(db[c]) + 0.02 * a[c];
            assert!(
                (a[c] - b[c]).abs() <= allowed,
                "element {element}: {} from lights, {} from surfaces",
                a[c],
                b[c]
            );
        }
    }
    // With one arrival a photon, that on the surface where it starts is the one, and it does not count; what is left is the lamp's.
    let once = |start| map(&session, &PhotonJob { max_hits: 1, replicates: 0..4, start, ..JOB });
    let surfaces_once = once(on_surfaces(Subdivision::robust(Weights::Density), Weights::Density));
    let lights_once = once(LIGHTS);
    let total = |film: &Film| (0..12).map(|i| film.mean(i)[0]).sum::<f64>();
    assert!((total(&surfaces_once) / total(&lights_once) - 1.0).abs() < 0.05);
    // The same number of photons says more when none is lost at the first hit.
    let noise =
        |film: &Film| (0..12).map(|i| film.variance(i).unwrap()[1] / film.mean(i)[1].powi(2)).sum::<f64>();
    assert!(noise(&surfaces) < noise(&lights), "{} {}", noise(&surfaces), noise(&lights));
}

#[test]
fn photons_start_on_triangles_only() {
    let session = session(&furnished(), None);
    let job = PhotonJob { start: on_surfaces(Subdivision::None, Weights::EXACT), ..JOB };
    let mut film = empty_map(&session, &job);
    let error = session.illumination(&job, &NoControl, &mut film).unwrap_err();
    assert_eq!(error, BackendError::FirstShot(FirstShotError::RoundShapes { count: 1 }));
}

#[test]
fn bits_depend_on_neither_threads_nor_splits() {
    let desc = furnished();
    let whole = map(&session(&desc, Some(1)), &PhotonJob { replicates: 0..4, ..JOB });
    let three = session(&desc, Some(3));
    assert!(map(&three, &PhotonJob { replicates: 0..4, ..JOB }) == whole);
    let mut late = map(&three, &PhotonJob { replicates: 2..4, ..JOB });
    late.merge(&map(&three, &PhotonJob { replicates: 0..2, ..JOB })).unwrap();
    assert!(late == whole);
    assert!(map(&three, &PhotonJob { seed: 4, replicates: 0..4, ..JOB }) != whole);
    let desc = flat_furnished();
    let (one, three) = (session(&desc, Some(1)), session(&desc, Some(3)));
    for sequence in SEQUENCES {
        for start in [LIGHTS, on_surfaces(Subdivision::robust(Weights::EXACT), Weights::EXACT)] {
            let elements = ElementSettings { basis: Basis::Linear, sides: Sides::Apart, largest: 0.7 };
            let job = PhotonJob { start, sequence, elements, replicates: 0..2, ..JOB };
            assert!(map(&three, &job) == map(&one, &job), "{sequence:?} {start:?}");
        }
    }
}

#[test]
fn what_cannot_be_done_is_said_and_leaves_the_film() {
    let dark = session(&room([0.5; 3], [0.0; 3]), None);
    assert_eq!(illumination_film_settings(dark.scene(), &elements(&dark), &JOB), Err(BackendError::Dark));
    let lit = session(&furnished(), None);
    let empty = empty_map(&lit, &JOB);
    let mut film = empty.clone();
    assert_eq!(dark.illumination(&JOB, &NoControl, &mut film), Err(BackendError::Dark));
    for bad in [PhotonJob { photons: 1000, ..JOB }, PhotonJob { photons: 1 << 27, ..JOB }] {
        assert!(matches!(lit.illumination(&bad, &NoControl, &mut film), Err(BackendError::BadJob { .. })));
    }
    let other = PhotonJob { seed: 9, ..JOB };
    assert!(matches!(lit.illumination(&other, &NoControl, &mut film), Err(BackendError::Film(_))));
    struct Stop;
    impl Control for Stop {
        fn advance(&self, done: u64, _: u64) -> ControlFlow<()> {
            if done > 100_000 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        }
    }
    assert_eq!(lit.illumination(&JOB, &Stop, &mut film), Err(BackendError::Cancelled));
    assert!(film == empty);
}

#[test]
fn variance_falls_at_least_as_one_over_n() {
    // Sobol sets that are reused between start and walk keep their noise at any number of photons.
    let session = session(&flat_furnished(), None);
    let starts = [
        LIGHTS,
        PhotonStart::Lights { registers_direct: true, survives_first: true },
        on_surfaces(Subdivision::robust(Weights::Density), Weights::Density),
        on_surfaces(Subdivision::robust(Weights::EXACT), Weights::EXACT),
    ];
    for (sequence, start) in SEQUENCES.into_iter().flat_map(|s| starts.map(|t| (s, t))) {
        let noise = |photons: u32| {
            let film = map(&session, &PhotonJob { photons, replicates: 0..32, sequence, start, ..JOB });
            let relative = (0..12).map(|i| film.variance(i).unwrap()[1] / film.mean(i)[1].powi(2));
            relative.sum::<f64>()
        };
        let (few, many) = (noise(1 << 8), noise(1 << 14));
        // 1/64 expected at worst; the ratio of two estimates of 12 x 31 degrees of freedom is off by less than 1.5 times.
        assert!(many <= few / 64.0 * 1.5, "{sequence:?} {start:?}: {few} {many}");
    }
}
