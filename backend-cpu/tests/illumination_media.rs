//! Maps of photons in rooms where nothing but the walls absorbs: what arrives at them is known, whatever scatters and refracts between.

#![allow(clippy::disallowed_methods, reason = "truth in f64")]

mod rooms;

use etendue_core::backend::{
    NoControl, PathJob, PhotonJob, PhotonStart, Session, direct_film_settings, illumination_film_settings,
};
use etendue_core::film::Film;
use etendue_core::illumination::{Basis, ElementSettings, Elements, Sides};
use etendue_core::scene::{
    GridDesc, LightDesc, MaterialKind, MediumDesc, Roughness, SceneDesc, ShapeDesc, ShapeKind,
};
use etendue_core::transport::first_shot::{Subdivision, Weights};
use etendue_core::transport::photon::Sequence;
use etendue_cpu::CpuSession;
use rooms::{made_of, mean_and_error, room, session, shape};
use std::f64::consts::PI;

const ELEMENTS: ElementSettings =
    ElementSettings { basis: Basis::Constant, sides: Sides::Together, largest: 0.5 };
const JOB: PhotonJob = PhotonJob {
    seed: 5,
    photons: 1 << 14,
    replicates: 0..16,
    max_hits: u32::MAX,
    start: PhotonStart::Lights { registers_direct: true, survives_first: false },
    sequence: Sequence::Sorted,
    elements: ELEMENTS,
};

/// Things that lose nothing in a room of albedo 0.4: a fog up to the walls, a dense one of colours in a pane's box, glass that disperses, paper.
fn lossless() -> SceneDesc {
    let mut desc = room([0.4; 3], [0.0; 3]);
    desc.lights.push(LightDesc::Point { position: [0.3, 0.2, -0.4], intensity: [1.0, 1.0, 2.0] });
    let filled = |min, max, material: &str, interior: &str| ShapeDesc {
        interior: interior.into(),
        ..shape(ShapeKind::Box { min, max }, material)
    };
    desc.media.push(MediumDesc::new("fog", [0.0; 3], [0.5, 0.3, 0.7], 0.5));
    desc.media.push(MediumDesc::new("milk", [0.0; 3], [1.0, 3.0, 2.0], -0.2));
    let film = MaterialKind::ThinFilm { reflect: [0.2, 0.3, 0.4], transmit: [0.8, 0.7, 0.6] };
    let paper = MaterialKind::ScatteringFilm { reflect: [0.6, 0.5, 0.3], transmit: [0.4, 0.5, 0.7] };
    for (name, kind) in [
        ("none", MaterialKind::Null),
        ("film", film),
        ("paper", paper),
        ("glass", MaterialKind::Dielectric { ior: [1.4, 1.5, 1.6], schlick: false }),
        ("plate", MaterialKind::ThinDielectric { ior: [1.5; 3], schlick: true }),
    ] {
        desc.materials.push(made_of(name, kind));
    }
    desc.shapes.push(filled([-1.0; 3], [1.0; 3], "none", "fog"));
    desc.shapes.push(filled([-0.8, -0.9, 0.1], [-0.3, -0.2, 0.6], "film", "milk"));
    desc.shapes.push(filled([0.1, -0.8, 0.2], [0.6, -0.5, 0.7], "glass", ""));
    let sheet = |center, material| {
        let kind = ShapeKind::Rectangle { center, u: [0.3, 0.0, 0.1], v: [0.0, 0.2, 0.0] };
        shape(kind, material)
    };
    desc.shapes.push(sheet([0.0, 0.5, 0.3], "paper"));
    desc.shapes.push(sheet([0.4, 0.1, 0.1], "plate"));
    desc
}

/// Intensity of the light.
const POINT: [f64; 3] = [1.0, 1.0, 2.0];

/// What arrives at the six walls, per channel.
fn on_walls(film: &Film, elements: &Elements) -> [f64; 3] {
    let walls = 0..(0..12).map(|triangle| elements.cells(triangle) as usize).sum();
    [0, 1, 2].map(|c| walls.clone().map(|i| film.mean(i)[c] * f64::from(elements.area(i))).sum())
}

fn by_photons(session: &CpuSession, job: &PhotonJob, elements: &Elements) -> Vec<[f64; 3]> {
    let one = |replicate| {
        let job = PhotonJob { replicates: replicate..replicate + 1, ..job.clone() };
        let mut film = Film::new(illumination_film_settings(session.scene(), elements, &job).unwrap());
        session.illumination(&job, &NoControl, &mut film).unwrap();
        assert_eq!((film.invalid(), film.saturated()), (0, 0));
        on_walls(&film, elements)
    };
    job.replicates.clone().map(one).collect()
}

/// What is emitted, 4 pi times this, over 1 - rho, with the first arrivals or without them.
#[track_caller]
fn balances(what: &str, emitted: [f64; 3], each: &[[f64; 3]], direct: [f64; 3], allowed: f64) {
    for (c, emitted) in emitted.into_iter().enumerate() {
        let truth = 4.0 * PI * emitted / (1.0 - f64::from(0.4_f32));
        let each: Vec<f64> = each.iter().map(|x| x[c] + direct[c]).collect();
        let (mean, error) = mean_and_error(&each);
        println!(
            "{what}, channel {c}: {:+.3} % +- {:.3} %",
            100.0 * (mean / truth - 1.0),
            100.0 * error / truth
        );
        // Student's t of 16 replicates: once in 10^5 by each.
        assert!(
            (mean - truth).abs() <= 6.5 * error + allowed * truth,
            "{what} {c}: {mean} +- {error}, {truth}"
        );
        assert!(error <= 0.01 * truth, "{what} {c}: {error}");
    }
}

#[test]
fn nothing_is_lost_between_the_walls() {
    let session = session(&lossless(), None);
    let elements = Elements::new(session.scene(), ELEMENTS);
    for sequence in [Sequence::Random, Sequence::Sobol, Sequence::Sorted] {
        let each = by_photons(&session, &PhotonJob { sequence, ..JOB }, &elements);
        balances(&format!("{sequence:?}"), POINT, &each, [0.0; 3], 1e-5);
    }
}

#[test]
fn what_starts_on_surfaces_is_what_comes_straight() {
    let session = session(&lossless(), None);
    let elements = Elements::new(session.scene(), ELEMENTS);
    let path = PathJob { seed: 2, block_length: 4096, blocks: 0..1, max_depth: u32::MAX };
    let mut film = Film::new(direct_film_settings(session.scene(), &elements, &path));
    session.direct_irradiance(&path, &ELEMENTS, &NoControl, &mut film).unwrap();
    let direct = on_walls(&film, &elements);
    // Straight from the light comes less than all, and more than nothing.
    assert!(direct[0] > 2.0 && direct[0] < 0.8 * 4.0 * PI, "{direct:?}");
    for (weights, allowed) in [(Weights::EXACT, 2e-3), (Weights::Density, 0.01)] {
        let start = PhotonStart::Surfaces { subdivision: Subdivision::robust(weights), weights };
        let each = by_photons(&session, &PhotonJob { start, ..JOB }, &elements);
        balances(&format!("{weights:?}"), POINT, &each, direct, allowed);
    }
    let start = PhotonStart::Lights { registers_direct: false, survives_first: true };
    balances("lights", POINT, &by_photons(&session, &PhotonJob { start, ..JOB }, &elements), direct, 2e-3);
}

/// A fire that fills a box but for a ball of fog of higher priority in it, and one on a grid, which emits alike whatever its density.
#[test]
fn media_that_emit_send_photons() {
    let mut desc = lossless();
    desc.lights.clear();
    let fire =
        MediumDesc { emission: [1.0, 2.0, 0.5], ..MediumDesc::new("fire", [0.0; 3], [0.5, 1.0, 2.0], 0.3) };
    let to_world = [[0.5, 0.0, 0.0, 0.4], [0.0, 0.5, 0.0, 0.2], [0.0, 0.0, 0.5, -0.9]];
    let density = GridDesc { size: [2, 1, 1], channels: 1, values: vec![0.0, 3.0], to_world };
    desc.media.push(MediumDesc { name: "cloud".into(), density: Some(density), ..fire.clone() });
    desc.media.push(fire);
    desc.media.push(MediumDesc { priority: 1, ..MediumDesc::new("hole", [0.0; 3], [1.0; 3], 0.0) });
    let filled = |kind, interior: &str| ShapeDesc { interior: interior.into(), ..shape(kind, "none") };
    let (min, max) = ([-0.8, 0.2, -0.8], [0.0, 0.8, -0.2]);
    desc.shapes.push(filled(ShapeKind::Box { min, max }, "fire"));
    desc.shapes.push(filled(ShapeKind::Box { min: [0.4, 0.2, -0.9], max: [0.9, 0.7, -0.4] }, "cloud"));
    desc.shapes.push(filled(ShapeKind::Sphere { center: [-0.4, 0.5, -0.5], radius: 0.2 }, "hole"));
    let session = session(&desc, None);
    let elements = Elements::new(session.scene(), ELEMENTS);
    let volume = 0.8 * 0.6 * 0.6 - 4.0 / 3.0 * PI * 0.2_f64.powi(3) + 0.5_f64.powi(3);
    let each = by_photons(&session, &PhotonJob { photons: 1 << 15, ..JOB }, &elements);
    balances("fire", [1.0, 2.0, 0.5].map(|j| j * volume), &each, [0.0; 3], 1e-5);
}

/// Facets that scatter once lose a part, and pass on what they do not: less than all arrives, the same from the lights and from surfaces.
#[test]
fn rough_glass_is_a_place_to_start() {
    let mut desc = lossless();
    let kind =
        MaterialKind::RoughDielectric { ior: [1.5; 3], schlick: false, roughness: Roughness::Ggx(0.4) };
    desc.materials.iter_mut().find(|m| m.name == "glass").unwrap().kind = kind;
    let session = session(&desc, None);
    let elements = Elements::new(session.scene(), ELEMENTS);
    let job = PhotonJob { photons: 1 << 15, ..JOB };
    let lights = PhotonStart::Lights { registers_direct: false, survives_first: true };
    let weights = Weights::EXACT;
    let surfaces = PhotonStart::Surfaces { subdivision: Subdivision::robust(weights), weights };
    let [a, b] =
        [lights, surfaces].map(|start| by_photons(&session, &PhotonJob { start, ..job.clone() }, &elements));
    for c in 0..3 {
        let of = |each: &[[f64; 3]]| mean_and_error(&each.iter().map(|x| x[c]).collect::<Vec<_>>());
        let ((x, dx), (y, dy)) = (of(&a), of(&b));
        println!("{c}: {x} +- {dx}, {y} +- {dy}");
        assert!((x - y).abs() <= 5.5 * dx.hypot(dy) + 1e-3 * x, "{c}: {x} +- {dx}, {y} +- {dy}");
    }
}
