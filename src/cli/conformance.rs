//! `etendue conformance`: the suite that every backend must pass.

use super::args::{BackendArgs, TalkArgs};
use super::error::{CliError, NO};
use crate::io::{LoadError, Problem};
use etendue_conformance::{
    CheckResult, Level, TABLE_COUNT, accuracy_report, drift, markdown, run as run_suite,
};
use etendue_core::backend::Backend;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Options of `conformance`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// More cases and samples: minutes instead of seconds
    #[arg(long)]
    full: bool,
    /// Print the accuracy tables instead, as the Markdown file that ships as ACCURACY.md
    #[arg(long)]
    accuracy: bool,
    /// Measure the accuracy tables and compare them with such a file; exit 1 where a number has drifted
    #[arg(long, value_name = "FILE", conflicts_with = "accuracy")]
    drift: Option<PathBuf>,
    #[command(flatten)]
    backend: BackendArgs,
    #[command(flatten)]
    talk: TalkArgs,
}

/// Runs the verb.
pub(super) fn run(args: &Args) -> Result<ExitCode, CliError> {
    let backend = args.backend.open()?;
    let info = backend.info();
    if args.accuracy {
        print!("{}", markdown(&[accuracy_report(&*backend, TABLE_COUNT)?]));
        return Ok(ExitCode::SUCCESS);
    }
    if let Some(file) = &args.drift {
        return check_drift(file, &*backend);
    }
    let level = if args.full { Level::Full } else { Level::Quick };
    let mut checks = Vec::new();
    let talk = &args.talk;
    let mut report = |check: &CheckResult| {
        if talk.json {
            checks.push(json!({
                "name": check.name,
                "passed": check.passed,
                "skipped": check.skipped,
                "detail": check.detail,
                "seconds": check.seconds,
            }));
        } else if !check.passed || !talk.quiet {
            let verdict = match (check.passed, check.skipped) {
                (_, true) => "skip",
                (true, _) => "ok  ",
                (false, _) => "FAIL",
            };
            println!("{verdict} {:<44} {:>6.2} s  {}", check.name, check.seconds, check.detail);
        }
    };
    let summary = run_suite(&*backend, level, &mut report);
    if talk.json {
        let object = json!({
            "version": env!("CARGO_PKG_VERSION"),
            "backend": info.name,
            "adapter": info.adapter,
            "passed": summary.passed,
            "failed": summary.failed,
            "skipped": summary.skipped,
            "seconds": summary.seconds,
            "checks": checks,
        });
        println!("{object}");
    } else if !talk.quiet {
        println!(
            "{} on {}: {} passed, {} failed, {} skipped in {:.1} s",
            info.name, info.adapter, summary.passed, summary.failed, summary.skipped, summary.seconds
        );
    }
    Ok(if summary.ok() { ExitCode::SUCCESS } else { ExitCode::from(NO) })
}

/// Whether the tables still say what is measured.
fn check_drift(file: &Path, backend: &dyn Backend) -> Result<ExitCode, CliError> {
    let read = |e| LoadError::new(file, Problem::Read(e));
    let stated = std::fs::read_to_string(file).map_err(read)?;
    let found = drift(&stated, &markdown(&[accuracy_report(backend, TABLE_COUNT)?]));
    for line in &found {
        println!("drift: {line}");
    }
    if found.is_empty() {
        println!("{}: no number has drifted", file.display());
        return Ok(ExitCode::SUCCESS);
    }
    Ok(ExitCode::from(NO))
}
