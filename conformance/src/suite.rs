//! The suite as the command runs it.

use crate::analytic::{self, Estimator, compiled};
use crate::golden;
use crate::invariance;
use crate::kernels::{self, expects_equal_bits};
use crate::trios;
use etendue_core::backend::{Backend, BackendError};
use etendue_core::kernel::Kernel;
use etendue_core::scene::SceneDesc;
use std::time::Instant;

/// How long it may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// Everything once, with few samples: seconds.
    Quick,
    /// Eight times the samples and more: minutes.
    Full,
}

/// The outcome of one check.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckResult {
    /// `group/what`, stable across versions.
    pub name: String,
    /// It is as it should be, or was skipped.
    pub passed: bool,
    /// It was not run; `detail` says why.
    pub skipped: bool,
    /// The numbers.
    pub detail: String,
    /// How long it took; 0 for all but the first check that share their work.
    pub seconds: f64,
}

/// The outcome of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Summary {
    /// Checks that passed.
    pub passed: usize,
    /// Checks that failed.
    pub failed: usize,
    /// Checks that were not run.
    pub skipped: usize,
    /// Names of the failed ones.
    pub failures: Vec<String>,
    /// How long all of it took.
    pub seconds: f64,
}

impl Summary {
    /// Nothing failed, and something was checked.
    pub fn ok(&self) -> bool {
        self.failed == 0 && self.passed > 0
    }
}

/// Passes results on and counts them.
struct Reporter<'a> {
    report: &'a mut dyn FnMut(&CheckResult),
    summary: Summary,
}

impl Reporter<'_> {
    fn one(&mut self, name: String, passed: bool, detail: String, seconds: f64) {
        if passed {
            self.summary.passed += 1;
        } else {
            self.summary.failed += 1;
            self.summary.failures.push(name.clone());
        }
        (self.report)(&CheckResult { name, passed, skipped: false, detail, seconds });
    }

    fn skip(&mut self, name: &str, why: &str) {
        self.summary.skipped += 1;
        let detail = format!("skipped: {why}");
        (self.report)(&CheckResult { name: name.into(), passed: true, skipped: true, detail, seconds: 0.0 });
    }

    /// Findings that share their work; an error of the backend is a failure of the whole.
    fn group(&mut self, name: &str, start: Instant, found: Result<Vec<trios::Finding>, BackendError>) {
        let mut seconds = start.elapsed().as_secs_f64();
        match found {
            Ok(list) => {
                for (name, passed, detail) in list {
                    self.one(name, passed, detail, std::mem::take(&mut seconds));
                }
            }
            Err(e) => self.one(name.into(), false, format!("the backend failed: {e}"), seconds),
        }
    }
}

/// Runs the suite on a backend; `report` hears of each check as it ends.
///
/// What the backend says it cannot do ([`Backend::capabilities`]) is skipped, visibly; what it says it can do and
/// refuses is a failure.
pub fn run(backend: &dyn Backend, level: Level, report: &mut dyn FnMut(&CheckResult)) -> Summary {
    let begin = Instant::now();
    let mut r = Reporter { report, summary: Summary::default() };
    let capabilities = backend.capabilities();
    if capabilities.kernels {
        check_kernels(backend, level, &mut r);
        let count = if level == Level::Quick { 1 << 15 } else { 1 << 19 };
        let start = Instant::now();
        r.group("trio", start, trios::check(backend, count));
    } else {
        r.skip("kernel", "the backend evaluates no kernels");
        r.skip("trio", "the backend evaluates no kernels");
    }
    if capabilities.path {
        check_scenes(backend, Estimator::Path, level, &mut r);
        let start = Instant::now();
        r.group("invariance", start, invariance::check(backend, level));
    } else {
        for group in ["analytic", "invariance", "golden"] {
            r.skip(group, "the backend traces no paths");
        }
    }
    if capabilities.bidirectional {
        check_scenes(backend, Estimator::Bidirectional, level, &mut r);
    } else {
        r.skip("bidirectional", "the backend does not trace paths from both ends");
    }
    let mut summary = r.summary;
    summary.seconds = begin.elapsed().as_secs_f64();
    summary
}

/// Every scene with an exact answer, and every golden.
fn check_scenes(backend: &dyn Backend, estimator: Estimator, level: Level, r: &mut Reporter<'_>) {
    let prefix = estimator.prefix();
    let beyond = |scene: &SceneDesc| {
        let volume = compiled(scene).is_ok_and(|scene| scene.needs.volume());
        volume && !backend.capabilities().volume
    };
    const WHY: &str = "the backend does not carry light through media and boundaries";
    for case in analytic::cases() {
        let name = format!("{prefix}analytic/{}", case.name);
        if beyond(&case.scene) {
            r.skip(&name, WHY);
            continue;
        }
        let start = Instant::now();
        let found = analytic::check(backend, estimator, &case, level);
        r.group(&name, start, found);
    }
    for scene in golden::scenes() {
        let name = format!("{prefix}golden/{}", scene.name);
        if beyond(&scene.scene) {
            r.skip(&name, WHY);
            continue;
        }
        let start = Instant::now();
        let found = golden::check(backend, estimator, &scene, level);
        r.group(&name, start, found);
    }
}

fn check_kernels(backend: &dyn Backend, level: Level, r: &mut Reporter<'_>) {
    let exact = expects_equal_bits(&backend.info());
    let count = if level == Level::Quick { kernels::QUICK_COUNT } else { kernels::FULL_COUNT };
    for kernel in Kernel::ALL {
        let start = Instant::now();
        let name = format!("kernel/{}", kernel.name());
        match kernels::measure(backend, *kernel, count) {
            Ok(row) => {
                let t = &row.tolerance;
                let detail = format!(
                    "worst {:.3} {} (allowed {}), {:.3} % equal bits, {} cases",
                    row.worst,
                    t.unit,
                    t.truth.limit,
                    100.0 * row.equal_share(),
                    row.cases
                );
                r.one(name, row.passes(exact), detail, start.elapsed().as_secs_f64());
            }
            Err(e) => r.one(name, false, format!("the backend failed: {e}"), start.elapsed().as_secs_f64()),
        }
    }
}
