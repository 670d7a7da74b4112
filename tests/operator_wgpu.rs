//! Operators baked on the device and on the CPU are the same, and relight on either.
#![cfg(all(feature = "io", feature = "cpu", feature = "wgpu"))]

mod common;

use common::{device, root};
use etendue::core::backend::{Arithmetic, Backend, BackendError, Session};
use etendue::core::radiosity::patches::PatchSettings;
use etendue::core::scene::{CompiledScene, compile};
use etendue::cpu::CpuBackend;
use etendue::driver::radiosity::{BakeError, BakeSettings, Codec, Light, bake, relit};
use etendue::driver::{Progress, Silent, Watcher, open_operator, operator_file};
use etendue::io::{encode_operator, load_scene, parse_operator};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

fn load(file: &str) -> Arc<CompiledScene> {
    let loaded = load_scene(&root().join("scenes").join(file)).unwrap_or_else(|e| panic!("{e}"));
    Arc::new(compile(&loaded.desc).unwrap_or_else(|e| panic!("{e}")).0)
}

fn settings(codec: Codec) -> BakeSettings {
    let patches = PatchSettings { count: 300, seed: 3 };
    BakeSettings { patches, rays: 256, codec, passes: None, bounces: None }
}

/// The bytes of an operator's file.
fn file(session: &dyn Session, codec: Codec) -> Vec<u8> {
    let made = bake(session, &settings(codec), &Silent).unwrap_or_else(|e| panic!("{e}"));
    let file = operator_file(&made, &settings(codec), session.scene());
    encode_operator(&file, Path::new("a.etd")).unwrap()
}

/// Indirect irradiance on patches, and all but the direct on elements.
fn light(session: &dyn Session, bytes: &[u8]) -> [Light; 2] {
    let operator = open_operator(parse_operator(bytes, Path::new("a.etd")).unwrap(), session).unwrap();
    let relit = relit(session, &operator, 1, &Silent).unwrap_or_else(|e| panic!("{e}"));
    [relit.indirect, relit.values]
}

#[test]
fn operators_of_both_backends_are_the_same_and_relight_on_either() {
    let Some(device) = device() else { return };
    if device.arithmetic() != Arithmetic::Ieee {
        eprintln!("SKIPPED: bits are the CPU's on IEEE 754 alone");
        return;
    }
    let cpu = CpuBackend::new(None).unwrap();
    let codecs = [
        ("cornell/closed.toml", Codec::Auto { max_error: 0.03 }),
        ("cornell/closed.toml", Codec::Bc1 { keep: 0.02 }),
        ("colonnade/lamps.toml", Codec::Auto { max_error: 0.03 }),
        ("colonnade/lamps.toml", Codec::Bc4 { keep: 0.02 }),
    ];
    for (name, codec) in codecs {
        let scene = load(name);
        let (ours, theirs) = (device.open(scene.clone()).unwrap(), cpu.open(scene).unwrap());
        let (found, expected) = (file(&*ours, codec), file(&*theirs, codec));
        assert!(found == expected, "{name} {codec:?}: {} and {} bytes", found.len(), expected.len());
        let lit = light(&*theirs, &found);
        assert!(lit[1].as_flattened().iter().any(|x| *x > 0.0), "{name}");
        assert!(light(&*ours, &expected) == lit, "{name} {codec:?}");
    }
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
    let found = bake(&*session, &settings(Codec::Tiles), &Impatient(1.into()));
    assert!(matches!(found, Err(BakeError::Backend(BackendError::Cancelled))), "{:?}", found.err());
}
