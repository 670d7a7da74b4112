//! What a figure of error against speed is made of.

/// One way to do a job.
pub struct Contender {
    /// Its name, as the legend and the table show it; a rival's with its version.
    pub name: String,
    /// Whether it is ours: drawn filled, a rival's is drawn hollow.
    pub ours: bool,
    /// Its error, in the figure's measure.
    pub error: f64,
    /// Does the whole job once. It is timed in turns with its rivals.
    pub work: Box<dyn FnMut()>,
}

/// Contenders for one job, to be timed in one interleaved run.
pub struct Contest {
    /// What is done, in words.
    pub title: &'static str,
    /// File name without ending.
    pub file: &'static str,
    /// What `error` is, with its unit.
    pub error_label: &'static str,
    /// One item of the job (`sample`, `block`, ...): speed is items per second.
    pub item: &'static str,
    /// Items in one call of `work`.
    pub items: u64,
    /// Who takes part.
    pub contenders: Vec<Contender>,
}

/// A curve of measured points.
pub struct Series {
    /// Its name.
    pub name: String,
    /// Points (x, y).
    pub points: Vec<(f64, f64)>,
}

/// Curves over a common axis, logarithmic both ways.
pub struct Curves {
    /// What is shown, in words.
    pub title: &'static str,
    /// File name without ending.
    pub file: &'static str,
    /// The horizontal axis, with its unit.
    pub x_label: &'static str,
    /// The vertical axis, with its unit.
    pub y_label: &'static str,
    /// The curves.
    pub series: Vec<Series>,
}

/// One numbered dot.
pub struct Dot {
    /// Its name.
    pub name: String,
    /// Drawn filled; others are drawn hollow.
    pub ours: bool,
    /// Where (x, y).
    pub at: (f64, f64),
}

/// Dots with a legend, logarithmic both ways.
pub struct Dots {
    /// What is shown, in words.
    pub title: &'static str,
    /// The axes, with their units.
    pub labels: [&'static str; 2],
    /// The dots.
    pub dots: Vec<Dot>,
}
