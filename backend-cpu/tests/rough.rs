//! Rough surfaces, plastic and films that scatter: radiance of a flat piece of each against sums of what its lobes say.

#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use etendue_core::backend::{NoControl, PathJob, Session, image_film_settings};
use etendue_core::bsdf::{Boundary, Facets, Finish, Lobes, Rough};
use etendue_core::film::Film;
use etendue_core::math::Vec3;
use etendue_core::scene::{
    CameraDesc, Checker, EnvironmentDesc, LightDesc, MaterialDesc, MaterialKind, MediumDesc, Reflectance,
    Roughness, SceneDesc, ShapeDesc, ShapeKind, compile,
};
use etendue_cpu::CpuBackend;
use std::sync::Arc;

/// Standard errors that a result may be off; one of the 100 comparisons here exceeds them by chance once in 1500 runs of other seeds.
const LIMIT: f64 = 4.5;

fn material(name: &str, kind: MaterialKind, emission: f32) -> MaterialDesc {
    MaterialDesc { name: name.into(), kind, two_sided: true, emission: [emission; 3] }
}

fn shape(kind: ShapeKind, material: &str) -> ShapeDesc {
    ShapeDesc { kind, material: material.into(), interior: String::new(), exterior: String::new() }
}

/// A square in y = 0, its front up.
fn piece(kind: MaterialKind) -> SceneDesc {
    let square = ShapeKind::Rectangle { center: [0.0; 3], u: [0.0, 0.0, 1.0], v: [1.0, 0.0, 0.0] };
    SceneDesc {
        materials: vec![
            material("piece", kind, 0.0),
            material("lamp", MaterialKind::Diffuse { albedo: Reflectance::flat([0.0; 3]) }, 1.0),
        ],
        shapes: vec![shape(square, "piece")],
        ..SceneDesc::default()
    }
}

/// The same light from everywhere.
fn in_the_open(kind: MaterialKind) -> SceneDesc {
    let sky = LightDesc::Environment(EnvironmentDesc::uniform([1.0; 3]));
    SceneDesc { lights: vec![sky], ..piece(kind) }
}

/// A square lamp about (0.8, -+1, 0), above or below the piece, facing it.
fn beside_a_lamp(kind: MaterialKind, above: bool) -> SceneDesc {
    let y = if above { 1.0 } else { -1.0 };
    let mut desc = piece(kind);
    let center = [0.8, y, 0.0];
    let lamp = ShapeKind::Rectangle { center, u: [0.4, 0.0, 0.0], v: [0.0, 0.0, 0.4 * y] };
    desc.shapes.push(shape(lamp, "lamp"));
    desc
}

type Found = ([f64; 3], [f64; 3]);

/// Radiance from the middle of the piece, `x` and `y` towards the camera.
fn seen(desc: &SceneDesc, [x, y]: [f32; 2], blocks: u32) -> Found {
    let camera = CameraDesc {
        position: [5.0 * x, 5.0 * y, 0.0],
        look_at: [0.0; 3],
        up: [0.0, 0.0, 1.0],
        fov_x_deg: 0.02,
        resolution: [1, 1],
        lens_radius: 0.0,
        focus_distance: 1.0,
        medium: String::new(),
    };
    let (scene, report) = compile(&SceneDesc { camera: Some(camera), ..desc.clone() }).unwrap();
    assert!(report.cleanups.is_empty(), "{report:?}");
    let session = CpuBackend::new(None).unwrap().open_session(Arc::new(scene)).unwrap();
    let job = PathJob { seed: 9, block_length: 256, blocks: 0..blocks, max_depth: 30 };
    let mut film = Film::new(image_film_settings(session.scene(), &job).unwrap());
    session.path_image(&job, &NoControl, &mut film).unwrap();
    assert_eq!(film.invalid(), 0);
    (film.mean(0), film.variance(0).unwrap().map(|v| v.max(0.0).sqrt()))
}

#[track_caller]
fn agrees(what: &str, (mean, stderr): Found, truth: [f64; 3], relative: f64) {
    for c in 0..3 {
        let error = (mean[c] - truth[c]).abs();
        let z = error / (stderr[c] + 3e-4 * truth[c].abs() + 1e-12);
        assert!(z <= LIMIT, "{what}: {} against {}, {z:.1} standard errors", mean[c], truth[c]);
        assert!(stderr[c] <= relative * truth[c].abs(), "{what}: {} +- {}", mean[c], stderr[c]);
    }
}

const CAMERAS: [[f32; 2]; 3] = [[-0.6, 0.8], [-0.28, 0.96], [-0.96, 0.28]];
const UP: Vec3 = Vec3::Y;

/// What the lobes of the piece bring from the lamp, transmittance of what is beyond the piece included.
fn from_lamp(lobes: &Lobes, [x, y]: [f32; 2], above: bool, sigma_t: f64) -> [f64; 3] {
    let wo = Vec3::new(x, y, 0.0).normalize();
    let side = if above { 1.0 } else { -1.0 };
    let steps = 400;
    let mut sum = [0.0; 3];
    for i in 0..steps {
        for j in 0..steps {
            let at = |k: i32| 0.8 * ((f64::from(k) + 0.5) / f64::from(steps) - 0.5);
            let p = [0.8 + at(i), side, at(j)];
            let r = p.iter().map(|x| x * x).sum::<f64>().sqrt();
            let wi = Vec3::new((p[0] / r) as f32, (p[1] / r) as f32, (p[2] / r) as f32).normalize();
            let area = (0.8 / f64::from(steps)).powi(2);
            let part = area / (r * r * r * r) * (-sigma_t * r).exp();
            let f = lobes.eval(UP, wo, wi);
            sum = [0, 1, 2].map(|c| sum[c] + f64::from(f[c]) * part);
        }
    }
    sum
}

fn plastic(albedo: Reflectance, roughness: Option<Roughness>, nonlinear: bool) -> MaterialKind {
    MaterialKind::Plastic { albedo, ior: 1.5, roughness, nonlinear }
}

/// The lobes that the scene's own tables make of the piece.
fn lobes_of(desc: &SceneDesc, [x, y]: [f32; 2]) -> Lobes {
    use etendue_core::geometry::{Hit, Ray};
    let (scene, _) = compile(desc).unwrap();
    let direction = -Vec3::new(x, y, 0.0).normalize();
    let ray = Ray { origin: -direction, direction, t_max: f32::MAX };
    let hit = Hit { t: 1.0, primitive: 0, b1: 0.25, b2: 0.25 };
    etendue_core::transport::surface_at::<true, true, true>(&scene, &ray, &hit).unwrap().lobes
}

fn reflectors() -> Vec<(&'static str, MaterialKind)> {
    let (eta, k) = ([0.2, 0.4, 1.3], [3.9, 2.4, 1.8]);
    let red = Reflectance::flat([0.7, 0.2, 0.1]);
    vec![
        ("ggx metal", MaterialKind::RoughConductor { eta, k, roughness: Roughness::Ggx(0.3) }),
        ("beckmann metal", MaterialKind::RoughConductor { eta, k, roughness: Roughness::Beckmann(0.3) }),
        ("phong metal", MaterialKind::RoughConductor { eta, k, roughness: Roughness::Phong(12.0) }),
        ("smooth plastic", plastic(red.clone(), None, false)),
        ("ggx plastic", plastic(red.clone(), Some(Roughness::Ggx(0.3)), true)),
        ("beckmann plastic", plastic(red.clone(), Some(Roughness::Beckmann(0.3)), false)),
        ("phong plastic", plastic(red, Some(Roughness::Phong(12.0)), false)),
    ]
}

#[test]
fn lamps_are_reflected_as_the_lobes_say() {
    for (name, kind) in reflectors() {
        let desc = beside_a_lamp(kind, true);
        for camera in CAMERAS {
            let lobes = lobes_of(&desc, camera);
            let mut truth = from_lamp(&lobes, camera, true, 0.0);
            // In the first camera's mirror there is the lamp itself.
            let mirrored = lobes.has_delta() && -camera[0] / camera[1] < 1.2 && -camera[0] / camera[1] > 0.4;
            if mirrored {
                let x = f64::from(etendue_core::bsdf::fresnel::dielectric(camera[1], 1.5));
                truth = truth.map(|t| t + x);
            }
            agrees(&format!("{name} {camera:?}"), seen(&desc, camera, 64), truth, 0.03);
        }
    }
}

#[test]
fn glass_and_films_pass_the_lamp_as_the_lobes_say() {
    let glass = |rough, ratio: [f32; 3], schlick| {
        let boundary = Boundary { rough, ratio: Vec3::from_array(ratio), schlick };
        Lobes::finished(Vec3::ZERO, Finish::Boundary(boundary))
    };
    let of = |roughness, ior, schlick| MaterialKind::RoughDielectric { ior, schlick, roughness };
    let ior = [1.5; 3];
    let (reflect, transmit) = ([0.3, 0.2, 0.1], [0.1, 0.5, 0.6]);
    let film = MaterialKind::ScatteringFilm { reflect, transmit };
    let rough = |f: Facets| Rough::Facets(f);
    let colours = [1.4, 1.5, 1.7];
    let (ggx, beckmann, phong) = (Roughness::Ggx(0.3), Roughness::Beckmann(0.3), Roughness::Phong(12.0));
    for (name, kind, lobes) in [
        ("ggx", of(ggx, ior, false), glass(rough(Facets::ggx(0.3)), ior, false)),
        ("schlick", of(beckmann, ior, true), glass(rough(Facets::beckmann(0.3)), ior, true)),
        ("phong", of(phong, ior, false), glass(Rough::Phong(12.0), ior, false)),
        ("colours", of(ggx, colours, false), glass(rough(Facets::ggx(0.3)), colours, false)),
        (
            "film",
            film,
            Lobes::finished(Vec3::from_array(reflect), Finish::Film { transmit: Vec3::from_array(transmit) }),
        ),
    ] {
        for above in [true, false] {
            for camera in [[-0.6, 0.8], [-0.96, 0.28], [-0.6, -0.8]] {
                for sigma in [0.0, 0.5_f32] {
                    // A medium behind the piece: it is before and beyond it, by turns.
                    let mut desc = beside_a_lamp(kind.clone(), above);
                    if sigma > 0.0 {
                        if camera[1] < 0.0 {
                            continue;
                        }
                        desc.media.push(MediumDesc::new("ink", [sigma; 3], [0.0; 3], 0.0));
                        desc.shapes[0].interior = "ink".into();
                    }
                    let inked = if above { 0.0 } else { f64::from(sigma) };
                    let truth = [0, 1, 2].map(|c| from_lamp(&lobes.of_channel(c), camera, above, inked)[c]);
                    let what = format!("{name}, above {above}, {camera:?}, {sigma}");
                    let relative = if name == "colours" { 0.06 } else { 0.03 };
                    if truth[1] > 1e-4 {
                        agrees(&what, seen(&desc, camera, 64), truth, relative);
                    }
                }
            }
        }
    }
}

#[test]
fn in_a_furnace_nothing_is_lost_but_between_facets() {
    // What a single scattering loses grows with the roughness.
    for (roughness, least) in [(1e-3, 0.995), (0.1, 0.95), (0.3, 0.85)] {
        for make in [Roughness::Ggx, Roughness::Beckmann] {
            let roughness = make(roughness);
            let kind = MaterialKind::RoughDielectric { ior: [1.5; 3], schlick: false, roughness };
            let sky = LightDesc::Environment(EnvironmentDesc::uniform([1.0; 3]));
            let mut ball = piece(kind);
            ball.shapes = vec![shape(ShapeKind::Sphere { center: [0.0; 3], radius: 0.5 }, "piece")];
            ball.lights.push(sky);
            let (mean, stderr) = seen(&ball, [-0.6, 0.8], 64);
            let x = mean[1];
            assert!(x >= least && x <= 1.0 + LIMIT * stderr[1], "ball, {roughness:?}: {mean:?}");
        }
    }
    let white = Reflectance::flat([1.0; 3]);
    agrees("white plastic", seen(&in_the_open(plastic(white, None, true)), CAMERAS[0], 32), [1.0; 3], 0.01);
    let film = MaterialKind::ScatteringFilm { reflect: [0.3, 0.2, 0.1], transmit: [0.1, 0.5, 0.6] };
    agrees("film", seen(&in_the_open(film), CAMERAS[1], 32), [0.4, 0.7, 0.7], 0.01);
}

#[test]
fn squares_of_a_checker_are_where_the_rule_puts_them() {
    // The middle of the piece is (u, v) = (1/2, 1/2): with one repeat, the first colour.
    let colors = [[0.9, 0.5, 0.1], [0.2, 0.4, 0.6]];
    for (repeat, k) in [([1.0, 1.0], 0), ([1.2, 0.9], 1), ([2.1, 0.9], 0), ([4.6, 4.6], 0), ([4.6, 3.2], 1)] {
        let albedo = Reflectance {
            color: [0.5, 1.0, 1.0],
            texture: String::new(),
            checker: Some(Checker { colors, repeat }),
        };
        let found = seen(&in_the_open(MaterialKind::Diffuse { albedo }), CAMERAS[0], 16);
        let truth = [0, 1, 2].map(|c| f64::from(colors[k][c]) * [0.5, 1.0, 1.0][c]);
        // Repeats that put an edge at the middle see both squares.
        if repeat != [1.0, 1.0] {
            agrees(&format!("checker {repeat:?}"), found, truth, 1e-6);
        }
    }
}
