//! Figures: the same drawing as SVG for the page and as PNG for elsewhere.

use super::ReportError;
use super::summary::{Cell, CurveSummary, Middle, Summary};
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::{FontStyle, register_font};
use std::sync::Once;

/// Pixels of a figure.
const SIZE: (u32, u32) = (960, 540);
/// Of these for the names at the right, where none is long.
const NAMES: u32 = 270;
/// Most labels of errors: enough for each whole one of two decades.
const LABELS: usize = 24;
const FONT: &str = "sans-serif";
/// Colours that keep apart for most eyes; by method, then by variant.
const COLOURS: [RGBColor; 12] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(120, 94, 240),
    RGBColor(100, 100, 100),
    RGBColor(160, 60, 40),
    RGBColor(120, 150, 30),
    RGBColor(30, 60, 120),
    RGBColor(190, 60, 110),
];

/// Which figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Figure {
    /// Error over seconds.
    Time,
    /// Error over seconds of all threads.
    CpuTime,
    /// Error over bytes of operators.
    Bytes,
    /// Efficiency relative to path tracing.
    Efficiency,
}

/// Pixels across and down, and all of them.
type Bitmap = ((u32, u32), Vec<[u8; 3]>);

/// An x with its ends.
type Across = fn(&Cell) -> Option<Middle>;

impl Figure {
    /// Those that the runs have something for.
    pub(super) fn all(summary: &Summary) -> Vec<Self> {
        [Self::Time, Self::CpuTime, Self::Bytes, Self::Efficiency]
            .into_iter()
            .filter(|f| match f {
                Self::Efficiency => summary.curves.iter().filter(|c| c.efficiency.is_some()).count() > 1,
                _ => !f.lines(summary).is_empty(),
            })
            .collect()
    }

    /// The name of its file.
    pub(super) fn file(self) -> &'static str {
        match self {
            Self::Time => "error-over-seconds",
            Self::CpuTime => "error-over-cpu-seconds",
            Self::Bytes => "error-over-bytes",
            Self::Efficiency => "efficiency",
        }
    }

    pub(super) fn title(self) -> &'static str {
        match self {
            Self::Time => "Error over time",
            Self::CpuTime => "Error over time of all threads",
            Self::Bytes => "Error over bytes of the operator",
            Self::Efficiency => "Efficiency: times less time than path tracing for the same error",
        }
    }

    fn across(self) -> Across {
        match self {
            Self::Time | Self::Efficiency => |c| Some(c.seconds),
            Self::CpuTime => |c| c.cpu_seconds,
            Self::Bytes => |c| {
                let bytes = c.bytes? as f64;
                Some(Middle { median: bytes, low: bytes, high: bytes })
            },
        }
    }

    /// Curves with points in this figure.
    fn lines(self, summary: &Summary) -> Vec<Line> {
        let point = |cell: &Cell| {
            let across = (self.across())(cell)?;
            (across.low > 0.0 && cell.rel_error.low > 0.0).then_some((across, cell.rel_error))
        };
        let line = |(number, curve): (usize, &'_ CurveSummary)| Line {
            name: curve.name.clone(),
            style: Style::of(number, &curve.curve.backend),
            points: curve.cells.iter().filter_map(point).collect(),
        };
        summary.curves.iter().enumerate().map(line).filter(|l| !l.points.is_empty()).collect()
    }

    /// As SVG.
    pub(super) fn svg(self, summary: &Summary) -> Result<String, ReportError> {
        let mut text = String::new();
        {
            let root = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
            self.draw(&root, summary)?;
        }
        Ok(text)
    }

    /// As pixels of this size.
    pub(super) fn pixels(self, summary: &Summary) -> Result<Bitmap, ReportError> {
        let mut bytes = vec![0; 3 * (SIZE.0 * SIZE.1) as usize];
        {
            let root = BitMapBackend::with_buffer(&mut bytes, SIZE).into_drawing_area();
            self.draw(&root, summary)?;
        }
        Ok((SIZE, bytes.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect()))
    }

    fn draw<B: DrawingBackend>(
        self,
        root: &DrawingArea<B, Shift>,
        summary: &Summary,
    ) -> Result<(), ReportError> {
        register_fonts();
        let fail = |e: String| ReportError::Figure(e);
        root.fill(&WHITE).map_err(|e| fail(e.to_string()))?;
        let drawn = match self {
            Self::Efficiency => bars(root, summary),
            _ => lines(root, self, summary),
        };
        drawn.map_err(|e| fail(e.to_string()))?;
        root.present().map_err(|e| fail(e.to_string()))
    }
}

/// Makes the font of figures known to `plotters`, which then needs none of the system's: text of bitmaps, and the room that text takes.
pub fn register_fonts() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        // The only error is of bytes that are no font; then text is what is missing.
        let _ = register_font(FONT, FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT);
    });
}

/// How a curve looks: colours by number, marks by backend.
#[derive(Clone, Copy)]
struct Style {
    colour: RGBColor,
    mark: Mark,
}

#[derive(Clone, Copy)]
enum Mark {
    Disk,
    Ring,
    Cross,
}

impl Style {
    fn of(number: usize, backend: &str) -> Self {
        let mark = match backend {
            "cpu" => Mark::Disk,
            "wgpu" => Mark::Ring,
            _ => Mark::Cross,
        };
        Self { colour: COLOURS[number % COLOURS.len()], mark }
    }
}

struct Line {
    name: String,
    style: Style,
    points: Vec<(Middle, Middle)>,
}

/// The ends of an axis that holds values from `low` to `high`, with some room.
fn ends(values: impl Iterator<Item = f64>) -> std::ops::Range<f64> {
    let (low, high) = values.fold((f64::MAX, 0.0_f64), |(l, h), v| (l.min(v), h.max(v)));
    if low > high {
        return 0.1..1.0;
    }
    0.7 * low..1.4 * high
}

fn number(x: f64) -> String {
    match x {
        x if x >= 1e9 => format!("{:.0} G", x / 1e9),
        x if x >= 1e6 => format!("{:.0} M", x / 1e6),
        x if x >= 1e4 => format!("{:.0} k", x / 1e3),
        x if x >= 1.0 => format!("{x:.0}"),
        x => format!("{}", (x * 1e6).round() / 1e6),
    }
}

fn percent(x: f64) -> String {
    format!("{} %", (x * 1e8).round() / 1e6)
}

type Drawn<B> = Result<(), DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>>;

fn lines<B: DrawingBackend>(root: &DrawingArea<B, Shift>, figure: Figure, summary: &Summary) -> Drawn<B> {
    let lines = figure.lines(summary);
    let (left, right) = root.split_horizontally(SIZE.0 - room(root, lines.iter().map(|l| l.name.as_str()))?);
    let points = || lines.iter().flat_map(|l| &l.points);
    let x = ends(points().flat_map(|p| [p.0.low, p.0.high]));
    let y = ends(points().flat_map(|p| [p.1.low, p.1.high]));
    let description = match figure {
        Figure::Bytes => "bytes",
        Figure::CpuTime => "seconds of all threads",
        _ => "seconds",
    };
    let mut chart = ChartBuilder::on(&left)
        .margin(12)
        .caption(figure.title(), (FONT, 20))
        .x_label_area_size(44)
        .y_label_area_size(64)
        .build_cartesian_2d(x.clone().log_scale(), y.clone().log_scale())?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .bold_line_style(RGBColor(220, 220, 220))
        .x_desc(description)
        .y_desc("relative error (rel_error)")
        .x_label_formatter(&|v| number(*v))
        .y_labels(LABELS)
        .y_label_formatter(&|v| percent(*v))
        .label_style((FONT, 14))
        .axis_desc_style((FONT, 15))
        .draw()?;
    let floor = 3.0 * summary.reference_error[0];
    if floor > y.start {
        let top = floor.min(y.end);
        let band = [(x.start, y.start), (x.end, top)];
        chart.draw_series([Rectangle::new(band, RGBColor(235, 235, 235).filled())])?;
    }
    for line in &lines {
        let colour = line.style.colour;
        let middle = |p: &(Middle, Middle)| (p.0.median, p.1.median);
        chart.draw_series(LineSeries::new(line.points.iter().map(middle), colour.stroke_width(2)))?;
        for p in &line.points {
            let upright = vec![(p.0.median, p.1.low), (p.0.median, p.1.high)];
            let level = vec![(p.0.low, p.1.median), (p.0.high, p.1.median)];
            for bar in [upright, level] {
                chart.draw_series([PathElement::new(bar, colour.mix(0.6).stroke_width(1))])?;
            }
        }
        let plotting = chart.plotting_area();
        for p in &line.points {
            let at = plotting.map_coordinate(&middle(p));
            mark(&left, at, line.style)?;
        }
    }
    names(&right, &lines, floor > y.start)
}

/// Pixels for these names and what stands before them, of half the figure at most.
fn room<'n, B: DrawingBackend>(
    root: &DrawingArea<B, Shift>,
    names: impl Iterator<Item = &'n str>,
) -> Result<u32, DrawingAreaErrorKind<B::ErrorType>> {
    let style = (FONT, 14).into_text_style(root);
    let mut widest = 0;
    for name in names {
        widest = widest.max(root.estimate_text_size(name, &style)?.0);
    }
    Ok((widest + 80).clamp(NAMES, SIZE.0 / 2))
}

fn mark<B: DrawingBackend>(area: &DrawingArea<B, Shift>, at: (i32, i32), style: Style) -> Drawn<B> {
    // The chart's places are counted from the root, as the area's are from its own corner; both are the same at the left.
    match style.mark {
        Mark::Disk => area.draw(&Circle::new(at, 4, style.colour.filled())),
        Mark::Ring => area.draw(&Circle::new(at, 4, style.colour.stroke_width(2))),
        Mark::Cross => area.draw(&Cross::new(at, 4, style.colour.stroke_width(2))),
    }
}

fn names<B: DrawingBackend>(area: &DrawingArea<B, Shift>, lines: &[Line], floor: bool) -> Drawn<B> {
    let step = (((SIZE.1 - 60) as usize / (lines.len() + 1)).min(24)) as i32;
    let mut y = 44;
    for line in lines {
        let stroke = line.style.colour.stroke_width(2);
        area.draw(&PathElement::new(vec![(4, y), (32, y)], stroke))?;
        mark(area, (18, y), line.style)?;
        area.draw(&Text::new(line.name.clone(), (40, y - 7), (FONT, 14)))?;
        y += step;
    }
    if floor {
        area.draw(&Rectangle::new([(4, y - 6), (32, y + 6)], RGBColor(225, 225, 225).filled()))?;
        area.draw(&Text::new("not told from the reference", (40, y - 7), (FONT, 14)))?;
    }
    Ok(())
}

fn bars<B: DrawingBackend>(root: &DrawingArea<B, Shift>, summary: &Summary) -> Drawn<B> {
    let mut list: Vec<(usize, &CurveSummary, Middle)> = summary
        .curves
        .iter()
        .enumerate()
        .filter_map(|(n, c)| Some((n, c, c.efficiency.filter(|e| e.low > 0.0)?)))
        .collect();
    list.sort_by(|a, b| b.2.median.total_cmp(&a.2.median));
    let x = ends(list.iter().flat_map(|l| [l.2.low, l.2.high, 1.0]));
    let count = list.len() as f64;
    let mut chart = ChartBuilder::on(root)
        .margin(12)
        .caption(Figure::Efficiency.title(), (FONT, 20))
        .x_label_area_size(36)
        .y_label_area_size(8)
        .right_y_label_area_size(room(root, list.iter().map(|l| l.1.name.as_str()))? - 20)
        .build_cartesian_2d(x.clone().log_scale(), 0.0..count)?;
    chart
        .configure_mesh()
        .disable_y_mesh()
        .disable_y_axis()
        .light_line_style(WHITE)
        .bold_line_style(RGBColor(220, 220, 220))
        .x_label_formatter(&|v| number(*v))
        .label_style((FONT, 14))
        .draw()?;
    for (place, (n, curve, e)) in list.iter().enumerate() {
        let y = count - place as f64 - 0.5;
        let style = Style::of(*n, &curve.curve.backend);
        let bar = [(x.start, y - 0.32), (e.median, y + 0.32)];
        chart.draw_series([Rectangle::new(bar, style.colour.mix(0.75).filled())])?;
        let ends = vec![(e.low, y), (e.high, y)];
        chart.draw_series([PathElement::new(ends, BLACK.stroke_width(2))])?;
        let at = chart.plotting_area().map_coordinate(&(x.end, y));
        let text = format!("{}  {}", times(e.median), curve.name);
        root.draw(&Text::new(text, (at.0 + 8, at.1 - 7), (FONT, 14)))?;
    }
    chart.draw_series([PathElement::new(vec![(1.0, 0.0), (1.0, count)], BLACK.stroke_width(1))])?;
    Ok(())
}

/// A factor with two digits.
pub(super) fn times(x: f64) -> String {
    match x {
        x if x >= 9.95 => format!("{x:.0} x"),
        x if x >= 0.095 => format!("{x:.2} x"),
        x => format!("{x:.3} x"),
    }
}
