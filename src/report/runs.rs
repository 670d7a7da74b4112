//! Runs: one line of the table each, whoever made them.

use super::ReportError;
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;
use std::path::Path;

/// One way to compute an image.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Curve {
    /// `path`, `bdpt`, `photon`, `radiosity`; or another program's.
    pub method: String,
    /// What tells it from others of the method; may be empty.
    pub variant: String,
    /// Who computes: `cpu`, `wgpu`, or another program.
    pub backend: String,
}

impl Curve {
    /// From its three names.
    pub fn new(method: &str, variant: &str, backend: &str) -> Self {
        Self { method: method.into(), variant: variant.into(), backend: backend.into() }
    }

    /// For people: `photon, gather (wgpu)`.
    pub fn name(&self) -> String {
        let mut name = self.method.clone();
        if !self.variant.is_empty() {
            let _ = write!(name, ", {}", self.variant);
        }
        if self.backend != "cpu" {
            let _ = write!(name, " ({})", self.backend);
        }
        name
    }
}

/// One image against the reference, and what it took. Errors are those of [`crate::metrics`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// The estimator.
    pub method: String,
    /// What tells it from others of the method.
    pub variant: String,
    /// Who computed.
    pub backend: String,
    /// What it was made with, in words.
    pub effort: String,
    /// Its place on the ladder of efforts.
    pub rung: u32,
    /// Runs of one rung differ by this, and their seed.
    pub replicate: u32,
    /// Samples per pixel.
    pub samples: u64,
    /// Seconds on the wall.
    pub seconds: f64,
    /// Seconds of all threads, where they are known.
    pub cpu_seconds: Option<f64>,
    /// `name=seconds` of each stage, in order.
    pub stages: String,
    /// Rays traced, where they are counted.
    pub rays: Option<u64>,
    /// Bytes of the operator, where there is one.
    pub bytes: Option<u64>,
    /// `rel_error`.
    pub rel_error: f64,
    /// `rel_mse`.
    pub rel_mse: f64,
    /// `energy_error`.
    pub energy_error: f64,
    /// `bias` of red.
    pub bias_r: f64,
    /// `bias` of green.
    pub bias_g: f64,
    /// `bias` of blue.
    pub bias_b: f64,
    /// `block_ratio`, its 5th percentile.
    pub block_5: f64,
    /// Its median.
    pub block_50: f64,
    /// Its 95th percentile.
    pub block_95: f64,
    /// `worst_block`.
    pub worst_block: f64,
    /// `flip`.
    pub flip: f64,
    /// `z_pass`, where the variance of the image is known.
    pub z_pass: Option<f64>,
}

impl Run {
    /// The curve that it is a point of.
    pub fn curve(&self) -> Curve {
        Curve::new(&self.method, &self.variant, &self.backend)
    }

    /// `bias` of the three channels.
    pub fn bias(&self) -> [f64; 3] {
        [self.bias_r, self.bias_g, self.bias_b]
    }

    fn check(&self) -> Result<(), String> {
        let positive = |x: f64| x.is_finite() && x > 0.0;
        if !positive(self.seconds) || !self.cpu_seconds.is_none_or(positive) {
            return Err("seconds must be above 0".into());
        }
        if !(self.rel_error.is_finite() && self.rel_error >= 0.0 && self.rel_mse >= 0.0) {
            return Err("errors must be finite and not below 0".into());
        }
        Ok(())
    }
}

/// Runs as a table with a heading, one line each.
///
/// # Errors
/// Never for runs that this program made.
pub(super) fn table_of(runs: &[Run]) -> Result<Vec<u8>, String> {
    let mut out = csv::WriterBuilder::new().terminator(csv::Terminator::Any(b'\n')).from_writer(Vec::new());
    for run in runs {
        out.serialize(run).map_err(|e| e.to_string())?;
    }
    out.into_inner().map_err(|e| e.to_string())
}

/// Reads a table of runs: the columns of `report.csv`, in any order.
///
/// # Errors
/// A file that cannot be read, a line that does not fit, or no line at all.
pub fn read_runs(path: &Path) -> Result<Vec<Run>, ReportError> {
    let fail = |reason: String| ReportError::Runs { file: path.display().to_string(), reason };
    let mut reader = csv::Reader::from_path(path).map_err(|e| fail(e.to_string()))?;
    let mut runs = Vec::new();
    for (number, line) in reader.deserialize::<Run>().enumerate() {
        let run = line.map_err(|e| fail(e.to_string()))?;
        run.check().map_err(|e| fail(format!("line {}: {e}", number + 2)))?;
        runs.push(run);
    }
    if runs.is_empty() {
        return Err(fail("it holds no run".into()));
    }
    Ok(runs)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run() -> Run {
        Run {
            method: "path".into(),
            backend: "cpu".into(),
            effort: "16 samples, \"sorted\"".into(),
            seconds: 0.1,
            rel_error: 0.03,
            rel_mse: 1e-3,
            ..Run::default()
        }
    }

    #[test]
    fn tables_come_back_as_they_were_written() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("runs.csv");
        let runs = vec![run(), Run { bytes: Some(7), z_pass: Some(0.999), ..run() }];
        std::fs::write(&file, table_of(&runs).unwrap()).unwrap();
        assert_eq!(read_runs(&file).unwrap(), runs);
    }

    #[test]
    fn bad_tables_say_where() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("runs.csv");
        assert!(read_runs(&file).is_err(), "no file");
        let good = String::from_utf8(table_of(&[run()]).unwrap()).unwrap();
        let (heading, line) = good.split_once('\n').unwrap();
        for (text, word) in [
            (String::new(), "no run"),
            (format!("{heading}\n"), "no run"),
            (format!("{heading}\n{}", line.replace("0.1", "-1")), "line 2"),
            (format!("{heading}\n{}", line.replace("0.1", "soon")), "soon"),
            ("method,seconds\npath,1\n".into(), "missing field"),
        ] {
            std::fs::write(&file, text).unwrap();
            let error = read_runs(&file).unwrap_err().to_string();
            assert!(error.contains(word) || error.contains("invalid float"), "{error}");
        }
    }
}
