//! The conformance suite holds the backend on the best adapter of this machine.

mod adapter;

use etendue_conformance::{Group, Level, run_groups};
use etendue_core::backend::Backend;

/// Every check of these groups passes, but for those that the backend says it cannot do.
fn hold(groups: &[Group], level: Level) {
    let Some(backend) = adapter::backend() else { return };
    println!("{}: {}", backend.info().adapter, backend.arithmetic().describe());
    let mut failures = String::new();
    let summary = run_groups(&backend, level, groups, &mut |r| {
        let verdict = match (r.passed, r.skipped) {
            (_, true) => "skip  ",
            (true, _) => "ok    ",
            (false, _) => "FAILED",
        };
        let line = format!("{verdict} {} ({:.2} s): {}\n", r.name, r.seconds, r.detail);
        print!("{line}");
        if !r.passed {
            failures += &line;
        }
    });
    let (passed, skipped) = (summary.passed, summary.skipped);
    println!("{passed} passed, {} failed, {skipped} skipped, {:.1} s", summary.failed, summary.seconds);
    assert!(summary.ok(), "{failures}");
}

#[test]
fn kernels_pass() {
    hold(&[Group::Kernels], Level::Quick);
}

#[test]
fn trios_pass() {
    hold(&[Group::Trios], Level::Quick);
}

#[test]
fn analytic_scenes_pass() {
    hold(&[Group::Analytic], Level::Quick);
}

#[test]
fn goldens_pass() {
    hold(&[Group::Goldens], Level::Quick);
}

#[test]
fn invariances_pass() {
    hold(&[Group::Invariance], Level::Quick);
}

#[test]
#[ignore = "minutes: cargo nextest run -p etendue-wgpu --run-ignored only the_whole_passes"]
fn the_whole_passes() {
    hold(&Group::ALL, Level::Quick);
}
