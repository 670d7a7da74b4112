//! Interleaved timing: all contenders take turns, so that a machine's drift hits all alike.

use crate::figure::Contest;
use std::time::Instant;

/// What one contender reached.
#[derive(Clone, Debug)]
pub struct Timed {
    /// Its name.
    pub name: String,
    /// Whether it is ours.
    pub ours: bool,
    /// Its error, in the contest's measure.
    pub error: f64,
    /// Median over the turns \[items/s\].
    pub rate: f64,
    /// Median over the turns of its speed over that of the contest's first contender in the same turn.
    pub ratio: f64,
    /// Smallest and largest of those ratios.
    pub spread: [f64; 2],
}

/// The middle value; 0 of nothing.
pub fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut v: Vec<f64> = values.into_iter().collect();
    v.sort_by(f64::total_cmp);
    v.get(v.len() / 2).copied().unwrap_or(0.0)
}

/// Runs every contender once a turn, `turns` times after one that is not counted. Work that is shorter than
/// `least` seconds is repeated within a turn.
pub fn run(contest: &mut Contest, turns: usize, least: f64) -> Vec<Timed> {
    let mut repeats = vec![1_u32; contest.contenders.len()];
    for (c, repeats) in contest.contenders.iter_mut().zip(&mut repeats) {
        (c.work)();
        let start = Instant::now();
        (c.work)();
        *repeats = (least / start.elapsed().as_secs_f64().max(1e-9)).clamp(0.0, 1e6) as u32 + 1;
    }
    let mut rates = vec![Vec::new(); contest.contenders.len()];
    for _ in 0..turns {
        for ((c, repeats), rates) in contest.contenders.iter_mut().zip(&repeats).zip(&mut rates) {
            let start = Instant::now();
            for _ in 0..*repeats {
                (c.work)();
            }
            let seconds = start.elapsed().as_secs_f64();
            rates.push((contest.items * u64::from(*repeats)) as f64 / seconds);
        }
    }
    let first = rates.first().cloned().unwrap_or_default();
    let timed = contest.contenders.iter().zip(&rates).map(|(c, mine)| {
        let ratios: Vec<f64> = mine.iter().zip(&first).map(|(a, b)| a / b).collect();
        let least = ratios.iter().copied().fold(f64::INFINITY, f64::min);
        let most = ratios.iter().copied().fold(0.0, f64::max);
        Timed {
            name: c.name.clone(),
            ours: c.ours,
            error: c.error,
            rate: median(mine.iter().copied()),
            ratio: median(ratios),
            spread: [least, most],
        }
    });
    timed.collect()
}
