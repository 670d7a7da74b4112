//! `etendue info`: what a scene contains and needs, or what an operator is.

use super::args::TalkArgs;
use super::error::CliError;
use super::job::{Stages, read_scene};
use super::output::scene_hash;
use super::radiosity_args::error_json;
use crate::io::read_operator;
use etendue_core::scene::{CompileReport, CompiledScene, LightKind};
use serde_json::{Map, Value, json};
use std::path::PathBuf;
use std::process::ExitCode;

/// Options of `info`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The scene (.toml, .xml, .obj or .ply), or an operator (.etd)
    scene: PathBuf,
    #[command(flatten)]
    talk: TalkArgs,
}

const LIGHT_KINDS: [(LightKind, &str); 7] = [
    (LightKind::Point, "point"),
    (LightKind::Spot, "spot"),
    (LightKind::Directional, "directional"),
    (LightKind::Triangle, "triangle"),
    (LightKind::Parallelogram, "rectangle"),
    (LightKind::Sphere, "sphere"),
    (LightKind::Disk, "disk"),
];

/// Runs the verb.
pub(super) fn run(args: &Args) -> Result<ExitCode, CliError> {
    if args.scene.extension().is_some_and(|e| e == "etd") {
        return operator(args);
    }
    let mut stages = Stages::new();
    let (scene, report) = read_scene(&args.scene, None, &args.talk, &mut stages)?;
    if args.talk.json {
        println!("{}", describe(&scene, &report, &stages));
    } else if !args.talk.quiet {
        print(&scene, &stages);
    }
    Ok(ExitCode::SUCCESS)
}

/// What an operator file says of itself.
fn operator(args: &Args) -> Result<ExitCode, CliError> {
    let mut stages = Stages::new();
    let file = read_operator(&args.scene)?;
    stages.done("read");
    let n = file.patches.len();
    let area: f64 = file.patches.iter().map(|p| f64::from(p.area)).sum();
    let per_pair = file.transport.bytes() as f64 / (n as f64 * n as f64);
    let (info, e) = (&file.info, file.info.error);
    let hash = info.transport_hash.iter().map(|b| format!("{b:02x}")).collect::<String>();
    if args.talk.json {
        println!(
            "{}",
            json!({
                "version": info.program,
                "transport_hash": hash,
                "patches": n,
                "area": area,
                "elements": file.of.len(),
                "codec": info.codec,
                "max_error": info.max_error,
                "codec_error": error_json(&e),
                "passes": info.passes,
                "bounces": info.bounces,
                "bytes_per_pair": per_pair,
                "rays": info.rays,
                "seed": info.seed,
                "seconds": stages.json(),
            })
        );
    } else if !args.talk.quiet {
        let line = |name: &str, text: String| println!("{name:>10}  {text}");
        line("patches", format!("{n} of {} elements, {area:.6} m^2", file.of.len()));
        line("scene", hash);
        let bounces = info.bounces.map_or_else(|| "all bounces".into(), |k| format!("{k} bounces"));
        line(
            "light",
            format!("{bounces} in {} passes, from {} rays, seed {}", info.passes, info.rays, info.seed),
        );
        line("codec", format!("{}, {per_pair:.4} bytes a pair", info.codec));
        line(
            "error",
            format!(
                "{:.3} % of irradiance over probe lights, {:.3} % of the worst, {:.3} % of its total",
                100.0 * e.rms,
                100.0 * e.worst,
                100.0 * e.energy
            ),
        );
    }
    Ok(ExitCode::SUCCESS)
}

/// The methods that have all that a scene needs.
fn methods(scene: &CompiledScene) -> Vec<&'static str> {
    let n = &scene.needs;
    if n.beyond_paths().is_some() {
        return Vec::new();
    }
    let mut list = vec!["path", "bdpt"];
    if n.beyond_photons().is_none() {
        list.push("photon");
    }
    if !(n.volume() || n.beyond_diffuse() || n.round_shapes || n.environment_image) {
        list.push("radiosity");
    }
    list
}

fn lights(scene: &CompiledScene) -> Vec<(&'static str, usize)> {
    let mut list: Vec<(&str, usize)> = LIGHT_KINDS
        .iter()
        .map(|(kind, name)| (*name, scene.lights.iter().filter(|l| l.kind == *kind as u32).count()))
        .collect();
    list.push(("environment", usize::from(scene.needs.environment)));
    list.retain(|l| l.1 > 0);
    list
}

fn describe(scene: &CompiledScene, report: &CompileReport, stages: &Stages) -> Value {
    let lights: Map<String, Value> = lights(scene).into_iter().map(|(n, c)| (n.into(), json!(c))).collect();
    let cleanups: Vec<Value> =
        report.cleanups.iter().map(|(what, n)| json!({ "what": what.to_string(), "count": n })).collect();
    let n = &scene.needs;
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "scene_hash": scene_hash(scene),
        "triangles": scene.triangles.len(),
        "shapes": scene.shapes.len(),
        "vertices": scene.positions.len(),
        "materials": scene.materials.len(),
        "textures": scene.textures.len(),
        "texels": scene.texels.len(),
        "media": scene.media.len(),
        "area": scene.area(),
        "bounds": { "min": scene.bounds.lo.to_array(), "max": scene.bounds.hi.to_array() },
        "camera": scene.camera.map(|c| json!({ "width": c.width, "height": c.height })),
        "lights": lights,
        "needs": {
            "textures": n.textures,
            "mirrors": n.mirrors,
            "glossy": n.glossy,
            "one_sided": n.one_sided,
            "shading_normals": n.shading_normals,
            "round_shapes": n.round_shapes,
            "point_like_lights": n.point_like_lights,
            "area_lights": n.area_lights,
            "environment": n.environment,
            "environment_image": n.environment_image,
            "light_choice": n.light_choice,
            "thin_lens": n.thin_lens,
            "media": n.media,
            "grids": n.grids,
            "null_boundaries": n.null_boundaries,
            "rough": n.rough,
            "plastic": n.plastic,
            "scattering_films": n.scattering_films,
            "unsupported": n.unsupported,
        },
        "methods": methods(scene),
        "cleanups": cleanups,
        "seconds": stages.json(),
    })
}

fn print(scene: &CompiledScene, stages: &Stages) {
    let line = |name: &str, text: String| println!("{name:>10}  {text}");
    line(
        "geometry",
        format!(
            "{} triangles, {} spheres or disks, {} vertices, {:.6} m^2",
            scene.triangles.len(),
            scene.shapes.len(),
            scene.positions.len(),
            scene.area()
        ),
    );
    line("bounds", format!("{} to {} m", scene.bounds.lo, scene.bounds.hi));
    line(
        "surfaces",
        format!(
            "{} materials, {} bitmaps of {} texels",
            scene.materials.len(),
            scene.textures.len(),
            scene.texels.len()
        ),
    );
    let lights: Vec<_> = lights(scene).into_iter().map(|(name, n)| format!("{n} {name}")).collect();
    line("lights", if lights.is_empty() { "none: the scene is dark".into() } else { lights.join(", ") });
    line(
        "camera",
        scene.camera.map_or_else(|| "none".into(), |c| format!("{} x {} pixels", c.width, c.height)),
    );
    line("needs", scene.needs.to_string());
    match scene.needs.beyond_paths() {
        None => line("methods", methods(scene).join(", ")),
        Some(missing) => line("methods", format!("none in this version: the scene has {missing}")),
    }
    line("read in", stages.text());
}
