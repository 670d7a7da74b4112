//! Every kernel of a backend against its truth and against the scalar reference.
//!
//! What a right backend may differ by hangs on its arithmetic ([`Arithmetic`]):
//! - `Ieee`: nothing; every word is the reference's, and so within the truth's bound.
//! - `FlushesSubnormals`: nothing but where a number below 2^-126 was lost. An item with such a number is left out (it may
//!   give anything but NaN), and a word may differ from the reference's by what losing one amounts to, an absolute bound. Both are
//!   counted, and must stay rare.
//! - `Loose`: the bounds of the table for peers, added to those for the truth.

use crate::inputs::{Batch, inputs};
use crate::tolerance::{Tolerance, tolerance};
use crate::truth::{Answer, Expect, error, truth, ulp_at};
use etendue_core::backend::{Arithmetic, Backend, BackendError};
use etendue_core::kernel::{self, Kernel};

/// How near a backend's kernel comes to its truth and to the scalar reference.
#[derive(Clone, Debug, PartialEq)]
pub struct AccuracyRow {
    /// Which kernel.
    pub kernel: Kernel,
    /// How the backend's operations round.
    pub arithmetic: Arithmetic,
    /// Items evaluated.
    pub cases: u64,
    /// Items whose truth f32 cannot decide (held to the reference alone).
    pub undecided: u64,
    /// Items in which a backend without subnormal numbers lost one: left out, or within the bound for that.
    pub flushed: u64,
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
    fn new(kernel: Kernel, arithmetic: Arithmetic) -> Self {
        Self {
            kernel,
            arithmetic,
            cases: 0,
            undecided: 0,
            flushed: 0,
            equal: 0,
            worst: 0.0,
            mean: 0.0,
            peer_worst: 0.0,
            peer_mean: 0.0,
            at: None,
            tolerance: tolerance(kernel),
        }
    }

    /// Share of items whose bits equal the reference's.
    pub fn equal_share(&self) -> f64 {
        self.equal as f64 / self.cases.max(1) as f64
    }

    /// Largest error against the truth that the backend's arithmetic excuses.
    pub fn truth_limit(&self) -> f64 {
        self.tolerance.truth.limit + self.peer_limit()
    }

    /// Largest distance from the reference that it excuses.
    pub fn peer_limit(&self) -> f64 {
        match self.arithmetic {
            Arithmetic::Loose => self.tolerance.peer.limit,
            Arithmetic::Ieee | Arithmetic::FlushesSubnormals => 0.0,
        }
    }

    /// Whether the kernel is as its backend's arithmetic lets it be.
    pub fn passes(&self) -> bool {
        let bits = match self.arithmetic {
            Arithmetic::Ieee => self.equal == self.cases,
            Arithmetic::FlushesSubnormals => self.equal + self.flushed == self.cases,
            Arithmetic::Loose => true,
        };
        let rare = self.undecided * RARE <= self.cases && self.flushed * RARE <= self.cases;
        let near = self.worst <= self.truth_limit() && self.peer_worst <= self.peer_limit();
        self.cases > 0 && bits && near && rare
    }
}

/// At most one item in so many is undecided, or has lost a subnormal number: the rest is what a comparison says something about.
const RARE: u64 = 4;

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

/// Whether a word differs from the reference's by no more than `limit`, as numbers: integers may not.
fn is_flushed(expect: Expect, reference: u32, got: u32, limit: f64) -> bool {
    let (a, b) = (f64::from(f32::from_bits(reference)), f64::from(f32::from_bits(got)));
    !matches!(expect, Expect::Word(_)) && (a - b).abs() <= limit
}

/// One item: its numbers, what should be, what is.
struct Item<'a> {
    constants: &'a [u32],
    item: &'a [u32],
    got: &'a [u32],
    reference: &'a [u32],
}

/// Sums over words, for the means.
#[derive(Default)]
struct Sums {
    truth: f64,
    peer: f64,
    words: u64,
}

impl AccuracyRow {
    fn add(&mut self, i: &Item<'_>, sums: &mut Sums) {
        let flushes = self.arithmetic == Arithmetic::FlushesSubnormals;
        let equal = i.got == i.reference;
        self.cases += 1;
        self.equal += u64::from(equal);
        let (answer, subnormal) = truth(self.kernel, i.constants, i.item);
        let (mut worst, mut peer) = (0.0_f64, 0.0_f64);
        let nan = || i.got.iter().zip(i.reference).any(|(g, r)| is_nan(*g) && !is_nan(*r));
        match answer {
            _ if flushes && !equal && subnormal => {
                self.flushed += 1;
                if nan() && !self.tolerance.is_exact() {
                    worst = f64::INFINITY;
                }
            }
            Answer::Is(expected) => {
                let name = self.kernel.name();
                assert_eq!(expected.len(), i.got.len(), "truth of {name} has the wrong length");
                let mut lost = false;
                for ((e, g), r) in expected.iter().zip(i.got).zip(i.reference) {
                    if flushes && g != r && is_flushed(*e, *r, *g, self.tolerance.flushed.limit) {
                        lost = true;
                        continue;
                    }
                    let (here, apart) = (error(*e, *g), peer_error(*e, *r, *g));
                    worst = worst.max(here);
                    peer = peer.max(apart);
                    sums.truth += here;
                    sums.peer += apart;
                    sums.words += 1;
                }
                self.flushed += u64::from(lost && peer == 0.0);
            }
            Answer::Undecided => {
                self.undecided += 1;
                if self.tolerance.is_exact() {
                    // Integer kernels have no rounding: what the truth leaves out must still equal the reference.
                    peer = if equal { 0.0 } else { f64::INFINITY };
                } else if i.got.iter().any(|g| is_nan(*g)) {
                    worst = f64::INFINITY;
                }
            }
        }
        if worst > self.worst || peer > self.peer_worst {
            self.at = Some(Batch { constants: i.constants.to_vec(), items: i.item.to_vec() });
        }
        self.worst = self.worst.max(worst);
        self.peer_worst = self.peer_worst.max(peer);
    }
}

fn is_nan(word: u32) -> bool {
    f32::from_bits(word).is_nan()
}

/// Runs one kernel over hard and random inputs.
///
/// # Errors
/// The backend's own.
pub fn measure(backend: &dyn Backend, kernel: Kernel, count: usize) -> Result<AccuracyRow, BackendError> {
    let shape = kernel.shape();
    let mut row = AccuracyRow::new(kernel, backend.arithmetic());
    let mut sums = Sums::default();
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
            row.add(&Item { constants: &batch.constants, item, got, reference }, &mut sums);
        }
    }
    row.mean = sums.truth / sums.words.max(1) as f64;
    row.peer_mean = sums.peer / sums.words.max(1) as f64;
    Ok(row)
}

/// Random items per kernel: a quick look, and the table's.
pub const QUICK_COUNT: usize = 4_000;
/// Random items per kernel for the table and the full suite.
pub const FULL_COUNT: usize = 100_000;
