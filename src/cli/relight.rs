//! `etendue relight`: the light of a baked scene for new lights.

use super::args::{BackendArgs, Size, TalkArgs, ToneArgs, positive};
use super::error::{CliError, INTERRUPTED};
use super::job::{Opened, Stages, heading, open, read_scene_with, report, summary, warn_about};
use super::output::{check_folder, image_of, probes_of, write_image, write_outcome};
use super::progress::Bar;
use super::radiosity_args::{Ready, read, ready};
use crate::driver::radiosity::{map_image, map_probes};
use crate::driver::{Budget, Outcome, Settings};
use crate::io::{SaveError, read_points, write_ply};
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Options of `relight`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The operator, as `bake` wrote it
    operator: PathBuf,
    /// The scene that it was baked from
    #[arg(long, value_name = "SCENE")]
    scene: PathBuf,
    /// Lights instead of the scene's: [[light]] of a scene file, and nothing else. Emissive surfaces stay
    #[arg(long, value_name = "L.toml")]
    lights: Option<PathBuf>,
    /// A mesh with irradiance per face [W m^-2] (.ply: direct_r/g/b of lights without size, indirect_r/g/b of everything else), irradiance at points (.json), or an image (.exr)
    #[arg(short, long, value_name = "OUT.ply|.json|.exr")]
    output: PathBuf,
    /// The points of a .json
    #[arg(long, value_name = "P.json")]
    points: Option<PathBuf>,
    /// Width and height of an image instead of the scene's
    #[arg(long, value_name = "WxH")]
    size: Option<Size>,
    /// Whether the first surface gathers its light by rays; without it the patches are read where the eye looks [default: image false, points true]
    #[arg(long, value_name = "true|false", num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    gather: Option<bool>,
    /// Samples per pixel or point [default: 64]
    #[arg(long, value_name = "N", group = "budget", value_parser = clap::value_parser!(u64).range(1..=1 << 40))]
    samples: Option<u64>,
    /// Stop sampling after this many seconds
    #[arg(long, value_name = "SECONDS", group = "budget", value_parser = positive, allow_negative_numbers = true)]
    time: Option<f64>,
    /// Seed of all samples
    #[arg(long, default_value_t = 0)]
    seed: u64,
    #[command(flatten)]
    tone: ToneArgs,
    #[command(flatten)]
    backend: BackendArgs,
    #[command(flatten)]
    talk: TalkArgs,
}

/// What is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    Mesh,
    Points,
    Image,
}

impl Args {
    fn form(&self) -> Result<Form, CliError> {
        let usage = |text: String| Err(CliError::Usage(text));
        let form = match self.output.extension().and_then(|e| e.to_str()) {
            Some("ply") => Form::Mesh,
            Some("json") => Form::Points,
            Some("exr") => Form::Image,
            _ => return usage(format!("{}: expected .ply, .json or .exr", self.output.display())),
        };
        if (form == Form::Points) != self.points.is_some() {
            return usage("--points and a .json as output need each other".into());
        }
        let image = self.size.is_some() || self.tone.png.is_some();
        if image && form != Form::Image {
            return usage("--size and --png need an .exr as output".into());
        }
        if form == Form::Mesh && (self.gather.is_some() || self.samples.is_some() || self.time.is_some()) {
            return usage("--gather, --samples and --time have no use with a .ply as output".into());
        }
        Ok(form)
    }

    fn settings(&self) -> Settings {
        let budget = match self.time {
            Some(seconds) => Budget::Seconds(seconds),
            None => Budget::Samples(self.samples.unwrap_or(64)),
        };
        Settings { seed: self.seed, max_depth: u32::MAX, budget }
    }
}

/// Runs the verb.
pub(super) fn run(args: &Args) -> Result<ExitCode, CliError> {
    let form = args.form()?;
    for file in std::iter::once(&args.output).chain(&args.tone.png) {
        check_folder(file)?;
    }
    let mut stages = Stages::new();
    let mut points = match &args.points {
        Some(file) => read_points(file)?,
        None => Vec::new(),
    };
    let (scene, _) =
        read_scene_with(&args.scene, args.lights.as_deref(), args.size, &args.talk, &mut stages)?;
    let opened = open(scene, &args.backend, &args.talk, &mut stages)?;
    let session = &*opened.session;
    let (operator, error) = read(&args.operator, session, &mut stages)?;
    let bar = Bar::new(&args.talk);
    let gather = args.gather.unwrap_or(form == Form::Points);
    let ready = ready(session, operator, error, (args.seed, gather), &bar, &mut stages)?;
    let settings = args.settings();
    let outcome = match form {
        Form::Mesh => {
            write_mesh(&args.output, &opened, &ready)?;
            None
        }
        Form::Points => Some(map_probes(session, &probes_of(&points), &settings, &ready.view(), &bar)?),
        Form::Image => Some(map_image(session, &settings, &ready.view(), &bar)?),
    };
    bar.finish();
    if let Some(outcome) = &outcome {
        stages.done("sample");
        warn_about(outcome);
        if outcome.film.block_count() == 0 {
            eprintln!("stopped before the first block of samples was complete: nothing was written");
            return Ok(ExitCode::from(INTERRUPTED));
        }
        if form == Form::Points {
            write_outcome(&args.output, &mut points, outcome)?;
        } else {
            let mut metadata = Map::new();
            metadata.insert("version".into(), json!(env!("CARGO_PKG_VERSION")));
            metadata.insert("backend".into(), json!(opened.info.name));
            metadata.insert("scene_hash".into(), json!(opened.hash));
            metadata.insert("seed".into(), json!(args.seed));
            metadata.insert("samples".into(), json!(outcome.film.samples()));
            metadata.insert("method".into(), json!("radiosity"));
            ready.describe(&mut metadata);
            let image = image_of(outcome, Value::Object(metadata).to_string());
            write_image(&image, &args.output, args.tone.png.as_deref(), args.tone.settings())?;
        }
    }
    stages.done("write");
    tell(args, &opened, &ready, outcome.as_ref(), &stages);
    if outcome.is_some_and(|o| o.cancelled) {
        eprintln!("stopped early: {} holds what there is", args.output.display());
        return Ok(ExitCode::from(INTERRUPTED));
    }
    Ok(ExitCode::SUCCESS)
}

/// Irradiance on the mesh of the elements.
fn write_mesh(path: &Path, opened: &Opened, ready: &Ready) -> Result<(), SaveError> {
    let map = &ready.operator.map;
    let mesh = map.elements.mesh(opened.session.scene());
    let mut properties = Vec::new();
    for (channel, names) in
        [["direct_r", "indirect_r"], ["direct_g", "indirect_g"], ["direct_b", "indirect_b"]]
            .into_iter()
            .enumerate()
    {
        for (name, values) in names.into_iter().zip([&ready.relit.light.elements, &ready.relit.values]) {
            let list: Vec<f32> = mesh.elements.iter().map(|e| values[*e as usize][channel]).collect();
            properties.push((name, list));
        }
    }
    write_ply(path, &mesh.positions, &mesh.triangles, &[], &properties)
}

fn tell(args: &Args, opened: &Opened, ready: &Ready, outcome: Option<&Outcome>, stages: &Stages) {
    if args.talk.json {
        let mut map = match outcome {
            Some(outcome) => report(opened, outcome, args.seed, stages),
            None => heading(opened, args.seed, stages),
        };
        map.insert("method".into(), json!("radiosity"));
        ready.describe(&mut map);
        map.insert("output".into(), json!(args.output));
        println!("{}", Value::Object(map));
    } else if !args.talk.quiet {
        let rest = outcome.map_or_else(|| format!("({})", stages.text()), |o| summary(o, stages));
        println!("{}: {}{rest}", args.output.display(), ready.words());
    }
}
