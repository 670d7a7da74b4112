//! Figures as SVG, tables as Markdown.
#![allow(clippy::disallowed_methods, reason = "lengths on paper")]

use crate::figure::{Contest, Curves, Dots, Series};
use crate::timing::Timed;
use plotters::coord::Shift;
use plotters::coord::combinators::{BindKeyPoints, LogCoord, WithKeyPoints};
use plotters::prelude::*;
use std::ops::Range;
use std::path::Path;

type Outcome = Result<(), Box<dyn std::error::Error>>;

const SIZE: (u32, u32) = (960, 600);
/// Dark enough on white, apart for the colour-blind (after Okabe and Ito 2008).
const COLOURS: [RGBColor; 8] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(110, 110, 110),
    RGBColor(0, 0, 0),
];

/// Both axes logarithmic, with ticks of our own.
type Axis = WithKeyPoints<LogCoord<f64>>;
type LogChart<'a, DB> = ChartContext<'a, DB, Cartesian2d<Axis, Axis>>;

/// The smallest and largest of positive values with a margin; a fallback where there are none.
fn bounds(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
    for v in values.filter(|v| v.is_finite() && *v > 0.0) {
        (low, high) = (low.min(v), high.max(v));
    }
    if high <= 0.0 {
        return 0.1..10.0;
    }
    let margin = (high / low).powf(0.08).max(1.02);
    low / margin..high * margin
}

/// Ticks at powers of ten, at 1, 2 and 5 times them, or at five even steps: as many as there is room for.
fn ticks(range: &Range<f64>) -> Vec<f64> {
    let within = |steps: &[f64]| -> Vec<f64> {
        (-20..20)
            .flat_map(|e| steps.iter().map(move |s| s * 10.0_f64.powi(e)))
            .filter(|v| range.contains(v))
            .collect()
    };
    for steps in [&[1.0][..], &[1.0, 2.0, 5.0]] {
        let list = within(steps);
        if list.len() >= 3 {
            return list;
        }
    }
    (0..5).map(|i| range.start * (range.end / range.start).powf(0.1 + 0.2 * f64::from(i))).collect()
}

fn axis(range: Range<f64>) -> Axis {
    let list = ticks(&range);
    LogCoord::from(range.log_scale()).with_key_points(list)
}

fn chart<'a, DB: DrawingBackend>(
    area: &DrawingArea<DB, Shift>,
    title: &str,
    labels: [&str; 2],
    ranges: [Range<f64>; 2],
    right: u32,
) -> Result<LogChart<'a, DB>, DrawingAreaErrorKind<DB::ErrorType>> {
    let [x, y] = ranges;
    let mut chart = ChartBuilder::on(area)
        .caption(title, ("sans-serif", 20))
        .margin(12)
        .margin_right(right)
        .x_label_area_size(48)
        .y_label_area_size(76)
        .build_cartesian_2d(axis(x), axis(y))?;
    chart
        .configure_mesh()
        .x_desc(labels[0])
        .y_desc(labels[1])
        .label_style(("sans-serif", 14))
        .axis_desc_style(("sans-serif", 15))
        .bold_line_style(RGBColor(225, 225, 225))
        .light_line_style(WHITE)
        .x_label_formatter(&|v| short(*v))
        .y_label_formatter(&|v| short(*v))
        .draw()?;
    Ok(chart)
}

/// Four digits and a power of ten where it is large or small.
pub fn short(v: f64) -> String {
    if v == 0.0 {
        "0".into()
    } else if (0.01..1e4).contains(&v.abs()) {
        let digits = (3 - v.abs().log10().floor() as i32).clamp(0, 5) as usize;
        let text = format!("{v:.digits$}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
    } else {
        format!("{v:.3e}").replace("000e", "e").replace("00e", "e").replace("0e", "e").replace(".e", "e")
    }
}

/// Error over speed, a numbered dot a contender with its name at the right: ours filled, rivals hollow. An error of zero stands
/// on the lower frame, one that is not a number is left to the table.
pub fn contest(contest: &Contest, timed: &[Timed], file: &Path) -> Outcome {
    let x_label = format!("{} per second", plural(contest.item));
    let list: Vec<_> = timed.iter().map(|t| (t.name.as_str(), t.ours, (t.rate, t.error))).collect();
    numbered(contest.title, [&x_label, contest.error_label], &list, file)
}

/// Numbered dots in the same style.
pub fn dots(dots: &Dots, file: &Path) -> Outcome {
    let list: Vec<_> = dots.dots.iter().map(|d| (d.name.as_str(), d.ours, d.at)).collect();
    numbered(dots.title, dots.labels, &list, file)
}

fn numbered(title: &str, labels: [&str; 2], list: &[(&str, bool, (f64, f64))], file: &Path) -> Outcome {
    const LEGEND: i32 = 300;
    etendue::report::register_fonts();
    let root = SVGBackend::new(file, (SIZE.0 + LEGEND as u32, SIZE.1)).into_drawing_area();
    root.fill(&WHITE)?;
    let ys = bounds(list.iter().map(|d| d.2.1));
    let xs = bounds(list.iter().map(|d| d.2.0));
    let mut chart = chart(&root, title, labels, [xs, ys.clone()], LEGEND as u32 + 12)?;
    for (i, (name, ours, (x, y))) in list.iter().enumerate() {
        let colour = COLOURS[i % COLOURS.len()];
        let style = if *ours { colour.filled() } else { colour.stroke_width(2) };
        let font = || ("sans-serif", 14).into_font().color(&colour);
        let line = 60 + 24 * i as i32;
        root.draw(&Circle::new((SIZE.0 as i32 + 8, line + 7), 5, style))?;
        root.draw(&Text::new(format!("{}  {name}", i + 1), (SIZE.0 as i32 + 20, line), font()))?;
        if y.is_finite() {
            let at = (*x, if *y > 0.0 { *y } else { ys.start });
            chart.draw_series([EmptyElement::at(at)
                + Circle::new((0, 0), 5, style)
                + Text::new((i + 1).to_string(), (7, -14), font())])?;
        }
    }
    root.present()?;
    Ok(())
}

/// Curves with a legend at the upper right.
pub fn curves(curves: &Curves, file: &Path) -> Outcome {
    etendue::report::register_fonts();
    let root = SVGBackend::new(file, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let points = || curves.series.iter().flat_map(|s| &s.points);
    let xs = bounds(points().map(|p| p.0));
    let ys = bounds(points().map(|p| p.1));
    let mut chart = chart(&root, curves.title, [curves.x_label, curves.y_label], [xs, ys], 30)?;
    for (i, s) in curves.series.iter().enumerate() {
        let colour = COLOURS[i % COLOURS.len()];
        let shown = || s.points.iter().copied().filter(|p| p.0 > 0.0 && p.1 > 0.0 && p.1.is_finite());
        chart
            .draw_series(LineSeries::new(shown(), colour.stroke_width(2)))?
            .label(s.name.clone())
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], colour.stroke_width(2)));
        chart.draw_series(shown().map(|p| Circle::new(p, 3, colour.filled())))?;
    }
    chart
        .configure_series_labels()
        .background_style(WHITE.mix(0.85))
        .border_style(RGBColor(200, 200, 200))
        .label_font(("sans-serif", 14))
        .position(SeriesLabelPosition::UpperRight)
        .draw()?;
    root.present()?;
    Ok(())
}

/// Of the words that are used.
fn plural(item: &str) -> String {
    if item == "matrix" { "matrices".into() } else { format!("{item}s") }
}

/// One row a contender.
pub fn contest_table(contest: &Contest, timed: &[Timed]) -> String {
    let first = timed.first().map_or("", |t| t.name.as_str());
    let mut out = format!(
        "| contender | {} | {}/s | speed over `{first}` (least to most) |\n|---|---:|---:|---:|\n",
        contest.error_label,
        plural(contest.item)
    );
    for t in timed {
        let name = if t.ours { format!("**{}**", t.name) } else { t.name.clone() };
        out += &format!(
            "| {name} | {} | {} | {} ({} to {}) |\n",
            if t.error.is_nan() { "NaN".into() } else { short(t.error) },
            short(t.rate),
            short(t.ratio),
            short(t.spread[0]),
            short(t.spread[1])
        );
    }
    out
}

/// Rows that a table may have before it is cut to powers of four.
const ROWS: usize = 24;

/// One row a point of the horizontal axis, one column a curve.
pub fn curves_table(curves: &Curves) -> String {
    let names: Vec<_> = curves.series.iter().map(|s| s.name.as_str()).collect();
    let mut xs: Vec<f64> = curves.series.iter().flat_map(|s| s.points.iter().map(|p| p.0)).collect();
    xs.sort_by(f64::total_cmp);
    xs.dedup();
    let mut out =
        format!("| {} | {} |\n|---:|{}\n", curves.x_label, names.join(" | "), "---:|".repeat(names.len()));
    if xs.len() <= ROWS {
        for x in &xs {
            let at = |s: &Series| s.points.iter().find(|p| p.0 == *x).map_or("".into(), |p| short(p.1));
            let row: Vec<_> = curves.series.iter().map(at).collect();
            out += &format!("| {} | {} |\n", short(*x), row.join(" | "));
        }
        return out;
    }
    // Curves of many points: what each has reached by powers of four.
    let (least, most) = (xs.first().copied().unwrap_or(1.0), xs.last().copied().unwrap_or(1.0));
    let mut x = 1.0;
    while x < 4.0 * most {
        if x >= least {
            let reached = |s: &Series| s.points.iter().rfind(|p| p.0 <= x).map_or("".into(), |p| short(p.1));
            let row: Vec<String> = curves.series.iter().map(reached).collect();
            out += &format!("| at most {} | {} |\n", short(x), row.join(" | "));
        }
        x *= 4.0;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Contender;
    use crate::timing;

    fn pretended() -> Contest {
        let one = |name: &str, ours, error, n: u32| Contender {
            name: name.into(),
            ours,
            error,
            work: Box::new(move || {
                std::hint::black_box((0..n).fold(0_u32, |a, x| std::hint::black_box(a ^ x)));
            }),
        };
        let contenders = vec![
            one("slow and exact", true, 0.0, 80_000),
            one("middling", true, 1e-3, 20_000),
            one("rival of the same speed 1.2", false, 1.2e-3, 20_000),
            one("fast", false, 2e-2, 1000),
            one("never", false, f64::NAN, 1000),
        ];
        let (error_label, item) = ("relative error", "item");
        Contest { title: "A contest", file: "contest", error_label, item, items: 1000, contenders }
    }

    #[test]
    fn figures_and_tables_name_every_contender() {
        let mut c = pretended();
        let timed = timing::run(&mut c, 3, 1e-4);
        let file = std::env::temp_dir().join(format!("etendue-figure-{}.svg", std::process::id()));
        contest(&c, &timed, &file).expect("a figure");
        let svg = std::fs::read_to_string(&file).expect("a file");
        let table = contest_table(&c, &timed);
        for t in &timed {
            assert!(table.contains(&t.name), "{table}");
            assert!(svg.contains(&t.name), "{} is not named", t.name);
        }
        // More work is slower, whatever the machine does.
        assert!(timed[3].ratio > timed[1].ratio && timed[1].ratio > timed[0].ratio, "{timed:?}");
        let series = |name: &str, shift: f64| Series {
            name: name.into(),
            points: (1..6).map(|x| (f64::from(x), shift / f64::from(x * x))).collect(),
        };
        let list = vec![series("one", 1.0), series("two", 3.0)];
        let curve = Curves { title: "Curves", file: "curves", x_label: "x", y_label: "y", series: list };
        curves(&curve, &file).expect("a figure");
        assert!(std::fs::read_to_string(&file).expect("a file").contains("two"));
        assert_eq!(curves_table(&curve).lines().count(), 7);
        std::fs::remove_file(file).expect("it was there");
    }

    #[test]
    fn numbers_are_short() {
        let list = [
            (0.0, "0"),
            (1.0, "1"),
            (0.123_456, "0.1235"),
            (12.345, "12.35"),
            (123.4, "123.4"),
            (5e-7, "5e-7"),
        ];
        for (x, text) in list {
            assert_eq!(short(x), text);
        }
    }
}
