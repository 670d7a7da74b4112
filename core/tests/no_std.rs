//! Core stands without std: the probe links a static library with its own panic handler and allocator.
//! The control leaks std into the same probe and must be refused, so that a green probe means something.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// Builds a copy of the probe in its own folder, with the workspace's lock file: the versions that are tested are the
/// ones that ship, and nothing is downloaded.
fn build(name: &str, leak: bool) -> Output {
    let core = Path::new(env!("CARGO_MANIFEST_DIR"));
    let probe = core.join("tests/no_std_probe");
    let copy = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::create_dir_all(copy.join("src")).expect("target is writable");
    let manifest = fs::read_to_string(probe.join("Cargo.toml")).expect("the probe has a manifest");
    let path = format!("path = {:?}", core.to_str().expect("a path in UTF-8"));
    assert!(manifest.contains("path = \"../..\""), "the probe names core by its relative path");
    fs::write(copy.join("Cargo.toml"), manifest.replace("path = \"../..\"", &path))
        .expect("target is writable");
    fs::copy(probe.join("src/lib.rs"), copy.join("src/lib.rs")).expect("the probe has a source");
    fs::copy(core.join("../Cargo.lock"), copy.join("Cargo.lock")).expect("the workspace has a lock file");
    let mut cargo = Command::new(env!("CARGO"));
    // One folder for both, so that core is compiled once.
    cargo.current_dir(&copy).args(["build", "--offline", "--target-dir", "../no_std_target"]);
    if leak {
        cargo.args(["--features", "leak_std"]);
    }
    cargo.env_remove("RUSTFLAGS").env_remove("CARGO_ENCODED_RUSTFLAGS");
    cargo.output().expect("cargo runs")
}

#[test]
fn core_links_without_std() {
    let out = build("no_std_probe", false);
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
}

#[test]
fn a_leaked_std_is_refused() {
    let out = build("no_std_probe_leaky", true);
    let log = String::from_utf8_lossy(&out.stderr);
    assert!(!out.status.success(), "the probe linked although std was in it");
    assert!(log.contains("E0152"), "refused for another reason than a second panic handler:\n{log}");
}
