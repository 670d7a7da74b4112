//! The command line: one file per verb. No math happens here.

mod adapters;
mod args;
mod bake;
mod bake_args;
mod compare;
mod conformance;
mod error;
mod gather_args;
mod illuminate;
mod info;
mod job;
mod output;
mod photon_args;
mod probe;
mod progress;
mod radiosity_args;
mod relight;
mod render;
mod report;
mod scatter_args;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Global illumination that states its error.
#[derive(Debug, Parser)]
#[command(name = "etendue", version, max_term_width = 100)]
pub struct Cli {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// Tell what a scene contains, which light transport it needs and what is wrong with it
    Info(info::Args),
    /// Render an image
    Render(render::Args),
    /// Estimate the irradiance at surface points, with standard errors
    Probe(probe::Args),
    /// Compute an illumination map on the mesh: irradiance per face, with standard errors
    Illuminate(illuminate::Args),
    /// Bake the light between all surfaces of a scene: once, for any lights to come
    Bake(bake::Args),
    /// Relight a baked scene: indirect light of new lights without tracing its bounces
    Relight(relight::Args),
    /// Measure speed against error on a scene: every method, backend and codec that applies
    Report(report::Args),
    /// Compare two images by every metric; exit 1 above a limit
    Compare(compare::Args),
    /// Run the conformance suite on a backend
    Conformance(conformance::Args),
    /// List the adapters that the wgpu backend can use
    Adapters(adapters::Args),
}

/// Runs the command of this process.
pub fn main() -> ExitCode {
    // Usage errors exit with 2 here, --help and --version with 0.
    let cli = Cli::parse();
    // For those who look into a run: ETENDUE_LOG=debug.
    if let Some(level) = std::env::var("ETENDUE_LOG").ok().and_then(|l| l.parse::<tracing::Level>().ok()) {
        tracing_subscriber::fmt().with_max_level(level).with_writer(std::io::stderr).init();
    }
    let result = match &cli.verb {
        Verb::Info(args) => info::run(args),
        Verb::Render(args) => render::run(args),
        Verb::Probe(args) => probe::run(args),
        Verb::Illuminate(args) => illuminate::run(args),
        Verb::Bake(args) => bake::run(args),
        Verb::Relight(args) => relight::run(args),
        Verb::Report(args) => report::run(args),
        Verb::Compare(args) => compare::run(args),
        Verb::Conformance(args) => conformance::run(args),
        Verb::Adapters(args) => adapters::run(args),
    };
    match result {
        Ok(code) => code,
        Err(e) => {
            eprintln!("etendue: {e}");
            e.exit_code()
        }
    }
}
