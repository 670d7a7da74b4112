//! Loads the shared scenes, where `ETENDUE_SCENES` names their folder.
#![cfg(feature = "io")]

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use etendue::io;

/// The folder of the shared scenes; nothing when the variable is unset, which is said.
fn scenes() -> Option<PathBuf> {
    let Ok(value) = std::env::var("ETENDUE_SCENES") else {
        println!("skipped: ETENDUE_SCENES is not set");
        return None;
    };
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(value);
    assert!(path.is_dir(), "ETENDUE_SCENES is set, but {} is not a folder", path.display());
    Some(path)
}

fn files(folder: &Path, extension: &str, out: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            files(&path, extension, out);
        } else if path.extension().is_some_and(|e| e == extension) {
            out.push(path);
        }
    }
}

#[test]
fn every_obj_loads_or_is_refused_with_its_line() {
    let Some(root) = scenes() else { return };
    let mut all = Vec::new();
    files(&root, "obj", &mut all);
    assert!(all.len() > 40);
    for path in all {
        let start = Instant::now();
        let loaded = io::load_scene(&path);
        let took = start.elapsed();
        let name = path.strip_prefix(&root).unwrap().display().to_string();
        match &loaded {
            Ok(scene) => {
                println!("{name}: {} triangles, {took:.1?}", scene.desc.meshes[0].triangles.len());
                for note in &scene.notes {
                    println!("    {}", note.to_string().replace(root.to_str().unwrap(), ""));
                }
            }
            Err(e) => {
                println!("{name}: refused: {}", e.to_string().replace(root.to_str().unwrap(), ""));
                assert!(e.line.is_some(), "{e}");
            }
        }
        assert!(took < Duration::from_secs(1), "{name} took {took:?}");
    }
}
