//! Samples from both ends on a device against the scalar reference: where the device's arithmetic is exact, films are equal to the last bit.

mod adapter;

use etendue_conformance::Level;
use etendue_conformance::analytic::{Estimator, cases, compiled, job, render};
use etendue_conformance::golden;
use etendue_conformance::reference::ReferenceBackend;
use etendue_conformance::scenes::cases::{Case, Measure};
use etendue_core::backend::PathJob;
use etendue_wgpu::Options;

fn goldens(which: impl Fn(&str) -> bool, blocks: u32, max_depth: u32) {
    let Some(backend) = adapter::exact_with(Options::default()) else { return };
    let (mut count, mut wrong) = (0, Vec::new());
    for scene in golden::scenes().into_iter().filter(|s| which(s.name)) {
        count += 1;
        let compiled = compiled(&scene.scene).unwrap();
        let job = PathJob { seed: 7, block_length: 2, blocks: 0..blocks, max_depth };
        let ours = render(&backend, Estimator::Bidirectional, &compiled, None, &job).unwrap();
        let theirs = render(&ReferenceBackend, Estimator::Bidirectional, &compiled, None, &job).unwrap();
        let differing = (0..ours.len()).filter(|i| ours.mean(*i) != theirs.mean(*i)).count();
        println!("{}: {differing} of {} pixels differ ({})", scene.name, ours.len(), compiled.needs);
        if ours != theirs {
            wrong.push(scene.name);
        }
    }
    assert!(count > 0 && wrong.is_empty(), "{wrong:?}");
}

/// Normals that bend, beams and a lens; bitmaps and round shapes under the sky. `both_ends` has lobes and media.
#[test]
fn goldens_have_the_reference_bits() {
    goldens(|name| ["stage", "terrace"].contains(&name), 1, 8);
}

#[test]
#[ignore = "half a minute: cargo nextest run -p etendue-wgpu --run-ignored only all_goldens"]
fn all_goldens_have_the_reference_bits() {
    goldens(|_| true, 2, u32::MAX);
}

fn hold(which: impl Fn(&Case) -> bool) {
    let Some(backend) = adapter::exact_with(Options::default()) else { return };
    let (mut count, mut wrong) = (0, Vec::new());
    for case in cases().into_iter().filter(which) {
        count += 1;
        let compiled = compiled(&case.scene).unwrap();
        let probes = match &case.measure {
            Measure::Probes(p) | Measure::ProbeMean(p) => Some(p.as_slice()),
            Measure::Pixels | Measure::ImageMean => None,
        };
        let job = job(&case, Estimator::Bidirectional, Level::Quick);
        let job = PathJob { block_length: 2, blocks: 0..2, ..job };
        let start = std::time::Instant::now();
        let ours = render(&backend, Estimator::Bidirectional, &compiled, probes, &job).unwrap();
        println!("{}: {:.2?} ({})", case.name, start.elapsed(), compiled.needs);
        let theirs = render(&ReferenceBackend, Estimator::Bidirectional, &compiled, probes, &job).unwrap();
        if ours != theirs {
            let i = (0..ours.len()).find(|i| ours.mean(*i) != theirs.mean(*i));
            let first = i.map(|i| (i, ours.mean(i), theirs.mean(i)));
            wrong.push(format!("{} ({first:?}; {})", case.name, compiled.needs));
        }
    }
    assert!(count > 0 && wrong.is_empty(), "{wrong:#?}");
}

/// Probes, under what the goldens do not have.
const FEW: [&str; 2] = ["sphere_light_3", "picture_gradient"];

#[test]
fn a_few_cases_have_the_reference_bits() {
    hold(|case| FEW.contains(&case.name.as_str()));
}

#[test]
#[ignore = "minutes: cargo nextest run -p etendue-wgpu --run-ignored only all_cases"]
fn all_cases_have_the_reference_bits() {
    hold(|_| true);
}
