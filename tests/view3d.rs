//! Form factors of the scenes of View3D (G. N. Walton, NIST), where `ETENDUE_SCENES` names the folder that has them.
#![cfg(all(feature = "cli", feature = "io", feature = "cpu"))]
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

mod common;

use common::shared_scenes;
use etendue::core::backend::{NoControl, Session};
use etendue::core::radiosity::form_factors::near::NearSettings;
use etendue::core::radiosity::patches::{Patch, PatchSettings};
use etendue::core::scene::{LightDesc, MeshDesc, SceneDesc, compile};
use etendue::cpu::CpuBackend;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

type P = [f32; 3];

/// Quadrilaterals by name.
fn read(path: &Path) -> BTreeMap<String, [P; 4]> {
    let text = std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let mut vertices = BTreeMap::new();
    let mut surfaces = BTreeMap::new();
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words.first() {
            Some(&"V") => {
                let p: Vec<f32> = words[2..5].iter().map(|w| w.parse().unwrap()).collect();
                vertices.insert(words[1].to_owned(), [p[0], p[1], p[2]]);
            }
            Some(&"S") => {
                let corners = [2, 3, 4, 5].map(|k| vertices[words[k]]);
                surfaces.insert(words[9].to_owned(), corners);
            }
            _ => {}
        }
    }
    surfaces
}

/// Whether a patch lies on a quadrilateral, on the side that View3D has as its front: corners run counter-clockwise as seen from there. Ours here lie in axis planes.
fn is_on(patch: &Patch, [a, b, c, _]: &[P; 4], normal_side: f32) -> bool {
    let (u, v): (P, P) = (std::array::from_fn(|k| b[k] - a[k]), std::array::from_fn(|k| c[k] - b[k]));
    let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let height: f32 = (0..3).map(|k| (patch.position[k] - a[k]) * n[k]).sum();
    let cos: f32 = (0..3).map(|k| patch.normal[k] * n[k]).sum();
    height.abs() < 1e-4 && cos * normal_side > 0.0
}

/// Form factors between the fronts (or, at -1, the backs) of two surfaces.
fn form_factors(path: &Path, lamp: bool, wanted: &[(&str, f32, &str, f32)]) -> Vec<f64> {
    let surfaces = read(path);
    let mut mesh = MeshDesc { name: "view3d".into(), ..MeshDesc::default() };
    for corners in surfaces.values() {
        let base = mesh.positions.len() as u32;
        mesh.positions.extend(corners);
        mesh.triangles.extend([[base, base + 1, base + 2], [base, base + 2, base + 3]]);
    }
    let mut desc = SceneDesc { meshes: vec![mesh], ..SceneDesc::default() };
    if lamp {
        desc.lights.push(LightDesc::Point { position: [0.4, 0.5, 0.6], intensity: [1.0; 3] });
    }
    let scene = compile(&desc).unwrap_or_else(|e| panic!("{e}")).0;
    let session = CpuBackend::new(None).unwrap().open_session(Arc::new(scene)).unwrap();
    let map = session.patches(&PatchSettings { count: 60, seed: 1 }).unwrap();
    let list = map.patches.list();
    let of = |name: &str, side: f32| -> Vec<u32> {
        (0..list.len() as u32).filter(|i| is_on(&list[*i as usize], &surfaces[name], side)).collect()
    };
    let settings = NearSettings { seed: 4, points: 1024 };
    wanted
        .iter()
        .map(|(from, a, to, b)| {
            let (from, to) = (of(from, *a), of(to, *b));
            let pairs: Vec<[u32; 2]> = from.iter().flat_map(|i| to.iter().map(|j| [*i, *j])).collect();
            let area: f64 = from.iter().map(|i| f64::from(list[*i as usize].area)).sum();
            assert!((area - 1.0).abs() < 1e-5 && !pairs.is_empty(), "{area}");
            let found = session.near_form_factors(&map, &pairs, &settings, &NoControl).unwrap();
            found.iter().map(|p| p.flux).sum::<f64>() / area
        })
        .collect()
}

#[test]
fn shared_form_factors_are_those_of_view3d() {
    let Some(folder) = shared_scenes() else { return };
    let folder = folder.join("view3d");
    let text = std::fs::read_to_string(folder.join("EXPECTED.json")).unwrap_or_else(|e| panic!("{e}"));
    let truth: serde_json::Value = serde_json::from_str(&text).unwrap();
    let truth = |name: &str| truth[name].as_f64().unwrap_or_else(|| panic!("no {name}"));
    // Fronts are inside.
    let cube = form_factors(
        &folder.join("cube.vs3"),
        true,
        &[("zeq0", 1.0, "zeq1", 1.0), ("zeq0", 1.0, "xeq1", 1.0), ("yeq1", 1.0, "xeq0", 1.0)],
    );
    for (found, truth) in cube.iter().zip([truth("F_unobstructed"), 0.200_043_776_075, 0.200_043_776_075]) {
        println!("{found} {truth}: {:+.1e}", found / truth - 1.0);
        assert!((found / truth - 1.0).abs() <= 1e-3, "{found} {truth}");
    }
    let between = form_factors(
        &folder.join("square-obstruction.vs3"),
        false,
        &[("zeq0.0", 1.0, "zeq1.0", 1.0), ("zeq0.0", 1.0, "zeq0.5", -1.0)],
    );
    let truths = [truth("F12_obstructed"), truth("F_from_z0_square_to_obstruction")];
    for ((found, truth), tolerance) in between.iter().zip(truths).zip([1e-2, 1e-3]) {
        println!("{found} {truth}: {:+.1e}", found / truth - 1.0);
        assert!((found / truth - 1.0).abs() <= tolerance, "{found} {truth}");
    }
}
