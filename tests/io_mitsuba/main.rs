//! Mitsuba scenes: what each element becomes, and that each mistake is named with its line.
#![cfg(feature = "io")]
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

#[path = "../common/mod.rs"]
mod common;
mod light;
mod shapes;
mod shared;
mod surfaces;
mod tree;

use std::path::Path;

use etendue::io::{
    LoadError, LoadedScene, MemorySource, MitsubaOptions, RenderImage, parse_scene_mitsuba, write_exr,
    write_png,
};
use etendue_core::scene::{LightDesc, MaterialKind, Roughness, SceneDesc, ShapeKind};

/// A quad in the plane z = 0 that faces +z, with texture coordinates.
const QUAD: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n";
/// The same with normals.
const NORMALS: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1 4//1\n";
/// Two triangles on an edge.
const TENT: &str = "v -1 0 0\nv 1 0 0\nv 0 1 1\nv 0 -1 3\nf 1 2 3\nf 2 1 4\n";

fn file(write: impl Fn(&Path)) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a");
    write(&path);
    std::fs::read(path).unwrap()
}

fn vol(channels: i32, values: &[f32]) -> Vec<u8> {
    let mut out = b"VOL\x03".to_vec();
    for word in [1, 2, 1, 1, channels] {
        out.extend(i32::to_le_bytes(word));
    }
    for bound in [-1.0f32, 0.0, 0.0, 3.0, 1.0, 2.0] {
        out.extend(bound.to_le_bytes());
    }
    values.iter().for_each(|v| out.extend(v.to_le_bytes()));
    out
}

fn files() -> MemorySource {
    let sky = RenderImage {
        width: 2,
        height: 3,
        radiance: (0..6).map(|i| [i as f32, 1.0, 0.5]).collect(),
        ..RenderImage::default()
    };
    MemorySource::new()
        .with("s/quad.obj", QUAD)
        .with("s/normals.obj", NORMALS)
        .with("s/tent.obj", TENT)
        .with("s/wood.png", file(|p| write_png(p, 2, 1, &[[255; 3], [0; 3]]).unwrap()))
        .with("s/sky.exr", file(|p| write_exr(p, &sky).unwrap()))
        .with("s/smoke.vol", vol(1, &[0.25, 0.75]))
        .with("s/tint.vol", vol(3, &[0.1, 0.2, 0.3, 0.4, 0.5, 0.6]))
        .with("s/short.vol", vol(1, &[0.5]))
}

fn parse_with(text: &str, source: &MemorySource, options: &MitsubaOptions) -> Result<LoadedScene, LoadError> {
    parse_scene_mitsuba(text.as_bytes(), Path::new("s/scene.xml"), source, options)
}

/// Parses what stands within `<scene>`, its first line.
fn parse(inner: &str) -> Result<LoadedScene, LoadError> {
    let text = format!("<scene version=\"3.0.0\">{inner}</scene>");
    parse_with(&text, &files(), &MitsubaOptions::default())
}

fn desc(inner: &str) -> SceneDesc {
    parse(inner).unwrap_or_else(|e| panic!("{e}")).desc
}

/// The only material, of a shape with this `bsdf`.
fn material(bsdf: &str) -> (MaterialKind, bool) {
    let d = desc(&format!("<shape type=\"rectangle\">{bsdf}</shape>"));
    assert_eq!(d.materials.len(), 1);
    (d.materials[0].kind.clone(), d.materials[0].two_sided)
}

fn refusal(inner: &str) -> String {
    parse(inner).expect_err(inner).to_string()
}

fn color(kind: &MaterialKind) -> [f32; 3] {
    match kind {
        MaterialKind::Diffuse { albedo } | MaterialKind::Mirror { albedo } => albedo.color,
        MaterialKind::Plastic { albedo, .. } => albedo.color,
        other => panic!("{other:?}"),
    }
}

fn near(a: [f32; 3], b: [f32; 3]) -> bool {
    (0..3).all(|k| (a[k] - b[k]).abs() <= 1e-6)
}

fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
