//! `etendue illuminate`: an illumination map on the mesh.

use super::args::{BackendArgs, TalkArgs, positive};
use super::error::{CliError, INTERRUPTED};
use super::job::{Stages, open, read_scene, report, warn_about};
use super::output::check_folder;
use super::progress::Bar;
use crate::driver::{self, Budget, Outcome, Settings};
use crate::io::write_ply;
use clap::ValueEnum;
use etendue_core::backend::PhotonStart;
use etendue_core::film::Film;
use etendue_core::transport::first_shot::Subdivision;
use serde_json::json;
use std::path::PathBuf;
use std::process::ExitCode;

/// Where photons start.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum From {
    /// On the lights, by flux
    Lights,
    /// On the surfaces that lights without size light, by what these send on
    Surfaces,
}

/// How photons that start on surfaces are weighted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Weights {
    /// As published: alike within a piece; biased at edges of shadows
    Density,
    /// Without bias (not in this version)
    Exact,
}

/// How lit triangles are cut into pieces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Subdivide {
    /// With bounded angles, by seven samples
    Robust,
    /// As published
    Published,
    /// Not at all
    None,
}

/// Options of `illuminate`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The scene: .toml, .obj or .ply
    scene: PathBuf,
    /// The mesh with irradiance per face [W m^-2]: direct_r/g/b of lights without size, indirect_r/g/b of everything else, stderr_r/g/b of their sum
    #[arg(short, long, value_name = "OUT.ply")]
    output: PathBuf,
    /// Where photons start
    #[arg(long, value_enum, default_value_t = From::Lights)]
    from: From,
    /// How photons from surfaces are weighted
    #[arg(long, value_enum, default_value_t = Weights::Density)]
    weights: Weights,
    /// How lit triangles are cut into pieces, for photons from surfaces
    #[arg(long, value_enum, default_value_t = Subdivide::Robust)]
    subdivide: Subdivide,
    /// Photons, rounded up to whole replicates [default: 1048576]
    #[arg(long, value_name = "N", group = "budget", value_parser = clap::value_parser!(u64).range(1..=1 << 40))]
    photons: Option<u64>,
    /// Stop after this many seconds
    #[arg(long, value_name = "SECONDS", group = "budget", value_parser = positive, allow_negative_numbers = true)]
    time: Option<f64>,
    /// Stop when the estimated rel_error falls below this; tested when the number of photons doubles
    #[arg(long, value_name = "E", group = "budget", value_parser = positive, allow_negative_numbers = true)]
    error: Option<f64>,
    /// Largest number of arrivals of a photon [default: unlimited]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    max_depth: Option<u32>,
    /// Seed of all samples
    #[arg(long, default_value_t = 0)]
    seed: u64,
    #[command(flatten)]
    backend: BackendArgs,
    #[command(flatten)]
    talk: TalkArgs,
}

impl Args {
    fn start(&self) -> PhotonStart {
        match self.from {
            From::Lights => PhotonStart::Lights { registers_direct: false },
            From::Surfaces => PhotonStart::Surfaces(match self.subdivide {
                Subdivide::None => Subdivision::None,
                Subdivide::Published => Subdivision::published(),
                Subdivide::Robust => Subdivision::robust(),
            }),
        }
    }

    fn settings(&self) -> Settings {
        let budget = match (self.time, self.error) {
            (Some(seconds), _) => Budget::Seconds(seconds),
            (_, Some(error)) => Budget::Error(error),
            _ => Budget::Samples(self.photons.unwrap_or(1 << 20)),
        };
        Settings { seed: self.seed, max_depth: self.max_depth.unwrap_or(u32::MAX), budget }
    }
}

/// A channel of a film as a property of the first `count` elements.
fn property(film: &Film, count: usize, channel: usize) -> Vec<f32> {
    (0..count).map(|i| film.mean(i)[channel] as f32).collect()
}

/// Runs the verb.
pub(super) fn run(args: &Args) -> Result<ExitCode, CliError> {
    if args.weights == Weights::Exact {
        return Err(CliError::Usage("--weights exact is not in this version, expected `density`".into()));
    }
    check_folder(&args.output)?;
    let mut stages = Stages::new();
    let (scene, _) = read_scene(&args.scene, None, &args.talk, &mut stages)?;
    let opened = open(scene, &args.backend, &args.talk, &mut stages)?;
    let scene = opened.session.scene();
    if !scene.shapes.is_empty() && !args.talk.quiet {
        let count = scene.shapes.len();
        eprintln!(
            "note: {count} round shapes receive light but have no faces, and are not in {}",
            args.output.display()
        );
    }
    let settings = args.settings();
    let bar = Bar::new(&args.talk);
    let direct = driver::direct_irradiance(&*opened.session, settings.seed, &bar)?;
    stages.done("direct");
    let indirect = driver::illumination(&*opened.session, &settings, args.start(), &bar)?;
    bar.finish();
    stages.done("photons");
    warn_about(&direct);
    warn_about(&indirect);
    let cancelled = direct.cancelled || indirect.cancelled;
    if direct.film.block_count() == 0 || indirect.film.block_count() == 0 {
        eprintln!("stopped before the first replicate of photons was complete: nothing was written");
        return Ok(ExitCode::from(INTERRUPTED));
    }
    let count = scene.triangles.len();
    let mut properties = Vec::new();
    for (channel, names) in [
        ["direct_r", "indirect_r", "stderr_r"],
        ["direct_g", "indirect_g", "stderr_g"],
        ["direct_b", "indirect_b", "stderr_b"],
    ]
    .into_iter()
    .enumerate()
    {
        properties.push((names[0], property(&direct.film, count, channel)));
        properties.push((names[1], property(&indirect.film, count, channel)));
        let error = |i: usize| driver::error_of_sum(&direct.film, &indirect.film, i)[channel] as f32;
        properties.push((names[2], (0..count).map(error).collect()));
    }
    write_ply(&args.output, &scene.positions, &scene.triangles, &[], &properties)?;
    stages.done("write");
    tell(args, &opened, &direct, &indirect, &settings, &stages);
    if cancelled {
        eprintln!("stopped early: {} holds {} photons", args.output.display(), indirect.film.samples());
        return Ok(ExitCode::from(INTERRUPTED));
    }
    Ok(ExitCode::SUCCESS)
}

fn tell(
    args: &Args,
    opened: &super::job::Opened,
    direct: &Outcome,
    indirect: &Outcome,
    settings: &Settings,
    stages: &Stages,
) {
    let rays = direct.stats.rays + indirect.stats.rays;
    if args.talk.json {
        let mut map = report(opened, indirect, settings.seed, stages);
        map.insert("method".into(), json!("photon"));
        let from = args.from.to_possible_value().map(|v| v.get_name().to_owned());
        map.insert("from".into(), json!(from));
        map.insert("photons".into(), json!(indirect.stats.paths));
        map.insert("hits".into(), json!(indirect.stats.hits));
        map.insert("rays".into(), json!(rays));
        map.insert("faces".into(), json!(opened.session.scene().triangles.len()));
        map.insert("output".into(), json!(args.output));
        println!("{}", serde_json::Value::Object(map));
    } else if !args.talk.quiet {
        let error =
            indirect.error.map_or_else(String::new, |e| format!(", rel_error {:.3} %", 100.0 * e.rel_error));
        println!(
            "{}: {} faces, {} photons, {:.2} hits each, {:.1} M rays{error} ({})",
            args.output.display(),
            opened.session.scene().triangles.len(),
            indirect.stats.paths,
            indirect.stats.hits as f64 / indirect.stats.paths.max(1) as f64,
            rays as f64 * 1e-6,
            stages.text()
        );
    }
}
