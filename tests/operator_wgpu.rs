//! Operators baked on the device and on the CPU are the same, and relight on either.
#![cfg(all(feature = "io", feature = "cpu", feature = "wgpu"))]

mod common;

use common::{device, root};
use etendue::core::backend::{Arithmetic, Backend, BackendError, Session};
use etendue::core::radiosity::patches::PatchSettings;
use etendue::core::scene::{CompiledScene, compile};
use etendue::cpu::CpuBackend;
use etendue::driver::radiosity::{BakeError, BakeSettings, Codec, Light, Order, bake, relit};
use etendue::driver::{Progress, Silent, Watcher, open_operator, operator_file};
use etendue::io::{encode_operator, load_scene, parse_operator};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

fn load(file: &str) -> Arc<CompiledScene> {
    let loaded = load_scene(&root().join("scenes").join(file)).unwrap_or_else(|e| panic!("{e}"));
    Arc::new(compile(&loaded.desc).unwrap_or_else(|e| panic!("{e}")).0)
}

fn settings(count: u32, codec: Codec) -> BakeSettings {
    let patches = PatchSettings { count, seed: 3 };
    BakeSettings { patches, rays: 128, codec, passes: None, bounces: None }
}

/// The bytes of an operator's file.
fn file(session: &dyn Session, settings: &BakeSettings) -> Vec<u8> {
    let made = bake(session, settings, &Silent).unwrap_or_else(|e| panic!("{e}"));
    let file = operator_file(&made, settings, session.scene());
    encode_operator(&file, Path::new("a.etd")).unwrap()
}

/// Indirect irradiance on patches, and all but the direct on elements.
fn light(session: &dyn Session, bytes: &[u8]) -> [Light; 2] {
    let operator = open_operator(parse_operator(bytes, Path::new("a.etd")).unwrap(), session).unwrap();
    let relit = relit(session, &operator, 1, &Silent).unwrap_or_else(|e| panic!("{e}"));
    [relit.indirect, relit.values]
}

/// Bakes on both, and relights what the other has baked.
fn check(jobs: &[(&str, u32, Codec)]) {
    let Some(device) = device() else { return };
    if device.arithmetic() != Arithmetic::Ieee {
        return eprintln!("SKIPPED: bits are the CPU's on IEEE 754 alone");
    }
    let cpu = CpuBackend::new(None).unwrap();
    for (name, count, codec) in jobs {
        let (scene, settings) = (load(name), settings(*count, *codec));
        let (ours, theirs) = (device.open(scene.clone()).unwrap(), cpu.open(scene).unwrap());
        let (found, expected) = (file(&*ours, &settings), file(&*theirs, &settings));
        assert!(found == expected, "{name} {codec:?}: {} and {} bytes", found.len(), expected.len());
        let lit = light(&*theirs, &found);
        assert!(lit[1].as_flattened().iter().any(|x| *x > 0.0), "{name}");
        assert!(light(&*ours, &expected) == lit, "{name} {codec:?}");
    }
}

#[test]
fn operators_of_both_backends_are_the_same_and_relight_on_either() {
    check(&[
        ("cornell/closed.toml", 60, Codec::Auto { max_error: 0.05 }),
        ("colonnade/lamps.toml", 60, Codec::Bc1 { keep: 0.02 }),
    ]);
}

#[test]
#[ignore = "minutes: cargo nextest run -p etendue --test operator_wgpu --run-ignored only"]
fn larger_operators_of_both_backends_are_the_same() {
    check(&[
        ("cornell/closed.toml", 400, Codec::Auto { max_error: 0.02 }),
        ("colonnade/lamps.toml", 300, Codec::Auto { max_error: 0.03 }),
        ("colonnade/lamps.toml", 300, Codec::Bc4 { keep: 0.02 }),
        (
            "cornell/closed.toml",
            200,
            Codec::Published { bounces: Some(3), keep: 0.01, order: Order::Greedy1 },
        ),
    ]);
}

/// Stops a bake after some calls.
struct Impatient(AtomicU32);

impl Watcher for Impatient {
    fn progress(&self, _: &Progress) {}

    fn cancelled(&self) -> bool {
        self.0.fetch_sub(1, Ordering::Relaxed) <= 1
    }
}

#[test]
fn a_bake_on_the_device_can_be_stopped() {
    let Some(device) = device() else { return };
    let session = device.open(load("cornell/closed.toml")).unwrap();
    let found = bake(&*session, &settings(100, Codec::Tiles), &Impatient(1.into()));
    assert!(matches!(found, Err(BakeError::Backend(BackendError::Cancelled))), "{:?}", found.err());
}
