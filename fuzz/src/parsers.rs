//! The readers of untrusted files.

use etendue::io;
use std::path::Path;

/// Scene files, with a mesh at hand for them to name.
pub fn scene(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let source = io::MemorySource::new()
        .with("a.obj", &b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n"[..])
        .with("a.mtl", &b"newmtl m\nKd 0.5 0.5 0.5\n"[..]);
    let _ = io::parse_scene_toml(text, Path::new("scene.toml"), &source);
}

/// Mitsuba scenes, with a mesh, a volume and an include at hand for them to name.
pub fn mitsuba(bytes: &[u8]) {
    let mut volume = b"VOL\x03".to_vec();
    [1, 1, 1, 1, 1].iter().for_each(|word| volume.extend(i32::to_le_bytes(*word)));
    [0.0f32, 0.0, 0.0, 1.0, 1.0, 1.0, 0.5].iter().for_each(|value| volume.extend(value.to_le_bytes()));
    let source = io::MemorySource::new()
        .with("a.obj", &b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"[..])
        .with("a.vol", volume)
        .with("a.xml", bytes);
    let options = io::MitsubaOptions::default();
    let _ = io::parse_scene_mitsuba(bytes, Path::new("scene.xml"), &source, &options);
}

/// Meshes in OBJ.
pub fn obj(bytes: &[u8]) {
    let _ = io::parse_obj(bytes, Path::new("a.obj"));
}

/// Materials in MTL.
pub fn mtl(bytes: &[u8]) {
    let _ = io::parse_mtl(bytes, Path::new("a.mtl"));
}

/// Meshes in PLY.
pub fn ply(bytes: &[u8]) {
    let _ = io::parse_ply(bytes, Path::new("a.ply"));
}

/// Images in EXR.
pub fn exr(bytes: &[u8]) {
    let _ = io::parse_exr(bytes, Path::new("a.exr"));
}

/// Probe lists.
pub fn points(bytes: &[u8]) {
    let _ = io::parse_points(bytes, Path::new("a.json"));
}
