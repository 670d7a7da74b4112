//! The conclusion in sentences, the same on the page, in Markdown and in the terminal.

use super::figures::times;
use super::summary::{CurveSummary, Middle, Summary};
use super::verdict::{Bias, Goal, Reach, Way};

/// So many methods that are off are named, the worst first.
const NAMED: usize = 3;

/// A share in percent, with two or three digits.
pub(super) fn percent(x: f64) -> String {
    match 100.0 * x {
        p if p >= 9.95 => format!("{p:.0} %"),
        p if p >= 0.995 => format!("{p:.1} %"),
        p => format!("{p:.2} %"),
    }
}

/// Seconds for people.
pub(super) fn seconds(s: f64) -> String {
    match s {
        s if s >= 100.0 => format!("{s:.0} s"),
        s if s >= 10.0 => format!("{s:.1} s"),
        s if s >= 0.1 => format!("{s:.2} s"),
        s => format!("{:.0} ms", 1e3 * s),
    }
}

/// Bytes for people.
pub(super) fn bytes(b: u64) -> String {
    let b = b as f64;
    if b >= 1e6 { format!("{:.1} MB", b / 1e6) } else { format!("{:.0} kB", b / 1e3) }
}

/// What a small error costs, with its range, and over each of the bases.
pub(super) fn price(curve: &CurveSummary, bases: usize) -> Vec<String> {
    let Some(price) = &curve.price else { return vec!["-".into(); bases + 1] };
    let cost = price.cpu_seconds;
    let mut list = vec![format!(
        "{}{} ({} to {})",
        price.reach.sign(),
        seconds(cost.median),
        seconds(cost.low),
        seconds(cost.high)
    )];
    let ratio = |m: &Option<Middle>| m.map_or_else(|| "-".into(), |m| times(m.median));
    list.extend(price.over.iter().map(ratio));
    list
}

/// What to use, and what to mind.
pub(super) fn conclusion(summary: &Summary, goals: &[Goal]) -> Vec<String> {
    let mut list = Vec::new();
    let name = |w: &Way| summary.curves[w.curve].name.as_str();
    let measured = |g: &&Goal| g.ways.first().is_some_and(|w| w.reach != Reach::Beyond);
    let fine = goals.iter().rev().find(measured);
    if let Some((goal, best)) = fine.and_then(|g| Some((g, g.ways.first()?))) {
        let mut text =
            format!("For an error of {} use {}: {}", percent(goal.error), name(best), seconds(best.seconds));
        if !best.options.is_empty() {
            text += &format!(" (`etendue render {}`)", best.options);
        }
        match goal.ways.get(1) {
            Some(next) => {
                text += &format!("; next is {}, {} as long.", name(next), times(next.seconds / best.seconds));
            }
            None => text += "; nothing else gets there in a comparable time.",
        }
        list.push(text);
        let quick = goals.first().filter(|g| g.error > goal.error);
        if let Some((quick, first)) = quick.and_then(|g| Some((g, g.ways.first()?))) {
            let same = if first.curve == best.curve { "also " } else { "" };
            list.push(format!(
                "For a quick look at {} it is {same}{}: {}.",
                percent(quick.error),
                name(first),
                seconds(first.seconds)
            ));
        }
    }
    if list.is_empty() {
        list.extend(too_early(summary));
    }
    if let Some((curve, cell)) = smallest_operator(summary) {
        list.push(format!(
            "To relight the scene again and again: {}, {}, {} and an error of {} here ({} from nothing to the picture).",
            curve.name,
            cell.effort,
            cell.bytes.map_or_else(String::new, bytes),
            percent(cell.rel_error.median),
            seconds(cell.seconds.median),
        ));
    }
    let mut off: Vec<(&CurveSummary, Bias)> =
        summary.curves.iter().filter_map(|c| Some((c, c.bias.filter(Bias::is_off)?))).collect();
    off.sort_by(|a, b| b.1.size().total_cmp(&a.1.size()));
    if !off.is_empty() {
        let shown = off.iter().take(NAMED).map(|(c, b)| format!("{} ({})", c.name, b.words()));
        let rest = off.len().saturating_sub(NAMED);
        let more =
            if rest > 0 { format!("; and {rest} more in the table of methods") } else { String::new() };
        list.push(format!("Mind what time does not mend: {}{more}.", shown.collect::<Vec<_>>().join(", ")));
    }
    list
}

/// What can be said where no error that people ask for can be told from the reference's own.
fn too_early(summary: &Summary) -> Option<String> {
    let own = summary.reference_error[0];
    let best = summary
        .curves
        .iter()
        .filter_map(|c| Some((c, c.efficiency?.median, c.cells.last()?)))
        .max_by(|a, b| a.1.total_cmp(&b.1))?;
    let (curve, efficiency, top) = best;
    Some(format!(
        "No small error can be told from none here: the reference itself is {} off. The best so far is {}: {} as efficient as path ({} in {}, {}). More time (`--budget`) or a better reference (`--reference`) says more.",
        percent(own),
        curve.name,
        times(efficiency),
        percent(top.rel_error.median),
        seconds(top.seconds.median),
        top.effort,
    ))
}

/// Of all operators that err at most half as much again as the best, the one of the fewest bytes.
fn smallest_operator(summary: &Summary) -> Option<(&CurveSummary, &super::summary::Cell)> {
    let operators = || {
        let cells = summary.curves.iter().flat_map(|c| c.cells.iter().map(move |cell| (c, cell)));
        cells.filter(|(_, cell)| cell.bytes.is_some())
    };
    let least = operators().map(|(_, c)| c.rel_error.median).fold(f64::MAX, f64::min);
    operators().filter(|(_, c)| c.rel_error.median <= 1.5 * least).min_by_key(|(_, c)| c.bytes)
}

#[cfg(test)]
mod tests {
    use super::super::runs::Run;
    use super::super::summary::Extra;
    use super::super::verdict::goals;
    use super::*;

    #[test]
    fn a_poor_reference_is_said_and_the_best_so_far() {
        let run = |method: &str, replicate: u32, rel_error: f64| Run {
            method: method.into(),
            backend: "cpu".into(),
            replicate,
            seconds: 1.0,
            rel_error,
            ..Run::default()
        };
        let runs: Vec<Run> = (0..5).flat_map(|r| [run("path", r, 0.8), run("bdpt", r, 0.4)]).collect();
        let summary = Summary::new(&runs, &Extra::new(), ([0.12, 0.12], [0.1; 3]));
        let goals = goals(&summary);
        assert!(goals.is_empty());
        let said = conclusion(&summary, &goals);
        assert!(said[0].contains("12 % off") && said[0].contains("bdpt: 4.00 x"), "{said:?}");
    }
}
