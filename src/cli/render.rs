//! `etendue render`: an image.

use super::args::{BackendArgs, SamplingArgs, Size, TalkArgs, ToneArgs};
use super::error::{CliError, INTERRUPTED};
use super::gather_args::{Estimator, GatherArgs};
use super::job::{Stages, open, read_scene, report, summary, warn_about};
use super::output::{check_folder, image_of, write_image};
use super::progress::Bar;
use super::scatter_args::ScatterArgs;
use crate::driver::{self, radiosity};
use serde_json::json;
use std::path::PathBuf;
use std::process::ExitCode;

/// Options of `render`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The scene: .toml, .xml (Mitsuba 3), .obj or .ply
    scene: PathBuf,
    /// The image: linear radiance, variance of the mean and sample counts
    #[arg(short, long, value_name = "OUT.exr")]
    output: PathBuf,
    /// Width and height instead of the scene's
    #[arg(long, value_name = "WxH")]
    size: Option<Size>,
    #[command(flatten)]
    sampling: SamplingArgs,
    #[command(flatten)]
    scatter: ScatterArgs,
    #[command(flatten)]
    gather: GatherArgs,
    #[command(flatten)]
    tone: ToneArgs,
    #[command(flatten)]
    backend: BackendArgs,
    #[command(flatten)]
    talk: TalkArgs,
}

/// Runs the verb.
pub(super) fn run(args: &Args) -> Result<ExitCode, CliError> {
    args.sampling.check_method()?;
    args.gather.check(&args.sampling)?;
    args.scatter.check(&args.sampling)?;
    for file in std::iter::once(&args.output).chain(&args.tone.png) {
        check_folder(file)?;
    }
    let mut stages = Stages::new();
    let (scene, _) = read_scene(&args.scene, args.size, &args.talk, &mut stages)?;
    let opened = open(scene, &args.backend, &args.talk, &mut stages)?;
    let settings = args.sampling.settings();
    let bar = Bar::new(&args.talk);
    let estimator = args.gather.estimator(&args.sampling, &*opened.session, false, (&bar, &mut stages))?;
    let outcome = match &estimator {
        Estimator::Path => match args.scatter.single() {
            Some(single) => driver::airlight_image(&*opened.session, &settings, single, &bar)?,
            None => driver::image(&*opened.session, &settings, &bar)?,
        },
        Estimator::Bidirectional(heuristic) => {
            driver::bidirectional_image(&*opened.session, &settings, heuristic.heuristic(), &bar)?
        }
        Estimator::Photon(gather) => driver::photon_image(&*opened.session, &settings, gather, &bar)?,
        Estimator::Radiosity(ready) => {
            radiosity::map_image(&*opened.session, &settings, &ready.view(), &bar)?
        }
    };
    bar.finish();
    stages.done("sample");
    warn_about(&outcome);
    if outcome.film.block_count() == 0 {
        eprintln!("stopped before the first block of samples was complete: nothing was written");
        return Ok(ExitCode::from(INTERRUPTED));
    }
    // What decides the bits, and nothing else: no times, no threads.
    let mut metadata = json!({
        "version": env!("CARGO_PKG_VERSION"),
        "backend": opened.info.name,
        "scene_hash": opened.hash,
        "seed": settings.seed,
        "samples": outcome.film.samples(),
        "block_length": outcome.film.settings().block_length,
        "max_depth": args.sampling.max_depth,
    });
    if let Some(map) = metadata.as_object_mut() {
        args.gather.describe(&estimator, &settings, map);
        args.scatter.describe(map);
    }
    let image = image_of(&outcome, metadata.to_string());
    write_image(&image, &args.output, args.tone.png.as_deref(), args.tone.settings())?;
    stages.done("write");

    if args.talk.json {
        let mut map = report(&opened, &outcome, settings.seed, &stages);
        args.gather.describe(&estimator, &settings, &mut map);
        args.scatter.describe(&mut map);
        estimator.count(&outcome, &settings, &mut map);
        map.insert("width".into(), json!(image.width));
        map.insert("height".into(), json!(image.height));
        map.insert("output".into(), json!(args.output));
        println!("{}", serde_json::Value::Object(map));
    } else if !args.talk.quiet {
        println!(
            "{}: {}x{}, {}{}",
            args.output.display(),
            image.width,
            image.height,
            estimator.words(&outcome, &settings),
            summary(&outcome, &stages)
        );
        if let Some(png) = &args.tone.png {
            println!("{}: for the eye", png.display());
        }
    }
    if outcome.cancelled {
        eprintln!(
            "stopped early: {} holds {} samples per pixel",
            args.output.display(),
            outcome.film.samples()
        );
        return Ok(ExitCode::from(INTERRUPTED));
    }
    Ok(ExitCode::SUCCESS)
}
