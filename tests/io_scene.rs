//! The scene file: what it accepts, and that each mistake is named with its line.
#![cfg(feature = "io")]
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use std::path::Path;

use etendue::io::{
    LoadError, LoadedScene, MemorySource, Volume, encode_vol, parse_mesh_scene, parse_scene_toml,
};
use etendue_core::scene::{Checker, LightDesc, MaterialKind, Reflectance, Roughness, ShapeKind};

const QUAD: &str = "mtllib quad.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl red\nf 1 2 3 4\n";
const QUAD_MTL: &str = "newmtl red\nKd 0.5 0.25 0.125\nKe 1 2 3\nmap_Kd wood.png\n";

/// A 2 x 1 PNG, white and black.
fn png() -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    etendue::io::write_png(&path, 2, 1, &[[255; 3], [0; 3]]).unwrap();
    std::fs::read(path).unwrap()
}

fn files() -> MemorySource {
    MemorySource::new()
        .with("s/quad.obj", QUAD)
        .with("s/quad.mtl", QUAD_MTL)
        .with("s/wood.png", png())
        .with("s/smoke.vol", smoke())
}

/// Two cells.
fn smoke() -> Vec<u8> {
    let volume =
        Volume { size: [2, 1, 1], channels: 1, bounds: [[0.0; 3], [1.0; 3]], values: vec![0.25, 4.0] };
    encode_vol(&volume, Path::new("smoke.vol")).unwrap()
}

fn parse(text: &str) -> Result<LoadedScene, LoadError> {
    parse_scene_toml(text, Path::new("s/scene.toml"), &files())
}

const FULL: &str = r#"
version = 1
[camera]
position = [278, 273, -800]
look_at = [278, 273, 0]
up = [0, 1, 0]
fov_x_deg = 39.3
resolution = [64, 32]
lens_radius = 0.1
focus_distance = 5
medium = "fog"

[[mesh]]
file = "quad.obj"
translate = [1, 2, 3]
scale = 2.0
normals = "shading"
interior = "fog"

[[mesh]]
file = "quad.obj"
matrix = [1,0,0,5, 0,1,0,6, 0,0,1,7, 0,0,0,1]
textures = false
mtl = "full"

[[mesh]]
file = "quad.obj"
material = "white"

[[shape]]
kind = "sphere"
center = [0, 1, 0]
radius = 0.5
material = "glass"

[[shape]]
kind = "disk"
center = [0, 1, 0]
normal = [0, 0, 1]
radius = 0.5

[[shape]]
kind = "rectangle"
center = [0, 1, 0]
u = [1, 0, 0]
v = [0, 1, 0]

[[shape]]
kind = "box"
min = [0, 0, 0]
max = [1, 1, 1]
material = "boundary"
interior = "fog"

[[light]]
kind = "point"
position = [278, 500, 279]
intensity = [1e5, 1e5, 1e5]

[[light]]
kind = "spot"
position = [0, 5, 0]
direction = [0, -1, 0]
intensity = [1, 1, 1]
cone_deg = 30
falloff_deg = 20

[[light]]
kind = "directional"
direction = [0, -1, 0]
irradiance = [1, 1, 1]

[[light]]
kind = "environment"
radiance = [0.5, 0.5, 0.5]
rotate_deg = 90

[[material]]
name = "white"
kind = "diffuse"
albedo = [0.5, 0.5, 0.5]
two_sided = false
emission = [1, 0, 0]

[[material]]
name = "wood"
kind = "diffuse"
texture = "wood.png"

[[material]]
name = "checked"
kind = "diffuse"
checker = { a = [0, 0, 0], b = [1, 1, 1], repeat = [2, 4] }

[[material]]
name = "mirror"
kind = "mirror"

[[material]]
name = "shiny"
kind = "phong"
specular = [0.5, 0.5, 0.5]
exponent = 20

[[material]]
name = "both"
kind = "diffuse_phong"
albedo = [0.5, 0.5, 0.5]
specular = [0.25, 0.25, 0.25]
exponent = 20

[[material]]
name = "boundary"
kind = "null"

[[material]]
name = "glass"
kind = "dielectric"
ior = [1.510, 1.514, 1.521]
roughness = 0.1
distribution = "beckmann"
fresnel = "exact"

[[material]]
name = "frosted"
kind = "dielectric"
exponent = 40
fresnel = "schlick"

[[material]]
name = "steel"
kind = "conductor"
eta = 2.5
k = 3.5
roughness = 0.2

[[material]]
name = "ball"
kind = "plastic"

[[material]]
name = "toy"
kind = "plastic"
albedo = [0.5, 0.25, 0.5]
checker = { a = [0, 0, 0], b = [1, 1, 1] }
ior = 1.6
roughness = 0.3
distribution = "beckmann"
nonlinear = true

[[material]]
name = "gold"
kind = "conductor"
eta = [0.2, 0.4, 1.3]
k = [3.9, 2.4, 1.8]

[[material]]
name = "film"
kind = "thin_film"
reflect = [0.1, 0.1, 0.1]
transmit = [0.5, 0.5, 0.5]
scatter = true

[[material]]
name = "filter"
kind = "thin_film"
transmit = [0.5, 0.25, 0.5]

[[material]]
name = "pane"
kind = "thin_dielectric"
fresnel = "schlick"

[[material]]
name = "prism"
kind = "dielectric"
ior = [1.510, 1.514, 1.521]

[[medium]]
name = "fog"
sigma_a = [0.1, 0.1, 0.1]
sigma_s = [1, 1, 1]
g = 0.5
emission = [0, 0, 0]
priority = -2

[[medium]]
name = "smoke"
sigma_s = [1, 1, 1]
density = "smoke.vol"
bounds = [[-1, 0, 0], [1, 1, 1]]
"#;

#[test]
fn everything_in_the_interface_parses() {
    let scene = parse(FULL).unwrap();
    let d = &scene.desc;
    let camera = d.camera.as_ref().unwrap();
    assert_eq!((camera.resolution, camera.fov_x_deg, camera.lens_radius), ([64, 32], 39.3, 0.1));
    assert_eq!(camera.medium, "fog");
    assert_eq!((d.meshes.len(), d.shapes.len(), d.lights.len(), d.media.len()), (3, 4, 4, 2));

    let first = &d.meshes[0];
    assert_eq!(first.transform, Some([[2.0, 0.0, 0.0, 1.0], [0.0, 2.0, 0.0, 2.0], [0.0, 0.0, 2.0, 3.0]]));
    assert!(first.shading_normals && first.textures);
    assert_eq!((first.interior.as_str(), first.exterior.as_str()), ("fog", ""));
    assert_eq!(first.material_names, ["quad.obj:red"]);
    assert_eq!(first.triangles.len(), 2);
    let second = &d.meshes[1];
    assert_eq!(second.transform.unwrap()[1], [0.0, 1.0, 0.0, 6.0]);
    assert!(!second.textures && !second.shading_normals);
    assert_eq!(second.material_names, ["quad.obj:red#2"], "read as full, so another material");
    let third = &d.meshes[2];
    assert_eq!((third.material.as_str(), third.material_names.len()), ("white", 0));

    let material = |name: &str| d.materials.iter().find(|m| m.name == name).unwrap();
    assert_eq!(material("quad.obj:red").emission, [1.0, 2.0, 3.0]);
    match &material("quad.obj:red").kind {
        MaterialKind::Diffuse { albedo } => {
            assert_eq!((albedo.color, albedo.texture.as_str()), ([0.5, 0.25, 0.125], "wood.png"));
        }
        other => panic!("{other:?}"),
    }
    match &material("wood").kind {
        MaterialKind::Diffuse { albedo } => {
            assert_eq!((albedo.color, albedo.texture.as_str()), ([1.0; 3], "wood.png"));
        }
        other => panic!("{other:?}"),
    }
    assert!(!material("white").two_sided && material("wood").two_sided);
    let ior = [1.510, 1.514, 1.521];
    let roughness = Roughness::Beckmann(0.1);
    assert_eq!(material("glass").kind, MaterialKind::RoughDielectric { ior, schlick: false, roughness });
    let roughness = Roughness::Phong(40.0);
    let frosted = MaterialKind::RoughDielectric { ior: [1.5; 3], schlick: true, roughness };
    assert_eq!(material("frosted").kind, frosted);
    let (eta, k, roughness) = ([2.5; 3], [3.5; 3], Roughness::Ggx(0.2));
    assert_eq!(material("steel").kind, MaterialKind::RoughConductor { eta, k, roughness });
    let albedo = Reflectance::flat([0.5; 3]);
    let ball = MaterialKind::Plastic { albedo, ior: 1.5, roughness: None, nonlinear: false };
    assert_eq!(material("ball").kind, ball);
    let checker = |repeat| Some(Checker { colors: [[0.0; 3], [1.0; 3]], repeat });
    let toy = MaterialKind::Plastic {
        albedo: Reflectance { color: [0.5, 0.25, 0.5], texture: String::new(), checker: checker([1.0; 2]) },
        ior: 1.6,
        roughness: Some(Roughness::Beckmann(0.3)),
        nonlinear: true,
    };
    assert_eq!(material("toy").kind, toy);
    let checked = Reflectance { checker: checker([2.0, 4.0]), ..Reflectance::flat([1.0; 3]) };
    assert_eq!(material("checked").kind, MaterialKind::Diffuse { albedo: checked });
    let (reflect, transmit) = ([0.1; 3], [0.5; 3]);
    assert_eq!(material("film").kind, MaterialKind::ScatteringFilm { reflect, transmit });
    let (eta, k) = ([0.2, 0.4, 1.3], [3.9, 2.4, 1.8]);
    assert_eq!(material("gold").kind, MaterialKind::Conductor { eta, k });
    let (reflect, transmit) = ([0.0; 3], [0.5, 0.25, 0.5]);
    assert_eq!(material("filter").kind, MaterialKind::ThinFilm { reflect, transmit });
    assert_eq!(material("pane").kind, MaterialKind::ThinDielectric { ior: [1.5; 3], schlick: true });
    assert_eq!(material("prism").kind, MaterialKind::Dielectric { ior, schlick: false });
    assert_eq!((d.media[0].priority, d.media[1].priority), (-2, 0));
    let grid = d.media[1].density.as_ref().unwrap();
    assert_eq!((grid.size, grid.channels, grid.values.as_slice()), ([2, 1, 1], 1, &[0.25, 4.0][..]));
    assert_eq!(grid.to_world, [[2.0, 0.0, 0.0, -1.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]);
    assert!(d.media.iter().all(|m| m.unsupported.is_empty() && m.albedo.is_none()));
    assert_eq!(d.textures.len(), 1, "one bitmap however many materials name it");
    assert_eq!(d.textures[0].texels, [[255; 3], [0; 3]]);
    assert!(matches!(d.lights[1], LightDesc::Spot { cone_deg: 30.0, falloff_deg: 20.0, .. }));
    assert!(matches!(d.shapes[3].kind, ShapeKind::Box { .. }));
}

const CAMERA: &str = "[camera]\nposition = [0, 0, 0]\nlook_at = [0, 0, 1]\n";

#[test]
fn a_vertical_field_of_view_is_converted_by_the_aspect() {
    let text = format!("{CAMERA}fov_y_deg = 90\nresolution = [200, 100]\n");
    let camera = parse(&text).unwrap().desc.camera.unwrap();
    // tan(fov_x / 2) = 2 tan(45 degrees)
    let expected = 2.0 * 2f64.atan().to_degrees();
    assert!((f64::from(camera.fov_x_deg) - expected).abs() <= 1e-4);
    let square = parse(&format!("{CAMERA}fov_y_deg = 40\n")).unwrap().desc.camera.unwrap();
    assert_eq!(square.resolution, [256, 256]);
    assert_eq!(square.fov_x_deg, 40.0);
}

/// Text of a scene file, the line of the mistake, and what the message must hold.
const MISTAKES: &[(&str, usize, &[&str])] = &[
    ("version = 2\n", 1, &["version", "found 2", "expected 1"]),
    ("version = \"1\"\n", 1, &["version", "a whole number"]),
    ("\n\nfoo = 1\n", 3, &["unknown field \"foo\"", "camera", "mesh"]),
    ("[camera]\nposition = [0, 0\n", 2, &["TOML"]),
    ("[camera\n", 1, &["TOML"]),
    ("a = 1\na = 2\n", 2, &["TOML"]),
    ("camera = 3\n", 1, &["camera", "[camera]"]),
    ("[mesh]\nfile = \"a.obj\"\n", 1, &["mesh", "[[mesh]]"]),
    ("light = [1]\n", 1, &["light", "[[light]]"]),
    ("[camera]\nlook_at = [0, 0, 1]\nfov_x_deg = 3\n", 1, &["camera: position", "no such field"]),
    (
        "[camera]\nposition = [0, 0]\nlook_at = [0, 0, 1]\nfov_x_deg = 3\n",
        2,
        &["position", "a list of 2", "3 numbers"],
    ),
    ("[camera]\nposition = [0, 0, \"x\"]\nlook_at = [0, 0, 1]\nfov_x_deg = 3\n", 2, &["position", "\"x\""]),
    ("[camera]\nposition = [0, 0, 0]\nlook_at = [0, 0, 1]\n", 1, &["fov_x_deg or fov_y_deg"]),
    (
        "[camera]\nposition = [0, 0, 0]\nlook_at = [0, 0, 1]\nfov_x_deg = 1\nfov_y_deg = 1\n",
        5,
        &["one of them"],
    ),
    ("[camera]\nposition = [0, 0, 0]\nlook_at = [0, 0, 1]\nfov_y_deg = 200\n", 4, &["200", "180"]),
    (
        "[camera]\nposition = [0, 0, 0]\nlook_at = [0, 0, 1]\nfov_x_deg = 3\nresolution = [0, 1]\n",
        5,
        &["resolution"],
    ),
    (
        "[camera]\nposition = [0, 0, 0]\nlook_at = [0, 0, 1]\nfov_x_deg = 3\nresolution = [1e9, 1]\n",
        5,
        &["resolution", "65536"],
    ),
    (
        "[camera]\nposition = [0, 0, 0]\nlook_at = [0, 0, 1]\nfov_x_deg = 3\nlens_radius = 1\n",
        1,
        &["focus_distance"],
    ),
    (
        "[camera]\nposition = [0, 0, 0]\nlook_at = [0, 0, 1]\nfov_x_deg = 3\nmedium = \"fog\"\n",
        5,
        &["\"fog\"", "[[medium]]"],
    ),
    (
        "[[mesh]]\nfile = \"quad.obj\"\nscale = 1\nmatrix = [1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]\n",
        4,
        &["matrix", "one or the other"],
    ),
    (
        "[[mesh]]\nfile = \"quad.obj\"\nmatrix = [1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,2]\n",
        3,
        &["matrix", "last row"],
    ),
    (
        "[[mesh]]\nfile = \"quad.obj\"\nnormals = \"flat\"\n",
        3,
        &["normals", "\"flat\"", "geometric, shading"],
    ),
    ("[[mesh]]\nfile = \"nothing.obj\"\n", 2, &["mesh 1: file", "\"nothing.obj\""]),
    (
        "[[mesh]]\nfile = \"quad.obj\"\n[[mesh]]\nfile = \"quad.obj\"\nmaterial = \"whit\"\n",
        5,
        &["mesh 2: material", "\"whit\""],
    ),
    ("[[mesh]]\n", 1, &["mesh 1: file", "no such field"]),
    ("[[shape]]\nkind = \"torus\"\n", 2, &["shape 1: kind", "\"torus\"", "sphere, disk, rectangle, box"]),
    ("[[shape]]\nkind = \"sphere\"\ncenter = [0,0,0]\nradius = true\n", 4, &["radius", "true", "a number"]),
    (
        "[[shape]]\nkind = \"sphere\"\ncenter = [0,0,0]\nradius = 1\nnormal = [0,0,1]\n",
        5,
        &["unknown field \"normal\"", "center"],
    ),
    ("[[light]]\nkind = \"environment\"\nfile = \"sky.exr\"\n", 3, &["light 1: file", "sky.exr"]),
    ("[[light]]\nposition = [0,0,0]\n", 1, &["light 1: kind", "point, spot, directional, environment"]),
    ("[[material]]\nname = \"a\"\nkind = \"velvet\"\n", 3, &["\"velvet\"", "diffuse_phong", "plastic"]),
    ("[[material]]\nname = \"a\"\nkind = \"diffuse\"\n", 1, &["albedo"]),
    ("[[material]]\nkind = \"null\"\n", 1, &["name"]),
    (
        "[[medium]]\nname = \"m\"\ndensity = \"fog.vol\"\n",
        3,
        &["medium 1: density", "\"fog.vol\"", ".vol file"],
    ),
    ("[[medium]]\nname = \"m\"\nbounds = [[0, 0, 0], [1, 1, 1]]\n", 3, &["bounds", "density or albedo_grid"]),
    (
        "[[medium]]\nname = \"m\"\ndensity = \"smoke.vol\"\nbounds = [0, 0, 0]\n",
        4,
        &["bounds", "two lists of 3 numbers"],
    ),
    ("[[material]]\nname = \"\"\nkind = \"null\"\n", 2, &["empty"]),
    (
        "[[material]]\nname = \"a\"\nkind = \"null\"\n[[material]]\nname = \"a\"\nkind = \"mirror\"\n",
        5,
        &["a second material \"a\""],
    ),
    ("[[material]]\nname = \"a\"\nkind = \"phong\"\nspecular = [0,0,0]\n", 1, &["exponent"]),
    ("[[material]]\nname = \"a\"\nkind = \"diffuse\"\ntexture = \"no.png\"\n", 4, &["texture", "\"no.png\""]),
    ("[[medium]]\nname = \"a\"\n[[medium]]\nname = \"a\"\n", 4, &["a second medium"]),
    ("[[medium]]\nname = \"a\"\nsigma_t = [1, 1, 1]\n", 3, &["unknown field \"sigma_t\"", "sigma_a"]),
];

#[test]
fn each_mistake_is_named_with_its_line() {
    for (text, line, words) in MISTAKES {
        let err = match parse(text) {
            Err(err) => err,
            Ok(_) => panic!("accepted:\n{text}"),
        };
        let message = err.to_string();
        assert_eq!(err.line, Some(*line), "{message}\n{text}");
        assert!(message.starts_with(&format!("s/scene.toml:{line}: ")), "{message}");
        assert!(!message.contains('\n'), "one sentence: {message}");
        for word in *words {
            assert!(message.contains(word), "no {word:?} in: {message}");
        }
    }
}

#[test]
fn letter_case_and_backslashes_of_nested_files_are_mended_and_said() {
    let source = MemorySource::new()
        .with("Maps/Wood.PNG", png())
        .with("room.OBJ", "mtllib Room.MTL\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n")
        .with("room.mtl", "newmtl a\nmap_Kd maps\\wood.png\n");
    let scene =
        parse_scene_toml("[[mesh]]\nfile = \"room.obj\"\n", Path::new("scene.toml"), &source).unwrap();
    let said: Vec<String> = scene.notes.iter().map(|n| n.to_string()).collect();
    assert_eq!(scene.desc.textures[0].name, "Maps/Wood.PNG");
    assert_eq!(said.iter().filter(|s| s.contains("letter case")).count(), 3, "{said:?}");
    assert!(said[0].starts_with("scene.toml:2: "), "{said:?}");
}

#[test]
fn a_mesh_without_textures_reads_no_bitmap() {
    let text = "[[mesh]]\nfile = \"quad.obj\"\ntextures = false\n";
    let scene = parse(text).unwrap();
    assert!(scene.desc.textures.is_empty());
    // Once any mesh of that file wants bitmaps they are read, and each mesh keeps its own choice.
    let scene = parse(&format!("{text}[[mesh]]\nfile = \"quad.obj\"\n")).unwrap();
    assert_eq!(scene.desc.textures.len(), 1);
    assert_eq!(scene.desc.materials.len(), 1);
    assert_eq!(scene.desc.meshes.iter().map(|m| m.textures).collect::<Vec<_>>(), [false, true]);
}

#[test]
fn a_bare_mesh_gets_a_camera_that_sees_it_and_a_sky_when_it_is_dark() {
    let cube = "v -1 -2 -3\nv 1 -2 -3\nv 1 2 3\nf 1 2 3\n";
    let source = MemorySource::new().with("cube.obj", cube);
    let scene = parse_mesh_scene(Path::new("cube.obj"), &source).unwrap();
    let camera = scene.desc.camera.unwrap();
    assert_eq!(camera.look_at, [0.0; 3]);
    // Every vertex lies within the frame: |y| <= distance * tan(20 degrees).
    for p in &scene.desc.meshes[0].positions {
        let ahead = camera.position[2] - p[2];
        assert!(ahead > 0.0);
        let reach = ahead * 20f32.to_radians().tan();
        assert!(p[0].abs() <= reach && p[1].abs() <= reach);
    }
    assert!(matches!(&scene.desc.lights[..], [LightDesc::Environment(e)] if e.radiance == [1.0; 3]));
    assert_eq!(scene.notes.len(), 2);

    let lit = parse_mesh_scene(Path::new("s/quad.obj"), &files()).unwrap();
    assert!(lit.desc.lights.is_empty(), "its faces emit");
    assert!(lit.notes.iter().all(|n| !n.message.contains("environment")));
}
