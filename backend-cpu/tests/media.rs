//! Light in participating media against what is known of it.

#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use etendue_core::backend::{
    BidirectionalJob, NoControl, PathJob, Probe, Session, image_film_settings, probe_film_settings,
};
use etendue_core::film::Film;
use etendue_core::sampling::counter::Counter;
use etendue_core::scene::{
    CameraDesc, EnvironmentDesc, EnvironmentImage, GridDesc, LightDesc, MaterialDesc, MaterialKind,
    MediumDesc, Reflectance, SceneDesc, ShapeDesc, ShapeKind, compile,
};
use etendue_core::transport::bidirectional::Heuristic;
use etendue_core::transport::volume::{Rule, SingleScatter};
use etendue_cpu::{CpuBackend, CpuSession};
use std::sync::Arc;

/// Standard errors that a result may be off; one of the 150 comparisons here exceeds them by chance once in 400 runs of other seeds.
const LIMIT: f64 = 4.5;

/// A grey medium of this extinction and albedo.
fn grey(name: &str, sigma_t: f32, albedo: f32, g: f32) -> MediumDesc {
    MediumDesc::new(name, [sigma_t * (1.0 - albedo); 3], [sigma_t * albedo; 3], g)
}

fn material(name: &str, kind: MaterialKind, emission: f32) -> MaterialDesc {
    MaterialDesc { name: name.into(), kind, two_sided: true, emission: [emission; 3] }
}

fn black(name: &str, emission: f32) -> MaterialDesc {
    material(name, MaterialKind::Diffuse { albedo: Reflectance::flat([0.0; 3]) }, emission)
}

fn shape(kind: ShapeKind, material: &str, interior: &str) -> ShapeDesc {
    ShapeDesc { kind, material: material.into(), interior: interior.into(), exterior: String::new() }
}

fn sphere(center: [f32; 3], radius: f32, material: &str, interior: &str) -> ShapeDesc {
    shape(ShapeKind::Sphere { center, radius }, material, interior)
}

fn open(desc: &SceneDesc) -> CpuSession {
    let (scene, report) = compile(desc).unwrap();
    assert!(report.cleanups.is_empty(), "{report:?}");
    CpuBackend::new(None).unwrap().open_session(Arc::new(scene)).unwrap()
}

fn job(blocks: u32, max_depth: u32) -> PathJob {
    PathJob { seed: 5, block_length: 256, blocks: 0..blocks, max_depth }
}

/// Mean and standard error per channel.
type Found = ([f64; 3], [f64; 3]);

fn result(film: &Film) -> Found {
    assert_eq!(film.invalid(), 0);
    (film.mean(0), film.variance(0).unwrap().map(|v| v.max(0.0).sqrt()))
}

fn irradiance(desc: &SceneDesc, position: [f32; 3], normal: [f32; 3], job: &PathJob) -> Found {
    let session = open(desc);
    let mut film = Film::new(probe_film_settings(session.scene(), job, 1));
    session.path_probes(job, &[Probe { position, normal }], &NoControl, &mut film).unwrap();
    result(&film)
}

/// A camera of one narrow pixel.
fn sight(from: [f32; 3], to: [f32; 3], medium: &str) -> CameraDesc {
    let along = [0, 1, 2].map(|k| (to[k] - from[k]).abs());
    let up = if along[1] > along[0] + along[2] { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    CameraDesc {
        position: from,
        look_at: to,
        up,
        fov_x_deg: 0.05,
        resolution: [1, 1],
        lens_radius: 0.0,
        focus_distance: 1.0,
        medium: medium.into(),
    }
}

/// Radiance of a ray.
fn radiance(desc: &SceneDesc, from: [f32; 3], to: [f32; 3], medium: &str, job: &PathJob) -> Found {
    let session = open(&SceneDesc { camera: Some(sight(from, to, medium)), ..desc.clone() });
    let mut film = Film::new(image_film_settings(session.scene(), job).unwrap());
    session.path_image(job, &NoControl, &mut film).unwrap();
    result(&film)
}

/// All channels agree with their truths, and are known well enough for that to mean something.
fn agrees(what: &str, (mean, stderr): Found, truth: [f64; 3], relative: f64) {
    for c in 0..3 {
        let z = (mean[c] - truth[c]).abs() / (stderr[c] + 5e-6 * truth[c].abs() + 1e-30);
        assert!(z <= LIMIT, "{what}: {} against {}, {z:.1} standard errors", mean[c], truth[c]);
        assert!(stderr[c] <= relative * truth[c].abs(), "{what}: standard error {}", stderr[c]);
    }
}

/// A slab of thickness 1 from y = 0 to 1 (or deeper), wide enough to be without end.
fn slab(tau: f32, albedo: f32, g: f32) -> SceneDesc {
    let wide = 300.0;
    SceneDesc {
        materials: vec![material("boundary", MaterialKind::Null, 0.0), black("lamp", 1.0)],
        media: vec![grey("slab", tau, albedo, g)],
        shapes: vec![shape(
            ShapeKind::Box { min: [-wide, 0.0, -wide], max: [wide, 1.0, wide] },
            "boundary",
            "slab",
        )],
        ..SceneDesc::default()
    }
}

fn beam(mu0: f32) -> LightDesc {
    LightDesc::Directional { direction: [(1.0 - mu0 * mu0).sqrt(), -mu0, 0.0], irradiance: [1.0; 3] }
}

const DOWN: [f32; 3] = [0.0, -1.0, 0.0];

#[test]
fn airlight_of_a_lamp_in_fog_is_its_closed_form() {
    // beta, D, gamma, length of the view ray; L. B. Sun et al., SIGGRAPH 2005.
    for (beta, d, gamma, length, truth) in
        [(0.3, 5.0, 0.4_f32, 20.0, 0.003_812_517_006), (0.1, 10.0, 1.2, 8.0, 0.000_183_160_246)]
    {
        let desc = SceneDesc {
            materials: vec![black("wall", 0.0)],
            media: vec![grey("fog", beta, 1.0, 0.0)],
            shapes: vec![shape(
                ShapeKind::Disk { center: [0.0, 0.0, length], normal: [0.0, 0.0, -1.0], radius: 1.0 },
                "wall",
                "",
            )],
            lights: vec![LightDesc::Point {
                position: [d * gamma.sin(), 0.0, d * gamma.cos()],
                intensity: [1.0; 3],
            }],
            ..SceneDesc::default()
        };
        let found = radiance(&desc, [0.0; 3], [0.0, 0.0, 1.0], "fog", &job(512, 2));
        agrees("airlight", found, [truth; 3], 0.01);
    }
}

#[test]
fn lamps_shine_through_the_boundaries_of_fog() {
    // A wall lit through an absorbing ball, by a lamp beyond it and by one within it.
    let ball = |light: [f32; 3]| SceneDesc {
        materials: vec![material("boundary", MaterialKind::Null, 0.0), black("wall", 0.0)],
        media: vec![MediumDesc::new("dark", [0.2, 0.5, 2.0], [0.0; 3], 0.0)],
        shapes: vec![sphere([0.0; 3], 1.0, "boundary", "dark"), sphere([0.0, 0.0, 9.0], 1.0, "wall", "")],
        lights: vec![LightDesc::Point { position: light, intensity: [1.0; 3] }],
        ..SceneDesc::default()
    };
    for (light, inside) in [([0.0, 0.0, -4.0], 2.0), ([0.0, 0.0, 0.5], 0.5), ([0.0, 0.0, 3.0], 0.0)] {
        let found = irradiance(&ball(light), [0.0, 0.0, 7.0], [0.0, 0.0, -1.0], &job(2, u32::MAX));
        let d2 = f64::from(7.0 - light[2]).powi(2);
        agrees("lamp", found, [0.2_f64, 0.5, 2.0].map(|s| (-s * inside).exp() / d2), 1e-5);
    }
    // Straight through boundaries is no edge: a lamp is seen beyond three balls at --max-depth 1.
    let mut row = SceneDesc {
        materials: vec![material("boundary", MaterialKind::Null, 0.0), black("lamp", 3.0)],
        media: vec![MediumDesc::new("dark", [0.2, 0.5, 2.0], [0.0; 3], 0.0)],
        shapes: vec![sphere([0.0, 0.0, 9.0], 1.0, "lamp", "")],
        ..SceneDesc::default()
    };
    for z in [0.0, 1.0, 3.5] {
        // The first two overlap: the same medium twice is the same medium.
        row.shapes.push(sphere([0.0, 0.0, z], 1.0, "boundary", "dark"));
    }
    let found = radiance(&row, [0.0, 0.0, -5.0], [0.0, 0.0, 0.0], "", &job(2048, 1));
    agrees("row", found, [0.2_f64, 0.5, 2.0].map(|s| 3.0 * (-5.0 * s).exp()), 0.2);
    let nothing = radiance(&row, [0.0, 0.0, -5.0], [0.0, 0.0, 0.0], "", &job(2, 0));
    assert_eq!(nothing.0, [0.0; 3]);
}

/// Volumes that touch, and one that fills a room up to its walls: nothing is missed and nothing leaks.
#[test]
fn boundaries_that_lie_upon_each_other_are_all_crossed() {
    let sigma = [0.2_f32, 0.5, 2.0];
    let cube =
        |min: [f32; 3], max: [f32; 3], medium: &str| shape(ShapeKind::Box { min, max }, "boundary", medium);
    // A row of three cubes of two media, face to face, then a lamp whose face is the last one's.
    let row = SceneDesc {
        materials: vec![material("boundary", MaterialKind::Null, 0.0), black("lamp", 1.0)],
        media: vec![
            MediumDesc::new("a", sigma, [0.0; 3], 0.0),
            MediumDesc::new("b", sigma.map(|s| 0.5 * s), [0.0; 3], 0.0),
        ],
        shapes: vec![
            cube([-1.0, -1.0, 0.0], [1.0, 1.0, 1.0], "a"),
            cube([-1.0, -1.0, 1.0], [1.0, 1.0, 2.0], "b"),
            cube([-1.0, -1.0, 2.0], [1.0, 1.0, 3.0], "a"),
            shape(
                ShapeKind::Rectangle { center: [0.0, 0.0, 3.0], u: [0.0, 1.0, 0.0], v: [1.0, 0.0, 0.0] },
                "lamp",
                "",
            ),
        ],
        ..SceneDesc::default()
    };
    let truth = sigma.map(|s| (-2.5 * f64::from(s)).exp());
    for at in [[0.3, 0.2], [0.0, 0.0], [0.5, 0.5]] {
        let (from, to) = ([at[0], at[1], -2.0], [at[0], at[1], 0.0]);
        agrees("row", radiance(&row, from, to, "", &job(2048, u32::MAX)), truth, 0.2);
        // From within the second cube, where nothing says so.
        let within = radiance(&row, [at[0], at[1], 1.5], [at[0], at[1], 2.0], "", &job(1024, u32::MAX));
        agrees("within", within, sigma.map(|s| (-1.25 * f64::from(s)).exp()), 0.2);
    }
    // A room filled with what emits and absorbs, its walls of radiance 1: light of a room in equilibrium. A leak would be dark.
    let mut fog = MediumDesc::new("fog", [0.5, 1.0, 2.0], [1.0; 3], 0.3);
    fog.emission = fog.sigma_a;
    for wall_first in [true, false] {
        let wall = |center: [f32; 3], u: [f32; 3], v: [f32; 3]| {
            shape(ShapeKind::Rectangle { center, u, v }, "wall", "")
        };
        let mut shapes = vec![
            wall([0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]),
            wall([0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
            wall([0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
            wall([0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]),
            wall([1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]),
            wall([-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]),
        ];
        shapes.insert(if wall_first { 6 } else { 0 }, cube([-1.0; 3], [1.0; 3], "fog"));
        let room = SceneDesc {
            materials: vec![material("boundary", MaterialKind::Null, 0.0), black("wall", 1.0)],
            media: vec![fog.clone()],
            shapes,
            ..SceneDesc::default()
        };
        for to in [[1.0, 0.3, 0.2], [0.1, -1.0, 0.4], [-0.3, 0.2, 1.0]] {
            let found = radiance(&room, [0.1, 0.2, 0.0], to, "", &job(64, u32::MAX));
            agrees("room", found, [1.0; 3], 0.01);
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let desc = SceneDesc { lights: vec![beam(0.8)], ..slab(2.0, 0.9, 0.5) };
    let (scene, _) = compile(&desc).unwrap();
    let scene = Arc::new(scene);
    let run = |threads: usize, parts: &[std::ops::Range<u32>]| {
        let session = CpuBackend::new(Some(threads)).unwrap().open_session(scene.clone()).unwrap();
        let all = PathJob { blocks: 0..4, ..job(4, u32::MAX) };
        let probes: Vec<Probe> =
            (0..9).map(|i| Probe { position: [0.1 * i as f32, 1.1, 0.0], normal: DOWN }).collect();
        let mut film = Film::new(probe_film_settings(session.scene(), &all, probes.len()));
        for blocks in parts {
            let job = PathJob { blocks: blocks.clone(), ..all.clone() };
            session.path_probes(&job, &probes, &NoControl, &mut film).unwrap();
        }
        (0..9).map(|i| film.mean(i).map(f64::to_bits)).collect::<Vec<_>>()
    };
    let one = run(1, &[0..2, 2..4]);
    assert_eq!(one, run(2, &[0..1, 1..4]));
    assert_eq!(one, run(5, &[2..4, 0..2]));
}

/// Whatever lies in whatever, with media of any strength: numbers come out, and come out soon.
#[test]
fn soups_of_media_give_numbers() {
    let numbers = Counter::new(77);
    for seed in 0..150 {
        let mut at = 0;
        let mut unit = || {
            at += 1;
            numbers.unit(seed, at, 0)
        };
        let kinds = [
            MaterialKind::Null,
            MaterialKind::Dielectric { ior: [1.5, 1.4, 1.6], schlick: false },
            MaterialKind::Dielectric { ior: [0.7; 3], schlick: true },
            MaterialKind::ThinDielectric { ior: [1.5; 3], schlick: false },
            MaterialKind::ThinFilm { reflect: [0.3, 0.0, 1.0], transmit: [0.7, 0.0, 0.0] },
            MaterialKind::Conductor { eta: [0.2, 0.9, 1.1], k: [3.9, 2.4, 2.2] },
            MaterialKind::Mirror { albedo: Reflectance::flat([1.0; 3]) },
            MaterialKind::Diffuse { albedo: Reflectance::flat([0.8; 3]) },
        ];
        let mut materials: Vec<_> =
            kinds.into_iter().enumerate().map(|(i, k)| material(&format!("m{i}"), k, 0.0)).collect();
        materials.push(black("lamp", 3.0));
        let media: Vec<_> = (0..4)
            .map(|i| {
                let mut sigma =
                    || [0; 3].map(|_| if unit() < 0.3 { 0.0 } else { 10_f32.powf(12.0 * unit() - 6.0) });
                let (a, s) = (sigma(), sigma());
                let mut m = MediumDesc::new(&format!("n{i}"), a, s, 1.98 * unit() - 0.99);
                m.priority = (3.0 * unit()) as i32;
                m.emission = if unit() < 0.3 { [0.1; 3] } else { [0.0; 3] };
                m
            })
            .collect();
        // Coordinates of a coarse lattice: faces lie upon each other.
        let mut lattice = |n: f32| (n * unit()).floor() * 0.5 - 1.0;
        let shapes = (0..8)
            .map(|i| {
                let low = [0; 3].map(|_| lattice(4.0));
                let size = 0.5 + 0.5 * (lattice(3.0) + 1.0);
                let kind = if i % 3 == 0 {
                    ShapeKind::Sphere { center: low, radius: size }
                } else {
                    ShapeKind::Box { min: low, max: low.map(|x| x + size) }
                };
                let name = |prefix: &str, k: f32, none: usize| {
                    if k as usize >= none { String::new() } else { format!("{prefix}{}", k as usize) }
                };
                ShapeDesc {
                    kind,
                    material: if i == 7 { "lamp".into() } else { name("m", 2.0 * (lattice(8.0) + 1.0), 8) },
                    interior: name("n", 2.0 * (lattice(6.0) + 1.0), 4),
                    exterior: name("n", 2.0 * (lattice(12.0) + 1.0), 4),
                }
            })
            .collect();
        let lights = vec![
            LightDesc::Environment(EnvironmentDesc::uniform([0.5; 3])),
            LightDesc::Point { position: [0.1, 1.3, -0.2], intensity: [1.0; 3] },
            beam(0.7),
        ];
        let desc = SceneDesc { materials, media, shapes, lights, ..SceneDesc::default() };
        let few = PathJob { seed: 1, block_length: 16, blocks: 0..2, max_depth: u32::MAX };
        let (mean, stderr) = radiance(&desc, [0.05, 0.3, -4.0], [0.0; 3], "", &few);
        assert!(mean.iter().chain(&stderr).all(|x| x.is_finite() && *x >= 0.0), "{seed}: {mean:?}");
        let rule = [Rule::Trapezoid, Rule::PlainTrapezoid, Rule::Equiangular][seed as usize % 3];
        let eye = sight([0.05, 0.3, -4.0], [0.0; 3], "");
        let session = open(&SceneDesc { camera: Some(eye), ..desc.clone() });
        let mut film = Film::new(image_film_settings(session.scene(), &few).unwrap());
        let single = SingleScatter { rule, nodes: 3 };
        session.airlight_image(&few, single, &NoControl, &mut film).unwrap();
        let (mean, stderr) = result(&film);
        assert!(mean.iter().chain(&stderr).all(|x| x.is_finite() && *x >= 0.0), "{seed}: {mean:?}");
        let (mean, _) = irradiance(&desc, [0.0, 0.0, -3.0], [0.0, 0.0, 1.0], &few);
        assert!(mean.iter().all(|x| x.is_finite() && *x >= 0.0), "{seed}: {mean:?}");
    }
}

/// A cloud on a grid above a floor, under a picture of the sky with a sun in it; the picture is turned.
fn cloud_under_sky() -> SceneDesc {
    let numbers = Counter::new(3);
    let values = (0..5 * 4 * 5).map(|i| 6.0 * (numbers.unit(0, i, 0) - 0.4).max(0.0)).collect();
    let to_world = [[1.2, 0.0, 0.0, -0.6], [0.0, 0.8, 0.0, 0.3], [0.0, 0.0, 1.2, -0.6]];
    let density = Some(GridDesc { size: [5, 4, 5], channels: 1, values, to_world });
    let medium = MediumDesc { density, ..MediumDesc::new("cloud", [0.1, 0.4, 0.2], [1.0, 1.5, 3.0], 0.4) };
    let texels = (0..12 * 7)
        .map(|i| if i == 12 + 4 { [60.0, 50.0, 30.0] } else { [0.2, 0.3, 0.4 + 0.01 * i as f32] })
        .collect();
    let (s, c) = (0.6, 0.8);
    let to_world_sky = [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]];
    let image = Some(EnvironmentImage { width: 12, height: 7, texels, to_world: to_world_sky });
    let floor = ShapeKind::Rectangle { center: [0.0; 3], u: [0.0, 0.0, 2.0], v: [2.0, 0.0, 0.0] };
    SceneDesc {
        materials: vec![
            material("boundary", MaterialKind::Null, 0.0),
            material("floor", MaterialKind::Diffuse { albedo: Reflectance::flat([0.6; 3]) }, 0.0),
        ],
        media: vec![medium],
        shapes: vec![shape(floor, "floor", ""), sphere([0.0, 0.7, 0.0], 0.6, "boundary", "cloud")],
        lights: vec![LightDesc::Environment(EnvironmentDesc { radiance: [1.0; 3], image })],
        ..SceneDesc::default()
    }
}

#[test]
fn paths_from_one_end_and_from_both_see_the_same_cloud() {
    let desc = cloud_under_sky();
    let session = open(&desc);
    let probe = [Probe { position: [0.2, 0.0, 0.1], normal: [0.0, 1.0, 0.0] }];
    for heuristic in [Heuristic::Power, Heuristic::Balance] {
        let paths = job(128, 12);
        let one = irradiance(&desc, probe[0].position, probe[0].normal, &paths);
        let both =
            BidirectionalJob { heuristic, ..BidirectionalJob::new(PathJob { seed: 77, ..paths.clone() }) };
        let mut film = Film::new(probe_film_settings(session.scene(), &both.path, 1));
        session.bidirectional_probes(&both, &probe, &NoControl, &mut film).unwrap();
        let two = result(&film);
        for c in 0..3 {
            let error = one.1[c].hypot(two.1[c]);
            let z = (one.0[c] - two.0[c]).abs() / error;
            assert!(z <= LIMIT && error < 0.02 * one.0[c], "{heuristic:?} {c}: {one:?} {two:?}");
        }
    }
}
