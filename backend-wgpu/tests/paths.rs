//! Paths on a device against the scalar reference: where the device's arithmetic is exact, films are equal to the last bit.

mod adapter;

use etendue_conformance::Level;
use etendue_conformance::analytic::{Estimator, compiled, job, render};
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
        let job = PathJob { seed: 7, block_length: 4, blocks: 0..4, max_depth: u32::MAX };
        let ours = render(&backend, Estimator::Path, &compiled, None, &job).unwrap();
        let theirs = render(&ReferenceBackend, Estimator::Path, &compiled, None, &job).unwrap();
        let differing = (0..ours.len()).filter(|i| ours.mean(*i) != theirs.mean(*i)).count();
        println!("{}: {differing} of {} pixels differ ({})", scene.name, ours.len(), compiled.needs);
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
    for case in etendue_conformance::analytic::cases() {
        let compiled = compiled(&case.scene).unwrap();
        let probes = match &case.measure {
            Measure::Probes(p) | Measure::ProbeMean(p) => Some(p.as_slice()),
            Measure::Pixels | Measure::ImageMean => None,
        };
        let job = PathJob { block_length: 2, blocks: 0..4, ..job(&case, Estimator::Path, Level::Quick) };
        let ours = render(&backend, Estimator::Path, &compiled, probes, &job).unwrap();
        let theirs = render(&ReferenceBackend, Estimator::Path, &compiled, probes, &job).unwrap();
        if ours != theirs {
            let i = (0..ours.len()).find(|i| ours.mean(*i) != theirs.mean(*i));
            wrong.push(format!(
                "{} ({:?}; {})",
                case.name,
                i.map(|i| (i, ours.mean(i), theirs.mean(i))),
                compiled.needs
            ));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
