//! The scenes: a closed box, an open colonnade, and Sponza where it is at hand.

use super::Outcome;
use crate::first_shot::scenes;
use etendue::core::scene::{CompiledScene, EnvironmentDesc, LightDesc, SceneDesc, compile};
use etendue::io::load_scene;
use std::path::Path;
use std::sync::Arc;

/// A scene to bake.
pub struct Case {
    /// Its name.
    pub name: &'static str,
    /// What it is.
    pub about: &'static str,
    /// The scene.
    pub scene: Arc<CompiledScene>,
}

fn compiled(desc: &SceneDesc) -> Outcome<Arc<CompiledScene>> {
    Ok(Arc::new(compile(desc)?.0))
}

/// The closed box as it is shipped.
///
/// # Errors
/// Where its file is missing.
pub fn cornell() -> Outcome<Arc<CompiledScene>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/cornell/closed.toml");
    compiled(&load_scene(&path)?.desc)
}

/// All scenes; `data` is the folder of the shared ones.
///
/// # Errors
/// Where a file is missing.
pub fn cases(data: Option<&Path>) -> Outcome<Vec<Case>> {
    let mut cases =
        vec![Case { name: "cornell", about: "scenes/cornell/closed.toml, a closed box", scene: cornell()? }];
    for name in ["colonnade", "sponza"] {
        let Some(case) = scenes::case(name, data) else {
            eprintln!("{name} is left out: ETENDUE_SCENES does not name the folder of the shared scenes");
            continue;
        };
        let about = if name == "sponza" {
            "Dabrovic's Sponza without bitmaps"
        } else {
            "scenes/colonnade/lamps.toml"
        };
        cases.push(Case { name, about, scene: Arc::new(case.scene) });
    }
    Ok(cases)
}

/// A mesh of the shared scenes as the references of its probes have it: plain colours, geometric normals, under a sky of radiance 1 where `sky`.
///
/// # Errors
/// Where its file is missing.
pub fn mesh(file: &Path, sky: bool) -> Outcome<Arc<CompiledScene>> {
    let mut desc = load_scene(file)?.desc;
    for mesh in &mut desc.meshes {
        (mesh.textures, mesh.shading_normals) = (false, false);
    }
    if sky {
        desc.lights = vec![LightDesc::Environment(EnvironmentDesc::uniform([1.0; 3]))];
    }
    compiled(&desc)
}
