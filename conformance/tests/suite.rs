//! The reference and the CPU pass the suite.

use etendue_conformance::reference::ReferenceBackend;
use etendue_conformance::{Level, run};
use etendue_core::backend::Backend;
use etendue_cpu::CpuBackend;

fn hold(backend: &dyn Backend, level: Level) {
    let mut failures = String::new();
    let summary = run(backend, level, &mut |r| {
        let line = format!(
            "{} {} ({:.2} s): {}",
            if r.passed { "ok    " } else { "FAILED" },
            r.name,
            r.seconds,
            r.detail
        );
        println!("{line}");
        if !r.passed {
            failures.push_str(&line);
            failures.push('\n');
        }
    });
    println!(
        "{} passed, {} failed, {} skipped, {:.1} s",
        summary.passed, summary.failed, summary.skipped, summary.seconds
    );
    assert!(summary.ok() && summary.skipped == 0, "{failures}");
}

#[test]
fn the_cpu_passes_quickly() {
    hold(&CpuBackend::new(None).expect("threads"), Level::Quick);
}

#[test]
#[ignore = "half a minute: cargo nextest run -p etendue-conformance --run-ignored only the_reference_passes"]
fn the_reference_passes() {
    hold(&ReferenceBackend, Level::Quick);
}

#[test]
#[ignore = "minutes: cargo nextest run -p etendue-conformance --run-ignored only the_cpu_passes_fully"]
fn the_cpu_passes_fully() {
    hold(&CpuBackend::new(None).expect("threads"), Level::Full);
}
