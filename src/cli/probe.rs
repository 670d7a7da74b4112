//! `etendue probe`: irradiance at surface points, or over whole surfaces.

use super::args::{BackendArgs, SamplingArgs, TalkArgs};
use super::error::{CliError, INTERRUPTED};
use super::gather_args::{Estimator, GatherArgs};
use super::job::{Stages, open, read_scene, report, summary, warn_about};
use super::output::{check_folder, probes_of, write_outcome};
use super::progress::Bar;
use crate::driver::{self, Meter, MeterMethod, Outcome, Settings, radiosity};
use crate::io::{self, MeterReading, read_points, write_meters};
use etendue_core::backend::{Probe, Session};
use etendue_core::scene::CompiledScene;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Options of `probe`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The scene: .toml, .xml (Mitsuba 3), .obj or .ply
    scene: PathBuf,
    /// The points: {"probes": [{"position": [x,y,z], "normal": [x,y,z]}, ...]}
    #[arg(long, value_name = "P.json", required_unless_present = "surface", conflicts_with = "surface")]
    points: Option<PathBuf>,
    /// Instead of points, all surfaces of a material together: the mean over them, at their fronts or, with `:back`, at their backs; may be repeated
    #[arg(long, value_name = "MATERIAL[:back]")]
    surface: Vec<String>,
    /// The same list with "E" (W m^-2, direct and indirect) and "stderr"; of surfaces {"meters": [{"surface", "side", "area", "E", "stderr"}, ...]}
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

/// Where irradiance is asked for.
enum Asked {
    Points { list: Vec<io::Probe>, probes: Vec<Probe> },
    Surfaces { names: Vec<(String, bool)>, meters: Vec<Meter> },
}

impl Asked {
    fn new(args: &Args, points: Option<Vec<io::Probe>>, scene: &CompiledScene) -> Result<Self, CliError> {
        if let Some(list) = points {
            return Ok(Self::Points { probes: probes_of(&list), list });
        }
        let names: Vec<(String, bool)> = args
            .surface
            .iter()
            .map(|said| match said.strip_suffix(":back") {
                Some(name) => (name.to_string(), true),
                None => (said.clone(), false),
            })
            .collect();
        let find = |(name, back): &(String, bool)| {
            Meter::of_material(scene, name, *back).ok_or_else(|| {
                let known = scene.material_names.join(", ");
                CliError::Input(format!(
                    "--surface {name}: no surface of this material, expected one of: {known}"
                ))
            })
        };
        let meters = names.iter().map(find).collect::<Result<_, _>>()?;
        Ok(Self::Surfaces { names, meters })
    }

    fn count(&self) -> usize {
        match self {
            Self::Points { list, .. } => list.len(),
            Self::Surfaces { meters, .. } => meters.len(),
        }
    }

    fn word(&self) -> &'static str {
        match self {
            Self::Points { .. } => "probes",
            Self::Surfaces { .. } => "surfaces",
        }
    }

    fn measure(
        &self,
        session: &dyn Session,
        estimator: &Estimator,
        settings: &Settings,
        bar: &Bar,
    ) -> Result<Outcome, CliError> {
        let outcome = match self {
            Self::Points { probes, .. } => match estimator {
                Estimator::Path => driver::probes(session, probes, settings, bar)?,
                Estimator::Bidirectional(heuristic) => {
                    driver::bidirectional_probes(session, probes, settings, heuristic.heuristic(), bar)?
                }
                Estimator::Photon(gather) => driver::photon_probes(session, probes, settings, gather, bar)?,
                Estimator::Radiosity(ready) => {
                    radiosity::map_probes(session, probes, settings, &ready.view(), bar)?
                }
            },
            Self::Surfaces { meters, .. } => {
                let method = match estimator {
                    Estimator::Path => MeterMethod::Path,
                    Estimator::Bidirectional(heuristic) => MeterMethod::Bidirectional(heuristic.heuristic()),
                    Estimator::Photon(gather) => MeterMethod::Photon(gather),
                    Estimator::Radiosity(_) => {
                        let reason = "--surface goes with method path, bdpt or photon: `etendue relight` writes what operators know of whole surfaces";
                        return Err(CliError::Usage(reason.into()));
                    }
                };
                driver::meters(session, meters, settings, method, bar)?
            }
        };
        Ok(outcome)
    }

    fn write(&mut self, file: &Path, outcome: &Outcome) -> Result<(), CliError> {
        match self {
            Self::Points { list, .. } => write_outcome(file, list, outcome),
            Self::Surfaces { names, meters } => {
                let reading = |(i, ((name, back), meter)): (usize, (&(String, bool), &Meter))| MeterReading {
                    surface: name.clone(),
                    side: if *back { "back" } else { "front" },
                    area: meter.area(),
                    irradiance: outcome.film.mean(i).map(|x| x as f32),
                    stderr: outcome.film.standard_error(i).map(|v| v.map(|x| x as f32)),
                };
                let readings: Vec<MeterReading> =
                    names.iter().zip(meters.iter()).enumerate().map(reading).collect();
                Ok(write_meters(file, &readings)?)
            }
        }
    }
}

/// Runs the verb.
pub(super) fn run(args: &Args) -> Result<ExitCode, CliError> {
    args.sampling.check_method()?;
    args.gather.check(&args.sampling)?;
    check_folder(&args.output)?;
    let mut stages = Stages::new();
    let points = args.points.as_deref().map(read_points).transpose()?;
    if let (Some(file), Some([])) = (&args.points, points.as_deref()) {
        return Err(CliError::Input(format!("{}: expected at least one probe", file.display())));
    }
    let (scene, _) = read_scene(&args.scene, None, &args.talk, &mut stages)?;
    let mut asked = Asked::new(args, points, &scene)?;
    let opened = open(scene, &args.backend, &args.talk, &mut stages)?;
    let settings = args.sampling.settings();
    let bar = Bar::new(&args.talk);
    let estimator = args.gather.estimator(&args.sampling, &*opened.session, true, (&bar, &mut stages))?;
    let outcome = asked.measure(&*opened.session, &estimator, &settings, &bar)?;
    bar.finish();
    stages.done("sample");
    warn_about(&outcome);
    if outcome.film.block_count() == 0 {
        eprintln!("stopped before the first block of samples was complete: nothing was written");
        return Ok(ExitCode::from(INTERRUPTED));
    }
    asked.write(&args.output, &outcome)?;
    stages.done("write");

    if args.talk.json {
        let mut map = report(&opened, &outcome, settings.seed, &stages);
        args.gather.describe(&estimator, &settings, &mut map);
        estimator.count(&outcome, &settings, &mut map);
        map.insert(asked.word().into(), json!(asked.count()));
        map.insert("output".into(), json!(args.output));
        println!("{}", serde_json::Value::Object(map));
    } else if !args.talk.quiet {
        println!(
            "{}: {} {}, {}{}",
            args.output.display(),
            asked.count(),
            asked.word(),
            estimator.words(&outcome, &settings),
            summary(&outcome, &stages)
        );
    }
    if outcome.cancelled {
        eprintln!("stopped early: {} holds {} samples each", args.output.display(), outcome.film.samples());
        return Ok(ExitCode::from(INTERRUPTED));
    }
    Ok(ExitCode::SUCCESS)
}
