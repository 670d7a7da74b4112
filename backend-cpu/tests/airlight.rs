//! Single scattering summed along camera rays, against what is known of it and against flights.

#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use etendue_core::backend::{BackendError, NoControl, PathJob, Session, image_film_settings};
use etendue_core::film::Film;
use etendue_core::scene::{
    CameraDesc, EnvironmentDesc, GridDesc, LightDesc, MaterialDesc, MaterialKind, MediumDesc, Reflectance,
    SceneDesc, ShapeDesc, ShapeKind, compile,
};
use etendue_core::transport::volume::{Rule, SingleScatter};
use etendue_cpu::{CpuBackend, CpuSession};
use std::f64::consts::PI;
use std::sync::Arc;

/// Standard errors that a result may be off; one of the 300 comparisons here exceeds them by chance once in 500 runs of other seeds.
const LIMIT: f64 = 4.5;
/// What f32 may lose of a sum of nodes.
const ROUNDING: f64 = 1e-5;
const RULES: [Rule; 3] = [Rule::Trapezoid, Rule::PlainTrapezoid, Rule::Equiangular];
const UNBIASED: [Rule; 2] = [Rule::Trapezoid, Rule::Equiangular];

fn material(name: &str, kind: MaterialKind, emission: f32) -> MaterialDesc {
    MaterialDesc { name: name.into(), kind, two_sided: true, emission: [emission; 3] }
}

fn diffuse(name: &str, albedo: f32, emission: f32) -> MaterialDesc {
    material(name, MaterialKind::Diffuse { albedo: Reflectance::flat([albedo; 3]) }, emission)
}

fn grey(name: &str, sigma_t: f32, albedo: f32, g: f32) -> MediumDesc {
    MediumDesc::new(name, [sigma_t * (1.0 - albedo); 3], [sigma_t * albedo; 3], g)
}

fn shape(kind: ShapeKind, material: &str, interior: &str) -> ShapeDesc {
    ShapeDesc { kind, material: material.into(), interior: interior.into(), exterior: String::new() }
}

/// Sees one direction.
fn eye(from: [f32; 3], to: [f32; 3], medium: &str) -> CameraDesc {
    let along = [0, 1, 2].map(|k| (to[k] - from[k]).abs());
    CameraDesc {
        position: from,
        look_at: to,
        up: if along[1] > along[0] + along[2] { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] },
        fov_x_deg: 1e-3,
        resolution: [1, 1],
        lens_radius: 0.0,
        focus_distance: 1.0,
        medium: medium.into(),
    }
}

fn open(desc: &SceneDesc) -> CpuSession {
    let (scene, report) = compile(desc).unwrap();
    assert!(report.cleanups.is_empty(), "{report:?}");
    CpuBackend::new(None).unwrap().open_session(Arc::new(scene)).unwrap()
}

/// Paths of at most `max_depth` edges, each sample a block of its own unless said otherwise.
fn job(blocks: u32, max_depth: u32) -> PathJob {
    PathJob { seed: 5, block_length: 1, blocks: 0..blocks, max_depth }
}

fn image(session: &CpuSession, job: &PathJob, single: Option<SingleScatter>) -> Film {
    let mut film = Film::new(image_film_settings(session.scene(), job).unwrap());
    match single {
        Some(single) => session.airlight_image(job, single, &NoControl, &mut film).unwrap(),
        None => session.path_image(job, &NoControl, &mut film).unwrap(),
    };
    assert_eq!((film.invalid(), film.saturated()), (0, 0));
    film
}

/// Mean of the first pixel, its standard error, and the error of one sample, for a truth.
fn first(film: &Film, channel: usize, truth: f64) -> (f64, f64, f64) {
    let mean = film.mean(0)[channel];
    let variance = film.variance(0).unwrap()[channel].max(0.0);
    let one = variance * film.block_count() as f64 + (mean - truth) * (mean - truth);
    (mean, variance.sqrt(), one.sqrt())
}

/// Unbiased rules agree with a truth for any number of nodes; the plain one comes near it with many.
fn agrees(what: &str, desc: &SceneDesc, truth: [f64; 3]) {
    let session = open(desc);
    for rule in UNBIASED {
        for nodes in [1, 4, 16] {
            let film = image(&session, &job(4096, 2), Some(SingleScatter { rule, nodes }));
            for (c, truth) in truth.into_iter().enumerate() {
                let (mean, stderr, _) = first(&film, c, truth);
                let z = (mean - truth).abs() / (stderr + ROUNDING * truth + 1e-30);
                assert!(
                    z <= LIMIT,
                    "{what} {rule:?} {nodes}: {mean} against {truth}, {z:.1} standard errors"
                );
                assert!(stderr <= 0.1 * truth, "{what} {rule:?} {nodes}: standard error {stderr} of {truth}");
            }
        }
    }
    let single = SingleScatter { rule: Rule::PlainTrapezoid, nodes: 4097 };
    let film = image(&session, &job(4, 2), Some(single));
    for (c, truth) in truth.into_iter().enumerate() {
        let (mean, ..) = first(&film, c, truth);
        assert!((mean / truth - 1.0).abs() <= 2e-4, "{what} plain: {mean} against {truth}");
    }
}

/// A lamp in fog; L. B. Sun et al., SIGGRAPH 2005: beta, distance, angle to the view ray, its length, radiance.
const LAMPS: [(f32, f32, f32, f32, f64); 2] =
    [(0.3, 5.0, 0.4, 20.0, 0.003_812_517_006_2), (0.1, 10.0, 1.2, 8.0, 0.000_183_160_245_975)];

fn lamp_in_fog((beta, d, gamma, length, _): (f32, f32, f32, f32, f64)) -> SceneDesc {
    let wall = ShapeKind::Disk { center: [0.0, 0.0, length], normal: [0.0, 0.0, -1.0], radius: 1.0 };
    SceneDesc {
        materials: vec![diffuse("wall", 0.0, 0.0)],
        media: vec![grey("fog", beta, 1.0, 0.0)],
        shapes: vec![shape(wall, "wall", "")],
        lights: vec![LightDesc::Point {
            position: [d * gamma.sin(), 0.0, d * gamma.cos()],
            intensity: [1.0; 3],
        }],
        camera: Some(eye([0.0; 3], [0.0, 0.0, 1.0], "fog")),
        ..SceneDesc::default()
    }
}

#[test]
fn a_lamp_in_fog_is_its_closed_form() {
    for lamp in LAMPS {
        agrees("lamp", &lamp_in_fog(lamp), [lamp.4; 3]);
    }
}

#[test]
fn the_bias_of_the_plain_rule_falls_by_the_square_of_its_nodes() {
    for lamp in LAMPS {
        let session = open(&lamp_in_fog(lamp));
        let bias = [16, 32, 64].map(|steps| {
            let single = SingleScatter { rule: Rule::PlainTrapezoid, nodes: steps + 1 };
            first(&image(&session, &job(16, 2), Some(single)), 0, lamp.4).0 - lamp.4
        });
        for pair in bias.windows(2) {
            let ratio = pair[0] / pair[1];
            assert!((3.5..4.5).contains(&ratio), "{bias:?}");
        }
        assert!(bias[2].abs() < 1e-3 * lamp.4, "{bias:?}");
    }
}

/// The table of `docs/media.md`: errors of one sample relative to the truth.
#[test]
fn errors_by_nodes() {
    for lamp in LAMPS {
        let session = open(&lamp_in_fog(lamp));
        let truth = lamp.4;
        let walk = first(&image(&session, &job(1 << 16, 2), None), 0, truth).2 / truth;
        println!("\n| nodes | jittered trapezoid | plain trapezoid | equiangular | as many flights |");
        println!("|---:|---:|---:|---:|---:|");
        let mut last = [f64::INFINITY; 3];
        for nodes in [1_u32, 4, 8, 16, 32, 64] {
            let errors = RULES.map(|rule| {
                let film = image(&session, &job(4096, 2), Some(SingleScatter { rule, nodes }));
                first(&film, 0, truth).2 / truth
            });
            let flights = walk / f64::from(nodes).sqrt();
            let [jittered, plain, equiangular] = errors.map(|e| 100.0 * e);
            println!(
                "| {nodes} | {jittered:.3} % | {plain:.3} % | {equiangular:.3} % | {:.1} % |",
                100.0 * flights
            );
            // Shifted rules fall by the number of nodes, flights by its root.
            assert!(errors[2] < flights, "{errors:?} {flights}");
            if nodes == 1 {
                assert!(errors[2] < errors[0], "angles over lengths where nodes are few: {errors:?}");
            } else {
                assert!(errors[0] < flights, "{errors:?} {flights}");
                assert!(errors.iter().zip(last).all(|(e, l)| *e < 0.8 * l), "{errors:?} {last:?}");
            }
            if nodes >= 16 {
                assert!(errors[1] < 0.5 * errors[2], "a smooth integrand needs no noise: {errors:?}");
            }
            last = errors;
        }
    }
}

fn beam(mu0: f32) -> LightDesc {
    LightDesc::Directional { direction: [(1.0 - mu0 * mu0).sqrt(), -mu0, 0.0], irradiance: [1.0; 3] }
}

fn slab(tau: f32, albedo: f32, lights: Vec<LightDesc>, camera: CameraDesc) -> SceneDesc {
    let wide = 300.0;
    let kind = ShapeKind::Box { min: [-wide, 0.0, -wide], max: [wide, 1.0, wide] };
    SceneDesc {
        materials: vec![material("boundary", MaterialKind::Null, 0.0)],
        media: vec![grey("slab", tau, albedo, 0.0)],
        shapes: vec![shape(kind, "boundary", "slab")],
        lights,
        camera: Some(camera),
        ..SceneDesc::default()
    }
}

#[test]
fn a_beam_in_a_slab_is_its_integral() {
    for (tau, albedo, mu0, mu, reflected, transmitted) in [
        (1.0, 0.5, 1.0, 1.0_f32, 0.017_201_957_974, 0.014_637_457_881),
        (0.3, 0.9, 0.5, 0.7, 0.019_172_679_748, 0.018_375_369_096),
    ] {
        let sin = (1.0 - mu * mu).max(0.0).sqrt();
        let seen = |from: [f32; 3], to: [f32; 3]| slab(tau, albedo, vec![beam(mu0)], eye(from, to, ""));
        agrees("reflected", &seen([sin, 1.0 + mu, 0.0], [0.0, 1.0, 0.0]), [reflected; 3]);
        agrees("transmitted", &seen([sin, -mu, 0.0], [0.0; 3]), [transmitted; 3]);
    }
    // Level, at a depth of 0.3, where the way is much longer than light gets: every place is lit alike.
    for tau in [0.01_f32, 1.0, 10.0] {
        let level = slab(tau, 0.8, vec![beam(0.6)], eye([0.0, 0.7, 0.0], [0.0, 0.7, 1.0], ""));
        let tau = f64::from(tau);
        let truth = 0.8 / (4.0 * PI) * (-tau * 0.3 / 0.6).exp() * -(-300.0 * tau).exp_m1();
        agrees("level", &level, [truth; 3]);
    }
}

/// Henyey and Greenstein, of the cosine between directions of travel.
fn phase(g: f64, cos: f64) -> f64 {
    (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * cos).powf(1.5))
}

/// Light of a place at `light` that sends intensity(cos to `axis`), scattered once along z by a medium of these coefficients on the way from 0 to `to`, which fills everything.
fn integral(
    sigma_t: f64,
    sigma_s: f64,
    g: f64,
    light: [f64; 3],
    to: f64,
    intensity: impl Fn([f64; 3]) -> f64,
) -> f64 {
    let n = 400_000;
    let h = to / f64::from(n);
    let at = |t: f64| {
        let d = [-light[0], -light[1], t - light[2]];
        let far = d.iter().map(|x| x * x).sum::<f64>().sqrt();
        let way = d.map(|x| x / far);
        // It travels along `way`, then back along -z.
        intensity(way) / (far * far) * (-sigma_t * (t + far)).exp() * sigma_s * phase(g, -way[2])
    };
    (0..n).map(|i| at((f64::from(i) + 0.5) * h) * h).sum()
}

#[test]
fn colours_lobes_spots_and_ways_without_end() {
    let (sigma_a, sigma_s) = ([0.1_f32, 0.0, 0.4], [0.2_f32, 0.5, 0.9]);
    for g in [0.0_f32, 0.7, -0.5] {
        for wall in [true, false] {
            let at = [1.2_f32, -0.4, 3.0];
            let axis = [-0.5_f32, 0.2, -1.0];
            // Behind the camera, where there is no end.
            let end = if wall {
                ShapeKind::Disk { center: [0.0, 0.0, 6.0], normal: [0.0, 0.0, -1.0], radius: 1.0 }
            } else {
                ShapeKind::Sphere { center: [0.0, 0.0, -9.0], radius: 1.0 }
            };
            let (cone, falloff) = (40.0_f32, 25.0_f32);
            for spot in [false, true] {
                let light = if spot {
                    LightDesc::Spot {
                        position: at,
                        direction: axis,
                        intensity: [2.0; 3],
                        cone_deg: cone,
                        falloff_deg: falloff,
                    }
                } else {
                    LightDesc::Point { position: at, intensity: [2.0; 3] }
                };
                let desc = SceneDesc {
                    materials: vec![diffuse("wall", 0.0, 0.0)],
                    media: vec![MediumDesc::new("fog", sigma_a, sigma_s, g)],
                    shapes: vec![shape(end.clone(), "wall", "")],
                    lights: vec![light],
                    camera: Some(eye([0.0; 3], [0.0, 0.0, 1.0], "fog")),
                    ..SceneDesc::default()
                };
                let axis = axis.map(f64::from);
                let norm = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
                let intensity = |way: [f64; 3]| {
                    let cos = (0..3).map(|k| way[k] * axis[k]).sum::<f64>() / norm;
                    let [low, high] = [cone, falloff].map(|a| f64::from(a).to_radians().cos());
                    let x = ((cos - low) / (high - low)).clamp(0.0, 1.0);
                    if spot { 2.0 * x * x * (3.0 - 2.0 * x) } else { 2.0 }
                };
                let truth = [0, 1, 2].map(|c| {
                    let (a, s) = (f64::from(sigma_a[c]), f64::from(sigma_s[c]));
                    let to = if wall { 6.0 } else { 60.0 };
                    integral(a + s, s, f64::from(g), at.map(f64::from), to, intensity)
                });
                agrees(&format!("g {g}, spot {spot}, wall {wall}"), &desc, truth);
            }
        }
    }
}

/// Two films agree in every pixel and in their mean.
fn films_agree(what: &str, a: &Film, b: &Film) {
    let (mut difference, mut variance, mut sum, mut worst) = ([0.0; 3], [0.0; 3], [0.0; 3], 0.0_f64);
    for i in 0..a.len() {
        let (x, y) = (a.mean(i), b.mean(i));
        let (v, w) = (a.variance(i).unwrap(), b.variance(i).unwrap());
        for c in 0..3 {
            let stderr = (v[c] + w[c]).max(0.0).sqrt() + ROUNDING * y[c];
            worst = worst.max((x[c] - y[c]).abs() / stderr);
            difference[c] += x[c] - y[c];
            variance[c] += v[c] + w[c];
            sum[c] += y[c];
        }
    }
    let z = [0, 1, 2].map(|c| difference[c] / variance[c].sqrt());
    let known = [0, 1, 2].map(|c| variance[c].sqrt() / sum[c]);
    println!("{what}: {z:.1?} standard errors in the mean, {worst:.1} in a pixel; known to {known:.4?}");
    assert!(z.iter().all(|z| z.abs() <= LIMIT), "{what}: {z:.1?} standard errors");
    // Paths that pass near a lamp make long tails of single pixels.
    assert!(worst <= 6.0, "{what}: {worst:.1} standard errors");
    assert!(known.iter().all(|k| *k <= 0.01), "{what}: {known:?}");
}

/// A ball of fog in a room, a pane before it, a disk before its lamp; lights of all kinds.
fn room(lights: Vec<LightDesc>, lamp: f32) -> SceneDesc {
    let wall = |center: [f32; 3], u: [f32; 3], v: [f32; 3]| {
        shape(ShapeKind::Rectangle { center, u, v }, "white", "")
    };
    let disk = |center: [f32; 3], normal: [f32; 3], radius: f32, material: &str| {
        shape(ShapeKind::Disk { center, normal, radius }, material, "")
    };
    let ball = |center: [f32; 3], radius: f32, material: &str, interior: &str| {
        shape(ShapeKind::Sphere { center, radius }, material, interior)
    };
    let mut core = MediumDesc::new("core", [0.3, 0.1, 0.0], [1.0, 2.0, 3.0], 0.5);
    core.priority = 1;
    SceneDesc {
        materials: vec![
            diffuse("white", 0.6, 0.0),
            diffuse("lamp", 0.0, lamp),
            material("boundary", MaterialKind::Null, 0.0),
            material("glass", MaterialKind::Dielectric { ior: [1.5; 3], schlick: false }, 0.0),
            material(
                "pane",
                MaterialKind::ThinFilm { reflect: [0.2, 0.1, 0.3], transmit: [0.8, 0.9, 0.6] },
                0.0,
            ),
        ],
        media: vec![grey("fog", 0.4, 0.8, -0.2), core],
        shapes: vec![
            wall([0.0, 0.0, 3.0], [0.0, 2.0, 0.0], [2.0, 0.0, 0.0]),
            wall([0.0, -2.0, 0.0], [0.0, 0.0, 3.0], [3.0, 0.0, 0.0]),
            ball([0.0; 3], 1.6, "boundary", "fog"),
            ball([0.5, 0.2, -0.2], 0.6, "boundary", "core"),
            ball([-0.6, -0.6, 0.1], 0.4, "glass", ""),
            disk([0.0, 0.0, -2.0], [0.1, 0.2, 1.0], 0.8, "pane"),
            disk([0.7, 1.0, 0.3], [0.3, 1.0, 0.2], 0.25, "white"),
            disk([-2.0, 0.5, -1.0], [1.0, 0.0, 0.0], 0.5, "lamp"),
        ],
        lights,
        camera: Some(CameraDesc {
            fov_x_deg: 45.0,
            resolution: [6, 6],
            ..eye([0.2, 0.3, -4.0], [0.0; 3], "")
        }),
        ..SceneDesc::default()
    }
}

fn point() -> LightDesc {
    LightDesc::Point { position: [0.9, 1.5, 0.4], intensity: [4.0, 3.0, 2.0] }
}

fn all_lights() -> Vec<LightDesc> {
    vec![
        point(),
        LightDesc::Spot {
            position: [-1.5, 1.5, -1.5],
            direction: [1.0, -1.0, 1.0],
            intensity: [6.0, 10.0, 8.0],
            cone_deg: 30.0,
            falloff_deg: 20.0,
        },
        beam(0.7),
        LightDesc::Environment(EnvironmentDesc::uniform([0.2; 3])),
    ]
}

#[test]
fn shadows_panes_boundaries_and_all_that_follows_agree_with_flights() {
    for (what, desc, max_depth) in [
        ("shadows, once", room(vec![point()], 0.0), 2),
        ("all lights, once", room(all_lights(), 0.0), 2),
        ("all lights, twice", room(all_lights(), 2.0), 3),
        ("all", room(all_lights(), 2.0), 8),
    ] {
        let session = open(&desc);
        let flights = PathJob { block_length: 16, ..job(512, max_depth) };
        let walked = image(&session, &flights, None);
        // Other numbers: the films are independent.
        let summed = PathJob { seed: 77, blocks: 0..128, ..flights };
        for rule in UNBIASED {
            let film = image(&session, &summed, Some(SingleScatter { rule, nodes: 4 }));
            films_agree(&format!("{what}, {rule:?}"), &film, &walked);
        }
        if max_depth == 2 {
            // Light is cut off along the way: its bias falls as 1 / n.
            let plain = SingleScatter { rule: Rule::PlainTrapezoid, nodes: 257 };
            let film = image(&session, &PathJob { block_length: 4, blocks: 0..16, ..summed }, Some(plain));
            let sum = |film: &Film| (0..film.len()).map(|i| film.mean(i)[1]).sum::<f64>();
            let (a, b) = (sum(&film), sum(&walked));
            assert!((a / b - 1.0).abs() < 0.02, "{what}, plain: {a} {b}");
        }
    }
}

#[test]
fn grids_have_airlight_too() {
    let grid = |channels: u32, low: f32, high: f32| {
        let value = |i: u32| low + (high - low) * ((i * i * 3 + i + i / 3) % 11) as f32 / 10.0;
        let to_world = [[1.0, 0.1, 0.0, -0.7], [0.0, 1.2, 0.0, -0.5], [0.1, 0.0, 2.0, 1.0]];
        Some(GridDesc {
            size: [3, 2, 4],
            channels,
            values: (0..24 * channels).map(value).collect(),
            to_world,
        })
    };
    let fog = MediumDesc::new("fog", [0.3, 0.1, 0.5], [1.0, 2.0, 0.5], 0.3);
    for (density, albedo) in
        [(grid(1, 0.0, 2.0), None), (grid(3, 0.0, 2.0), grid(1, 0.2, 1.0)), (None, grid(3, 0.0, 1.0))]
    {
        // Everywhere, so that only the grid ends it; and within a box.
        for boxed in [false, true] {
            let kind = ShapeKind::Box { min: [-1.0, -0.6, 1.4], max: [1.0, 0.6, 3.4] };
            let medium = MediumDesc { density: density.clone(), albedo: albedo.clone(), ..fog.clone() };
            let end = ShapeKind::Sphere { center: [0.0, 0.0, -9.0], radius: 1.0 };
            let desc = SceneDesc {
                materials: vec![diffuse("wall", 0.0, 0.0), material("boundary", MaterialKind::Null, 0.0)],
                media: vec![medium],
                shapes: vec![if boxed { shape(kind, "boundary", "fog") } else { shape(end, "wall", "") }],
                lights: vec![LightDesc::Point { position: [0.6, 0.9, 2.0], intensity: [1.0; 3] }, beam(0.8)],
                // The sun is too far to be seen through a medium without end.
                camera: Some(eye([0.0; 3], [0.05, 0.02, 1.0], if boxed { "" } else { "fog" })),
                ..SceneDesc::default()
            };
            let session = open(&desc);
            let walked = image(&session, &PathJob { block_length: 64, ..job(1024, 2) }, None);
            let film = |rule: Rule, nodes: u32, blocks: u32| {
                let job = PathJob { seed: 9, block_length: 16, ..job(blocks, 2) };
                image(&session, &job, Some(SingleScatter { rule, nodes }))
            };
            let what = format!("{}, {}, {boxed}", density.is_some(), albedo.is_some());
            for rule in UNBIASED {
                films_agree(&format!("{what}, {rule:?}"), &film(rule, 4, 128), &walked);
            }
            let (plain, best) = (film(Rule::PlainTrapezoid, 1025, 1), film(Rule::Equiangular, 64, 64));
            for c in 0..3 {
                let (a, b) = (plain.mean(0)[c], best.mean(0)[c]);
                assert!((a / b - 1.0).abs() < 2e-3, "{what}, plain: {a} {b}");
            }
        }
    }
}

#[test]
fn summed_airlight_has_less_noise_than_flights() {
    let session = open(&room(vec![point()], 0.0));
    let variance = |film: &Film| -> f64 { (0..film.len()).map(|i| film.variance(i).unwrap()[1]).sum() };
    let all = job(256, 2);
    let walked = variance(&image(&session, &all, None));
    for rule in UNBIASED {
        let film = image(&session, &all, Some(SingleScatter { rule, nodes: 16 }));
        assert!(variance(&film) < 0.2 * walked, "{rule:?}: {} {walked}", variance(&film));
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let (scene, _) = compile(&room(all_lights(), 2.0)).unwrap();
    let scene = Arc::new(scene);
    for rule in RULES {
        let run = |threads: usize, parts: &[std::ops::Range<u32>]| {
            let session = CpuBackend::new(Some(threads)).unwrap().open_session(scene.clone()).unwrap();
            let all = PathJob { block_length: 4, ..job(4, u32::MAX) };
            let mut film = Film::new(image_film_settings(session.scene(), &all).unwrap());
            for blocks in parts {
                let job = PathJob { blocks: blocks.clone(), ..all.clone() };
                let single = SingleScatter { rule, nodes: 5 };
                session.airlight_image(&job, single, &NoControl, &mut film).unwrap();
            }
            (0..film.len()).map(|i| film.mean(i).map(f64::to_bits)).collect::<Vec<_>>()
        };
        let one = run(1, &[0..2, 2..4]);
        assert_eq!(one, run(2, &[0..1, 1..4]));
        assert_eq!(one, run(5, &[2..4, 0..2]));
    }
}

#[test]
fn where_nothing_is_scattered_once_paths_are_what_they_were() {
    let single = Some(SingleScatter { rule: Rule::Trapezoid, nodes: 4 });
    let same = |desc: &SceneDesc, max_depth: u32| {
        let session = open(desc);
        let job = PathJob { block_length: 16, ..job(2, max_depth) };
        let (a, b) = (image(&session, &job, None), image(&session, &job, single));
        (0..a.len()).all(|i| a.mean(i).map(f64::to_bits) == b.mean(i).map(f64::to_bits))
    };
    let environment = vec![LightDesc::Environment(EnvironmentDesc::uniform([0.2; 3]))];
    assert!(same(&room(environment, 2.0), u32::MAX), "no light without size");
    assert!(same(&room(all_lights(), 2.0), 1), "no scattering");
    assert!(!same(&room(all_lights(), 2.0), 2));
    let mut clear = room(all_lights(), 2.0);
    clear.media.clear();
    clear.shapes.iter_mut().for_each(|s| s.interior.clear());
    assert!(same(&clear, u32::MAX), "no medium");
}

#[test]
fn jobs_without_nodes_are_refused() {
    let session = open(&room(vec![point()], 0.0));
    let job = job(1, 2);
    let mut film = Film::new(image_film_settings(session.scene(), &job).unwrap());
    for nodes in [0, u32::MAX] {
        let single = SingleScatter { rule: Rule::Trapezoid, nodes };
        let error = session.airlight_image(&job, single, &NoControl, &mut film).unwrap_err();
        assert!(matches!(error, BackendError::BadJob { .. }), "{error}");
    }
}
