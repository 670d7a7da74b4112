//! Closed rooms with exact balances.

use super::cases::{Case, Measure, POWER, ROUNDING, probes};
use super::{camera, diffuse, material, point_light, probe, room, round_room, sphere};
use etendue_core::scene::{MaterialKind, Reflectance, SceneDesc};
use std::f64::consts::PI;

const HOMOGENEOUS: &str = "homogeneous closed environment, L = Le / (1 - rho): P. Shirley, Eurographics 1991";

pub(super) fn cases() -> Vec<Case> {
    let mut all = vec![
        furnace("furnace_cube", false, 0.5, u32::MAX, 1024),
        furnace("furnace_sphere", true, 0.8, u32::MAX, 1024),
        furnace("furnace_cube_bright", false, 0.9, u32::MAX, 2048),
        mirror_room(),
    ];
    // Truncation: 1 + rho + ... + rho^k after k bounces, edge k + 1.
    for (k, rho) in [(0, 0.5), (1, 0.5), (2, 0.5), (5, 0.5), (10, 0.8)] {
        all.push(furnace(&format!("furnace_after_{k}_bounces"), false, rho, k + 1, 512));
    }
    all.push(furnace_view());
    all.extend(integrating_sphere());
    all.extend(concentric());
    all.push(cube_mean());
    all
}

fn furnace_sum(rho: f64, max_depth: u32) -> f64 {
    if max_depth == u32::MAX { 1.0 / (1.0 - rho) } else { (0..max_depth).map(|k| rho.powi(k as i32)).sum() }
}

/// Every surface emits radiance 1 and reflects rho: irradiance pi L anywhere.
fn furnace(name: &str, round: bool, rho: f32, max_depth: u32, samples: u32) -> Case {
    let walls = if round { round_room(2.0, 2, "wall") } else { room([0.0; 3], 1.0, "wall") };
    let scene =
        SceneDesc { meshes: vec![walls], materials: vec![diffuse("wall", rho, 1.0)], ..SceneDesc::default() };
    let e = PI * furnace_sum(f64::from(rho), max_depth);
    // One in the middle of the air, one on a wall (of the cube).
    let mut list = vec![(probe([0.1, -0.2, 0.3], [0.0, 0.6, 0.8]), e)];
    if !round {
        list.push((probe([0.3, 0.2, -1.0], [0.0, 0.0, 1.0]), e));
        list.push((probe([1.0, -0.9, 0.95], [-1.0, 0.0, 0.0]), e));
    }
    let mut case = probes(name, HOMOGENEOUS, scene, list, max_depth, samples);
    // f32 loses a little at each of many bounces.
    case.rounding = 2e-5;
    case
}

/// The same seen by a camera.
fn furnace_view() -> Case {
    let mut scene = SceneDesc {
        meshes: vec![room([0.0; 3], 1.0, "wall")],
        materials: vec![diffuse("wall", 0.5, 1.0)],
        ..SceneDesc::default()
    };
    scene.camera = Some(camera([0.5, 0.4, 0.3], [-1.0, -0.3, 0.0], 80.0, [6, 4]));
    Case {
        name: "furnace_view".into(),
        source: HOMOGENEOUS,
        scene,
        measure: Measure::Pixels,
        max_depth: u32::MAX,
        truth: vec![[2.0; 3]; 24],
        samples: 512,
        rounding: 2e-5,
        power: POWER,
    }
}

/// Mirrors of reflectance r that emit 1 each show 1 / (1 - r) along every ray.
fn mirror_room() -> Case {
    let mirror = material("wall", MaterialKind::Mirror { albedo: Reflectance::flat([0.7, 0.5, 0.2]) }, 1.0);
    let scene = SceneDesc {
        meshes: vec![room([0.0; 3], 1.0, "wall")],
        materials: vec![mirror],
        ..SceneDesc::default()
    };
    let e = [0.7_f32, 0.5, 0.2].map(|r| PI / (1.0 - f64::from(r)));
    Case {
        name: "mirror_room".into(),
        source: "each reflection multiplies by r: L = Le / (1 - r)",
        scene,
        measure: Measure::Probes(vec![probe([0.1, -0.2, 0.3], [0.0, 0.6, 0.8])]),
        max_depth: u32::MAX,
        truth: vec![e],
        samples: 4096,
        rounding: 2e-5,
        power: POWER,
    }
}

/// A point light at the centre of a sphere: E = Phi / (4 pi R^2) / (1 - rho), the same everywhere.
fn integrating_sphere() -> Vec<Case> {
    let mut out = Vec::new();
    for (name, rho, light) in [("centre", 0.5_f32, [0.0; 3]), ("eccentric", 0.8, [0.5, 0.4, -0.3])] {
        let scene = SceneDesc {
            shapes: vec![sphere([0.0; 3], 2.0, "wall")],
            materials: vec![diffuse("wall", rho, 0.0)],
            lights: vec![point_light(light, (100.0 / (4.0 * PI)) as f32)],
            ..SceneDesc::default()
        };
        let mean = 100.0 / (4.0 * PI * 4.0);
        let list = [[0.0, 0.0, -1.0], [0.6, 0.0, 0.8], [0.0, -1.0, 0.0_f32]]
            .map(|n: [f32; 3]| {
                let p = n.map(|x| 2.0 * x);
                // Direct light from where the source is; the first reflection makes it uniform.
                let to = [0, 1, 2].map(|k| f64::from(light[k]) - f64::from(p[k]));
                let d2: f64 = to.iter().map(|x| x * x).sum();
                let cos: f64 = (0..3).map(|k| -to[k] * f64::from(n[k])).sum::<f64>() / d2.sqrt();
                let direct = 100.0 / (4.0 * PI) * cos / d2;
                let rho = f64::from(rho);
                (probe(p, n.map(|x| -x)), direct + mean * rho / (1.0 - rho))
            })
            .to_vec();
        let source = "integrating-sphere theory: form factors inside a sphere are A2 / (4 pi R^2)";
        let samples = if rho > 0.6 { 4096 } else { 1024 };
        let mut case = probes(format!("integrating_sphere_{name}"), source, scene, list, u32::MAX, samples);
        case.rounding = 2e-5;
        out.push(case);
    }
    out
}

/// B1 = M1 + rho1 B2, B2 = rho2 (F21 B1 + F22 B2), F21 = (r1/r2)^2; the outer wall receives B2 / rho2, the inner one B2.
fn concentric() -> Vec<Case> {
    let mut out = Vec::new();
    for (name, r2, rho1, rho2) in [("near", 2.0_f32, 0.5_f32, 0.8_f32), ("far", 3.0, 0.0, 0.9)] {
        let scene = SceneDesc {
            shapes: vec![sphere([0.0; 3], 1.0, "inner"), sphere([0.0; 3], r2, "outer")],
            materials: vec![diffuse("inner", rho1, (1.0 / PI) as f32), diffuse("outer", rho2, 0.0)],
            ..SceneDesc::default()
        };
        let [a, b] = [rho1, rho2].map(f64::from);
        let f21 = 1.0 / f64::from(r2).powi(2);
        let b2 = b * f21 / (1.0 - b * (1.0 - f21) - a * b * f21);
        let list = vec![
            (probe([0.0, 0.0, -r2], [0.0, 0.0, 1.0]), b2 / b),
            (probe([0.6 * r2, 0.8 * r2, 0.0], [-0.6, -0.8, 0.0]), b2 / b),
            (probe([0.0, 1.0, 0.0], [0.0, 1.0, 0.0]), b2),
        ];
        let source = "flux balance of two spheres (enclosure theory)";
        let mut case = probes(format!("concentric_spheres_{name}"), source, scene, list, u32::MAX, 4096);
        case.rounding = 2e-5;
        out.push(case);
    }
    out
}

/// The mean over the walls of any room is Phi / S / (1 - rho) (CIE 171 TC 5.8): a grid of probes over one wall, which
/// stands for all six as the source is at the centre of the cube.
fn cube_mean() -> Case {
    let scene = SceneDesc {
        meshes: vec![room([0.0; 3], 2.0, "wall")],
        materials: vec![diffuse("wall", 0.5, 0.0)],
        lights: vec![point_light([0.0; 3], (10_000.0 / (4.0 * PI)) as f32)],
        ..SceneDesc::default()
    };
    // Midpoints over a quarter of the wall, 24 a side.
    const SIDE: usize = 24;
    let mut list = Vec::new();
    for i in 0..SIDE {
        for j in 0..SIDE {
            let at = |i: usize| (2.0 * (i as f64 + 0.5) / SIDE as f64) as f32;
            list.push(probe([at(i), at(j), -2.0], [0.0, 0.0, 1.0]));
        }
    }
    Case {
        name: "cube_mean".into(),
        source: "flux balance, E = Phi / S / (1 - rho); CIE 171:2006 TC 5.8",
        scene,
        measure: Measure::ProbeMean(list),
        max_depth: u32::MAX,
        truth: vec![[10_000.0 / 96.0 / 0.5; 3]],
        samples: 64,
        // The midpoint rule over direct light I h / (h^2 + r^2)^(3/2): 1e-4.
        rounding: 1e-4 + ROUNDING,
        power: POWER,
    }
}
