//! First shot where numbers are extreme: lamps on walls and in planes, slivers, far from the origin, dark, many.

#![allow(clippy::disallowed_methods, reason = "truth in f64")]

mod rooms;

use etendue_core::backend::{
    BackendError, NoControl, PhotonJob, PhotonStart, Session, illumination_film_settings,
};
use etendue_core::film::Film;
use etendue_core::illumination::{ElementSettings, Elements};
use etendue_core::scene::{LightDesc, MeshDesc, SceneDesc, ShapeKind};
use etendue_core::transport::first_shot::{FirstShotError, Subdivision, Weights};
use etendue_core::transport::photon::Sequence;
use etendue_cpu::CpuSession;
use rooms::{diffuse, mean_and_error, session, shape};

/// A closed box of 2 m about `centre`, of one albedo, with a point light of 1 W/sr at `light` from the centre.
fn room(centre: [f32; 3], albedo: f32, light: [f32; 3]) -> SceneDesc {
    let at = |s: f32| [0, 1, 2].map(|k| centre[k] + s);
    SceneDesc {
        materials: vec![diffuse("wall", [albedo; 3], [0.0; 3])],
        shapes: vec![shape(ShapeKind::Box { min: at(-1.0), max: at(1.0) }, "wall")],
        lights: vec![LightDesc::Point {
            position: [0, 1, 2].map(|k| centre[k] + light[k]),
            intensity: [1.0; 3],
        }],
        ..SceneDesc::default()
    }
}

fn on_surfaces(weights: Weights) -> PhotonStart {
    PhotonStart::Surfaces { subdivision: Subdivision::robust(weights), weights }
}

fn job(start: PhotonStart) -> PhotonJob {
    PhotonJob {
        seed: 3,
        photons: 1 << 13,
        replicates: 0..16,
        max_hits: u32::MAX,
        start,
        sequence: Sequence::Sorted,
        elements: ElementSettings::default(),
    }
}

/// All flux that arrives but direct light: mean and standard error over the replicates.
fn flux(session: &CpuSession, job: &PhotonJob) -> (f64, f64) {
    let elements = Elements::new(session.scene(), job.elements);
    let each: Vec<f64> = job
        .replicates
        .clone()
        .map(|r| {
            let job = PhotonJob { replicates: r..r + 1, ..job.clone() };
            let mut film = Film::new(illumination_film_settings(session.scene(), &elements, &job).unwrap());
            session.illumination(&job, &NoControl, &mut film).unwrap();
            assert_eq!((film.invalid(), film.saturated()), (0, 0));
            (0..film.len()).map(|i| film.mean(i)[0] * f64::from(elements.area(i))).sum()
        })
        .collect();
    mean_and_error(&each)
}

const STARTS: [fn() -> PhotonStart; 3] =
    [|| PhotonStart::LIGHTS, || on_surfaces(Weights::EXACT), || on_surfaces(Weights::Density)];

/// Indirect flux in a closed room of albedo rho: 4 pi I rho / (1 - rho), wherever the lamp is. `slack`: what `density` may miss of it.
fn check_closed(what: &str, desc: &SceneDesc, rho: f64, slack: f64) {
    check_rounded(what, desc, rho, slack, 1e-5);
}

/// The same where coordinates are so coarse that a share `rounding` of it may be lost.
fn check_rounded(what: &str, desc: &SceneDesc, rho: f64, slack: f64, rounding: f64) {
    let session = session(desc, None);
    let truth = 4.0 * std::f64::consts::PI * rho / (1.0 - rho);
    for start in STARTS {
        let start = start();
        let (mean, error) = flux(&session, &job(start));
        let density = matches!(start, PhotonStart::Surfaces { weights: Weights::Density, .. });
        let allowed = 4.5 * error + if density { slack } else { rounding } * truth;
        assert!((mean - truth).abs() <= allowed, "{what}, {start:?}: {mean} +- {error}, truth {truth}");
        assert!(error <= 0.03 * truth, "{what}, {start:?}: {error} of {truth}");
    }
}

#[test]
fn a_closed_room_keeps_its_flux() {
    check_closed("centre", &room([0.0; 3], 0.5, [0.0; 3]), 0.5, 0.01);
    check_closed("off the centre", &room([0.0; 3], 0.7, [0.6, -0.3, 0.2]), 0.7, 0.01);
}

#[test]
fn a_light_on_a_wall() {
    // A micrometre in front of it: half of the flux lands within a few micrometres, on no piece that any probe has seen.
    let close = [0.2, -1.0 + 1e-6, 0.1];
    check_closed("touching", &room([0.0; 3], 0.5, close), 0.5, 0.6);
    check_closed("a millimetre", &room([0.0; 3], 0.5, [0.2, -0.999, 0.1]), 0.5, 0.6);
}

#[test]
fn a_light_in_the_plane_of_a_triangle() {
    // A shelf whose plane holds the lamp: it gets no direct light, and no direction to it is defined by its normal.
    let mut desc = room([0.0; 3], 0.5, [0.0; 3]);
    desc.shapes.push(shape(
        ShapeKind::Rectangle { center: [0.6, 0.0, 0.0], u: [0.2, 0.0, 0.0], v: [0.0, 0.0, 0.2] },
        "wall",
    ));
    check_closed("in a plane", &desc, 0.5, 0.02);
}

#[test]
fn far_from_the_origin() {
    // 1e5 m away coordinates have steps of 8 mm, and what leaves a wall is lifted off it by 4 cm: so near to an edge that is through the next wall.
    // Each of a photon's two flights (in the mean) loses one in a thousand.
    check_rounded("far", &room([1e5, 1e5, -1e5], 0.5, [0.25, 0.125, -0.25]), 0.5, 0.01, 0.004);
}

#[test]
fn slivers_and_triangles_without_area() {
    let mut desc = room([0.0; 3], 0.5, [0.1, 0.2, -0.3]);
    desc.meshes.push(MeshDesc {
        name: "bad".into(),
        positions: vec![
            [-0.5, -0.5, 0.5],
            [0.5, -0.5, 0.5],
            [0.0, -0.5, 0.5],
            [0.0, -0.5 + 1e-7, 0.5],
            [0.3, 0.1, 0.2],
        ],
        triangles: vec![[0, 1, 2], [0, 1, 3], [4, 4, 4], [0, 4, 4]],
        material: "wall".into(),
        ..MeshDesc::default()
    });
    check_closed("slivers", &desc, 0.5, 0.01);
}

#[test]
fn one_lit_piece_of_a_millionth_of_the_area() {
    // A spot 2 mm wide on a wall of 4 m^2 in a closed room: all of the light lands there.
    let mut desc = room([0.0; 3], 0.5, [0.0; 3]);
    desc.lights = vec![LightDesc::Spot {
        position: [0.1, 0.9, 0.2],
        direction: [0.1, -1.0, 0.05],
        intensity: [1.0; 3],
        cone_deg: 0.03,
        falloff_deg: 0.03,
    }];
    let session = session(&desc, None);
    let omega = std::f64::consts::TAU * (1.0 - 0.03_f64.to_radians().cos());
    for start in [PhotonStart::LIGHTS, on_surfaces(Weights::EXACT)] {
        let (mean, error) = flux(&session, &job(start));
        // cos of 0.03 degrees has three digits in f32: what the light sends is known to so many.
        let allowed = 4.5 * error + 0.15 * omega;
        assert!((mean - omega).abs() <= allowed, "{start:?}: {mean} +- {error}, truth {omega}");
    }
    // No probe finds it: what cannot be seen is said to be dark instead of being guessed.
    let density = session.first_shot(&Subdivision::robust(Weights::Density), Weights::Density);
    assert!(density.is_err_and(|e| e == FirstShotError::Dark));
}

#[test]
fn a_dark_scene_is_named() {
    let mut desc = room([0.0; 3], 0.5, [0.0; 3]);
    desc.lights.clear();
    let dark = session(&desc, None);
    let weights = Weights::EXACT;
    let subdivision = Subdivision::robust(weights);
    assert_eq!(dark.first_shot(&subdivision, weights).unwrap_err(), FirstShotError::Dark);
    assert_eq!(dark.forecast(&subdivision, 1 << 20), Err(BackendError::FirstShot(FirstShotError::Dark)));
    // Lit, but black: nothing is ever sent on.
    let black = session(&room([0.0; 3], 0.0, [0.0; 3]), None);
    assert_eq!(black.first_shot(&subdivision, Weights::Density).unwrap_err(), FirstShotError::Dark);
    let text = FirstShotError::Dark.to_string();
    assert!(text.contains("nothing in the scene emits, or nothing that is lit reflects"), "{text}");
    for share in [0.0, 1.0, -0.1, f32::NAN] {
        let error = black.first_shot(&subdivision, Weights::Exact { share }).unwrap_err();
        assert_eq!(error, FirstShotError::Share);
    }
}

#[test]
fn ten_thousand_lights_stay_within_the_budget() {
    // A grid of 24 x 24 x 2 triangles for each of six walls, and more lights than pairs are allowed for.
    let mut desc = room([0.0; 3], 0.5, [0.0; 3]);
    let lights = 10_000;
    desc.lights = (0..lights)
        .map(|i| {
            let x = |k: i32| ((i * 7919 * k) % 1000) as f32 / 1000.0 * 1.8 - 0.9;
            LightDesc::Point { position: [x(1), x(3), x(7)], intensity: [1e-4 * (1 + i % 3) as f32; 3] }
        })
        .collect();
    let n = 32_u16;
    let mut mesh = MeshDesc { name: "grid".into(), material: "wall".into(), ..MeshDesc::default() };
    for i in 0..=n {
        for j in 0..=n {
            let at = |k: u16| f32::from(k) / f32::from(n) * 1.9 - 0.95;
            mesh.positions.push([at(i), -0.95, at(j)]);
        }
    }
    for i in 0..u32::from(n) {
        for j in 0..u32::from(n) {
            let a = i * (u32::from(n) + 1) + j;
            let b = a + u32::from(n) + 1;
            mesh.triangles.extend([[a, b, a + 1], [a + 1, b, b + 1]]);
        }
    }
    desc.meshes.push(mesh);
    let session = session(&desc, None);
    let triangles = session.scene().triangles.len();
    assert!(triangles * lights as usize > 1 << 22, "the budget must matter");
    let weights = Weights::EXACT;
    let shot = session.first_shot(&Subdivision::robust(weights), weights).unwrap();
    println!("{} pieces, {:.1} MB", shot.pairs(), shot.bytes() as f64 * 1e-6);
    assert!(shot.bytes() < 300_000_000, "{} bytes", shot.bytes());
    let power: f64 = (0..lights).map(|i| 4.0 * std::f64::consts::PI * 1e-4 * f64::from(1 + i % 3)).sum();
    for start in [PhotonStart::LIGHTS, on_surfaces(weights)] {
        let (mean, error) = flux(&session, &job(start));
        assert!(
            (mean - power).abs() <= 4.5 * error + 1e-4 * power,
            "{start:?}: {mean} +- {error}, truth {power}"
        );
    }
}
