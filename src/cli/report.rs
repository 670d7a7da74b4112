//! `etendue report`: speed against error on one's own scene.

use super::args::{Size, TalkArgs, positive};
use super::error::{CliError, INTERRUPTED};
use super::job::{Stages, read_scene};
use super::output::scene_hash;
use super::progress::Bar;
use crate::engine::{BackendKind, is_software, open_backend_on};
use crate::io::{read_exr, read_mask};
use crate::report::{self, Facts, LeftOut, Plan, Reference, read_runs};
use clap::ValueEnum;
use etendue_core::backend::Session;
use etendue_core::scene::CompiledScene;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

/// A method to measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum MethodName {
    Path,
    Bdpt,
    Photon,
    Radiosity,
}

/// Options of `report`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The scene: .toml, .xml (Mitsuba 3), .obj or .ply
    #[arg(required_unless_present = "runs")]
    scene: Option<PathBuf>,
    /// The folder of the report; made if it is not there
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Minutes for all of it, the reference's included
    #[arg(long, value_name = "MINUTES", default_value_t = 5.0, value_parser = positive, allow_negative_numbers = true)]
    budget: f64,
    /// Measure against this image, with its variance if it has it, instead of one made now [default: the folder's own of an earlier report, if it is of the same scene and size]
    #[arg(long, value_name = "A.exr")]
    reference: Option<PathBuf>,
    /// Leave out the black pixels of this image
    #[arg(long, value_name = "M.png")]
    mask: Option<PathBuf>,
    /// Width and height [default: the scene's, made smaller to some 32768 pixels]
    #[arg(long, value_name = "WxH")]
    size: Option<Size>,
    /// Replicates of everything
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(2..=1000))]
    replicates: u32,
    /// Only these methods [default: all that the scene allows]
    #[arg(long, value_enum, value_delimiter = ',', value_name = "METHOD,...")]
    methods: Vec<MethodName>,
    /// Only these backends [default: cpu, and wgpu where it has a GPU]
    #[arg(long, value_delimiter = ',', value_name = "cpu,wgpu")]
    backends: Vec<BackendKind>,
    /// Part of the name of the adapter that the wgpu backend takes [default: the best]
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// Seed of the first replicate
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Worker threads [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    threads: Option<u32>,
    /// Measure nothing: draw the runs of this table, which has the columns of report.csv
    #[arg(long, value_name = "RUNS.csv", conflicts_with_all = ["scene", "reference", "mask", "methods", "backends"])]
    runs: Option<PathBuf>,
    #[command(flatten)]
    talk: TalkArgs,
}

/// Runs the verb.
pub(super) fn run(args: &Args) -> Result<ExitCode, CliError> {
    std::fs::create_dir_all(&args.output)
        .map_err(|e| CliError::Folder { folder: args.output.display().to_string(), reason: e.to_string() })?;
    match (&args.runs, &args.scene) {
        (Some(file), _) => draw(args, file),
        (None, Some(scene)) => measure(args, scene),
        (None, None) => Err(CliError::Usage("expected a scene, or --runs".into())),
    }
}

/// Draws what others have measured.
fn draw(args: &Args, file: &Path) -> Result<ExitCode, CliError> {
    let runs = read_runs(file)?;
    let name = file.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
    let facts = Facts { scene: name, version: env!("CARGO_PKG_VERSION"), ..Facts::default() };
    let (_, sentences) = report::write(&args.output, &facts, (&runs, None), None)?;
    tell(args, &facts, &sentences);
    Ok(ExitCode::SUCCESS)
}

fn measure(args: &Args, file: &Path) -> Result<ExitCode, CliError> {
    let mut stages = Stages::new();
    let (mut scene, _) = read_scene(file, args.size, &args.talk, &mut stages)?;
    let camera = scene.camera.as_mut().ok_or_else(|| {
        CliError::Input("the scene has no camera: a report compares images, expected a [camera]".into())
    })?;
    let mut size = (camera.width, camera.height);
    if args.size.is_none() {
        size = report::modest_size(size);
        *camera = camera.with_resolution(size.0, size.1);
    }
    let hash = scene_hash(&scene);
    let mask = args.mask.as_deref().map(|m| mask_of(m, size)).transpose()?;
    let reference = match &args.reference {
        Some(file) => Some(Reference::of_image(read_exr(file)?, file.display().to_string())),
        None => Reference::kept(&args.output, &hash, size),
    };
    let mut facts = Facts {
        scene: file.display().to_string(),
        scene_hash: hash,
        size,
        threads: args.threads.map_or_else(
            || std::thread::available_parallelism().map_or(1, std::num::NonZero::get),
            |n| n as usize,
        ),
        budget: 60.0 * args.budget,
        version: env!("CARGO_PKG_VERSION"),
        ..Facts::default()
    };
    let sessions = sessions(args, Arc::new(scene), &mut facts)?;
    let methods: Vec<String> =
        args.methods.iter().filter_map(|m| m.to_possible_value().map(|v| v.get_name().to_owned())).collect();
    let mut contenders: Vec<_> =
        sessions.iter().flat_map(|(name, session)| report::contenders(&**session, name, &methods)).collect();
    let plan = Plan { seconds: facts.budget, replicates: args.replicates, seed: args.seed, size, mask };
    let bar = Bar::new(&args.talk);
    let measured = report::measure(&mut contenders, &plan, reference, &bar);
    bar.finish();
    let measured = match measured {
        Err(e) if e.is_cancelled() => {
            eprintln!("stopped before anything was measured: nothing was written");
            return Ok(ExitCode::from(INTERRUPTED));
        }
        other => other?,
    };
    if !args.talk.quiet {
        for LeftOut { curve, reason } in &measured.left_out {
            eprintln!("note: {} was not measured: {reason}", curve.name());
        }
    }
    let runs = (measured.runs.as_slice(), Some(&measured));
    let (_, sentences) = report::write(&args.output, &facts, runs, plan.mask.as_deref())?;
    tell(args, &facts, &sentences);
    if measured.cancelled {
        eprintln!("stopped early: {} holds what there is", args.output.display());
        return Ok(ExitCode::from(INTERRUPTED));
    }
    Ok(ExitCode::SUCCESS)
}

fn mask_of(file: &Path, size: (u32, u32)) -> Result<Vec<bool>, CliError> {
    let mask = read_mask(file)?;
    if (mask.width, mask.height) != size {
        return Err(CliError::Input(format!(
            "{}: {} x {} pixels, expected {} x {}",
            file.display(),
            mask.width,
            mask.height,
            size.0,
            size.1
        )));
    }
    Ok(mask.keep)
}

type Sessions = Vec<(&'static str, Box<dyn Session>)>;

/// The scene on every backend that is wanted and there; a backend that was asked for by name must be, and one that was not must be worth the time.
fn sessions(args: &Args, scene: Arc<CompiledScene>, facts: &mut Facts) -> Result<Sessions, CliError> {
    let asked = !args.backends.is_empty();
    let kinds = if asked { args.backends.clone() } else { vec![BackendKind::Cpu, BackendKind::Wgpu] };
    let mut list = Sessions::new();
    for kind in kinds {
        let threads = args.threads.map(|n| n as usize);
        let backend = match open_backend_on(kind, threads, args.adapter.as_deref()) {
            Ok(backend) if !asked && args.adapter.is_none() && is_software(&backend.info().adapter) => {
                let adapter = backend.info().adapter;
                facts.notes.push(format!(
                    "The {kind} backend has no GPU here, only {adapter}, whose speed says nothing: it was not measured (--backends cpu,wgpu does)"
                ));
                continue;
            }
            other => other,
        };
        match backend.and_then(|backend| Ok((backend.info(), backend.open(scene.clone())?))) {
            Ok((info, session)) => {
                facts.machines.push(format!("{}: {}", info.name, info.adapter));
                list.push((kind.name(), session));
            }
            Err(e) if asked || kind == BackendKind::Cpu => return Err(e.into()),
            Err(e) => facts.notes.push(format!("No {kind} backend: {e}")),
        }
    }
    Ok(list)
}

fn tell(args: &Args, facts: &Facts, sentences: &[String]) {
    let page = args.output.join("report.html");
    if args.talk.json {
        println!("{}", json!({ "output": page, "conclusion": sentences, "facts": facts }));
    } else if !args.talk.quiet {
        for sentence in sentences {
            println!("{sentence}");
        }
        println!("{}", page.display());
    }
}
