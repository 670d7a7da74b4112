//! What follows from runs alone: medians and ranges, slopes, efficiencies.

use super::price::{self, Price, Prices};
use super::runs::{Curve, Run};
use super::structure::Parts;
use super::verdict::Bias;
use serde::Serialize;
use std::collections::BTreeMap;

/// Middle of some values with their ends. Of five independent values the ends hold the true median with a probability of 15/16.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Middle {
    /// The median.
    pub median: f64,
    /// The least.
    pub low: f64,
    /// The greatest.
    pub high: f64,
}

impl Middle {
    /// `None` of nothing.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut list: Vec<f64> = values.into_iter().collect();
        list.sort_by(f64::total_cmp);
        let (low, high) = (*list.first()?, *list.last()?);
        let n = list.len();
        Some(Self { median: 0.5 * (list[(n - 1) / 2] + list[n / 2]), low, high })
    }
}

/// A rung of a curve.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cell {
    /// What it was made with.
    pub effort: String,
    /// Its place on the ladder.
    pub rung: u32,
    /// Samples per pixel.
    pub samples: u64,
    /// Runs.
    pub replicates: usize,
    /// Seconds on the wall.
    pub seconds: Middle,
    /// Seconds of all threads.
    pub cpu_seconds: Option<Middle>,
    /// `rel_error`.
    pub rel_error: Middle,
    /// `rel_mse`.
    pub rel_mse: Middle,
    /// `flip`.
    pub flip: Middle,
    /// `worst_block`.
    pub worst_block: Middle,
    /// `energy_error`.
    pub energy_error: Middle,
    /// `z_pass`.
    pub z_pass: Option<Middle>,
    /// Rays per second on the wall.
    pub rays_per_second: Option<f64>,
    /// Bytes of the operator.
    pub bytes: Option<u64>,
    /// Its error is below three standard errors of the reference: not told from none.
    pub at_floor: bool,
    /// The part of its `rel_error` that more replicates would not take away, where images were at hand.
    pub lasting: Option<f64>,
    /// The part that is noise.
    pub noise: Option<f64>,
    /// Options of `etendue render` that make it again; empty for other programs.
    pub options: String,
}

/// All rungs of a curve, and what they have in common.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CurveSummary {
    /// Which.
    #[serde(flatten)]
    pub curve: Curve,
    /// For people.
    pub name: String,
    /// From the least effort on.
    pub cells: Vec<Cell>,
    /// Slope of log error over log seconds, by least squares through the medians; -0.5 is that of independent samples.
    pub slope: Option<f64>,
    /// `rel_error^2 x seconds` of path tracing on the CPU over this curve's, at the highest rung of each, replicate by replicate: how many times less time for the same error, if error falls with the root of time.
    pub efficiency: Option<Middle>,
    /// The same with the part of the error that is noise alone, from medians.
    pub noise_efficiency: Option<f64>,
    /// Whether it is off, beyond noise.
    pub bias: Option<Bias>,
    /// CPU seconds to a small error, where it gets there.
    pub price: Option<Price>,
}

/// Everything that a report says in numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// In the order of their names.
    pub curves: Vec<CurveSummary>,
    /// Standard error of the reference: `rel_error`, and root of `rel_mse`.
    pub reference_error: [f64; 2],
    /// Replicates of a rung, at most.
    pub replicates: usize,
    /// Names of the curves that prices are compared with.
    pub bases: Vec<String>,
}

/// What images told beyond their metrics, by curve and rung.
pub(super) type Extra = BTreeMap<(Curve, u32), (Option<Parts>, String)>;

impl Summary {
    /// Of runs, and of what else is known.
    pub(super) fn new(runs: &[Run], extra: &Extra, reference: ([f64; 2], [f64; 3])) -> Self {
        let mut by_curve: BTreeMap<Curve, BTreeMap<u32, Vec<&Run>>> = BTreeMap::new();
        for run in runs {
            by_curve.entry(run.curve()).or_default().entry(run.rung).or_default().push(run);
        }
        let (errors, energy) = reference;
        let path = Curve::new("path", "", "cpu");
        let base = by_curve.get(&path).cloned();
        let tests = 3 * by_curve.len() as u64;
        let names: Vec<Curve> = by_curve.keys().cloned().collect();
        let bases = price::bases(&names);
        let mut costs: BTreeMap<Curve, Prices> = BTreeMap::new();
        let mut curves: Vec<CurveSummary> = by_curve
            .into_iter()
            .map(|(curve, rungs)| {
                let cells: Vec<Cell> = rungs
                    .iter()
                    .filter_map(|(rung, list)| cell(list, extra.get(&(curve.clone(), *rung)), errors))
                    .collect();
                let all: Vec<&Run> = rungs.values().flatten().copied().collect();
                let parts = rungs
                    .keys()
                    .next_back()
                    .and_then(|top| extra.get(&(curve.clone(), *top)).and_then(|e| e.0));
                let bias = Bias::of(&all, parts, energy, tests);
                costs.insert(curve.clone(), price::prices(&rungs, bias));
                CurveSummary {
                    name: curve.name(),
                    slope: slope(&cells),
                    efficiency: base.as_ref().and_then(|base| efficiency(base, &rungs)),
                    noise_efficiency: None,
                    bias,
                    price: None,
                    cells,
                    curve,
                }
            })
            .collect();
        let noise_price = |c: &CurveSummary| {
            let top = c.cells.last()?;
            Some(top.noise?.powi(2) * top.seconds.median).filter(|p| *p > 0.0)
        };
        let plain = curves.iter().find(|c| c.curve == path).and_then(noise_price);
        for curve in &mut curves {
            curve.noise_efficiency = plain.zip(noise_price(curve)).map(|(plain, own)| plain / own);
        }
        let replicates = curves.iter().flat_map(|c| &c.cells).map(|c| c.replicates).max().unwrap_or(0);
        let of_bases: Vec<&Prices> = bases.iter().filter_map(|b| costs.get(b)).collect();
        for curve in &mut curves {
            curve.price = costs.get(&curve.curve).and_then(|own| Price::of(own, replicates, &of_bases));
        }
        let bases = bases.iter().map(Curve::name).collect();
        Self { curves, reference_error: errors, replicates, bases }
    }

    /// The curve of this method, variant and backend.
    pub fn curve(&self, curve: &Curve) -> Option<&CurveSummary> {
        self.curves.iter().find(|c| c.curve == *curve)
    }
}

fn cell(runs: &[&Run], extra: Option<&(Option<Parts>, String)>, floor: [f64; 2]) -> Option<Cell> {
    let first = runs.first()?;
    let middle = |f: fn(&Run) -> f64| Middle::of(runs.iter().map(|r| f(r)));
    let maybe = |f: fn(&Run) -> Option<f64>| Middle::of(runs.iter().filter_map(|r| f(r)));
    let rel_error = middle(|r| r.rel_error)?;
    let parts = extra.and_then(|e| e.0);
    let rates = runs.iter().filter_map(|r| Some(r.rays? as f64 / r.seconds));
    Some(Cell {
        effort: first.effort.clone(),
        rung: first.rung,
        samples: first.samples,
        replicates: runs.len(),
        seconds: middle(|r| r.seconds)?,
        cpu_seconds: maybe(|r| r.cpu_seconds),
        rel_error,
        rel_mse: middle(|r| r.rel_mse)?,
        flip: middle(|r| r.flip)?,
        worst_block: middle(|r| r.worst_block)?,
        energy_error: middle(|r| r.energy_error)?,
        z_pass: maybe(|r| r.z_pass),
        rays_per_second: Middle::of(rates).map(|m| m.median),
        bytes: first.bytes,
        at_floor: rel_error.median < 3.0 * floor[0],
        lasting: parts.map(|p| p.lasting),
        noise: parts.map(|p| p.noise),
        options: extra.map(|e| e.1.clone()).unwrap_or_default(),
    })
}

/// Least squares through the medians of at least three rungs.
fn slope(cells: &[Cell]) -> Option<f64> {
    let points: Vec<[f64; 2]> = cells
        .iter()
        .filter(|c| c.rel_error.median > 0.0)
        .map(|c| [c.seconds.median.ln(), c.rel_error.median.ln()])
        .collect();
    if points.len() < 3 {
        return None;
    }
    let n = points.len() as f64;
    let [x, y] = [0, 1].map(|k| points.iter().map(|p| p[k]).sum::<f64>() / n);
    let [xx, xy] = [0, 1].map(|k| points.iter().map(|p| (p[0] - x) * (p[k] - [x, y][k])).sum::<f64>());
    (xx > 0.0).then(|| xy / xx)
}

/// Prices of the highest rungs, replicate by replicate.
fn efficiency(base: &BTreeMap<u32, Vec<&Run>>, own: &BTreeMap<u32, Vec<&Run>>) -> Option<Middle> {
    let top = |rungs: &BTreeMap<u32, Vec<&Run>>| -> BTreeMap<u32, f64> {
        let last = rungs.values().next_back().cloned().unwrap_or_default();
        last.iter().map(|r| (r.replicate, r.rel_error.powi(2) * r.seconds)).collect()
    };
    let (base, own) = (top(base), top(own));
    Middle::of(own.iter().filter_map(|(replicate, price)| Some(base.get(replicate)? / price)))
        .filter(|m| m.median.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn runs(method: &str, price: f64) -> Vec<Run> {
        let mut list = Vec::new();
        for rung in 0..4 {
            for replicate in 0..5 {
                let seconds = 0.1 * f64::from(1 << rung);
                list.push(Run {
                    method: method.into(),
                    backend: "cpu".into(),
                    rung,
                    replicate,
                    samples: 16 << rung,
                    seconds,
                    rel_error: (price / seconds).sqrt(),
                    ..Run::default()
                });
            }
        }
        list
    }

    #[test]
    fn prices_and_slopes_come_back() {
        let all = [runs("path", 1e-4), runs("bdpt", 4e-4)].concat();
        let summary = Summary::new(&all, &Extra::new(), ([0.0; 2], [0.0; 3]));
        let bdpt = summary.curve(&Curve::new("bdpt", "", "cpu")).unwrap();
        assert!((bdpt.slope.unwrap() + 0.5).abs() < 1e-9);
        let found = bdpt.efficiency.unwrap();
        assert!((found.median - 0.25).abs() < 1e-9 && (found.low - 0.25).abs() < 1e-9);
        assert_eq!(summary.replicates, 5);
        assert_eq!(bdpt.cells.len(), 4);
    }

    #[test]
    fn what_is_below_three_errors_of_the_reference_is_at_the_floor() {
        let summary = Summary::new(&runs("path", 1e-4), &Extra::new(), ([0.005, 0.005], [0.0; 3]));
        let flags: Vec<bool> = summary.curves[0].cells.iter().map(|c| c.at_floor).collect();
        // 3.2, 2.2, 1.6 and 1.1 %, against 1.5 %.
        assert_eq!(flags, [false, false, false, true]);
    }

    #[test]
    fn middles_are_medians() {
        assert_eq!(Middle::of([]), None);
        assert_eq!(Middle::of([3.0, 1.0, 2.0]), Some(Middle { median: 2.0, low: 1.0, high: 3.0 }));
        assert_eq!(Middle::of([4.0, 1.0]).unwrap().median, 2.5);
    }
}
