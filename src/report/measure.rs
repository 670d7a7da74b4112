//! Runs all contenders in turns, so that a machine's moods hit all alike.

use super::reference::efficiency;
use super::runs::{Curve, Run};
use super::structure::Structure;
use super::{Contender, Picture, Reference, ReportError};
use crate::driver::{Progress, Watcher};
use crate::metrics::{MetricsInput, compare};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::time::Instant;

/// Pixels of an image where nothing is said.
const PIXELS: f64 = 32768.0;
/// Part of the time that the reference may take, and part that is left to draw and write.
const REFERENCE: f64 = 0.5;
const WRITING: f64 = 0.04;
/// The rung of trial runs: enough blocks to tell a variance.
const TRIAL_RUNG: u32 = 2;
/// A trial of a rung that would take this part of a contender's share is not made.
const TRIAL_SHARE: f64 = 0.5;
/// A first run may take so many times longer than those that follow.
const ONCE: f64 = 5.0;
/// The reference has this part of the time at least, however long trials took.
const REFERENCE_LEAST: f64 = 0.25;
/// So many standard errors more light are clearly more.
const MORE_LIGHT: f64 = 4.0;
/// Highest rung.
const RUNG_MOST: u32 = 12;
/// Seeds of the trial and the reference, far from those of replicates.
const TRIAL_SEED: u64 = 1 << 40;
const REFERENCE_SEED: u64 = 2 << 40;

/// What to spend.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Seconds for all of it.
    pub seconds: f64,
    /// Replicates of each rung, at least 2.
    pub replicates: u32,
    /// The first replicate's seed.
    pub seed: u64,
    /// Pixels across and down.
    pub size: (u32, u32),
    /// Pixels that count; `None`: all.
    pub mask: Option<Vec<bool>>,
}

/// A size of the same shape with few enough pixels for a ladder of efforts to fit into minutes.
pub fn modest_size((width, height): (u32, u32)) -> (u32, u32) {
    let scale = (PIXELS / (f64::from(width) * f64::from(height))).sqrt();
    let side = |n: u32| ((f64::from(n) * scale).round() as u32).max(1);
    if scale < 1.0 { (side(width), side(height)) } else { (width, height) }
}

/// What was not measured, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftOut {
    /// The curve.
    pub curve: Curve,
    /// The reason, for people.
    pub reason: String,
}

/// A rung of a curve: what its runs leave to be looked at.
#[derive(Clone, Debug)]
pub struct RungSums {
    /// Sums over the replicates.
    pub structure: Structure,
    /// The first replicate.
    pub radiance: Vec<[f32; 3]>,
    /// Options that make it again.
    pub options: String,
}

/// All that was measured.
#[derive(Debug)]
pub struct Measured {
    /// The reference.
    pub reference: Reference,
    /// Every run.
    pub runs: Vec<Run>,
    /// By curve and rung.
    pub sums: BTreeMap<(Curve, u32), RungSums>,
    /// What was not measured.
    pub left_out: Vec<LeftOut>,
    /// It was stopped: replicates are missing.
    pub cancelled: bool,
    /// Seconds of all of it.
    pub seconds: f64,
}

/// Tells how much of the budget is gone.
struct Within<'a> {
    outer: &'a dyn Watcher,
    start: Instant,
    seconds: f64,
}

impl Watcher for Within<'_> {
    fn progress(&self, progress: &Progress) {
        let seconds = self.start.elapsed().as_secs_f64();
        let fraction = Some((seconds / self.seconds).min(1.0));
        self.outer.progress(&Progress { fraction, seconds, ..*progress });
    }

    fn cancelled(&self) -> bool {
        self.outer.cancelled()
    }
}

/// A contender on its ladder.
struct Climber<'c, 'a> {
    contender: &'c mut (dyn Contender + 'a),
    /// Seconds of its last run, and of all its runs of the first replicate.
    last: f64,
    spent: f64,
    /// Rungs that it takes part in.
    rungs: u32,
    done: bool,
}

impl Climber<'_, '_> {
    /// Runs a rung, by the clock.
    fn run(&mut self, rung: u32, seed: u64, watcher: &dyn Watcher) -> Result<Vec<Picture>, ReportError> {
        let clock = Instant::now();
        let made = self.contender.run(rung, seed, watcher)?;
        self.last = clock.elapsed().as_secs_f64();
        Ok(made)
    }

    fn leave(&mut self, reason: &str, left_out: &mut Vec<LeftOut>) {
        self.done = true;
        let list = self.contender.curves().iter();
        left_out.extend(list.map(|curve| LeftOut { curve: curve.clone(), reason: reason.into() }));
    }
}

/// Measures contenders against a reference, which the best of them makes where none is given.
///
/// # Errors
/// A reference that does not fit or cannot be made. What a contender refuses is in [`Measured::left_out`]; being stopped is no error once there is a reference.
pub fn measure<'a>(
    contenders: &mut [Box<dyn Contender + 'a>],
    plan: &Plan,
    reference: Option<Reference>,
    watcher: &dyn Watcher,
) -> Result<Measured, ReportError> {
    let start = Instant::now();
    let watcher = &Within { outer: watcher, start, seconds: plan.seconds };
    if let Some(reference) = &reference {
        reference.check(plan.size)?;
    }
    let mut left_out = Vec::new();
    let mut climbers: Vec<Climber<'_, 'a>> = contenders
        .iter_mut()
        .map(|c| Climber { contender: &mut **c, last: 0.0, spent: 0.0, rungs: 0, done: false })
        .collect();
    let best = try_out(&mut climbers, plan, &mut left_out, watcher)?;
    let reference = match reference {
        Some(given) => given,
        None => make_reference(&mut climbers, best, plan, watcher)?,
    };
    let mut measured = Measured {
        reference,
        runs: Vec::new(),
        sums: BTreeMap::new(),
        left_out,
        cancelled: watcher.cancelled(),
        seconds: 0.0,
    };
    if !measured.cancelled {
        let left = plan.seconds * (1.0 - WRITING) - start.elapsed().as_secs_f64();
        climb(&mut climbers, plan, left, &mut measured, watcher)?;
    }
    measured.seconds = start.elapsed().as_secs_f64();
    if measured.runs.is_empty() {
        let list: Vec<String> =
            measured.left_out.iter().map(|l| format!("{}: {}", l.curve.name(), l.reason)).collect();
        let reason =
            if list.is_empty() { "stopped before the first run ended".into() } else { list.join("; ") };
        return Err(ReportError::Nothing { reason });
    }
    Ok(measured)
}

/// One run of each, at a rung that tells the variance where the lowest does not take long; the number of the best that converges.
fn try_out(
    climbers: &mut [Climber<'_, '_>],
    plan: &Plan,
    left_out: &mut Vec<LeftOut>,
    watcher: &Within<'_>,
) -> Result<Option<usize>, ReportError> {
    let share = plan.seconds * (1.0 - REFERENCE - WRITING) / climbers.len().max(1) as f64;
    let mut trials: Vec<Trial> = Vec::new();
    let count = climbers.len();
    for (number, climber) in climbers.iter_mut().enumerate() {
        match climber.run(0, TRIAL_SEED, watcher) {
            Ok(_) => {}
            Err(e) if e.is_cancelled() => return Err(e),
            Err(e) => {
                climber.leave(&e.to_string(), left_out);
                continue;
            }
        }
        let most = 2.0 * share / f64::from(plan.replicates);
        // The first run of all has whatever a backend does once; where that cannot be all of it there is no second.
        if climber.last <= ONCE * most || count == 1 {
            climber.run(0, TRIAL_SEED, watcher)?;
        }
        if climber.last > most && count > 1 {
            let reason = format!(
                "its least run takes {:.1} s, and {} of them are more than its share of the time",
                climber.last, plan.replicates
            );
            climber.leave(&reason, left_out);
            continue;
        }
        let expected = climber.last * climber.contender.growth().powi(TRIAL_RUNG as i32);
        let worth = trials.is_empty() || expected <= TRIAL_SHARE * share;
        if climber.contender.converges() && worth {
            let last = climber.last;
            let made = climber.run(TRIAL_RUNG, TRIAL_SEED, watcher)?;
            climber.last = last;
            trials.extend(made.first().map(|picture| Trial::of(number, picture)));
        }
    }
    Ok(best_of(&trials))
}

/// What a trial says of a contender that could make the reference.
struct Trial {
    number: usize,
    efficiency: f64,
    /// Mean of all pixels and channels, and its variance.
    mean: f64,
    variance: f64,
}

impl Trial {
    fn of(number: usize, picture: &Picture) -> Self {
        let values = |list: &[[f32; 3]]| list.iter().flatten().map(|x| f64::from(*x)).sum::<f64>();
        let count = 3.0 * picture.radiance.len().max(1) as f64;
        Self {
            number,
            efficiency: efficiency(picture).unwrap_or(0.0),
            mean: values(&picture.radiance) / count,
            variance: picture.variance.as_deref().map_or(0.0, values) / (count * count),
        }
    }
}

/// The most efficient; but where another finds clearly more light, that one: rare light that has not been met yet makes a small variance, too.
fn best_of(trials: &[Trial]) -> Option<usize> {
    let best = trials.iter().max_by(|a, b| a.efficiency.total_cmp(&b.efficiency))?;
    let brighter = trials.iter().filter(|t| {
        let spread = (t.variance + best.variance).sqrt();
        t.mean - best.mean > MORE_LIGHT * spread
    });
    Some(brighter.max_by(|a, b| a.mean.total_cmp(&b.mean)).unwrap_or(best).number)
}

fn make_reference(
    climbers: &mut [Climber<'_, '_>],
    best: Option<usize>,
    plan: &Plan,
    watcher: &Within<'_>,
) -> Result<Reference, ReportError> {
    let nothing = |reason: &str| ReportError::Nothing { reason: reason.into() };
    let climber = best
        .and_then(|b| climbers.get_mut(b))
        .ok_or_else(|| nothing("no method that converges runs here; --reference FILE.exr can stand in"))?;
    let name = climber.contender.curves().first().map(Curve::name).unwrap_or_default();
    let left = plan.seconds * REFERENCE - watcher.start.elapsed().as_secs_f64();
    let left = left.max(plan.seconds * REFERENCE_LEAST);
    let outcome = climber.contender.for_seconds(left.max(climber.last), REFERENCE_SEED, watcher)?;
    Reference::of_outcome(&outcome, name)
        .ok_or_else(|| nothing("the reference is black, or was stopped before two blocks of samples"))
}

/// Rung after rung and replicate after replicate, all contenders in turns; the first replicate tells how high each can climb.
fn climb(
    climbers: &mut [Climber<'_, '_>],
    plan: &Plan,
    seconds: f64,
    measured: &mut Measured,
    watcher: &Within<'_>,
) -> Result<(), ReportError> {
    let running = climbers.iter().filter(|c| !c.done).count().max(1);
    let share = seconds / running as f64 / f64::from(plan.replicates.max(1));
    for replicate in 0..plan.replicates {
        for rung in 0..RUNG_MOST {
            for turn in 0..climbers.len() {
                // Another one first in each replicate.
                let number = (turn + replicate as usize) % climbers.len();
                let climber = &mut climbers[number];
                let expected = climber.last * if rung == 0 { 1.0 } else { climber.contender.growth() };
                let climbs = if replicate == 0 {
                    rung == 0 || (climber.rungs == rung && climber.spent + expected <= share)
                } else {
                    rung < climber.rungs
                };
                if climber.done || !climbs {
                    continue;
                }
                let made = match climber.run(rung, plan.seed + u64::from(replicate), watcher) {
                    Ok(made) => made,
                    Err(e) if e.is_cancelled() => {
                        measured.cancelled = true;
                        return Ok(());
                    }
                    Err(e) => {
                        climber.leave(&e.to_string(), &mut measured.left_out);
                        continue;
                    }
                };
                if made.is_empty() {
                    continue;
                }
                if replicate == 0 {
                    climber.spent += climber.last;
                    climber.rungs = rung + 1;
                }
                for picture in made {
                    let curve = climber.contender.curves()[picture.curve].clone();
                    take(measured, plan, (&curve, rung, replicate), picture)?;
                }
            }
        }
    }
    Ok(())
}

/// Compares a picture and keeps what is needed of it.
fn take(
    measured: &mut Measured,
    plan: &Plan,
    (curve, rung, replicate): (&Curve, u32, u32),
    picture: Picture,
) -> Result<(), ReportError> {
    let (width, height) = (plan.size.0 as usize, plan.size.1 as usize);
    let reference = &measured.reference;
    let mask = plan.mask.as_deref();
    let metrics = compare(&MetricsInput {
        var_x: picture.variance.as_deref(),
        var_r: reference.variance.as_deref(),
        mask,
        ..MetricsInput::new(width, height, &picture.radiance, &reference.radiance)
    })?;
    let stages = picture.stages.iter().fold(String::new(), |mut text, (name, s)| {
        let _ = write!(text, "{}{name}={s:.4}", if text.is_empty() { "" } else { " " });
        text
    });
    measured.runs.push(Run {
        method: curve.method.clone(),
        variant: curve.variant.clone(),
        backend: curve.backend.clone(),
        effort: picture.effort.clone(),
        rung,
        replicate,
        samples: picture.samples,
        seconds: picture.seconds(),
        cpu_seconds: Some(picture.cpu_seconds),
        stages,
        rays: Some(picture.rays),
        bytes: picture.bytes,
        rel_error: metrics.rel_error,
        rel_mse: metrics.rel_mse,
        energy_error: metrics.energy_error,
        bias_r: metrics.bias[0],
        bias_g: metrics.bias[1],
        bias_b: metrics.bias[2],
        block_5: metrics.block_ratio[0],
        block_50: metrics.block_ratio[1],
        block_95: metrics.block_ratio[2],
        worst_block: metrics.worst_block,
        flip: metrics.flip,
        z_pass: metrics.z_pass,
    });
    let sums = measured.sums.entry((curve.clone(), rung)).or_insert_with(|| RungSums {
        structure: Structure::new(width, width * height),
        radiance: picture.radiance.clone(),
        options: picture.options.clone(),
    });
    sums.structure.add(&picture.radiance, &reference.radiance, mask);
    Ok(())
}
