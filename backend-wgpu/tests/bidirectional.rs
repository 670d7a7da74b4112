//! Samples from both ends on a device against the scalar reference: where the device's arithmetic is exact, films are equal to the last bit.

mod adapter;

use etendue_conformance::Level;
use etendue_conformance::analytic::{Estimator, cases, compiled, job, render};
use etendue_conformance::golden;
use etendue_conformance::reference::ReferenceBackend;
use etendue_conformance::scenes::cases::Measure;
use etendue_core::backend::PathJob;
use etendue_wgpu::Options;

#[test]
fn goldens_have_the_reference_bits() {
    let Some(backend) = adapter::exact_with(Options::default()) else { return };
    let mut wrong = Vec::new();
    for scene in golden::scenes() {
        let compiled = compiled(&scene.scene).unwrap();
        let job = PathJob { seed: 7, block_length: 2, blocks: 0..2, max_depth: u32::MAX };
        let start = std::time::Instant::now();
        let ours = render(&backend, Estimator::Bidirectional, &compiled, None, &job).unwrap();
        let took = start.elapsed();
        let theirs = render(&ReferenceBackend, Estimator::Bidirectional, &compiled, None, &job).unwrap();
        let differing = (0..ours.len()).filter(|i| ours.mean(*i) != theirs.mean(*i)).count();
        println!(
            "{}: {differing} of {} pixels differ, {took:.2?} ({})",
            scene.name,
            ours.len(),
            compiled.needs
        );
        if ours != theirs {
            wrong.push(scene.name);
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}

#[test]
fn cases_have_the_reference_bits() {
    let Some(backend) = adapter::exact_with(Options::default()) else { return };
    let mut wrong = Vec::new();
    for case in cases() {
        let compiled = compiled(&case.scene).unwrap();
        let probes = match &case.measure {
            Measure::Probes(p) | Measure::ProbeMean(p) => Some(p.as_slice()),
            Measure::Pixels | Measure::ImageMean => None,
        };
        let job =
            PathJob { block_length: 2, blocks: 0..2, ..job(&case, Estimator::Bidirectional, Level::Quick) };
        let start = std::time::Instant::now();
        let ours = render(&backend, Estimator::Bidirectional, &compiled, probes, &job).unwrap();
        println!("{}: {:.2?}", case.name, start.elapsed());
        let theirs = render(&ReferenceBackend, Estimator::Bidirectional, &compiled, probes, &job).unwrap();
        if ours != theirs {
            let i = (0..ours.len()).find(|i| ours.mean(*i) != theirs.mean(*i));
            let first = i.map(|i| (i, ours.mean(i), theirs.mean(i)));
            wrong.push(format!("{} ({first:?}; {})", case.name, compiled.needs));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
