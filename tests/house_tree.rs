//! What core may depend on. Each new crate below it is a decision, so it has to be made here.

use std::collections::BTreeSet;
use std::process::Command;

/// Names of the crates in `cargo tree` of core, without core itself.
fn tree(options: &[&str]) -> BTreeSet<String> {
    let out = Command::new(env!("CARGO"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(["tree", "--offline", "--locked", "-p", "etendue-core", "-e", "normal", "--prefix", "none"])
        .args(options)
        .output()
        .expect("cargo runs");
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let names: BTreeSet<String> = String::from_utf8_lossy(&out.stdout)
        .lines()
        .filter_map(|line| line.split_whitespace().next())
        .filter(|&name| name != "etendue-core")
        .map(str::to_owned)
        .collect();
    assert!(!names.is_empty(), "cargo tree printed nothing");
    names
}

fn set(names: &[&str]) -> BTreeSet<String> {
    names.iter().map(|&name| name.to_owned()).collect()
}

#[test]
fn core_depends_on_four_crates() {
    assert_eq!(tree(&["--depth", "1"]), set(&["bytemuck", "glam", "half", "libm"]));
}

#[test]
fn nothing_else_hides_below_them() {
    let allowed = set(&[
        "bytemuck",
        "glam",
        "half",
        "libm",
        // bytemuck's derive: at compile time only
        "bytemuck_derive",
        "proc-macro2",
        "quote",
        "syn",
        "unicode-ident",
        // half: choosing by target, and its byte casts
        "cfg-if",
        "zerocopy",
        "zerocopy-derive",
    ]);
    let found = tree(&[]);
    let extra: Vec<_> = found.difference(&allowed).collect();
    assert!(extra.is_empty(), "not on core's list: {extra:?}");
}
