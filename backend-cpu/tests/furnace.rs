//! Closed rooms in which the answer is known everywhere.

#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use etendue_core::backend::{NoControl, PathJob, Probe, Session, probe_film_settings};
use etendue_core::film::Film;
use etendue_core::scene::{
    MaterialDesc, MaterialKind, Reflectance, SceneDesc, ShapeDesc, ShapeKind, compile,
};
use etendue_cpu::CpuBackend;
use std::sync::Arc;

/// A closed box or sphere seen from inside, everywhere of radiance Le = 1 and albedo rho: irradiance pi / (1 - rho).
fn furnace(kind: ShapeKind, rho: f32) -> SceneDesc {
    SceneDesc {
        materials: vec![MaterialDesc {
            name: "wall".into(),
            kind: MaterialKind::Diffuse { albedo: Reflectance::flat([rho; 3]) },
            two_sided: true,
            emission: [1.0; 3],
        }],
        shapes: vec![ShapeDesc {
            kind,
            material: "wall".into(),
            interior: String::new(),
            exterior: String::new(),
        }],
        ..SceneDesc::default()
    }
}

fn irradiance(desc: &SceneDesc, probe: Probe, max_depth: u32) -> ([f64; 3], [f64; 3]) {
    let (scene, report) = compile(desc).unwrap();
    assert!(report.cleanups.is_empty(), "{report:?}");
    let session = CpuBackend::new(None).unwrap().open_session(Arc::new(scene)).unwrap();
    let job = PathJob { seed: 1, block_length: 256, blocks: 0..64, max_depth };
    let mut film = Film::new(probe_film_settings(session.scene(), &job, 1));
    session.path_probes(&job, &[probe], &NoControl, &mut film).unwrap();
    assert_eq!(film.invalid(), 0);
    (film.mean(0), film.variance(0).unwrap())
}

/// An inside-out box: its fronts face inward where max < min would be refused, so it is made of rectangles.
fn room(rho: f32) -> SceneDesc {
    let mut desc = furnace(ShapeKind::Sphere { center: [0.0; 3], radius: 1.0 }, rho);
    desc.shapes.clear();
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0_f32]];
    for i in 0..3 {
        for side in [1.0, -1.0_f32] {
            let center = axes[i].map(|x| x * side);
            let (mut u, v) = (axes[(i + 1) % 3], axes[(i + 2) % 3]);
            // u x v points along +axis i; the front must face the centre.
            if side > 0.0 {
                u = u.map(|x| -x);
            }
            desc.shapes.push(ShapeDesc {
                kind: ShapeKind::Rectangle { center, u, v },
                material: "wall".into(),
                interior: String::new(),
                exterior: String::new(),
            });
        }
    }
    desc
}

#[test]
fn a_closed_room_has_the_same_radiance_everywhere() {
    for rho in [0.0_f32, 0.5, 0.9] {
        let probe = Probe { position: [0.3, -1.0, 0.2], normal: [0.0, 1.0, 0.0] };
        let (mean, variance) = irradiance(&room(rho), probe, u32::MAX);
        let truth = std::f64::consts::PI / (1.0 - f64::from(rho));
        for c in 0..3 {
            let stderr = variance[c].max(0.0).powf(0.5);
            let z = (mean[c] - truth).abs() / (stderr + 1e-6 * truth);
            assert!(z <= 4.0, "rho {rho}: {} against {truth}, {z} standard errors of {stderr}", mean[c]);
            assert!(stderr <= 0.01 * truth, "rho {rho}: {stderr}");
        }
    }
}

#[test]
fn bounces_add_up_one_by_one() {
    let probe = Probe { position: [0.3, -1.0, 0.2], normal: [0.0, 1.0, 0.0] };
    let mut sum = 0.0;
    for depth in 1..6 {
        sum += 0.5_f64.powi(depth - 1);
        let (mean, variance) = irradiance(&room(0.5), probe, depth as u32);
        let truth = std::f64::consts::PI * sum;
        let stderr = variance[0].powf(0.5);
        assert!((mean[0] - truth).abs() <= 4.0 * stderr + 1e-6, "depth {depth}: {} {truth}", mean[0]);
    }
}
