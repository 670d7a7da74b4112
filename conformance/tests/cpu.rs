//! What only the CPU backend promises: the bits of the scalar reference, and code that depends on what a scene needs
//! without changing what it gives.

use etendue_conformance::analytic::{Estimator, cases, compiled, render};
use etendue_conformance::golden;
use etendue_conformance::kernels::measure;
use etendue_conformance::reference::ReferenceBackend;
use etendue_conformance::scenes::cases::Measure;
use etendue_conformance::{AccuracyReport, TABLE_COUNT, accuracy_report, markdown};
use etendue_core::backend::{Backend, NoControl, PathJob, Session, image_film_settings};
use etendue_core::film::Film;
use etendue_core::transport::TransportCode;
use etendue_cpu::CpuBackend;

fn cpu() -> CpuBackend {
    CpuBackend::new(Some(2)).expect("threads")
}

fn job() -> PathJob {
    PathJob { seed: 3, block_length: 16, blocks: 1..4, max_depth: u32::MAX }
}

#[test]
fn films_equal_the_reference_bit_for_bit() {
    for estimator in [Estimator::Path, Estimator::Bidirectional] {
        for scene in golden::scenes() {
            let scene = compiled(&scene.scene).expect("a good scene");
            let ours = render(&cpu(), estimator, &scene, None, &job()).expect("all it needs");
            let theirs = render(&ReferenceBackend, estimator, &scene, None, &job()).expect("all it needs");
            assert!(ours == theirs);
            assert!((0..ours.len()).any(|i| ours.mean(i)[0] > 0.0));
        }
        for case in cases() {
            if let Measure::Probes(probes) = &case.measure {
                let scene = compiled(&case.scene).expect("a good scene");
                let job = PathJob { max_depth: case.max_depth, ..job() };
                let ours = render(&cpu(), estimator, &scene, Some(probes), &job).expect("all it needs");
                let theirs =
                    render(&ReferenceBackend, estimator, &scene, Some(probes), &job).expect("all it needs");
                assert!(ours == theirs, "{}", case.name);
            }
        }
    }
}

#[test]
fn code_that_a_scene_does_not_need_changes_no_bit() {
    for scene in golden::scenes() {
        let name = scene.name;
        let scene = compiled(&scene.scene).expect("a good scene");
        let film = |code| {
            let session = cpu().open_session(scene.clone()).expect("fits").with_code(code);
            let mut film = Film::new(image_film_settings(&scene, &job()).expect("a camera"));
            session.path_image(&job(), &NoControl, &mut film).expect("surfaces only");
            film
        };
        assert!(film(TransportCode::of(&scene.needs)) == film(TransportCode::FULL), "{name}");
    }
}

#[test]
fn the_accuracy_table_is_the_same_text_each_time() {
    let kernels: Vec<_> = ["math::ln", "discrete::pick_in", "geometry::intersect_triangle"].into();
    let text = || {
        let rows = etendue_core::kernel::Kernel::ALL
            .iter()
            .filter(|k| kernels.contains(&k.name()))
            .map(|k| measure(&cpu(), *k, 500).expect("all kernels"))
            .collect();
        let (info, arithmetic) = (cpu().info(), cpu().arithmetic());
        markdown(&[AccuracyReport { info, arithmetic, rows, missing: Vec::new() }])
    };
    assert_eq!(text(), text());
    assert_eq!(text().lines().filter(|l| l.starts_with("| `")).count(), 3);
}

#[test]
#[ignore = "prints ACCURACY.md's table: cargo test -p etendue-conformance --test cpu -- --ignored --nocapture print_accuracy"]
fn print_accuracy() {
    print!("{}", markdown(&[accuracy_report(&cpu(), TABLE_COUNT).expect("all kernels")]));
}
