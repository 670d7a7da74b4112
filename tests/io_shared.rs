//! Loads the shared scenes, where `ETENDUE_SCENES` names their folder.
#![cfg(feature = "io")]

mod common;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use common::shared_scenes;
use etendue::io;

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
fn shared_every_obj_loads_or_is_refused_with_its_line() {
    let Some(root) = shared_scenes() else { return };
    let mut all = Vec::new();
    files(&root, "obj", &mut all);
    assert!(all.len() > 40);
    let mut refused = Vec::new();
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
                refused.push(path.file_name().unwrap().to_str().unwrap().to_owned());
            }
        }
        assert!(took < Duration::from_secs(1), "{name} took {took:?}");
    }
    assert_eq!(refused, ["issue-140-zero-face-idx.obj", "test-nan.obj"]);
}

#[test]
fn shared_sponza_loads_whole_and_fast() {
    let Some(root) = shared_scenes() else { return };
    let path = root.join("sponza_dabrovic/sponza.obj");
    let scene = io::load_scene(&path).unwrap();
    let mesh = &scene.desc.meshes[0];
    assert_eq!(mesh.triangles.len(), 66_450);
    assert_eq!(mesh.face_materials.len(), 66_450);
    assert!(scene.desc.textures.len() >= 9, "{}", scene.desc.textures.len());
    assert!(scene.notes.iter().any(|n| n.message.contains("letter case")));
    let bytes = std::fs::read(&path).unwrap();
    let start = Instant::now();
    let obj = io::parse_obj(&bytes, &path).unwrap();
    println!("{} vertices from {} bytes in {:?}", obj.positions.len(), bytes.len(), start.elapsed());
    assert!(start.elapsed() < Duration::from_secs(1));
}

#[test]
fn shared_closed_cornell_scenes_load() {
    let Some(root) = shared_scenes() else { return };
    for (name, shapes, lights, media) in [("area", 1, 0, 0), ("point", 0, 1, 0), ("fog", 2, 0, 1)] {
        let scene = io::load_scene(&root.join(format!("closed_cornell/{name}.toml"))).unwrap();
        let d = &scene.desc;
        assert_eq!(d.meshes[0].triangles.len(), 32);
        assert_eq!((d.shapes.len(), d.lights.len(), d.media.len()), (shapes, lights, media));
        assert_eq!(d.camera.as_ref().unwrap().resolution, [256, 256]);
        assert_eq!(d.meshes[0].material_names.len(), 3);
        assert!(scene.notes.is_empty(), "{:?}", scene.notes);
    }
}

#[test]
fn shared_every_exr_reads() {
    let Some(root) = shared_scenes() else { return };
    let mut all = Vec::new();
    files(&root, "exr", &mut all);
    assert!(all.len() > 15);
    for path in all {
        let start = Instant::now();
        let image = io::read_exr(&path).unwrap();
        let finite = image.radiance.iter().flatten().all(|x| x.is_finite());
        assert!(finite, "{}", path.display());
        assert_eq!(image.radiance.len(), (image.width * image.height) as usize);
        let mean = image.radiance.iter().flatten().map(|x| f64::from(*x)).sum::<f64>();
        let mean = mean / (3.0 * image.radiance.len() as f64);
        println!(
            "{}: {} x {}, mean {mean:.5}, {:.1?}",
            path.strip_prefix(&root).unwrap().display(),
            image.width,
            image.height,
            start.elapsed()
        );
    }
}

#[test]
fn shared_every_list_of_points_reads() {
    let Some(root) = shared_scenes() else { return };
    let points = io::read_points(&root.join("closed_cornell/area_points.json")).unwrap();
    assert_eq!(points.len(), 1024);
    assert!(points.iter().all(|p| p.irradiance.is_some()));
    for name in ["cornell_original", "cornell_empty_white", "sponza_sky"] {
        let points = io::read_points(&root.join(format!("probes/{name}_probes.json"))).unwrap();
        assert!(!points.is_empty(), "{name}");
    }
}
