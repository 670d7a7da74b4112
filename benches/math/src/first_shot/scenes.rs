//! The scenes of the comparison: two with nine lamps, one of large triangles, one with bitmaps, one of dark surfaces.

use etendue::core::scene::{CompiledScene, LightDesc, MaterialKind, SceneDesc, compile};
use etendue::io::load_scene;
use std::path::Path;

/// A scene to compare on.
pub struct Case {
    /// Its name, as the program takes it.
    pub name: &'static str,
    /// What it is.
    pub about: &'static str,
    /// The scene.
    pub scene: CompiledScene,
    /// Longest edge of the elements \[m\]: that of its triangles where it is infinite.
    pub largest: f32,
}

fn point(position: [f32; 3], intensity: [f32; 3]) -> LightDesc {
    LightDesc::Point { position, intensity }
}

fn spot(position: [f32; 3], direction: [f32; 3], intensity: [f32; 3], cone_deg: f32) -> LightDesc {
    LightDesc::Spot { position, direction, intensity, cone_deg, falloff_deg: 0.7 * cone_deg }
}

fn sponza(data: &Path, textures: bool) -> SceneDesc {
    let file = data.join("sponza_dabrovic/sponza.obj");
    let mut desc = load_scene(&file).unwrap_or_else(|e| panic!("{e}")).desc;
    desc.lights = ours("sponza_lamps.toml").lights;
    if !textures {
        for mesh in &mut desc.meshes {
            mesh.textures = false;
        }
    }
    desc
}

fn ours(file: &str) -> SceneDesc {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes").join(file);
    load_scene(&path).unwrap_or_else(|e| panic!("{e}")).desc
}

/// The colonnade at night with surfaces that reflect a fifth of what they did.
fn dark() -> SceneDesc {
    let mut desc = ours("colonnade/lamps.toml");
    for material in &mut desc.materials {
        if let MaterialKind::Diffuse { albedo } = &mut material.kind {
            albedo.color = albedo.color.map(|x| 0.3 * x);
        }
    }
    desc
}

/// The closed box, of 32 large triangles, with lamps of no size.
pub fn room() -> SceneDesc {
    let mut desc = ours("cornell/closed.toml");
    desc.shapes.clear();
    desc.lights = vec![
        point([2.78, 4.5, 2.795], [10.0, 10.0, 10.0]),
        spot([1.0, 5.0, 1.0], [0.4, -1.0, 0.5], [40.0, 30.0, 20.0], 30.0),
    ];
    desc
}

/// The scene of a name; `None` for an unknown one, or one of the shared scenes where `data`, their folder, is not given.
pub fn case(name: &'static str, data: Option<&Path>) -> Option<Case> {
    let (about, desc) = match (name, data) {
        ("colonnade", _) => {
            ("scenes/colonnade/lamps.toml: six points and three spots", ours("colonnade/lamps.toml"))
        }
        ("room", _) => (
            "scenes/cornell/closed.toml without its lamp and with a point and a spot: large triangles, elements of 0.15 m",
            room(),
        ),
        ("dark", _) => ("scenes/colonnade/lamps.toml, all albedos times 0.3", dark()),
        ("sponza", Some(data)) => {
            ("Dabrovic's Sponza without bitmaps: seven points and two spots", sponza(data, false))
        }
        ("textured", Some(data)) => {
            ("Dabrovic's Sponza with its bitmaps and the same lamps", sponza(data, true))
        }
        _ => return None,
    };
    let scene = compile(&desc).unwrap_or_else(|e| panic!("{name}: {e}")).0;
    let largest = if name == "room" { 0.15 } else { f32::INFINITY };
    Some(Case { name, about, scene, largest })
}
