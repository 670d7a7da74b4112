//! The conclusion in sentences, the same on the page, in Markdown and in the terminal.

use super::figures::times;
use super::summary::{CurveSummary, Summary};
use super::verdict::{Goal, Way};

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

/// What to use, and what to mind.
pub(super) fn conclusion(summary: &Summary, goals: &[Goal]) -> Vec<String> {
    let mut list = Vec::new();
    let name = |w: &Way| summary.curves[w.curve].name.as_str();
    let measured = |g: &&Goal| g.ways.first().is_some_and(|w| !w.beyond);
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
    let off: Vec<String> = summary
        .curves
        .iter()
        .filter_map(|c| {
            Some(format!("{} ({})", c.name, c.bias.filter(super::verdict::Bias::is_off)?.words()))
        })
        .collect();
    if !off.is_empty() {
        list.push(format!("Mind what time does not mend: {}.", off.join(", ")));
    }
    list
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
