//! The radiosity operator on whole scenes: what its codec costs, and the light of the path tracer.
#![cfg(all(feature = "io", feature = "cpu"))]
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

mod common;

use common::root;
use etendue::core::backend::{GivenMap, Probe, Session};
use etendue::core::radiosity::patches::PatchSettings;
use etendue::core::scene::{LightDesc, SceneDesc, compile};
use etendue::cpu::{CpuBackend, CpuSession};
use etendue::driver::radiosity::{
    BakeSettings, Baked, Codec, Order, Rooms, Truth, bake, map_probes, patch_light, radiosity_map, relight,
};
use etendue::driver::{self, Budget, OpenError, Settings, Silent, open_operator, operator_file};
use etendue::io::{encode_operator, load_scene, parse_operator};
use std::path::Path;
use std::sync::Arc;

fn load(file: &str) -> SceneDesc {
    load_scene(&root().join("scenes").join(file)).unwrap_or_else(|e| panic!("{e}")).desc
}

fn open(desc: &SceneDesc) -> CpuSession {
    let scene = compile(desc).unwrap_or_else(|e| panic!("{e}")).0;
    CpuBackend::new(None).unwrap().open_session(Arc::new(scene)).unwrap()
}

fn baked(session: &dyn Session, count: u32, codec: Codec) -> Baked {
    let settings = BakeSettings {
        patches: PatchSettings { count, seed: 3 },
        rays: 1024,
        codec,
        passes: None,
        bounces: None,
    };
    bake(session, &settings, &Silent).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn the_codec_keeps_its_error_and_its_energy() {
    for file in ["cornell/closed.toml", "colonnade/lamps.toml"] {
        let session = open(&load(file));
        let full = baked(&session, 1000, Codec::F32);
        assert!(full.error.rms < 0.005 && full.error.energy < 5e-3, "{file}: {:?}", full.error);
        let small = baked(&session, 1000, Codec::Auto { max_error: 0.02 });
        let n = small.operator.map.patches.len() as f64;
        let [a, b] = [&full, &small].map(|x| x.operator.bytes() as f64 / (n * n));
        println!("{file}: {n} patches, {a:.3} and {b:.3} bytes a pair, {:?}", small.error);
        assert!(small.error.rms <= 0.02 && small.error.energy < 0.015, "{file}: {:?}", small.error);
        assert!(b < 0.25 * a, "{file}: {b} bytes a pair, {a} in f32");
    }
}

#[test]
fn probes_from_an_operator_agree_with_paths() {
    let session = open(&load("cornell/closed.toml"));
    let made = baked(&session, 1500, Codec::Auto { max_error: 0.01 });
    let light = patch_light(&session, &made.operator, 1, &Silent).unwrap();
    let indirect = relight(&session, &made.operator, &light, &mut Rooms::default()).unwrap();
    let values = radiosity_map(&session, &made.operator, &light, &indirect).unwrap();
    let probes: Vec<Probe> = [
        ([2.7, 2.0, 5.592], [0.0, 0.0, -1.0]),
        ([1.0, 5.488, 1.0], [0.0, -1.0, 0.0]),
        ([4.5, 0.0, 1.2], [0.0, 1.0, 0.0]),
        ([5.5, 2.0, 2.0], [-1.0, 0.0, 0.0]),
    ]
    .map(|(position, normal)| Probe { position, normal })
    .to_vec();
    let settings = Settings { budget: Budget::Samples(4096), ..Settings::default() };
    let paths =
        driver::probes(&session, &probes, &Settings { budget: Budget::Samples(65536), ..settings }, &Silent)
            .unwrap();
    let elements = *made.operator.map.elements.settings();
    let view = GivenMap { elements, values: &values, gather: true };
    let found = map_probes(&session, &probes, &settings, &view, &Silent).unwrap();
    for i in 0..probes.len() {
        let (x, y) = (found.film.mean(i), paths.film.mean(i));
        println!("{x:.4?} from the operator, {y:.4?} by paths");
        for c in 0..3 {
            assert!((x[c] / y[c] - 1.0).abs() < 0.03, "probe {i}: {x:?} from the operator, {y:?} by paths");
        }
    }
}

#[test]
fn a_file_brings_the_operator_back() {
    let desc = load("cornell/closed.toml");
    let session = open(&desc);
    let settings = BakeSettings {
        patches: PatchSettings { count: 300, seed: 3 },
        rays: 256,
        codec: Codec::Auto { max_error: 0.05 },
        passes: None,
        bounces: None,
    };
    let made = bake(&session, &settings, &Silent).unwrap();
    let file = operator_file(&made, &settings, session.scene());
    let bytes = encode_operator(&file, Path::new("a.etd")).unwrap();
    let back = || parse_operator(&bytes, Path::new("a.etd")).unwrap();
    assert_eq!(back(), file);

    // Another session, and other lights.
    let mut lit = desc.clone();
    lit.camera = None;
    lit.lights = vec![
        LightDesc::Point { position: [2.0, 3.0, 1.0], intensity: [9.0, 5.0, 1.0] };
        lit.lights.len() + 1
    ];
    for desc in [&desc, &lit] {
        let session = open(desc);
        let operator = open_operator(back(), &session).unwrap();
        assert_eq!(operator.transport, made.operator.transport);
        assert_eq!(operator.map.patches, made.operator.map.patches);
        assert_eq!(operator.map.elements, made.operator.map.elements);
        assert_eq!(operator.escaped, made.operator.escaped);
        let light = |operator| {
            let light = patch_light(&session, operator, 1, &Silent).unwrap();
            relight(&session, operator, &light, &mut Rooms::default()).unwrap()
        };
        let found = light(&operator);
        assert_eq!(found, light(&made.operator));
        assert!(found.iter().any(|e| e[0] > 0.0));
    }

    let mut moved = desc.clone();
    moved.meshes[0].positions[0][0] += 1e-3;
    let other = open(&moved);
    assert!(matches!(open_operator(back(), &other), Err(OpenError::OtherScene { .. })));
    let mut wrong = back();
    wrong.info.elements.largest *= 0.5;
    assert!(matches!(open_operator(wrong, &session), Err(OpenError::Elements { .. })));
    let mut wrong = back();
    wrong.patches[5].albedo[0] *= 0.5;
    assert_eq!(open_operator(wrong, &session).unwrap_err(), OpenError::Patch { patch: 5 });
    let mut wrong = back();
    let (a, b) = (wrong.of.iter().position(|p| *p == 0), wrong.of.iter().position(|p| *p == 1));
    wrong.of.swap(a.unwrap(), b.unwrap());
    assert!(matches!(open_operator(wrong, &session), Err(OpenError::Patch { patch: 0 | 1 })));
}

/// Error of the indirect radiosity of an evenly lit scene, by area, against form factors in f32.
fn radiosity_error(session: &dyn Session, made: &Baked) -> f64 {
    let map = &made.operator.map;
    let albedo: Vec<[f32; 3]> = map.patches.list().iter().map(|p| p.albedo).collect();
    let truth = Truth::new(session, &made.form_factors, map, &albedo, None).unwrap();
    // The last light is the even one.
    let (direct, exact) = (truth.lights.last().unwrap(), truth.exact.last().unwrap());
    let mut found = vec![[0.0; 3]; albedo.len()];
    made.operator.transport.relight(session, (direct, &[]), &mut found, 1, &mut Rooms::default()).unwrap();
    let (mut moved, mut all) = (0.0, 0.0);
    for (i, rho) in albedo.iter().enumerate() {
        for c in 0..3 {
            let [x, y] = [found[i][c], exact[i][c]].map(|e| f64::from(rho[c] * e));
            let area = f64::from(made.form_factors.areas[i]);
            moved += area * (x - y) * (x - y);
            all += area * y * y;
        }
    }
    (moved / all).sqrt()
}

#[test]
fn every_codec_bakes_the_same_bytes_with_any_number_of_threads_and_comes_back() {
    let desc = load("cornell/closed.toml");
    let scene = Arc::new(compile(&desc).unwrap().0);
    let keep = 0.04;
    for (codec, most) in [
        (Codec::Auto { max_error: 0.05 }, 0.05),
        (Codec::Tiles, 0.03),
        (Codec::F16, 0.006),
        (Codec::Published { bounces: Some(3), keep, order: Order::Greedy2 }, 0.25),
        (Codec::Published { bounces: None, keep, order: Order::Voxels }, 0.5),
        (Codec::Bc1 { keep }, 0.12),
        (Codec::Bc4 { keep }, 0.06),
    ] {
        let settings = BakeSettings {
            patches: PatchSettings { count: 300, seed: 3 },
            rays: 256,
            codec,
            passes: None,
            bounces: None,
        };
        let made = [1, 2, 5].map(|threads| {
            let session = CpuBackend::new(Some(threads)).unwrap().open_session(scene.clone()).unwrap();
            let made = bake(&session, &settings, &Silent).unwrap();
            let file = operator_file(&made, &settings, session.scene());
            (encode_operator(&file, Path::new("a.etd")).unwrap(), made)
        });
        assert!(made[0].0 == made[1].0 && made[0].0 == made[2].0, "{codec:?}");
        let (bytes, made) = &made[0];
        let n = made.operator.map.patches.len() as f64;
        println!("{codec:?}: {:?}, {:.3} bytes a pair", made.error, made.operator.bytes() as f64 / (n * n));
        let session = open(&desc);
        // The published codec gives radiosity: divided by the albedo of dark channels, its errors say nothing.
        let published = matches!(codec, Codec::Published { .. });
        let error = if published { radiosity_error(&session, made) } else { made.error.rms };
        println!("{error}");
        assert!(error <= most, "{codec:?}: {error}, {:?}", made.error);
        let back = open_operator(parse_operator(bytes, Path::new("a.etd")).unwrap(), &session).unwrap();
        assert_eq!(back.transport, made.operator.transport, "{codec:?}");
        assert_eq!(back.passes, made.operator.passes);
    }
}

#[test]
fn so_many_bounces_are_so_many() {
    let session = open(&load("cornell/closed.toml"));
    let settings = |bounces| BakeSettings {
        patches: PatchSettings { count: 200, seed: 3 },
        rays: 256,
        codec: Codec::F32,
        passes: None,
        bounces,
    };
    let made = [Some(1), Some(2), Some(30), None].map(|k| bake(&session, &settings(k), &Silent).unwrap());
    let n = made[0].operator.map.patches.len();
    let mut direct = vec![[0.0; 3]; n];
    direct[n / 2] = [1.0; 3];
    let [one, two, many, all] = made.each_ref().map(|made| {
        let mut found = vec![[0.0; 3]; n];
        let operator = &made.operator;
        let light = (&direct[..], &[][..]);
        operator
            .transport
            .relight(&session, light, &mut found, operator.passes, &mut Rooms::default())
            .unwrap();
        found.iter().zip(operator.map.patches.list()).map(|(e, p)| f64::from(e[0] * p.area)).sum::<f64>()
    });
    assert!(one > 0.0 && two > 1.2 * one && many > 1.2 * two, "{one} {two} {many}");
    assert!((many / all - 1.0).abs() < 0.02, "{many} in thirty bounces, {all} in all");
}
