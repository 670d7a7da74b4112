//! `etendue illuminate`: an illumination map on the mesh.

use super::args::{BackendArgs, TalkArgs, positive};
use super::error::{CliError, INTERRUPTED};
use super::job::{Stages, open, read_scene, report, warn_about};
use super::output::check_folder;
use super::photon_args::{PhotonArgs, name_of};
use super::progress::Bar;
use crate::driver::{self, Budget, MapValues, Outcome, PhotonSettings, Settings};
use crate::io::{SaveError, write_ply};
use etendue_core::illumination::{Basis, Elements, Sides};
use etendue_core::scene::CompiledScene;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Options of `illuminate`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The scene: .toml, .xml (Mitsuba 3), .obj or .ply
    scene: PathBuf,
    /// The mesh with irradiance per face [W m^-2]: direct_r/g/b of lights without size, indirect_r/g/b of everything else, stderr_r/g/b of their sum
    #[arg(short, long, value_name = "OUT.ply")]
    output: PathBuf,
    #[command(flatten)]
    photon: PhotonArgs,
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
    /// Draw each face towards its surroundings, by as much as it is noisy: less error, some of it bias, and both are in stderr and rel_error; `--error` looks at the map before that
    #[arg(long)]
    reconstruct: bool,
    /// Seed of all samples
    #[arg(long, default_value_t = 0)]
    seed: u64,
    #[command(flatten)]
    backend: BackendArgs,
    #[command(flatten)]
    talk: TalkArgs,
}

impl Args {
    fn settings(&self) -> Settings {
        let budget = match (self.time, self.error) {
            (Some(seconds), _) => Budget::Seconds(seconds),
            (_, Some(error)) => Budget::Error(error),
            _ => Budget::Samples(self.photons.unwrap_or(1 << 20)),
        };
        Settings { seed: self.seed, max_depth: self.max_depth.unwrap_or(u32::MAX), budget }
    }
}

/// Writes the sums on the mesh of their elements.
fn write_map(
    path: &Path,
    scene: &CompiledScene,
    elements: &Elements,
    direct: &MapValues,
    indirect: &MapValues,
) -> Result<(), SaveError> {
    let mesh = elements.mesh(scene);
    let mut properties = Vec::new();
    for (channel, names) in [
        ["direct_r", "indirect_r", "stderr_r"],
        ["direct_g", "indirect_g", "stderr_g"],
        ["direct_b", "indirect_b", "stderr_b"],
    ]
    .into_iter()
    .enumerate()
    {
        let of = |value: &dyn Fn(usize) -> f64| -> Vec<f32> {
            mesh.elements.iter().map(|e| value(*e as usize) as f32).collect()
        };
        properties.push((names[0], of(&|i| direct.values[i][channel])));
        properties.push((names[1], of(&|i| indirect.values[i][channel])));
        properties.push((names[2], of(&|i| direct.stderr_with(indirect, i, channel))));
    }
    match elements.settings().basis {
        Basis::Constant => write_ply(path, &mesh.positions, &mesh.triangles, &[], &properties),
        Basis::Linear => write_ply(path, &mesh.positions, &mesh.triangles, &properties, &[]),
    }
}

/// Runs the verb.
pub(super) fn run(args: &Args) -> Result<ExitCode, CliError> {
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
    let photons = args.photon.settings(&*opened.session, settings.budget, Sides::Together)?;
    stages.done("choose");
    let direct = driver::direct_irradiance(&*opened.session, settings.seed, &photons.elements, &bar)?;
    stages.done("direct");
    let indirect = driver::illumination(&*opened.session, &settings, &photons, &bar)?;
    bar.finish();
    stages.done("photons");
    warn_about(&direct);
    warn_about(&indirect);
    let cancelled = direct.cancelled || indirect.cancelled;
    if direct.film.block_count() == 0 || indirect.film.block_count() == 0 {
        eprintln!("stopped before the first replicate of photons was complete: nothing was written");
        return Ok(ExitCode::from(INTERRUPTED));
    }
    let elements = opened.session.elements(&photons.elements);
    let found =
        args.reconstruct.then(|| MapValues::reconstructed(scene, &elements, &indirect.film)).flatten();
    if args.reconstruct {
        stages.done("reconstruct");
        if found.is_none() {
            eprintln!(
                "warning: one replicate of photons says nothing of its noise: nothing is reconstructed"
            );
        }
    }
    let found = found.unwrap_or_else(|| MapValues::of(&indirect.film));
    write_map(&args.output, scene, &elements, &MapValues::of(&direct.film), &found)?;
    stages.done("write");
    tell(args, &opened, &photons, [&direct, &indirect], found.reconstructed, (&settings, &stages));
    if cancelled {
        eprintln!("stopped early: {} holds {} photons", args.output.display(), indirect.film.samples());
        return Ok(ExitCode::from(INTERRUPTED));
    }
    Ok(ExitCode::SUCCESS)
}

fn tell(
    args: &Args,
    opened: &super::job::Opened,
    photons: &PhotonSettings,
    [direct, indirect]: [&Outcome; 2],
    reconstructed: Option<Option<f64>>,
    (settings, stages): (&Settings, &Stages),
) {
    let rays = direct.stats.rays + indirect.stats.rays;
    if args.talk.json {
        let mut map = report(opened, indirect, settings.seed, stages);
        map.insert("reconstructed".into(), json!(reconstructed.is_some()));
        if let Some(rel_error) = reconstructed {
            // The interval is that of the map before.
            map.insert("rel_error".into(), json!(rel_error));
            map.insert("confidence".into(), json!(null));
            map.insert("rel_error_before".into(), json!(indirect.error.map(|e| e.rel_error)));
        }
        map.insert("method".into(), json!("photon"));
        map.insert("from".into(), json!(name_of(&photons.start)));
        map.insert("photons".into(), json!(indirect.stats.paths));
        map.insert("hits".into(), json!(indirect.stats.hits));
        map.insert("rays".into(), json!(rays));
        map.insert("faces".into(), json!(opened.session.scene().triangles.len()));
        map.insert("output".into(), json!(args.output));
        println!("{}", serde_json::Value::Object(map));
    } else if !args.talk.quiet {
        let error = match (reconstructed, indirect.error) {
            (Some(Some(e)), _) => format!(", rel_error {:.3} % after reconstruction", 100.0 * e),
            (None, Some(e)) => format!(", rel_error {:.3} %", 100.0 * e.rel_error),
            _ => String::new(),
        };
        println!(
            "{}: {} faces, {} photons from {}, {:.2} hits each, {:.1} M rays{error} ({})",
            args.output.display(),
            opened.session.scene().triangles.len(),
            indirect.stats.paths,
            name_of(&photons.start),
            indirect.stats.hits as f64 / indirect.stats.paths.max(1) as f64,
            rays as f64 * 1e-6,
            stages.text()
        );
    }
}
