//! The page: one file that needs no network.

use super::figures::times;
use super::files::Told;
use super::pictures::Pictures;
use super::price;
use super::summary::{Cell, CurveSummary};
use super::verdict::Reach;
use super::words::{self, bytes, percent, seconds};
use maud::{DOCTYPE, Markup, PreEscaped, html};

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// The whole page.
pub(super) fn page(told: &Told<'_>, figures: &[(&str, String)], pictures: Option<&Pictures>) -> String {
    let facts = told.facts;
    let markup = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { "Speed against error: " (facts.scene) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                h1 { "Speed against error" }
                p.about {
                    strong { (facts.scene) }
                    ", " (facts.size.0) " x " (facts.size.1) " pixels, "
                    @if facts.threads > 0 { (facts.threads) " threads, " }
                    "etendue " (facts.version)
                }
                @if told.cancelled {
                    p.warning { "Stopped early: some replicates are missing." }
                }
                section.answer {
                    h2 { "What to use" }
                    @if told.sentences.is_empty() { p { "Nothing here reaches an error that can be told from the reference's." } }
                    ul { @for s in told.sentences { li { (sentence(s)) } } }
                }
                (first_figure(figures))
                (goals(told))
                (prices(told))
                @if let Some(p) = pictures { (gallery(p)) }
                (curves(told))
                (cells(told))
                @for (title, svg) in figures.iter().skip(1) {
                    h2 { (title) }
                    div.figure { (PreEscaped(svg)) }
                }
                (notes(told))
                script { (PreEscaped(SCRIPT)) }
            }
        }
    };
    markup.into_string()
}

/// Text whose `code` is marked by backticks.
fn sentence(text: &str) -> Markup {
    html! {
        @for (i, part) in text.split('`').enumerate() {
            @if i % 2 == 1 { code { (part) } } @else { (part) }
        }
    }
}

fn first_figure(figures: &[(&str, String)]) -> Markup {
    html! {
        @if let Some((_, svg)) = figures.first() { div.figure { (PreEscaped(svg)) } }
    }
}

fn goals(told: &Told<'_>) -> Markup {
    html! {
        @if !told.goals.is_empty() {
            h2 { "Seconds to an error" }
            p { "Medians; the fastest in bold; ≤ where the least effort has less error already; pale where it lies beyond what was measured (by the fitted slope); a dash where the method does not get there in eight times the time that it was given." }
            table.sortable {
                thead { tr { th { "method" } @for g in told.goals { th.number { (percent(g.error)) } } } }
                tbody {
                    @for (number, curve) in told.summary.curves.iter().enumerate() {
                        tr {
                            td { (curve.name) }
                            @for g in told.goals {
                                @match g.ways.iter().find(|w| w.curve == number) {
                                    Some(w) => {
                                        td.number.best[g.ways[0].curve == number].beyond[w.reach == Reach::Beyond] data-value=(w.seconds) title=(w.options) { (w.reach.sign()) (seconds(w.seconds)) }
                                    }
                                    None => td.number data-value="1e99" { "-" }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn prices(told: &Told<'_>) -> Markup {
    let (curves, bases) = (&told.summary.curves, &told.summary.bases);
    html! {
        @if curves.iter().any(|c| c.price.is_some()) {
            h2 { "CPU seconds to a " code { "rel_mse" } " of " (format!("{:.0e}", price::GOAL)) }
            p { "Of all threads: medians with their range, and ratios within each replicate. As far beyond the last run as eight times its cost (~), where squared errors fall as one over the samples." }
            table.sortable {
                thead { tr { th { "method" } th.number { "CPU seconds" } @for base in bases { th.number { "over " (base) } } } }
                tbody {
                    @for curve in curves {
                        tr {
                            td { (curve.name) }
                            @for (column, text) in words::price(curve, bases.len()).iter().enumerate() {
                                td.number data-value=(price_value(curve, column)) { (text) }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// What a column of prices is sorted by.
fn price_value(curve: &CurveSummary, column: usize) -> f64 {
    let none = 1e99;
    let Some(price) = &curve.price else { return none };
    match column {
        0 => price.cpu_seconds.median,
        c => price.over[c - 1].map_or(none, |m| m.median),
    }
}

fn gallery(p: &Pictures) -> Markup {
    html! {
        h2 { "The same time: about " (seconds(p.seconds)) " each" }
        p { "Beside each picture its difference from the reference: " span.high { "red" } " too bright, " span.low { "blue" } " too dark, in full colour at 20 %. Methods on coarse ladders have the rung whose time is nearest." }
        div.gallery {
            figure { img src=(p.reference) alt="reference"; figcaption { strong { "reference" } } }
            @for s in &p.list {
                figure {
                    div.pair {
                        img src=(s.picture) alt=(s.name);
                        img src=(s.error) alt={ "difference of " (s.name) };
                    }
                    figcaption { strong { (s.name) } br; (s.words) }
                }
            }
        }
    }
}

fn maybe(x: Option<f64>, show: impl Fn(f64) -> String) -> Markup {
    html! {
        @match x {
            Some(x) => td.number data-value=(x) { (show(x)) }
            None => td.number data-value="-1" { "-" }
        }
    }
}

fn curves(told: &Told<'_>) -> Markup {
    let range = |c: &CurveSummary| {
        c.efficiency.map_or_else(String::new, |e| format!("{} to {}", times(e.low), times(e.high)))
    };
    html! {
        h2 { "Methods" }
        p {
            "Efficiency: how many times less time than path tracing for the same error, if errors fall with the root of time; at the highest rung of each, replicate by replicate, with the range of these. That of noise leaves out what lasts. "
            "Slope: of log error over log seconds; -0.5 is plain sampling, 0 no use of more time."
        }
        table.sortable {
            thead { tr {
                th { "method" } th.number { "efficiency" } th { "range" } th.number { "of noise" } th.number { "slope" }
                th.number { "noise" } th.number { "lasting error" } th { "bias" }
            } }
            tbody {
                @for c in &told.summary.curves {
                    @let top = c.cells.last();
                    tr {
                        td { (c.name) }
                        (maybe(c.efficiency.map(|e| e.median), times))
                        td { (range(c)) }
                        (maybe(c.noise_efficiency, times))
                        (maybe(c.slope, |s| format!("{s:.2}")))
                        (maybe(top.and_then(|t| t.noise), percent))
                        (maybe(top.and_then(|t| t.lasting), percent))
                        td.off[c.bias.is_some_and(|b| b.is_off())] { (c.bias.map_or_else(|| "-".into(), |b| b.words())) }
                    }
                }
            }
        }
    }
}

fn cells(told: &Told<'_>) -> Markup {
    let row = |c: &CurveSummary, cell: &Cell| {
        html! {
            tr.floor[cell.at_floor] {
                td { (c.name) }
                td { (cell.effort) @if cell.at_floor { " (at the floor)" } }
                td.number data-value=(cell.seconds.median) title={ (seconds(cell.seconds.low)) " to " (seconds(cell.seconds.high)) } { (seconds(cell.seconds.median)) }
                (maybe(cell.cpu_seconds.map(|s| s.median), seconds))
                td.number data-value=(cell.rel_error.median) title={ (percent(cell.rel_error.low)) " to " (percent(cell.rel_error.high)) } { (percent(cell.rel_error.median)) }
                td.number data-value=(cell.rel_mse.median) { (format!("{:.2e}", cell.rel_mse.median)) }
                td.number data-value=(cell.worst_block.median) { (percent(cell.worst_block.median)) }
                td.number data-value=(cell.energy_error.median) { (format!("{:+.2} %", 100.0 * cell.energy_error.median)) }
                (maybe(cell.z_pass.map(|z| z.median), |z| format!("{z:.4}")))
                td.number data-value=(cell.flip.median) { (format!("{:.4}", cell.flip.median)) }
                (maybe(cell.rays_per_second, |r| format!("{:.2} M", 1e-6 * r)))
                (maybe(cell.bytes.map(|b| b as f64), |b| bytes(b as u64)))
            }
        }
    };
    html! {
        h2 { "All rungs" }
        p { "Medians of " (told.summary.replicates) " replicates, run in turns; ranges where the pointer rests. Click a heading to sort. Every run is in " code { "report.csv" } "." }
        table.sortable {
            thead { tr {
                th { "method" } th { "effort" } th.number { "seconds" } th.number { "of all threads" } th.number { "rel_error" } th.number { "rel_mse" }
                th.number { "worst block" } th.number { "energy" } th.number { "z_pass" } th.number { "flip" } th.number { "rays/s" } th.number { "operator" }
            } }
            tbody { @for c in &told.summary.curves { @for cell in &c.cells { (row(c, cell)) } } }
        }
    }
}

fn notes(told: &Told<'_>) -> Markup {
    let [error, relative] = told.summary.reference_error;
    html! {
        h2 { "How it was measured" }
        ul {
            @if told.reference.is_empty() {
                li { "Runs come from a table; their errors are against the reference that it was made with." }
            } @else {
                li {
                    "Reference: " (told.reference) ", its own standard error " (percent(error)) " (rel_error) and " (format!("{:.1e}", relative * relative)) " (rel_mse). Errors below three of these are at the floor: not told from none."
                }
            }
            @for m in &told.facts.machines { li { (m) } }
            @if told.facts.budget > 0.0 { li { "Given " (seconds(told.facts.budget)) ", took " (seconds(told.seconds)) "." } }
            li { "Seconds are of the clock, from an opened scene to the image: what is made once (trees, uploads, shaders) is left out, what a method makes for its picture (maps, operators) is in." }
            li { "A bias is named where it is off at a level of 1 % for all methods and channels of this page together." }
            @for n in &told.facts.notes { li { (n) } }
            @for l in told.left_out { li { "Not measured: " (l.curve.name()) ": " (l.reason) } }
        }
    }
}
