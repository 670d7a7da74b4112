//! What an error costs in seconds of all threads: a price that hardly depends on how many threads shared the work.

use super::runs::{Curve, Run};
use super::summary::Middle;
use super::verdict::{BEYOND, Bias, Reach, reached};
use serde::Serialize;
use std::collections::BTreeMap;

/// The `rel_mse` that is paid for.
pub(super) const GOAL: f64 = 1e-3;
/// The part of it that may be there to stay.
const LASTING: f64 = 0.05;

/// CPU seconds to a `rel_mse` of 1e-3.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Price {
    /// Over the replicates.
    pub cpu_seconds: Middle,
    /// The least sure of all replicates.
    pub reach: Reach,
    /// How many times as much as others cost, replicate by replicate, in the order of [`Summary::bases`](super::Summary::bases).
    pub over: Vec<Option<Middle>>,
}

/// Prices of one curve by replicate.
pub(super) type Prices = BTreeMap<u32, (f64, Reach)>;

/// Whose prices the others are compared with: plain paths of the CPU; all that it does by sampling, where other programs are in the table.
pub(super) fn bases(curves: &[Curve]) -> Vec<Curve> {
    let foreign = curves.iter().any(|c| c.backend != "cpu" && c.backend != "wgpu");
    let is_base = |c: &&Curve| {
        c.backend == "cpu"
            && match c.method.as_str() {
                "path" => true,
                "bdpt" | "photon" => foreign,
                _ => false,
            }
    };
    curves.iter().filter(is_base).cloned().collect()
}

/// Of all replicates that get there. What is off by more than a little does not fall to nothing, so that nothing is known beyond what was measured.
pub(super) fn prices(rungs: &BTreeMap<u32, Vec<&Run>>, bias: Option<Bias>) -> Prices {
    let off = bias.is_some_and(|b| b.size().powi(2) > LASTING * GOAL);
    let mut points: BTreeMap<u32, Vec<[f64; 2]>> = BTreeMap::new();
    for run in rungs.values().flatten() {
        if let Some(seconds) = run.cpu_seconds {
            points.entry(run.replicate).or_default().push([seconds, run.rel_mse]);
        }
    }
    points.iter().filter_map(|(replicate, list)| Some((*replicate, price(list, off)?))).collect()
}

/// Between rungs by straight lines in logarithms; beyond the last one as independent samples do, whose squared error falls as one over their number.
fn price(points: &[[f64; 2]], off: bool) -> Option<(f64, Reach)> {
    if let Some((_, seconds, reach)) = reached(points, GOAL) {
        return Some((seconds, reach));
    }
    let [seconds, error] = *points.last()?;
    let factor = error / GOAL;
    (!off && factor <= BEYOND).then_some((seconds * factor, Reach::Beyond))
}

impl Price {
    /// `None` where not all replicates get there.
    pub(super) fn of(own: &Prices, replicates: usize, bases: &[&Prices]) -> Option<Self> {
        if own.len() != replicates {
            return None;
        }
        // A ratio with a bound in it is none.
        let known = |p: &(f64, Reach)| p.1 != Reach::AtMost;
        let ratio = |base: &Prices| {
            let pairs = own.iter().filter_map(|(replicate, mine)| Some((mine, base.get(replicate)?)));
            let list: Vec<f64> =
                pairs.filter(|(a, b)| known(a) && known(b)).map(|(a, b)| a.0 / b.0).collect();
            (list.len() == replicates).then(|| Middle::of(list)).flatten()
        };
        Some(Self {
            cpu_seconds: Middle::of(own.values().map(|p| p.0))?,
            reach: own.values().map(|p| p.1).max()?,
            over: bases.iter().map(|base| ratio(base)).collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prices_lie_between_rungs_and_shortly_beyond() {
        // Squared error 0.01 / seconds: the goal costs 10.
        let law = |seconds: f64| [seconds, 0.01 / seconds];
        let is = |found: Option<(f64, Reach)>, reach: Reach| {
            let (seconds, r) = found.unwrap();
            assert!((seconds - 10.0).abs() < 1e-9 && r == reach, "{seconds} {r:?}");
        };
        is(price(&[law(1.0), law(4.0), law(16.0)], false), Reach::Measured);
        is(price(&[law(1.0), law(2.0)], false), Reach::Beyond);
        assert_eq!(price(&[law(1.0), law(2.0)], true), None);
        assert_eq!(price(&[law(1.0)], false), None);
        assert_eq!(price(&[law(20.0), law(40.0)], false), Some((20.0, Reach::AtMost)));
        assert_eq!(price(&[], false), None);
    }

    #[test]
    fn ratios_are_of_the_same_replicate() {
        let prices = |list: [f64; 2]| -> Prices { (0..).zip(list.map(|s| (s, Reach::Measured))).collect() };
        let found = Price::of(&prices([3.0, 8.0]), 2, &[&prices([1.0, 4.0])]).unwrap();
        assert_eq!(found.over, [Some(Middle { median: 2.5, low: 2.0, high: 3.0 })]);
        assert_eq!(Price::of(&prices([3.0, 8.0]), 3, &[]), None);
    }

    #[test]
    fn other_programs_are_compared_with_all_of_ours() {
        let curve = |method: &str, backend: &str| Curve::new(method, "", backend);
        let ours = [curve("bdpt", "cpu"), curve("path", "cpu"), curve("radiosity", "cpu")];
        assert_eq!(bases(&ours), [curve("path", "cpu")]);
        let all = [&ours[..], &[curve("path", "other")]].concat();
        assert_eq!(bases(&all), ours[..2]);
    }
}
