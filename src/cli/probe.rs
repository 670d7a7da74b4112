//! `etendue probe`: irradiance at surface points.

use super::args::{BackendArgs, SamplingArgs, TalkArgs};
use super::error::{CliError, INTERRUPTED};
use super::gather_args::{Estimator, GatherArgs};
use super::job::{Stages, open, read_scene, report, summary, warn_about};
use super::output::{check_folder, probes_of, write_outcome};
use super::progress::Bar;
use crate::driver::{self, radiosity};
use crate::io::read_points;
use serde_json::json;
use std::path::PathBuf;
use std::process::ExitCode;

/// Options of `probe`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The scene: .toml, .xml (Mitsuba 3), .obj or .ply
    scene: PathBuf,
    /// The points: {"probes": [{"position": [x,y,z], "normal": [x,y,z]}, ...]}
    #[arg(long, value_name = "P.json")]
    points: PathBuf,
    /// The same list with "E" (W m^-2, direct and indirect) and "stderr"
    #[arg(short, long, value_name = "OUT.json")]
    output: PathBuf,
    #[command(flatten)]
    sampling: SamplingArgs,
    #[command(flatten)]
    gather: GatherArgs,
    #[command(flatten)]
    backend: BackendArgs,
    #[command(flatten)]
    talk: TalkArgs,
}

/// Runs the verb.
pub(super) fn run(args: &Args) -> Result<ExitCode, CliError> {
    args.sampling.check_method()?;
    args.gather.check(&args.sampling)?;
    check_folder(&args.output)?;
    let mut stages = Stages::new();
    let mut points = read_points(&args.points)?;
    if points.is_empty() {
        return Err(CliError::Input(format!("{}: expected at least one probe", args.points.display())));
    }
    let probes = probes_of(&points);
    let (scene, _) = read_scene(&args.scene, None, &args.talk, &mut stages)?;
    let opened = open(scene, &args.backend, &args.talk, &mut stages)?;
    let settings = args.sampling.settings();
    let bar = Bar::new(&args.talk);
    let estimator = args.gather.estimator(&args.sampling, &*opened.session, true, (&bar, &mut stages))?;
    let outcome = match &estimator {
        Estimator::Path => driver::probes(&*opened.session, &probes, &settings, &bar)?,
        Estimator::Bidirectional(heuristic) => {
            driver::bidirectional_probes(&*opened.session, &probes, &settings, heuristic.heuristic(), &bar)?
        }
        Estimator::Photon(gather) => {
            driver::photon_probes(&*opened.session, &probes, &settings, gather, &bar)?
        }
        Estimator::Radiosity(ready) => {
            radiosity::map_probes(&*opened.session, &probes, &settings, &ready.view(), &bar)?
        }
    };
    bar.finish();
    stages.done("sample");
    warn_about(&outcome);
    if outcome.film.block_count() == 0 {
        eprintln!("stopped before the first block of samples was complete: nothing was written");
        return Ok(ExitCode::from(INTERRUPTED));
    }
    write_outcome(&args.output, &mut points, &outcome)?;
    stages.done("write");

    if args.talk.json {
        let mut map = report(&opened, &outcome, settings.seed, &stages);
        args.gather.describe(&estimator, &settings, &mut map);
        estimator.count(&outcome, &settings, &mut map);
        map.insert("probes".into(), json!(points.len()));
        map.insert("output".into(), json!(args.output));
        println!("{}", serde_json::Value::Object(map));
    } else if !args.talk.quiet {
        println!(
            "{}: {} probes, {}{}",
            args.output.display(),
            points.len(),
            estimator.words(&outcome, &settings),
            summary(&outcome, &stages)
        );
    }
    if outcome.cancelled {
        eprintln!(
            "stopped early: {} holds {} samples per probe",
            args.output.display(),
            outcome.film.samples()
        );
        return Ok(ExitCode::from(INTERRUPTED));
    }
    Ok(ExitCode::SUCCESS)
}
