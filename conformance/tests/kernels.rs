//! Every kernel is covered, and the scalar reference is within its own table.

use etendue_conformance::about::about;
use etendue_conformance::inputs::inputs;
use etendue_conformance::kernels::{FULL_COUNT, QUICK_COUNT};
use etendue_conformance::reference::ReferenceBackend;
use etendue_conformance::tolerance::tolerance;
use etendue_conformance::{accuracy_report, markdown};
use etendue_core::kernel::Kernel;

fn hold(count: usize) {
    let report = accuracy_report(&ReferenceBackend, count).expect("the reference answers");
    assert!(report.missing.is_empty(), "the reference has all");
    println!("{}", markdown(std::slice::from_ref(&report)));
    let wrong: Vec<String> = report
        .rows
        .iter()
        .filter(|r| !r.passes())
        .map(|r| {
            let at = r.at.as_ref().map(|b| {
                let f = |w: &[u32]| {
                    w.iter().map(|x| format!("{:?}", f32::from_bits(*x))).collect::<Vec<_>>().join(" ")
                };
                format!("constants [{}] item [{}]", f(&b.constants[..b.constants.len().min(24)]), f(&b.items))
            });
            format!(
                "{}: worst {} undecided {}/{} at {}",
                r.kernel.name(),
                r.worst,
                r.undecided,
                r.cases,
                at.unwrap_or_default()
            )
        })
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_reference_is_within_the_table() {
    hold(QUICK_COUNT);
}

#[test]
#[ignore = "half a minute: cargo nextest run -p etendue-conformance --run-ignored only the_reference_is_within_the_table_everywhere"]
fn the_reference_is_within_the_table_everywhere() {
    hold(FULL_COUNT);
}

#[test]
fn every_kernel_has_inputs_a_truth_a_reason_and_a_source() {
    for k in Kernel::ALL {
        let t = tolerance(*k);
        assert!(!t.truth.reason.is_empty() && !t.peer.reason.is_empty(), "{} has no tolerance", k.name());
        let words = about(*k);
        assert!(!words.domain.is_empty() && !words.source.is_empty(), "{} has no domain or source", k.name());
        let shape = k.shape();
        let batches = inputs(*k, 100);
        let items: usize = batches.iter().map(|b| b.items.len() / shape.item).sum();
        assert!(items >= 50, "{} has {items} inputs", k.name());
        for b in &batches {
            assert!(
                k.check(&b.constants, &b.items, &vec![0; b.items.len() / shape.item * shape.out]).is_ok()
            );
        }
    }
}
