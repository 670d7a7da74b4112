//! Answers: what is off beyond noise, and what to use for an error.

use super::runs::Run;
use super::structure::Parts;
use super::summary::{CurveSummary, Summary};
use super::words::percent;
use crate::metrics::statistics::{sidak, student_t_two_sided};
use serde::Serialize;
use std::collections::BTreeMap;

/// Level of all tests of a report together.
const ALPHA: f64 = 0.01;
/// Lasting errors below this are not worth a word.
const WORTH: f64 = 5e-4;
/// Errors that people ask for.
const GOALS: [f64; 10] = [0.3, 0.2, 0.1, 0.05, 0.03, 0.02, 0.01, 0.005, 0.002, 0.001];
/// How far beyond what was measured an answer may reach, in time.
pub(super) const BEYOND: f64 = 8.0;
/// A curve falls at least so steeply where more time is worth it.
const FALLS: f64 = -0.25;

/// Whether a curve is off.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bias {
    /// Mean energy over the reference's, less 1, per channel; runs weigh by their samples.
    pub energy: [f64; 3],
    /// Half the width of its interval, for all channels and curves of a report together at 99 %; the reference's own error is in it.
    pub width: [f64; 3],
    /// Energy is off beyond that in some channel.
    pub energy_off: bool,
    /// The part of `rel_error` at the highest rung that more replicates would not take away.
    pub lasting: Option<f64>,
    /// That part is there beyond chance, in some place of the image, and worth a word.
    pub lasting_off: bool,
}

impl Bias {
    /// From all runs of a curve. Rungs share one spread per sample, so that a few replicates of several rungs tell it well. `None` where no rung has two.
    pub(super) fn of(runs: &[&Run], parts: Option<Parts>, reference: [f64; 3], tests: u64) -> Option<Self> {
        let mut rungs: BTreeMap<u32, Vec<&Run>> = BTreeMap::new();
        for run in runs {
            rungs.entry(run.rung).or_default().push(run);
        }
        let degrees: usize = rungs.values().map(|list| list.len() - 1).sum();
        if degrees == 0 {
            return None;
        }
        let weight = |r: &Run| r.samples.max(1) as f64;
        let t = student_t_two_sided(sidak(ALPHA, tests), degrees as f64);
        let total: f64 = runs.iter().map(|r| weight(r)).sum();
        let mut energy = [0.0; 3];
        let mut width = [0.0; 3];
        for c in 0..3 {
            energy[c] = runs.iter().map(|r| weight(r) * r.bias()[c]).sum::<f64>() / total;
            let squares: f64 = rungs
                .values()
                .map(|list| {
                    let mean = list.iter().map(|r| r.bias()[c]).sum::<f64>() / list.len() as f64;
                    list.iter().map(|r| weight(r) * (r.bias()[c] - mean).powi(2)).sum::<f64>()
                })
                .sum();
            let variance = squares / degrees as f64 / total;
            width[c] = t * (variance + reference[c].powi(2)).sqrt();
        }
        let energy_off = (0..3).any(|c| energy[c].is_finite() && energy[c].abs() > width[c]);
        let lasting_off = parts.is_some_and(|p| p.chance < sidak(ALPHA, tests) && p.lasting > WORTH);
        Some(Self { energy, width, energy_off, lasting: parts.map(|p| p.lasting), lasting_off })
    }

    /// Whether it is off at all.
    pub fn is_off(&self) -> bool {
        self.energy_off || self.lasting_off
    }

    /// By how much it is off, of what is beyond noise.
    pub fn size(&self) -> f64 {
        let energy = if self.energy_off { self.energy[self.worst()].abs() } else { 0.0 };
        energy.max(if self.lasting_off { self.lasting.unwrap_or(0.0) } else { 0.0 })
    }

    /// The channel that is off most, for the width of its interval.
    fn worst(&self) -> usize {
        let off = |c: usize| self.energy[c].abs() / self.width[c].max(f64::MIN_POSITIVE);
        (0..3).max_by(|a, b| off(*a).total_cmp(&off(*b))).unwrap_or(0)
    }

    /// For people.
    pub fn words(&self) -> String {
        let c = self.worst();
        let (mean, width) = (100.0 * self.energy[c], 100.0 * self.width[c]);
        let energy =
            format!("{mean:+.2} \u{b1} {width:.2} % of the light in {}", ["red", "green", "blue"][c]);
        match (self.energy_off, self.lasting_off) {
            (true, true) => format!("biased: {energy}; {}", self.lasting_words()),
            (true, false) => format!("biased: {energy}"),
            (false, true) => format!("biased in places: {}", self.lasting_words()),
            (false, false) => format!("no bias found ({energy})"),
        }
    }

    fn lasting_words(&self) -> String {
        format!("an error of {} stays", percent(self.lasting.unwrap_or(0.0)))
    }
}

/// How an answer between measurements was found, the surest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Reach {
    /// Between two rungs.
    Measured,
    /// The least effort has less error already: it takes that long at most.
    AtMost,
    /// Beyond the last rung.
    Beyond,
}

impl Reach {
    /// What is written before a number.
    pub(super) fn sign(self) -> &'static str {
        match self {
            Self::AtMost => "\u{2264} ",
            Self::Measured => "",
            Self::Beyond => "~",
        }
    }
}

/// Seconds that a curve takes to an error.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Way {
    /// The curve, by its place in the summary.
    pub curve: usize,
    /// Median seconds.
    pub seconds: f64,
    /// How that is known.
    pub reach: Reach,
    /// Options of `etendue render` for about that, empty where they are not known.
    pub options: String,
}

/// The ways to an error, the fastest first.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Goal {
    /// `rel_error`.
    pub error: f64,
    /// Curves that reach it.
    pub ways: Vec<Way>,
}

/// The ways to each error that some curve reaches.
pub(super) fn goals(summary: &Summary) -> Vec<Goal> {
    let list = GOALS.iter().filter(|goal| **goal >= 3.0 * summary.reference_error[0]).map(|error| {
        let mut ways: Vec<Way> = summary
            .curves
            .iter()
            .enumerate()
            .filter_map(|(number, curve)| way(number, curve, *error))
            .collect();
        ways.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
        Goal { error: *error, ways }
    });
    let mut list: Vec<Goal> = list.filter(|g| g.ways.iter().any(|w| w.reach != Reach::Beyond)).collect();
    // Where all are there from their least effort on, one goal says it.
    let easy = list
        .iter()
        .rposition(|g| {
            g.ways.len() == summary.curves.len() && g.ways.iter().all(|w| w.reach == Reach::AtMost)
        })
        .unwrap_or(0);
    list.drain(..easy);
    list
}

/// Where times and errors of rungs get to an error: the rung, and the time, between two of them by a straight line in logarithms.
pub(super) fn reached(rungs: &[[f64; 2]], error: f64) -> Option<(usize, f64, Reach)> {
    let rung = rungs.iter().position(|r| r[1] <= error)?;
    let [time, reached] = rungs[rung];
    let Some([before, high]) = rung.checked_sub(1).map(|r| rungs[r]) else {
        return Some((rung, time, Reach::AtMost));
    };
    let part = (high / error).ln() / (high / reached).ln();
    Some((rung, before * (time / before).powf(part), Reach::Measured))
}

fn way(number: usize, curve: &CurveSummary, error: f64) -> Option<Way> {
    let cells = &curve.cells;
    let made = |seconds: f64, reach: Reach, options: &str| {
        Some(Way { curve: number, seconds, reach, options: options.into() })
    };
    let rungs: Vec<[f64; 2]> = cells.iter().map(|c| [c.seconds.median, c.rel_error.median]).collect();
    if let Some((rung, seconds, reach)) = reached(&rungs, error) {
        return made(seconds, reach, &cells[rung].options);
    }
    let last = cells.last()?;
    let slope = curve.slope.filter(|s| *s < FALLS)?;
    if curve.bias.is_some_and(|b| b.lasting.is_some_and(|l| b.is_off() && l > 0.5 * error)) {
        return None;
    }
    let seconds = last.seconds.median * (error / last.rel_error.median).powf(1.0 / slope);
    if seconds > BEYOND * last.seconds.median {
        return None;
    }
    made(seconds, Reach::Beyond, "")
}

#[cfg(test)]
mod tests {
    use super::super::summary::Extra;
    use super::*;

    /// Runs of unbiased noise, or all of them off by as much.
    fn runs(shift: f64, noise: f64) -> Vec<Run> {
        let mut list = Vec::new();
        for rung in 0..3_u32 {
            for replicate in 0..5_u32 {
                // Fixed numbers in [-1, 1] that look like noise.
                let u =
                    f64::from((rung * 5 + replicate + 1).wrapping_mul(0x9E37_79B9)) / 2.0_f64.powi(31) - 1.0;
                let bias = shift + noise * u / f64::from(1 << rung).sqrt();
                list.push(Run {
                    method: "x".into(),
                    rung,
                    replicate,
                    samples: 16 << rung,
                    seconds: f64::from(1 << rung),
                    rel_error: 0.1 / f64::from(1 << rung).sqrt(),
                    bias_r: bias,
                    bias_g: bias,
                    bias_b: bias,
                    ..Run::default()
                });
            }
        }
        list
    }

    fn bias(shift: f64) -> Bias {
        let list = runs(shift, 1e-3);
        Bias::of(&list.iter().collect::<Vec<_>>(), None, [1e-5; 3], 30).unwrap()
    }

    #[test]
    fn a_hundredth_too_little_light_is_named() {
        let found = bias(-0.01);
        assert!(found.energy_off && found.is_off());
        assert!(found.words().starts_with("biased: -"), "{}", found.words());
        assert!((found.energy[0] + 0.01).abs() < 1e-3);
        let right = bias(0.0);
        assert!(!right.is_off() && right.words().starts_with("no bias found"), "{right:?}");
    }

    #[test]
    fn ways_to_errors_are_found_between_and_shortly_beyond_what_was_measured() {
        let summary = Summary::new(&runs(0.0, 1e-3), &Extra::new(), ([0.0; 2], [0.0; 3]));
        let found: Vec<(f64, Option<f64>)> =
            GOALS.iter().map(|e| (*e, way(0, &summary.curves[0], *e).map(|w| w.seconds))).collect();
        // Error 0.1 / sqrt(t), measured from 1 to 4 seconds.
        for (error, seconds) in found {
            let truth = (0.1 / error).powi(2).max(1.0);
            match seconds {
                Some(s) => assert!((s - truth).abs() < 1e-6 * truth, "{error}: {s}"),
                None => assert!(truth > 32.0, "{error}"),
            }
        }
        let goals = goals(&summary);
        assert_eq!(goals.iter().map(|g| g.error).collect::<Vec<_>>(), [0.1, 0.05]);
    }
}
