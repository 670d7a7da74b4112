//! Scenes with exact answers, rendered through a session and compared by Student's t.

use crate::scenes::cases::{Case, Measure};
use crate::statistics::{sidak, t_quantile};
use crate::suite::Level;
use crate::trios::Finding;
use etendue_core::backend::{self, Backend, BackendError, BidirectionalJob, NoControl, PathJob, Probe};
use etendue_core::film::Film;
use etendue_core::scene::{CompiledScene, SceneDesc, compile};
use std::sync::Arc;

pub use crate::scenes::cases::cases;

/// Probability that a right backend fails any comparison of one case, for a random seed.
pub const ALPHA: f64 = 1e-4;
/// Blocks of samples per element: enough for the tails of t to be thin.
pub const BLOCKS: u32 = 32;

/// Multiples of a case's own samples.
const QUICK: u32 = 8;
const FULL: u32 = 64;

/// Compiles a scene of this crate.
///
/// # Errors
/// Never for the scenes here; a bad scene is reported as a backend's refusal would be.
pub fn compiled(scene: &SceneDesc) -> Result<Arc<CompiledScene>, BackendError> {
    match compile(scene) {
        Ok((scene, _)) => Ok(Arc::new(scene)),
        Err(e) => Err(BackendError::Unsupported { backend: "core", what: format!("{e}") }),
    }
}

/// What estimates light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Estimator {
    /// Path tracing from the sensor.
    Path,
    /// Bidirectional path tracing.
    Bidirectional,
}

impl Estimator {
    /// What comes before the names of its checks.
    pub fn prefix(self) -> &'static str {
        match self {
            Self::Path => "",
            Self::Bidirectional => "bidirectional/",
        }
    }

    /// By how much the samples of a case are divided: walks from both ends and their joints cost some four paths.
    pub fn thrift(self) -> u32 {
        match self {
            Self::Path => 1,
            Self::Bidirectional => 4,
        }
    }

    /// Multiple of a case's largest relative standard error: fewer samples, and light from infinity starts all over a disk as wide as the scene, which slabs without end make very wide.
    fn slack(self) -> f64 {
        match self {
            Self::Path => 1.0,
            Self::Bidirectional => 4.0,
        }
    }
}

/// Runs a job of `samples` per element: an image, or the probes.
///
/// # Errors
/// The backend's own.
pub fn render(
    backend: &dyn Backend,
    estimator: Estimator,
    scene: &Arc<CompiledScene>,
    probes: Option<&[Probe]>,
    job: &PathJob,
) -> Result<Film, BackendError> {
    let session = backend.open(scene.clone())?;
    let settings = match probes {
        Some(p) => backend::probe_film_settings(scene, job, p.len()),
        None => backend::image_film_settings(scene, job)?,
    };
    let mut film = Film::new(settings);
    let both = BidirectionalJob::new(job.clone());
    match (probes, estimator) {
        (Some(p), Estimator::Path) => session.path_probes(job, p, &NoControl, &mut film)?,
        (None, Estimator::Path) => session.path_image(job, &NoControl, &mut film)?,
        (Some(p), Estimator::Bidirectional) => {
            session.bidirectional_probes(&both, p, &NoControl, &mut film)?
        }
        (None, Estimator::Bidirectional) => session.bidirectional_image(&both, &NoControl, &mut film)?,
    };
    Ok(film)
}

/// Mean and standard error per element and channel; pooled over the elements where `pool` is set.
pub fn estimates(film: &Film, pool: bool) -> Vec<[(f64, f64); 3]> {
    let one = |i: usize| {
        let (mean, variance) = (film.mean(i), film.variance(i).unwrap_or([f64::INFINITY; 3]));
        [0, 1, 2].map(|c| (mean[c], variance[c].sqrt()))
    };
    let all: Vec<_> = (0..film.len()).map(one).collect();
    if !pool {
        return all;
    }
    let n = all.len() as f64;
    vec![[0, 1, 2].map(|c| {
        let mean = all.iter().map(|e| e[c].0).sum::<f64>() / n;
        (mean, all.iter().map(|e| e[c].1 * e[c].1).sum::<f64>().sqrt() / n)
    })]
}

/// The job of a case.
pub fn job(case: &Case, estimator: Estimator, level: Level) -> PathJob {
    let samples = case.samples * if level == Level::Quick { QUICK } else { FULL } / estimator.thrift();
    let block_length = (samples / BLOCKS).max(1).next_power_of_two();
    PathJob { seed: 0x0c0f_fee0, block_length, blocks: 0..BLOCKS, max_depth: case.max_depth }
}

/// Compares one case.
///
/// # Errors
/// The backend's own.
pub fn check(
    backend: &dyn Backend,
    estimator: Estimator,
    case: &Case,
    level: Level,
) -> Result<Vec<Finding>, BackendError> {
    let scene = compiled(&case.scene)?;
    let (probes, pool) = match &case.measure {
        Measure::Probes(p) => (Some(p.as_slice()), false),
        Measure::ProbeMean(p) => (Some(p.as_slice()), true),
        Measure::Pixels => (None, false),
        Measure::ImageMean => (None, true),
    };
    let film = render(backend, estimator, &scene, probes, &job(case, estimator, level))?;
    let found = estimates(&film, pool);
    let tests = 3 * found.len();
    let dof = if pool { f64::from(BLOCKS) * film.len() as f64 / 2.0 } else { f64::from(BLOCKS) - 1.0 };
    let z = t_quantile(sidak(ALPHA, tests), dof);
    let mut passed = film.invalid() == 0 && film.saturated() == 0 && found.len() == case.truth.len();
    let (mut worst, mut widest) = (0.0_f64, 0.0_f64);
    let mut at = String::new();
    let power = case.power * estimator.slack();
    for (i, (got, truth)) in found.iter().zip(&case.truth).enumerate() {
        for c in 0..3 {
            let ((mean, stderr), t) = (got[c], truth[c]);
            let allowed = z * stderr + case.rounding * t;
            let off = (mean - t).abs();
            passed &= off <= allowed;
            passed &= stderr <= power * t;
            widest = widest.max(if t > 0.0 { stderr / t } else { 0.0 });
            let share = if off == 0.0 { 0.0 } else { off / allowed };
            if share > worst || share.is_nan() {
                worst = share;
                at = format!(" (element {i}, channel {c}: {mean:.6} +- {stderr:.1e} against {t:.6})");
            }
        }
    }
    let detail = format!(
        "{worst:.2} of what is allowed{at}; widest error bar {:.3} % (limit {:.1} %), t = {z:.2}, {} samples, {} bad numbers",
        100.0 * widest,
        100.0 * power,
        film.samples(),
        film.invalid() + film.saturated(),
    );
    Ok(vec![(format!("{}analytic/{}", estimator.prefix(), case.name), passed, detail)])
}
