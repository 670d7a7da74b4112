//! Every kernel of a backend against its truth and against the scalar reference.

use crate::inputs::{Batch, inputs};
use crate::tolerance::{Tolerance, tolerance};
use crate::truth::{Answer, Expect, error, truth, ulp_at};
use etendue_core::backend::{Backend, BackendError, BackendInfo};
use etendue_core::kernel::{self, Kernel};

/// How near a backend's kernel comes to its truth and to the scalar reference.
#[derive(Clone, Debug, PartialEq)]
pub struct AccuracyRow {
    /// Which kernel.
    pub kernel: Kernel,
    /// Items evaluated.
    pub cases: u64,
    /// Items whose truth f32 cannot decide (held to the reference alone).
    pub undecided: u64,
    /// Items whose words all equal the scalar reference's.
    pub equal: u64,
    /// Largest error against the truth, in the tolerance's unit.
    pub worst: f64,
    /// Mean over all words of the error against the truth.
    pub mean: f64,
    /// Largest distance from the scalar reference, in the same unit.
    pub peer_worst: f64,
    /// Mean over all words of the distance from the scalar reference.
    pub peer_mean: f64,
    /// Where the worst error against the truth, or the worst distance, was met: constants and item.
    pub at: Option<Batch>,
    /// What is allowed.
    pub tolerance: Tolerance,
}

impl AccuracyRow {
    /// Share of items whose bits equal the reference's.
    pub fn equal_share(&self) -> f64 {
        self.equal as f64 / self.cases.max(1) as f64
    }

    /// Whether the kernel is within its tolerances; `exact`: its bits must equal the reference's.
    pub fn passes(&self, exact: bool) -> bool {
        let t = &self.tolerance;
        let truth = if exact { t.truth.limit } else { t.truth.limit + t.peer.limit };
        let peer = if exact { self.equal == self.cases } else { self.peer_worst <= t.peer.limit };
        self.cases > 0 && self.worst <= truth && peer && self.undecided * 4 <= self.cases
    }
}

/// Whether a backend's float operations are those of IEEE 754, so that its kernels must give the reference's bits: the
/// CPU and the software adapters that were measured to be so. Other adapters may err in division and square root and may
/// fuse products (WGSL, "Floating Point Accuracy").
pub fn expects_equal_bits(info: &BackendInfo) -> bool {
    info.name == "cpu" || info.name == "reference" || info.adapter.contains("llvmpipe")
}

/// Distance of a backend's word from the reference's, in the unit of the expectation.
fn peer_error(expect: Expect, reference: u32, got: u32) -> f64 {
    if got == reference {
        return 0.0;
    }
    let (a, b) = (f64::from(f32::from_bits(reference)), f64::from(f32::from_bits(got)));
    let distance = match expect {
        Expect::Word(_) => f64::INFINITY,
        Expect::Ulp(_) => (a - b).abs() / ulp_at(a),
        Expect::Scaled(_, scale) | Expect::AtMost(_, scale) => (a - b).abs() / (scale / 16_777_216.0),
        Expect::Turn(_) => (a - b).abs().min((1.0 - (a - b).abs()).abs()) * 16_777_216.0,
        Expect::Finite => 0.0,
    };
    if distance.is_nan() { f64::INFINITY } else { distance }
}

/// Runs one kernel over hard and random inputs.
///
/// # Errors
/// The backend's own.
pub fn measure(backend: &dyn Backend, kernel: Kernel, count: usize) -> Result<AccuracyRow, BackendError> {
    let shape = kernel.shape();
    let mut row = AccuracyRow {
        kernel,
        cases: 0,
        undecided: 0,
        equal: 0,
        worst: 0.0,
        mean: 0.0,
        peer_worst: 0.0,
        peer_mean: 0.0,
        at: None,
        tolerance: tolerance(kernel),
    };
    let (mut sum, mut peer_sum, mut words) = (0.0, 0.0, 0_u64);
    for batch in inputs(kernel, count) {
        let n = batch.items.len() / shape.item;
        let mut got = vec![0xdead_beef; n * shape.out];
        let mut reference = got.clone();
        backend.map(kernel, &batch.constants, &batch.items, &mut got)?;
        kernel::evaluate(kernel, &batch.constants, &batch.items, &mut reference)?;
        for ((item, got), reference) in batch
            .items
            .chunks_exact(shape.item)
            .zip(got.chunks_exact(shape.out))
            .zip(reference.chunks_exact(shape.out))
        {
            row.cases += 1;
            row.equal += u64::from(got == reference);
            let mut worst = 0.0_f64;
            let mut peer = 0.0_f64;
            match truth(kernel, &batch.constants, item) {
                Answer::Is(expected) => {
                    assert_eq!(expected.len(), shape.out, "truth of {} has the wrong length", kernel.name());
                    for ((e, g), r) in expected.iter().zip(got).zip(reference) {
                        let here = error(*e, *g);
                        worst = worst.max(here);
                        let apart = peer_error(*e, *r, *g);
                        peer = peer.max(apart);
                        sum += here;
                        peer_sum += apart;
                        words += 1;
                    }
                }
                Answer::Undecided => {
                    row.undecided += 1;
                    // Integer kernels have no rounding: what the truth leaves out must still equal the reference.
                    if tolerance(kernel).is_exact() && got != reference {
                        peer = f64::INFINITY;
                    }
                    if !tolerance(kernel).is_exact() && got.iter().any(|g| f32::from_bits(*g).is_nan()) {
                        worst = f64::INFINITY;
                    }
                }
            }
            if worst > row.worst || peer > row.peer_worst {
                row.at = Some(Batch { constants: batch.constants.clone(), items: item.to_vec() });
            }
            row.worst = row.worst.max(worst);
            row.peer_worst = row.peer_worst.max(peer);
        }
    }
    row.mean = sum / words.max(1) as f64;
    row.peer_mean = peer_sum / words.max(1) as f64;
    Ok(row)
}

/// Random items per kernel: a quick look, and the table's.
pub const QUICK_COUNT: usize = 4_000;
/// Random items per kernel for the table and the full suite.
pub const FULL_COUNT: usize = 100_000;
