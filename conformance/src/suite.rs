//! The suite as the command runs it.

use crate::analytic::{self, Estimator, compiled};
use crate::golden;
use crate::invariance;
use crate::kernels;
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

/// A part of the suite.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Group {
    /// Each kernel against its truth and the reference.
    Kernels,
    /// Properties of sampling that know no truth.
    Trios,
    /// Scenes with exact answers.
    Analytic,
    /// Images against the reference's.
    Goldens,
    /// What must not change.
    Invariance,
}

impl Group {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Kernels, Self::Trios, Self::Analytic, Self::Goldens, Self::Invariance];
}

/// Runs the suite on a backend; `report` hears of each check as it ends.
///
/// What the backend says it cannot do ([`Backend::capabilities`]) is skipped, visibly; what it says it can do and
/// refuses is a failure.
pub fn run(backend: &dyn Backend, level: Level, report: &mut dyn FnMut(&CheckResult)) -> Summary {
    run_groups(backend, level, &Group::ALL, report)
}

/// The same for parts of the suite.
pub fn run_groups(
    backend: &dyn Backend,
    level: Level,
    groups: &[Group],
    report: &mut dyn FnMut(&CheckResult),
) -> Summary {
    let begin = Instant::now();
    let mut r = Reporter { report, summary: Summary::default() };
    for group in groups {
        check_group(backend, level, *group, &mut r);
    }
    let mut summary = r.summary;
    summary.seconds = begin.elapsed().as_secs_f64();
    summary
}

fn check_group(backend: &dyn Backend, level: Level, group: Group, r: &mut Reporter<'_>) {
    const NO_KERNELS: &str = "the backend evaluates no kernels";
    let capabilities = backend.capabilities();
    match group {
        Group::Kernels if !capabilities.kernels => r.skip("kernel", NO_KERNELS),
        Group::Kernels => check_kernels(backend, level, r),
        Group::Trios if !capabilities.kernels => r.skip("trio", NO_KERNELS),
        Group::Trios => {
            let count = if level == Level::Quick { 1 << 15 } else { 1 << 19 };
            let start = Instant::now();
            r.group("trio", start, trios::check(backend, count));
        }
        Group::Analytic | Group::Goldens => {
            let (name, check): (_, SceneCheck) = match group {
                Group::Analytic => ("analytic", check_cases),
                _ => ("golden", check_goldens),
            };
            for (estimator, can) in
                [(Estimator::Path, capabilities.path), (Estimator::Bidirectional, capabilities.bidirectional)]
            {
                if can {
                    check(backend, estimator, level, r);
                } else {
                    let name = format!("{}{name}", estimator.prefix());
                    r.skip(&name, "the backend does not trace such paths");
                }
            }
        }
        Group::Invariance if !capabilities.path => r.skip("invariance", "the backend traces no paths"),
        Group::Invariance => {
            let start = Instant::now();
            r.group("invariance", start, invariance::check(backend, level));
        }
    }
}

type SceneCheck = fn(&dyn Backend, Estimator, Level, &mut Reporter<'_>);

/// Why a scene is beyond a backend.
fn beyond(backend: &dyn Backend, scene: &SceneDesc) -> Option<&'static str> {
    let volume = compiled(scene).is_ok_and(|scene| scene.needs.volume());
    let out = volume && !backend.capabilities().volume;
    out.then_some("the backend does not carry light through media and boundaries")
}

fn check_cases(backend: &dyn Backend, estimator: Estimator, level: Level, r: &mut Reporter<'_>) {
    for case in analytic::cases() {
        let name = format!("{}analytic/{}", estimator.prefix(), case.name);
        if let Some(why) = beyond(backend, &case.scene) {
            r.skip(&name, why);
            continue;
        }
        let start = Instant::now();
        let found = analytic::check(backend, estimator, &case, level);
        r.group(&name, start, found);
    }
}

fn check_goldens(backend: &dyn Backend, estimator: Estimator, level: Level, r: &mut Reporter<'_>) {
    for scene in golden::scenes() {
        let name = format!("{}golden/{}", estimator.prefix(), scene.name);
        if let Some(why) = beyond(backend, &scene.scene) {
            r.skip(&name, why);
            continue;
        }
        let start = Instant::now();
        let found = golden::check(backend, estimator, &scene, level);
        r.group(&name, start, found);
    }
}

fn check_kernels(backend: &dyn Backend, level: Level, r: &mut Reporter<'_>) {
    let count = if level == Level::Quick { kernels::QUICK_COUNT } else { kernels::FULL_COUNT };
    for kernel in Kernel::ALL {
        let start = Instant::now();
        let name = format!("kernel/{}", kernel.name());
        match kernels::measure(backend, *kernel, count) {
            Ok(row) => {
                let detail = format!(
                    "worst {:.3} {} (allowed {}), {:.3} to the reference (allowed {}), {:.3} % equal bits, {} cases, {} flushed",
                    row.worst,
                    row.tolerance.unit,
                    row.truth_limit(),
                    row.peer_worst,
                    row.peer_limit(),
                    100.0 * row.equal_share(),
                    row.cases,
                    row.flushed
                );
                r.one(name, row.passes(), detail, start.elapsed().as_secs_f64());
            }
            Err(e) => r.one(name, false, format!("the backend failed: {e}"), start.elapsed().as_secs_f64()),
        }
    }
}
