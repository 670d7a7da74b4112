//! Drives a job to its end: a number of samples, a time, or an estimated error.
//!
//! Work advances by whole sample blocks; after each pass the film is a valid result, so that a job can be stopped at
//! any time and leave what it has. The same settings give the same bits for any number of threads; a budget in
//! seconds decides only how many blocks there are.

#![allow(clippy::disallowed_methods, reason = "estimates of error for people, in f64: no kernel")]

mod map;
mod meter;
#[cfg(feature = "io")]
mod operator_file;
mod photon;
pub mod radiosity;

use crate::metrics::statistics;
use etendue_core::backend::{
    self, BackendError, BidirectionalJob, Control, JobStats, PathJob, Probe, Session,
};
use etendue_core::film::Film;
use etendue_core::transport::bidirectional::Heuristic;
use etendue_core::transport::volume::SingleScatter;
use std::ops::{ControlFlow, Range};
use std::time::{Duration, Instant};

pub use map::MapValues;
pub use meter::{Meter, MeterMethod, meters};
#[cfg(feature = "io")]
pub use operator_file::{OpenError, open_operator, operator_file};
pub use photon::{
    GatherSettings, PhotonSettings, choose_start, direct_irradiance, element_size, illumination,
    photon_image, photon_probes, photons_per_block, photons_per_replicate,
};

/// Shortest block of samples.
pub const BLOCK_MIN: u32 = 16;
/// Length of a block where the number of samples is not known beforehand.
pub const BLOCK_OPEN: u32 = 64;
/// Longest block.
const BLOCK_MAX: u32 = 1 << 16;
/// What a pass should take: so much is lost at most when a job is stopped.
const PASS_SECONDS: f64 = 1.0;
/// Confidence of the interval of the estimated error.
pub const CONFIDENCE: f64 = 0.99;

/// When a job ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Budget {
    /// After this many samples per pixel or probe, rounded up to whole blocks.
    Samples(u64),
    /// After this many seconds; the first block is finished whatever it takes.
    Seconds(f64),
    /// When the estimated relative error falls below this; tested when the number of samples doubles.
    Error(f64),
}

/// What to compute.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Seed of all samples.
    pub seed: u64,
    /// Largest number of edges of a path.
    pub max_depth: u32,
    /// When to end.
    pub budget: Budget,
}

impl Default for Settings {
    fn default() -> Self {
        Self { seed: 0, max_depth: u32::MAX, budget: Budget::Samples(256) }
    }
}

/// The length of a block for a budget: about a sixteenth of the samples where their number is known, a power of two.
pub fn block_length(budget: Budget) -> u32 {
    match budget {
        Budget::Samples(n) => {
            let sixteenth = (n / 16).clamp(1, u64::from(BLOCK_MAX)) as u32;
            (1 << sixteenth.ilog2()).max(BLOCK_MIN)
        }
        Budget::Seconds(_) | Budget::Error(_) => BLOCK_OPEN,
    }
}

/// Where a job stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Finished part in \[0, 1\], where it can be known.
    pub fraction: Option<f64>,
    /// Samples per element in the film so far.
    pub samples: u64,
    /// Estimated relative error of the film so far.
    pub rel_error: Option<f64>,
    /// Seconds since the start.
    pub seconds: f64,
}

/// Watches a job and may stop it.
pub trait Watcher: Sync {
    /// Called from worker threads and between passes.
    fn progress(&self, progress: &Progress);

    /// True ends the job; it returns what it has.
    fn cancelled(&self) -> bool {
        false
    }
}

/// Neither watches nor stops.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Watcher for Silent {
    fn progress(&self, _: &Progress) {}
}

/// The estimated relative error of a film: `sqrt(sum var / sum |mean|^2)` over elements and channels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorEstimate {
    /// The estimate.
    pub rel_error: f64,
    /// Ends of its confidence interval ([`CONFIDENCE`]), from the chi-square law of the block variances.
    pub interval: [f64; 2],
}

/// A finished (or stopped) job.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The sums.
    pub film: Film,
    /// What it cost.
    pub stats: JobStats,
    /// Seconds of sampling.
    pub seconds: f64,
    /// The watcher stopped it before its budget was used.
    pub cancelled: bool,
    /// The estimated error; `None` below two blocks or for a black result.
    pub error: Option<ErrorEstimate>,
}

/// Path-traces an image.
///
/// # Errors
/// As [`Session::path_image`]; being stopped is no error.
pub fn image(
    session: &dyn Session,
    settings: &Settings,
    watcher: &dyn Watcher,
) -> Result<Outcome, BackendError> {
    let first = first_job(settings);
    let film = Film::new(backend::image_film_settings(session.scene(), &first)?);
    drive(film, first, settings.budget, watcher, &even, |job, control, film| {
        session.path_image(job, control, film)
    })
}

/// Path-traces an image, its airlight summed along the camera's rays.
///
/// # Errors
/// As [`Session::airlight_image`]; being stopped is no error.
pub fn airlight_image(
    session: &dyn Session,
    settings: &Settings,
    single: SingleScatter,
    watcher: &dyn Watcher,
) -> Result<Outcome, BackendError> {
    let first = first_job(settings);
    let film = Film::new(backend::image_film_settings(session.scene(), &first)?);
    drive(film, first, settings.budget, watcher, &even, |job, control, film| {
        session.airlight_image(job, single, control, film)
    })
}

/// Path-traces the irradiance at probes.
///
/// # Errors
/// As [`Session::path_probes`]; being stopped is no error.
pub fn probes(
    session: &dyn Session,
    probes: &[Probe],
    settings: &Settings,
    watcher: &dyn Watcher,
) -> Result<Outcome, BackendError> {
    let first = first_job(settings);
    let film = Film::new(backend::probe_film_settings(session.scene(), &first, probes.len()));
    drive(film, first, settings.budget, watcher, &even, |job, control, film| {
        session.path_probes(job, probes, control, film)
    })
}

/// Traces an image from both ends.
///
/// # Errors
/// As [`Session::bidirectional_image`]; being stopped is no error.
pub fn bidirectional_image(
    session: &dyn Session,
    settings: &Settings,
    heuristic: Heuristic,
    watcher: &dyn Watcher,
) -> Result<Outcome, BackendError> {
    let first = first_job(settings);
    let film = Film::new(backend::image_film_settings(session.scene(), &first)?);
    drive(film, first, settings.budget, watcher, &even, |job, control, film| {
        session.bidirectional_image(&both_ends(job, heuristic), control, film)
    })
}

/// Traces the irradiance at probes from both ends.
///
/// # Errors
/// As [`Session::bidirectional_probes`]; being stopped is no error.
pub fn bidirectional_probes(
    session: &dyn Session,
    probes: &[Probe],
    settings: &Settings,
    heuristic: Heuristic,
    watcher: &dyn Watcher,
) -> Result<Outcome, BackendError> {
    let first = first_job(settings);
    let film = Film::new(backend::probe_film_settings(session.scene(), &first, probes.len()));
    drive(film, first, settings.budget, watcher, &even, |job, control, film| {
        session.bidirectional_probes(&both_ends(job, heuristic), probes, control, film)
    })
}

fn both_ends(path: &PathJob, heuristic: Heuristic) -> BidirectionalJob {
    BidirectionalJob { heuristic, ..BidirectionalJob::new(path.clone()) }
}

/// Elements that count alike.
fn even(_: usize) -> f64 {
    1.0
}

fn first_job(settings: &Settings) -> PathJob {
    PathJob {
        seed: settings.seed,
        block_length: block_length(settings.budget),
        blocks: 0..0,
        max_depth: settings.max_depth,
    }
}

/// Reports the progress within a pass and stops it when the watcher says so.
struct PassControl<'a> {
    watcher: &'a dyn Watcher,
    start: Instant,
    samples: u64,
    rel_error: Option<f64>,
    /// Part of the whole job that is done before this pass and after it.
    span: Option<[f64; 2]>,
}

impl<'a> PassControl<'a> {
    /// Of a job that is one pass.
    fn whole(watcher: &'a dyn Watcher, samples: u64) -> Self {
        Self { watcher, start: Instant::now(), samples, rel_error: None, span: Some([0.0, 1.0]) }
    }
}

impl Control for PassControl<'_> {
    fn advance(&self, done: u64, total: u64) -> ControlFlow<()> {
        let within = done as f64 / total.max(1) as f64;
        self.watcher.progress(&Progress {
            fraction: self.span.map(|[a, b]| a + (b - a) * within),
            samples: self.samples,
            rel_error: self.rel_error,
            seconds: self.start.elapsed().as_secs_f64(),
        });
        if self.watcher.cancelled() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

fn drive(
    mut film: Film,
    mut job: PathJob,
    budget: Budget,
    watcher: &dyn Watcher,
    weight: &dyn Fn(usize) -> f64,
    mut run: impl FnMut(&PathJob, &dyn Control, &mut Film) -> Result<JobStats, BackendError>,
) -> Result<Outcome, BackendError> {
    let start = Instant::now();
    let mut stats = JobStats::default();
    let mut error = None;
    let mut cancelled = false;
    while let Some(blocks) = next_blocks(budget, job.block_length, job.blocks.end, start.elapsed(), error) {
        if watcher.cancelled() {
            cancelled = true;
            break;
        }
        let span = span(budget, job.block_length, &blocks, start.elapsed());
        job.blocks = blocks;
        let control = PassControl {
            watcher,
            start,
            samples: film.samples(),
            rel_error: error.map(|e: ErrorEstimate| e.rel_error),
            span,
        };
        tracing::debug!(blocks = ?job.blocks, "pass");
        match run(&job, &control, &mut film) {
            Ok(s) => stats += s,
            Err(BackendError::Cancelled) => {
                cancelled = true;
                break;
            }
            Err(e) => return Err(e),
        }
        error = estimate_weighted_error(&film, weight);
    }
    Ok(Outcome { film, stats, seconds: start.elapsed().as_secs_f64(), cancelled, error })
}

/// The blocks of the next pass, or `None` when the budget is used up after `done` blocks.
///
/// A pass is as many blocks as seem to take [`PASS_SECONDS`]: a pass that is stopped is lost, so it must be short. How
/// a job is cut into passes does not touch its bits.
fn next_blocks(
    budget: Budget,
    length: u32,
    done: u32,
    elapsed: Duration,
    error: Option<ErrorEstimate>,
) -> Option<Range<u32>> {
    let per_block = (elapsed.as_secs_f64() / f64::from(done.max(1))).max(1e-9);
    let step = if done == 0 { 1 } else { ((PASS_SECONDS / per_block) as u32).clamp(1, done) };
    let end = done.checked_add(step)?;
    match budget {
        Budget::Samples(n) => {
            let total = n.div_ceil(u64::from(length)).clamp(1, u64::from(u32::MAX)) as u32;
            (done < total).then(|| done..total.min(end))
        }
        Budget::Seconds(seconds) => {
            let fit = (seconds - elapsed.as_secs_f64()) / per_block;
            let last = done.saturating_add((fit as u32).max(1));
            (done == 0 || fit >= 0.5).then(|| done..end.min(last))
        }
        Budget::Error(target) => {
            // Tested when the number doubles; four blocks are the least from which a variance says something.
            if done >= 4 && done.is_power_of_two() && error.is_none_or(|e| e.rel_error <= target) {
                return None;
            }
            let next_test = done.checked_add(1)?.checked_next_power_of_two()?.max(4);
            Some(done..end.min(next_test))
        }
    }
}

/// Which part of the whole job a pass is, where that can be known.
fn span(budget: Budget, length: u32, blocks: &Range<u32>, elapsed: Duration) -> Option<[f64; 2]> {
    match budget {
        Budget::Samples(n) => {
            let total = n.div_ceil(u64::from(length)).max(1) as f64;
            Some([f64::from(blocks.start) / total, f64::from(blocks.end) / total])
        }
        Budget::Seconds(seconds) => {
            let now = (elapsed.as_secs_f64() / seconds.max(1e-9)).min(1.0);
            let per_block = now / f64::from(blocks.start.max(1));
            let pass = per_block * f64::from(blocks.end - blocks.start);
            Some([now, if blocks.start == 0 { 1.0 } else { (now + pass).min(1.0) }])
        }
        Budget::Error(_) => None,
    }
}

/// Estimates the relative error of a film from its own block variances; the noise in the mean squares is taken out.
pub fn estimate_error(film: &Film) -> Option<ErrorEstimate> {
    estimate_weighted_error(film, &even)
}

/// [`estimate_error`] with a weight for each element, its area say.
pub fn estimate_weighted_error(film: &Film, weight: &dyn Fn(usize) -> f64) -> Option<ErrorEstimate> {
    let (mut variance, mut variance2, mut square) = (0.0, 0.0, 0.0);
    for i in 0..film.len() {
        let (v, m) = (film.variance(i)?, film.mean(i));
        let w = weight(i);
        let v = w * v.iter().sum::<f64>();
        variance += v;
        variance2 += v * v;
        square += w * m.iter().map(|x| x * x).sum::<f64>();
    }
    let signal = (square - variance).max(0.5 * square);
    if signal <= 0.0 {
        return None;
    }
    let rel_error = (variance / signal).sqrt();
    // Sums of variances follow a chi-square law of so many degrees (Welch 1947, Satterthwaite 1946); the cube-root
    // approximation of its quantiles (Wilson and Hilferty 1931) is within 1 % from 3 degrees on.
    let blocks = film.block_count() as f64;
    let degrees =
        if variance2 > 0.0 { (blocks - 1.0) * variance * variance / variance2 } else { f64::INFINITY };
    let z = statistics::normal_two_sided(1.0 - CONFIDENCE);
    let quantile = |z: f64| {
        let spread = 2.0 / (9.0 * degrees);
        (1.0 - spread + z * spread.sqrt()).max(1e-3).powi(3)
    };
    let interval = [rel_error / quantile(z).sqrt(), rel_error / quantile(-z).sqrt()];
    Some(ErrorEstimate { rel_error, interval })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_a_sixteenth_of_the_samples() {
        for (n, length) in
            [(0, 16), (1, 16), (256, 16), (512, 32), (1000, 32), (1 << 20, 1 << 16), (u64::MAX, 1 << 16)]
        {
            assert_eq!(block_length(Budget::Samples(n)), length, "{n}");
        }
        assert_eq!(block_length(Budget::Seconds(1.0)), 64);
        assert_eq!(block_length(Budget::Error(0.1)), 64);
    }

    #[test]
    fn passes_cover_each_block_once() {
        for n in [1_u64, 16, 17, 100, 256, 1000, 4096, 100_000] {
            let budget = Budget::Samples(n);
            let length = block_length(budget);
            let mut done = 0;
            while let Some(r) = next_blocks(budget, length, done, Duration::ZERO, None) {
                assert_eq!(r.start, done);
                assert!(r.end > r.start);
                done = r.end;
            }
            let samples = u64::from(done) * u64::from(length);
            assert!(samples >= n && samples < n + u64::from(length), "{n}: {samples}");
        }
    }

    #[test]
    fn an_error_budget_is_tested_when_the_number_doubles() {
        let error = |e| Some(ErrorEstimate { rel_error: e, interval: [e, e] });
        let next = |done, e| next_blocks(Budget::Error(0.01), 64, done, Duration::from_millis(1), e);
        assert_eq!(next(0, None), Some(0..1));
        assert_eq!(next(3, error(0.001)), Some(3..4), "too few blocks to trust");
        assert_eq!(next(4, error(0.02)), Some(4..8));
        assert_eq!(next(6, error(0.001)), Some(6..8), "tested at powers of two only");
        assert_eq!(next(8, error(0.0101)), Some(8..16));
        assert_eq!(next(16, error(0.0099)), None);
        assert_eq!(next(4, None), None, "a black result has no error to reduce");
    }

    #[test]
    fn a_time_budget_ends_and_passes_are_short() {
        let next = |done, seconds| {
            next_blocks(Budget::Seconds(10.0), 64, done, Duration::from_secs_f64(seconds), None)
        };
        assert_eq!(next(0, 0.0), Some(0..1));
        assert_eq!(next(1, 1.0), Some(1..2));
        assert_eq!(next(100, 1.0), Some(100..200), "a second's worth");
        assert_eq!(next(100, 9.95), Some(100..101), "what is left");
        assert_eq!(next(10, 9.8), None);
        assert_eq!(next(1, 60.0), None);
    }
}
