//! The files of a report.

use super::ReportError;
use super::figures::Figure;
use super::measure::Measured;
use super::page::page;
use super::pictures::Pictures;
use super::price;
use super::runs::{Run, table_of};
use super::summary::{Extra, Summary};
use super::verdict::{Goal, goals};
use super::words::{self, conclusion};
use crate::io::{SaveError, write_png, write_whole};
use serde::Serialize;
use serde_json::json;
use std::fmt::Write as _;
use std::path::Path;

/// What a report is of.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Facts {
    /// The scene, as it was named.
    pub scene: String,
    /// Hash of its content.
    pub scene_hash: String,
    /// Pixels across and down.
    pub size: (u32, u32),
    /// Who computed: backend and adapter.
    pub machines: Vec<String>,
    /// Threads of the CPU backend.
    pub threads: usize,
    /// Seconds that it was given; 0 where runs came from a file.
    pub budget: f64,
    /// What else a reader should know.
    pub notes: Vec<String>,
    /// Of this program.
    pub version: &'static str,
}

/// A report in numbers and sentences.
pub(super) struct Told<'a> {
    pub facts: &'a Facts,
    pub summary: &'a Summary,
    pub goals: &'a [Goal],
    pub sentences: &'a [String],
    pub left_out: &'a [super::LeftOut],
    pub cancelled: bool,
    /// Where the reference comes from; empty for runs of a file.
    pub reference: &'a str,
    /// Seconds of all of it.
    pub seconds: f64,
}

/// Sums up runs and writes `report.html`, `report.csv`, `report.json`, `report.md` and the figures as PNG into a folder that exists, and `reference.exr` where the reference was made now. The conclusion comes back.
///
/// With `measured` come its pictures; without it `runs` are all there is.
///
/// # Errors
/// A file that cannot be written.
pub fn write(
    folder: &Path,
    facts: &Facts,
    (runs, measured): (&[Run], Option<&Measured>),
    mask: Option<&[bool]>,
) -> Result<(Summary, Vec<String>), ReportError> {
    let mut extra = Extra::new();
    let mut reference = ([0.0; 2], [0.0; 3]);
    if let Some(m) = measured {
        let r = &m.reference;
        reference = (r.error(mask), r.energy_error(mask));
        for (key, sums) in &m.sums {
            let parts = sums.structure.parts(&r.radiance, r.variance.as_deref(), mask);
            extra.insert(key.clone(), (parts, sums.options.clone()));
        }
    }
    let summary = Summary::new(runs, &extra, reference);
    let goals = goals(&summary);
    let sentences = conclusion(&summary, &goals);
    let told = Told {
        facts,
        summary: &summary,
        goals: &goals,
        sentences: &sentences,
        left_out: measured.map_or(&[], |m| &m.left_out),
        cancelled: measured.is_some_and(|m| m.cancelled),
        reference: measured.map_or("", |m| &m.reference.made_by),
        seconds: measured.map_or(0.0, |m| m.seconds),
    };
    let pictures = measured.and_then(|m| Pictures::new(m, &summary));
    let put = |name: &str, bytes: &[u8]| write_whole(&folder.join(name), bytes);
    let table = table_of(runs).map_err(|e| SaveError::new(&folder.join("report.csv"), e))?;
    put("report.csv", &table)?;
    put("report.json", format!("{:#}\n", json_of(&told)).as_bytes())?;
    put("report.md", markdown(&told).as_bytes())?;
    let mut figures = Vec::new();
    for figure in Figure::all(&summary) {
        let (size, pixels) = figure.pixels(&summary)?;
        write_png(&folder.join(format!("{}.png", figure.file())), size.0, size.1, &pixels)?;
        figures.push((figure.title(), figure.svg(&summary)?));
    }
    if let Some(m) = measured.filter(|m| m.reference.seconds > 0.0) {
        m.reference.keep(folder, &facts.scene_hash)?;
    }
    put("report.html", page(&told, &figures, pictures.as_ref()).as_bytes())?;
    Ok((summary, sentences))
}

fn json_of(told: &Told<'_>) -> serde_json::Value {
    let left_out: Vec<_> =
        told.left_out.iter().map(|l| json!({ "curve": l.curve.name(), "reason": l.reason })).collect();
    json!({
        "facts": told.facts,
        "reference": {
            "made_by": told.reference,
            "rel_error": told.summary.reference_error[0],
            "root_rel_mse": told.summary.reference_error[1],
        },
        "conclusion": told.sentences,
        "goals": told.goals,
        "curves": told.summary.curves,
        "replicates": told.summary.replicates,
        "left_out": left_out,
        "cancelled": told.cancelled,
        "seconds": told.seconds,
    })
}

/// The conclusion and some tables: what documents quote.
fn markdown(told: &Told<'_>) -> String {
    let mut text = String::new();
    for sentence in told.sentences {
        let _ = writeln!(text, "- {sentence}");
    }
    let curves: Vec<_> = told.summary.curves.iter().collect();
    if !told.goals.is_empty() {
        text += "\n| seconds to an error of |";
        for goal in told.goals {
            let _ = write!(text, " {} |", words::percent(goal.error));
        }
        let _ = write!(text, "\n|---|{}", "---:|".repeat(told.goals.len()));
        for (number, curve) in curves.iter().enumerate() {
            let _ = write!(text, "\n| {} |", curve.name);
            for goal in told.goals {
                let way = goal.ways.iter().find(|w| w.curve == number);
                let cell = way.map_or_else(
                    || "-".into(),
                    |w| format!("{}{}", w.reach.sign(), words::seconds(w.seconds)),
                );
                let _ = write!(text, " {cell} |");
            }
        }
        text.push('\n');
    }
    text += &prices(told);
    text += "\n| method | most effort | seconds | error | slope | efficiency | bias |\n|---|---|---:|---:|---:|---:|---|";
    for curve in curves {
        let Some(top) = curve.cells.last() else { continue };
        let _ = write!(
            text,
            "\n| {} | {} | {} | {} | {} | {} | {} |",
            curve.name,
            top.effort,
            words::seconds(top.seconds.median),
            words::percent(top.rel_error.median),
            curve.slope.map_or_else(|| "-".into(), |s| format!("{s:.2}")),
            curve.efficiency.map_or_else(|| "-".into(), |e| super::figures::times(e.median)),
            curve.bias.map_or_else(|| "-".into(), |b| b.words()),
        );
    }
    let reference = if told.reference.is_empty() {
        "the runs' own".into()
    } else {
        format!("{}, its own error {}", told.reference, words::percent(told.summary.reference_error[0]))
    };
    let _ = writeln!(
        text,
        "\n\nMedians of {} replicates in turns; `\u{2264}`: the least effort has less error already; `~`: beyond what was measured. Reference: {reference}.",
        told.summary.replicates,
    );
    text
}

/// What a small error costs, and how many times as much as ours.
fn prices(told: &Told<'_>) -> String {
    let summary = told.summary;
    let mut text = String::new();
    if summary.curves.iter().all(|c| c.price.is_none()) {
        return text;
    }
    let _ = write!(text, "\n| CPU seconds to `rel_mse` {:.0e} | |", price::GOAL);
    for base in &summary.bases {
        let _ = write!(text, " over {base} |");
    }
    let _ = write!(text, "\n|---|---:|{}", "---:|".repeat(summary.bases.len()));
    for curve in &summary.curves {
        let [cost, ratios @ ..] = &words::price(curve, summary.bases.len())[..] else { continue };
        let _ = write!(text, "\n| {} | {cost} |", curve.name);
        for ratio in ratios {
            let _ = write!(text, " {ratio} |");
        }
    }
    text.push('\n');
    text
}
