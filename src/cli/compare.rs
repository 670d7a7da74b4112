//! `etendue compare`: the metrics, one definition each.

use super::args::TalkArgs;
use super::error::{CliError, NO};
use crate::io::{RenderImage, read_exr, read_mask};
use crate::metrics::{MetricValue, MetricsInput, compare};
use serde_json::{Map, Value, json};
use std::path::PathBuf;
use std::process::ExitCode;
use std::str::FromStr;

/// Options of `compare`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The image in question
    a: PathBuf,
    /// The reference
    b: PathBuf,
    /// Variance of the mean of the reference, as the colours of an image [default: the reference's own layer]
    #[arg(long, value_name = "V.exr")]
    variance: Option<PathBuf>,
    /// The variance file is per sample: divide it by this number
    #[arg(long, value_name = "N", requires = "variance", value_parser = clap::value_parser!(u64).range(1..))]
    variance_samples: Option<u64>,
    /// Leave out the black pixels of this image
    #[arg(long, value_name = "M.png")]
    mask: Option<PathBuf>,
    /// Exit 1 when a metric exceeds its limit (`flip=0.1`); may be repeated
    #[arg(long, value_name = "METRIC=X")]
    fail_above: Vec<Limit>,
    #[command(flatten)]
    talk: TalkArgs,
}

/// A metric and its limit.
#[derive(Clone, Debug, PartialEq)]
struct Limit {
    metric: String,
    limit: f64,
}

impl FromStr for Limit {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        let expected = || "expected METRIC=NUMBER, as in rel_mse=1e-3".to_owned();
        let (metric, limit) = s.split_once('=').ok_or_else(expected)?;
        let limit = limit.trim().parse::<f64>().ok().filter(|x| !x.is_nan()).ok_or_else(expected)?;
        Ok(Self { metric: metric.trim().into(), limit })
    }
}

/// Runs the verb.
pub(super) fn run(args: &Args) -> Result<ExitCode, CliError> {
    let a = read_exr(&args.a)?;
    let b = read_exr(&args.b)?;
    let same_size = |other: (u32, u32), file: &PathBuf| {
        if other == (b.width, b.height) {
            return Ok(());
        }
        Err(CliError::Input(format!(
            "{}: is {} x {} pixels, expected {} x {} as {}",
            file.display(),
            other.0,
            other.1,
            b.width,
            b.height,
            args.b.display()
        )))
    };
    same_size((a.width, a.height), &args.a)?;
    let var_r = match &args.variance {
        Some(file) => {
            let image = read_exr(file)?;
            same_size((image.width, image.height), file)?;
            Some(per_mean(image, args.variance_samples))
        }
        None => b.variance.clone(),
    };
    let mask = match &args.mask {
        Some(file) => {
            let mask = read_mask(file)?;
            same_size((mask.width, mask.height), file)?;
            Some(mask.keep)
        }
        None => None,
    };
    let input = MetricsInput {
        var_x: a.variance.as_deref(),
        var_r: var_r.as_deref(),
        mask: mask.as_deref(),
        ..MetricsInput::new(b.width as usize, b.height as usize, &a.radiance, &b.radiance)
    };
    let metrics = compare(&input)?;
    let mut exceeded = Vec::new();
    for l in &args.fail_above {
        // A name that does not exist is a mistake in the command, not in the images.
        if metrics.exceeds(&l.metric, l.limit).map_err(|e| CliError::Usage(e.to_string()))? {
            exceeded.push(l);
        }
    }
    if args.talk.json {
        let mut map: Map<String, Value> =
            metrics.fields().into_iter().map(|(name, value)| (name.to_owned(), value_json(&value))).collect();
        map.insert("exceeded".into(), json!(exceeded.iter().map(|l| &l.metric).collect::<Vec<_>>()));
        println!("{}", Value::Object(map));
    } else if !args.talk.quiet {
        for (name, value) in metrics.fields() {
            println!("{name:>14}  {}", value_text(&value));
        }
    }
    for l in &exceeded {
        eprintln!("{} is above its limit {}", l.metric, l.limit);
    }
    Ok(if exceeded.is_empty() { ExitCode::SUCCESS } else { ExitCode::from(NO) })
}

fn per_mean(image: RenderImage, samples: Option<u64>) -> Vec<[f32; 3]> {
    let n = samples.unwrap_or(1) as f32;
    image.radiance.into_iter().map(|p| p.map(|x| x / n)).collect()
}

fn value_json(value: &MetricValue) -> Value {
    match value {
        MetricValue::Number(x) => json!(x),
        MetricValue::List(x) => json!(x),
        MetricValue::Intervals(x) => json!(x),
        MetricValue::Count(n) => json!(n),
    }
}

fn value_text(value: &MetricValue) -> String {
    match value {
        MetricValue::Number(x) => format!("{x:.6e}"),
        MetricValue::List(x) => format!("{x:.5?}"),
        MetricValue::Intervals(x) => format!("{x:.5?}"),
        MetricValue::Count(n) => n.to_string(),
    }
}
