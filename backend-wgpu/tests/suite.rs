//! The conformance suite holds the backend: all of it on the best adapter of this machine, numbers and a few scenes also on other software
//! adapters, each in a process of its own, since a process finds its drivers once.

mod adapter;

use etendue_conformance::analytic::{self, Estimator};
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
#[ignore = "minutes on a software device, whose films `paths` holds to the reference's bits: cargo nextest run -p etendue-wgpu --run-ignored only"]
fn analytic_scenes_pass() {
    hold(&[Group::Analytic], Level::Quick);
}

#[test]
#[ignore = "minutes on a software device, whose films `paths` holds to the reference's bits: cargo nextest run -p etendue-wgpu --run-ignored only"]
fn goldens_pass() {
    hold(&[Group::Goldens], Level::Quick);
}

#[test]
fn invariances_pass() {
    hold(&[Group::Invariance], Level::Quick);
}

/// Scenes that even the slowest device has done in a second or two: lights of every kind, a picture, round shapes, normals.
const FEW: [&str; 9] = [
    "furnace_after_2_bounces",
    "light_choice",
    "shadow",
    "sphere_light_3",
    "square_light",
    "open_floor",
    "coincident_surfaces",
    "picture_gradient",
    "shading_normal_sky",
];

#[test]
fn a_few_scenes_pass() {
    let Some(backend) = adapter::backend() else { return };
    println!("{}", backend.info().adapter);
    let cases: Vec<_> = analytic::cases().into_iter().filter(|c| FEW.contains(&c.name.as_str())).collect();
    assert_eq!(cases.len(), FEW.len());
    for case in &cases {
        for (name, passed, detail) in analytic::check(&backend, Estimator::Path, case, Level::Quick).unwrap()
        {
            println!("{name}: {detail}");
            assert!(passed, "{name}: {detail}");
        }
    }
}

/// Runs tests of this file where Vulkan has the drivers of this file alone, and gives what they printed.
fn on_drivers_of(icd: &str, tests: &[&str]) -> String {
    let me = std::env::current_exe().unwrap();
    let mut command = std::process::Command::new(me);
    command
        .args(tests)
        .args(["--exact", "--nocapture"])
        .env("VK_ICD_FILENAMES", icd)
        .env_remove("VK_DRIVER_FILES");
    let done = command.output().unwrap();
    let said = String::from_utf8_lossy(&done.stdout).into_owned() + &String::from_utf8_lossy(&done.stderr);
    println!("{said}");
    assert!(done.status.success(), "{tests:?} with the drivers of {icd}");
    said
}

/// `ETENDUE_SWIFTSHADER` names SwiftShader's ICD file, as Chromium has it.
fn on_swiftshader(tests: &[&str]) {
    let Some(icd) = std::env::var_os("ETENDUE_SWIFTSHADER") else {
        return adapter::skip("ETENDUE_SWIFTSHADER names no driver");
    };
    let icd = icd.to_string_lossy();
    assert!(std::path::Path::new(&*icd).is_file(), "ETENDUE_SWIFTSHADER: {icd} is no file");
    let said = on_drivers_of(&icd, tests);
    assert!(said.contains("SwiftShader"), "another adapter answered");
}

#[test]
fn kernels_pass_on_swiftshader() {
    on_swiftshader(&["kernels_pass"]);
}

#[test]
#[ignore = "a minute: cargo nextest run -p etendue-wgpu --run-ignored only swiftshader"]
fn a_few_scenes_pass_on_swiftshader() {
    on_swiftshader(&["a_few_scenes_pass"]);
}

/// Without a driver of Vulkan, GL is what is left; machines without it skip this, whatever is required.
#[test]
fn numbers_and_a_few_scenes_pass_by_gl() {
    let said = on_drivers_of("/nonexistent", &["kernels_pass", "trios_pass", "a_few_scenes_pass"]);
    assert!(said.contains(" (gl, ") || said.contains("SKIPPED"), "another adapter answered");
}

#[test]
#[ignore = "minutes: cargo nextest run -p etendue-wgpu --run-ignored only the_whole_passes"]
fn the_whole_passes() {
    hold(&Group::ALL, Level::Quick);
}
