//! `etendue info`: what a scene contains and needs.

use super::args::TalkArgs;
use super::error::CliError;
use super::job::{Stages, read_scene};
use super::output::scene_hash;
use etendue_core::scene::{CompileReport, CompiledScene, LightKind};
use serde_json::{Map, Value, json};
use std::path::PathBuf;
use std::process::ExitCode;

/// Options of `info`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The scene: .toml, .obj or .ply
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
    let mut stages = Stages::new();
    let (scene, report) = read_scene(&args.scene, None, &args.talk, &mut stages)?;
    if args.talk.json {
        println!("{}", describe(&scene, &report, &stages));
    } else if !args.talk.quiet {
        print(&scene, &stages);
    }
    Ok(ExitCode::SUCCESS)
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
            "light_choice": n.light_choice,
            "thin_lens": n.thin_lens,
            "media": n.media,
            "null_boundaries": n.null_boundaries,
            "unsupported": n.unsupported,
        },
        "methods": if n.beyond_surfaces().is_none() { vec!["path", "photon"] } else { vec![] },
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
    match scene.needs.beyond_surfaces() {
        None => line("methods", "path, photon".into()),
        Some(missing) => line("methods", format!("none in this version: the scene has {missing}")),
    }
    line("read in", stages.text());
}
