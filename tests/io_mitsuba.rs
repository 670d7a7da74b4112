//! Mitsuba scenes: what each element becomes, and that each mistake is named with its line.
#![cfg(feature = "io")]
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

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

#[test]
fn surfaces_have_the_defaults_of_the_format() {
    let (kind, two_sided) = material("");
    assert_eq!((color(&kind), two_sided), ([0.5; 3], false));
    let (kind, two_sided) = material("<bsdf type=\"diffuse\"/>");
    assert_eq!((color(&kind), two_sided), ([0.5; 3], false));
    let glass = 1.5046f64 / 1.000277;
    let (kind, two_sided) = material("<bsdf type=\"dielectric\"/>");
    assert_eq!(kind, MaterialKind::Dielectric { ior: [glass as f32; 3], schlick: false });
    assert!(two_sided);
    let (kind, _) = material("<bsdf type=\"thindielectric\"/>");
    assert_eq!(kind, MaterialKind::ThinDielectric { ior: [glass as f32; 3], schlick: false });
    let (kind, _) = material("<bsdf type=\"roughdielectric\"/>");
    let roughness = Roughness::Beckmann(0.1);
    assert_eq!(kind, MaterialKind::RoughDielectric { ior: [glass as f32; 3], schlick: false, roughness });
    let (kind, two_sided) = material("<bsdf type=\"conductor\"/>");
    assert_eq!((color(&kind), two_sided), ([1.0; 3], false));
    let (kind, two_sided) = material("<bsdf type=\"plastic\"/>");
    let MaterialKind::Plastic { ior, roughness: None, nonlinear: false, .. } = kind else { panic!() };
    assert!((ior - 1.49 / 1.000277).abs() < 1e-6 && !two_sided);
    let (kind, _) =
        material("<bsdf type=\"roughplastic\"><boolean name=\"nonlinear\" value=\"true\"/></bsdf>");
    let MaterialKind::Plastic { roughness: r, nonlinear: true, .. } = kind else { panic!() };
    assert_eq!(r, Some(Roughness::Beckmann(0.1)));
    assert_eq!(material("<bsdf type=\"null\"/>").0, MaterialKind::Null);
}

#[test]
fn surfaces_say_what_they_are() {
    let (kind, two_sided) = material(
        "<bsdf type=\"twosided\"><bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"0.1 0.2, 0.3\"/></bsdf></bsdf>",
    );
    assert_eq!((color(&kind), two_sided), ([0.1, 0.2, 0.3], true));
    for grey in ["rgb", "spectrum", "float"] {
        let (kind, _) =
            material(&format!("<bsdf type=\"diffuse\"><{grey} name=\"reflectance\" value=\"0.25\"/></bsdf>"));
        assert_eq!(color(&kind), [0.25; 3], "{grey}");
    }
    let (kind, _) = material(
        "<bsdf type=\"dielectric\"><string name=\"int_ior\" value=\"Water\"/><float name=\"ext_ior\" value=\"1\"/></bsdf>",
    );
    assert_eq!(kind, MaterialKind::Dielectric { ior: [1.333; 3], schlick: false });
    let (kind, _) = material(
        "<bsdf type=\"roughconductor\"><rgb name=\"eta\" value=\"1 2 3\"/><rgb name=\"k\" value=\"4\"/>\
         <string name=\"distribution\" value=\"ggx\"/><float name=\"alpha\" value=\"0.3\"/></bsdf>",
    );
    let roughness = Roughness::Ggx(0.3);
    assert_eq!(kind, MaterialKind::RoughConductor { eta: [1.0, 2.0, 3.0], k: [4.0; 3], roughness });
    let (kind, _) = material("<bsdf type=\"conductor\"><string name=\"material\" value=\"Au\"/></bsdf>");
    let MaterialKind::Conductor { eta, k } = kind else { panic!() };
    assert!(eta[0] < eta[2] && k[0] > k[2], "gold reflects red");
    let (kind, _) = material(
        "<bsdf type=\"conductor\"><string name=\"material\" value=\"none\"/><rgb name=\"specular_reflectance\" value=\"0.9\"/></bsdf>",
    );
    assert_eq!(kind, MaterialKind::Mirror { albedo: etendue_core::scene::Reflectance::flat([0.9; 3]) });
    // A rough metal that reflects everything.
    let (kind, _) = material("<bsdf type=\"roughconductor\"/>");
    let MaterialKind::RoughConductor { eta, k, .. } = kind else { panic!() };
    for degrees in 0..90 {
        let reflectance = conductor(f64::from(eta[0]), f64::from(k[0]), f64::from(degrees).to_radians());
        assert!(reflectance > 1.0 - 1e-6, "{degrees}: {reflectance}");
    }
}

/// Reflectance of unpolarised light by a metal (Born and Wolf, section 14.2), in complex arithmetic.
fn conductor(eta: f64, k: f64, angle: f64) -> f64 {
    let (s2, c) = (angle.sin().powi(2), angle.cos());
    let (re, im) = (eta * eta - k * k - s2, 2.0 * eta * k);
    let modulus = re.hypot(im);
    let (p, q) = (((modulus + re) / 2.0).max(0.0).sqrt(), ((modulus - re) / 2.0).max(0.0).sqrt());
    let rs = ((p - c).powi(2) + q * q) / ((p + c).powi(2) + q * q);
    let t = angle.sin() * angle.tan();
    let rp = rs * ((p - t).powi(2) + q * q) / ((p + t).powi(2) + q * q);
    0.5 * (rs + rp)
}

#[test]
fn what_cannot_be_rendered_the_same_is_refused() {
    for (inner, words) in [
        ("<shape type=\"serialized\"/>", "obj, ply, rectangle"),
        ("<shape type=\"rectangle\"><bsdf type=\"bumpmap\"/></shape>", "diffuse, dielectric"),
        ("<shape type=\"rectangle\"><bsdf type=\"mask\"/></shape>", "is not supported"),
        (
            "<shape type=\"rectangle\"><bsdf type=\"diffuse\"><float name=\"shine\" value=\"1\"/></bsdf></shape>",
            "shine: found <float>, expected what this version reads of it: reflectance",
        ),
        (
            "<shape type=\"rectangle\"><bsdf type=\"dielectric\"><rgb name=\"specular_transmittance\" value=\"0.5\"/></bsdf></shape>",
            "expected 1",
        ),
        (
            "<shape type=\"rectangle\"><bsdf type=\"diffuse\"><spectrum name=\"reflectance\" value=\"400:0.1, 700:0.2\"/></bsdf></shape>",
            "three colours",
        ),
        (
            "<shape type=\"rectangle\"><bsdf type=\"conductor\"><string name=\"material\" value=\"mithril\"/></bsdf></shape>",
            "eta and k",
        ),
        (
            "<shape type=\"rectangle\"><bsdf type=\"roughplastic\"><float name=\"alpha_u\" value=\"0.1\"/><float name=\"alpha_v\" value=\"0.2\"/></bsdf></shape>",
            "both directions",
        ),
        (
            "<shape type=\"rectangle\"><bsdf type=\"twosided\"><bsdf type=\"dielectric\"/></bsdf></shape>",
            "an opaque one",
        ),
        (
            "<bsdf type=\"twosided\" id=\"a\"><ref id=\"a\"/></bsdf><shape type=\"rectangle\"><ref id=\"a\"/></shape>",
            "go round",
        ),
        (
            "<shape type=\"sphere\"><transform name=\"to_world\"><scale x=\"2\"/></transform></shape>",
            "ellipsoid",
        ),
        ("<shape type=\"sphere\"><boolean name=\"flip_normals\" value=\"true\"/></shape>", "front is inside"),
        ("<shape type=\"disk\"><transform name=\"to_world\"><scale x=\"2\"/></transform></shape>", "ellipse"),
        (
            "<shape type=\"rectangle\"><transform name=\"to_world\"><scale z=\"0\"/></transform></shape>",
            "flattens",
        ),
        ("<shape type=\"rectangle\"><ref id=\"none\"/></shape>", "expected an id"),
        ("<shape type=\"rectangle\"><emitter type=\"point\"/></shape>", "area"),
        ("<shape type=\"obj\"/>", "no filename"),
        (
            "<shape type=\"obj\"><string name=\"filename\" value=\"no.obj\"/></shape>",
            "a file beside s/scene.xml",
        ),
        ("<emitter type=\"sunsky\"/>", "point, spot"),
        ("<emitter type=\"envmap\"><string name=\"filename\" value=\"wood.png\"/></emitter>", "EXR"),
        (
            "<integrator type=\"path\"><boolean name=\"hide_emitters\" value=\"true\"/></integrator>",
            "lights that are seen",
        ),
        (
            "<sensor type=\"perspective\"><transform name=\"to_world\"><scale x=\"-1\"/></transform></sensor>",
            "mirrored",
        ),
        (
            "<sensor type=\"perspective\"><transform name=\"to_world\"><scale value=\"2\"/></transform></sensor>",
            "scales",
        ),
        (
            "<sensor type=\"perspective\"><film type=\"hdrfilm\"><integer name=\"crop_width\" value=\"3\"/></film></sensor>",
            "cropped",
        ),
        ("<sensor type=\"orthographic\"/>", "perspective, thinlens"),
        ("<wonder/>", "<wonder>"),
    ] {
        let text = refusal(inner);
        assert!(text.starts_with("s/scene.xml:1: ") && text.contains(words), "{inner}\n{text}");
    }
}

#[test]
fn transforms_apply_in_the_order_of_the_file() {
    let center = |steps: &str| {
        let d = desc(&format!(
            "<shape type=\"sphere\"><point name=\"center\" x=\"1\" y=\"0\" z=\"0\"/><float name=\"radius\" value=\"0.5\"/>\
             <transform name=\"to_world\">{steps}</transform></shape>"
        ));
        match d.shapes[0].kind {
            ShapeKind::Sphere { center, radius } => (center, radius),
            _ => panic!(),
        }
    };
    let (scale, translate) = ("<scale value=\"2\"/>", "<translate x=\"1\" z=\"3\"/>");
    assert_eq!(center(""), ([1.0, 0.0, 0.0], 0.5));
    assert_eq!(center(&format!("{scale}{translate}")), ([3.0, 0.0, 3.0], 1.0));
    assert_eq!(center(&format!("{translate}{scale}")), ([4.0, 0.0, 6.0], 1.0));
    assert_eq!(center("<rotate z=\"1\" angle=\"90\"/>").0, [0.0, 1.0, 0.0]);
    assert_eq!(center("<rotate value=\"0 1 0\" angle=\"-90\"/>").0, [0.0, 0.0, 1.0]);
    let (turned, _) = center("<rotate x=\"1\" y=\"1\" z=\"1\" angle=\"120\"/>");
    assert!(near(turned, [0.0, 1.0, 0.0]), "{turned:?}");
    assert_eq!(center("<matrix value=\"0 -1 0 7, 1 0 0 8, 0 0 1 9, 0 0 0 1\"/>").0, [7.0, 9.0, 9.0]);
    assert_eq!(center("<matrix value=\"0 -1 0 1 0 0 0 0 1\"/>").0, [0.0, 1.0, 0.0]);
    // Of a camera: +z looks at the target, +x is on the left.
    let look = "<lookat origin=\"0, 0, 5\" target=\"0 0 0\" up=\"0 1 0\"/>";
    assert_eq!(center(look).0, [-1.0, 0.0, 5.0]);
}

#[test]
fn fronts_are_where_normals_point() {
    let kind = |shape: &str, inner: &str| {
        desc(&format!("<shape type=\"{shape}\">{inner}</shape>")).shapes[0].kind.clone()
    };
    let scale = |s: &str| format!("<transform name=\"to_world\"><scale {s}/></transform>");
    let flip = "<boolean name=\"flip_normals\" value=\"true\"/>";
    for (inner, expected) in [
        (String::new(), 1.0),
        (flip.to_owned(), -1.0),
        (scale("x=\"-1\""), 1.0),
        (scale("z=\"-1\""), -1.0),
        (format!("{flip}{}", scale("z=\"-1\"")), 1.0),
    ] {
        let ShapeKind::Rectangle { u, v, .. } = kind("rectangle", &inner) else { panic!() };
        assert_eq!(cross(u, v), [0.0, 0.0, expected], "rectangle {inner}");
        let ShapeKind::Disk { normal, radius, .. } = kind("disk", &inner) else { panic!() };
        assert_eq!((normal, radius), ([0.0, 0.0, expected], 1.0), "disk {inner}");
    }
    let ShapeKind::Disk { radius, .. } = kind("disk", &scale("x=\"2\" y=\"2\" z=\"7\"")) else { panic!() };
    assert_eq!(radius, 2.0);
    // A cube's front is outside, whatever mirrors it; its volume by the divergence theorem tells.
    for (inner, expected) in [
        (String::new(), 8.0),
        (scale("x=\"-1\" y=\"2\""), 16.0),
        (flip.to_owned(), -8.0),
        (format!("{}<boolean name=\"face_normals\" value=\"true\"/>", scale("x=\"-1\"")), -8.0),
    ] {
        let d = desc(&format!("<shape type=\"cube\">{inner}</shape>"));
        let mesh = &d.meshes[0];
        assert_eq!((mesh.positions.len(), mesh.triangles.len()), (24, 12));
        let volume: f32 = mesh
            .triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
                let n = cross(b, c);
                (a[0] * n[0] + a[1] * n[1] + a[2] * n[2]) / 6.0
            })
            .sum();
        assert!((volume - expected).abs() < 1e-5, "{inner}: {volume}");
    }
}

#[test]
fn meshes_shade_as_the_format_says() {
    let mesh = |name: &str, inner: &str| {
        let shape =
            format!("<shape type=\"obj\"><string name=\"filename\" value=\"{name}\"/>{inner}</shape>");
        desc(&shape).meshes[0].clone()
    };
    let mirror = "<transform name=\"to_world\"><scale x=\"-1\"/></transform>";
    let flip = "<boolean name=\"flip_normals\" value=\"true\"/>";
    let faces = "<boolean name=\"face_normals\" value=\"true\"/>";
    // Flat without normals: geometric, and a mirror turns the front round (compile keeps sides, so corners turn).
    let flat = mesh("quad.obj", "");
    assert!(!flat.shading_normals && flat.normals.is_empty() && flat.texcoords.is_empty());
    let turned: Vec<[u32; 3]> = flat.triangles.iter().map(|t| [t[0], t[2], t[1]]).collect();
    assert_eq!(mesh("quad.obj", mirror).triangles, turned);
    assert_eq!(mesh("quad.obj", flip).triangles, turned);
    // Normals of the file keep their side.
    let with = mesh("normals.obj", mirror);
    assert!(with.shading_normals);
    assert_eq!((&with.triangles, with.normals[0]), (&flat.triangles, [0.0, 0.0, 1.0]));
    assert_eq!(mesh("normals.obj", flip).normals[0], [0.0, 0.0, -1.0]);
    let without = mesh("normals.obj", faces);
    assert!(!without.shading_normals && without.normals.is_empty());
    // Bent and without normals: smooth ones by angle (values of Mitsuba 3.9.1).
    let tent = mesh("tent.obj", "");
    assert!(tent.shading_normals);
    let expected = [
        [0.0, 0.438_112, 0.898_921],
        [0.0, 0.438_112, 0.898_921],
        [0.0, -std::f32::consts::FRAC_1_SQRT_2, std::f32::consts::FRAC_1_SQRT_2],
        [0.0, 0.948_683, 0.316_228],
    ];
    for (n, e) in tent.normals.iter().zip(expected) {
        assert!(near(*n, e), "{n:?} {e:?}");
    }
    assert!(mesh("tent.obj", faces).normals.is_empty());
}

#[test]
fn textures_lie_as_in_the_format() {
    let shape = |kind: &str, file: &str, texture: &str| {
        desc(&format!(
            "<shape type=\"{kind}\">{file}<bsdf type=\"diffuse\"><texture name=\"reflectance\" {texture}</texture></bsdf></shape>"
        ))
    };
    let bitmap = "type=\"bitmap\"><string name=\"filename\" value=\"wood.png\"/>";
    let quad = "<string name=\"filename\" value=\"quad.obj\"/>";
    // Exporters of OBJ and this program agree that v points up.
    let d = shape("obj", quad, bitmap);
    assert_eq!(d.textures.len(), 1);
    assert_eq!(d.meshes[0].texcoords, [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    let MaterialKind::Diffuse { albedo } = &d.materials[0].kind else { panic!() };
    assert_eq!((albedo.color, albedo.texture.as_str()), ([1.0; 3], "wood.png"));
    let unflipped = format!("{quad}<boolean name=\"flip_tex_coords\" value=\"false\"/>");
    assert_eq!(shape("obj", &unflipped, bitmap).meshes[0].texcoords[0], [0.0, 1.0]);
    // On a rectangle the top row lies at its lower edge.
    let d = shape("rectangle", "", bitmap);
    assert_eq!(d.meshes[0].positions[0], [-1.0, -1.0, 0.0]);
    assert_eq!(d.meshes[0].texcoords, [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]]);
    let twice = format!("{bitmap}<transform name=\"to_uv\"><scale x=\"2\" y=\"2\"/></transform>");
    assert_eq!(shape("rectangle", "", &twice).meshes[0].texcoords[2], [2.0, -1.0]);
    // A checker counts v as the format does: an OBJ's v is turned over.
    let checker = "type=\"checkerboard\"><rgb name=\"color0\" value=\"1 0 0\"/><transform name=\"to_uv\"><scale x=\"4\" y=\"8\"/></transform>";
    let d = shape("obj", quad, checker);
    let MaterialKind::Diffuse { albedo } = &d.materials[0].kind else { panic!() };
    let pattern = albedo.checker.unwrap();
    assert_eq!((pattern.colors, pattern.repeat), ([[1.0, 0.0, 0.0], [0.2; 3]], [4.0, 8.0]));
    assert_eq!(d.meshes[0].texcoords, [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]]);
    assert_eq!(shape("rectangle", "", checker).meshes[0].texcoords[2], [1.0, 1.0]);
    let moved = "type=\"checkerboard\"><transform name=\"to_uv\"><translate x=\"0.25\"/></transform>";
    let d = shape("rectangle", "", moved);
    assert_eq!(d.meshes[0].texcoords[0], [0.25, 0.0]);
    for (kind, texture, words) in [
        ("sphere", bitmap, "a texture on a sphere"),
        ("disk", bitmap, "a texture on a disk"),
        ("rectangle", "type=\"bitmap\"><string name=\"filename\" value=\"no.png\"/>", "no.png"),
        (
            "rectangle",
            "type=\"bitmap\"><string name=\"filename\" value=\"wood.png\"/><boolean name=\"raw\" value=\"true\"/>",
            "raw",
        ),
        (
            "rectangle",
            "type=\"bitmap\"><string name=\"filename\" value=\"wood.png\"/><string name=\"wrap_mode\" value=\"mirror\"/>",
            "repeat",
        ),
        ("rectangle", "type=\"volume\">", "bitmap, checkerboard"),
    ] {
        let text = refusal(&format!(
            "<shape type=\"{kind}\"><bsdf type=\"diffuse\"><texture name=\"reflectance\" {texture}</texture></bsdf></shape>"
        ));
        assert!(text.contains(words), "{text}");
    }
}

#[test]
fn cameras_see_what_the_format_sees() {
    let camera = |inner: &str, film: &str| {
        let text =
            format!("<sensor type=\"perspective\">{inner}<film type=\"hdrfilm\">{film}</film></sensor>");
        desc(&text).camera.unwrap()
    };
    let size = "<integer name=\"width\" value=\"400\"/><integer name=\"height\" value=\"300\"/>";
    // What Mitsuba 3.9.1 says its horizontal field of view is.
    for (axis, expected) in
        [("x", 40.0), ("y", 51.774_01), ("smaller", 51.774_01), ("larger", 40.0), ("diagonal", 32.468_605)]
    {
        let fov = format!("<float name=\"fov\" value=\"40\"/><string name=\"fov_axis\" value=\"{axis}\"/>");
        let x = camera(&fov, size).fov_x_deg;
        assert!((x - expected).abs() < 1e-4, "{axis}: {x}");
    }
    assert!((camera("", size).fov_x_deg - 38.184_84).abs() < 1e-4, "a lens of 50 mm");
    let c = camera("", "");
    assert_eq!(
        (c.resolution, c.position, c.look_at, c.up),
        ([768, 576], [0.0; 3], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0])
    );
    let c = camera(
        "<transform name=\"to_world\"><lookat origin=\"1 2 -9\" target=\"1 2 3\" up=\"0 1 0\"/></transform>",
        size,
    );
    assert_eq!(
        (c.position, c.look_at, c.up, c.resolution),
        ([1.0, 2.0, -9.0], [1.0, 2.0, 0.0], [0.0, 1.0, 0.0], [400, 300])
    );
    assert_eq!((c.lens_radius, c.medium.as_str()), (0.0, ""));
    let d = desc(
        "<medium type=\"homogeneous\" id=\"fog\"/><sensor type=\"thinlens\"><float name=\"fov\" value=\"30\"/>\
         <float name=\"aperture_radius\" value=\"0.1\"/><float name=\"focus_distance\" value=\"7\"/>\
         <ref id=\"fog\"/><sampler type=\"independent\"/></sensor>",
    );
    let c = d.camera.unwrap();
    assert_eq!((c.lens_radius, c.focus_distance, c.medium.as_str()), (0.1, 7.0, "fog"));
    let scene = parse(
        "<sensor type=\"perspective\"><film type=\"hdrfilm\"><rfilter type=\"box\"/></film></sensor>\n\
         <sensor type=\"perspective\"/>\n<integrator type=\"moment\"><integrator type=\"volpath\">\
         <integer name=\"max_depth\" value=\"12\"/><integer name=\"rr_depth\" value=\"5\"/></integrator></integrator>",
    )
    .unwrap();
    assert_eq!(scene.max_depth, Some(12));
    let notes: Vec<String> = scene.notes.iter().map(ToString::to_string).collect();
    assert_eq!(notes.len(), 2, "{notes:?}");
    assert!(notes[0].starts_with("s/scene.xml:2: 2 sensors"), "{notes:?}");
    assert!(notes[1].contains("--max-depth 12"), "{notes:?}");
}

#[test]
fn media_are_by_extinction_and_albedo() {
    let medium = |inner: &str| {
        let d = desc(&format!(
            "<shape type=\"cube\"><medium name=\"interior\" {inner}</medium><bsdf type=\"null\"/></shape>"
        ));
        assert_eq!(d.meshes[0].interior, d.media[0].name);
        d.media[0].clone()
    };
    let m = medium("type=\"homogeneous\">");
    assert_eq!((m.sigma_s, m.sigma_a, m.g), ([0.75; 3], [0.25; 3], 0.0));
    let m = medium(
        "type=\"homogeneous\"><float name=\"scale\" value=\"2\"/><rgb name=\"sigma_t\" value=\"1 2 4\"/>\
         <rgb name=\"albedo\" value=\"0.5\"/><phase type=\"hg\"><float name=\"g\" value=\"-0.25\"/></phase>",
    );
    assert_eq!((m.sigma_s, m.sigma_a, m.g), ([1.0, 2.0, 4.0], [1.0, 2.0, 4.0], -0.25));
    let grid = |name: &str, file: &str, more: &str| {
        format!(
            "<volume name=\"{name}\" type=\"gridvolume\"><string name=\"filename\" value=\"{file}\"/>{more}</volume>"
        )
    };
    let m = medium(&format!(
        "type=\"heterogeneous\"><float name=\"scale\" value=\"8\"/>{}",
        grid("sigma_t", "smoke.vol", "")
    ));
    let density = m.density.unwrap();
    assert_eq!((m.sigma_s, m.sigma_a), ([6.0; 3], [2.0; 3]));
    assert_eq!((density.size, density.channels, density.values), ([2, 1, 1], 1, vec![0.25, 0.75]));
    assert_eq!(density.to_world, [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]);
    // The bounds of the file, then to_world.
    let placed = "<boolean name=\"use_grid_bbox\" value=\"true\"/><transform name=\"to_world\"><scale value=\"2\"/></transform>";
    let m = medium(&format!(
        "type=\"heterogeneous\">{}{}",
        grid("sigma_t", "smoke.vol", placed),
        grid("albedo", "tint.vol", "")
    ));
    assert_eq!(
        m.density.unwrap().to_world,
        [[8.0, 0.0, 0.0, -2.0], [0.0, 2.0, 0.0, 0.0], [0.0, 0.0, 4.0, 0.0]]
    );
    assert_eq!(m.albedo.unwrap().channels, 3);
    assert_eq!((m.sigma_a, m.sigma_s), ([1.0; 3], [0.0; 3]));
    // Written out twice, it is one.
    let fog = |side: &str| {
        format!("<shape type=\"rectangle\"><medium name=\"{side}\" type=\"homogeneous\"/></shape>")
    };
    let d = desc(&format!("{}{}", fog("interior"), fog("exterior")));
    assert_eq!((d.media.len(), &d.shapes[0].interior), (1, &d.shapes[1].exterior));
    for (inner, words) in [
        ("type=\"homogeneous\"><phase type=\"rayleigh\"/>".to_owned(), "isotropic, hg"),
        (format!("type=\"homogeneous\">{}", grid("sigma_t", "smoke.vol", "")), "the same everywhere"),
        (format!("type=\"heterogeneous\">{}", grid("sigma_t", "short.vol", "")), "s/short.vol: is damaged"),
        (format!("type=\"heterogeneous\">{}", grid("sigma_t", "quad.obj", "")), "VOL"),
        (format!("type=\"heterogeneous\">{}", grid("emission", "smoke.vol", "")), "emission"),
        ("type=\"homogeneous\"><rgb name=\"sigma_s\" value=\"1\"/>".to_owned(), "sigma_t"),
    ] {
        let text =
            refusal(&format!("<shape type=\"cube\"><medium name=\"interior\" {inner}</medium></shape>"));
        assert!(text.contains(words), "{text}");
    }
}

#[test]
fn lights_are_where_and_what_the_file_says() {
    let light = |inner: &str| desc(&format!("<emitter {inner}</emitter>")).lights[0].clone();
    let look =
        "<transform name=\"to_world\"><lookat origin=\"1 2 3\" target=\"1 2 9\" up=\"0 1 0\"/></transform>";
    let point =
        "type=\"point\"><point name=\"position\" value=\"1 2 3\"/><rgb name=\"intensity\" value=\"4\"/>";
    assert_eq!(light(point), LightDesc::Point { position: [1.0, 2.0, 3.0], intensity: [4.0; 3] });
    let LightDesc::Spot { position, direction, cone_deg, falloff_deg, intensity } =
        light(&format!("type=\"spot\">{look}"))
    else {
        panic!()
    };
    assert_eq!((position, direction, intensity), ([1.0, 2.0, 3.0], [0.0, 0.0, 1.0], [1.0; 3]));
    assert_eq!((cone_deg, falloff_deg), (20.0, 15.0));
    let noted = parse("<emitter type=\"spot\"/>").unwrap().notes;
    assert!(noted[0].message.contains("smooth step"), "{noted:?}");
    let sun = "type=\"directional\"><vector name=\"direction\" x=\"0\" y=\"-2\" z=\"0\"/><rgb name=\"irradiance\" value=\"3\"/>";
    assert_eq!(light(sun), LightDesc::Directional { direction: [0.0, -1.0, 0.0], irradiance: [3.0; 3] });
    let LightDesc::Environment(sky) = light("type=\"constant\">") else { panic!() };
    assert_eq!((sky.radiance, sky.image), ([1.0; 3], None));
    let picture = |transform: &str| {
        let text = format!(
            "type=\"envmap\"><string name=\"filename\" value=\"sky.exr\"/><float name=\"scale\" value=\"2\"/>{transform}"
        );
        let LightDesc::Environment(sky) = light(&text) else { panic!() };
        assert_eq!(sky.radiance, [2.0; 3]);
        sky.image.unwrap()
    };
    // Where each column looks: the middle of the picture is at -z of its axes, and a quarter to the right is +x.
    let world =
        |to_world: [[f32; 3]; 3], d: [f32; 3]| to_world.map(|r| r[0] * d[0] + r[1] * d[1] + r[2] * d[2]);
    let plain = picture("");
    assert_eq!((plain.width, plain.height, plain.texels[1]), (2, 3, [1.0, 1.0, 0.5]));
    // Mitsuba 3.9.1: without a transform the middle column is at +z and three quarters along is -x.
    assert_eq!(world(plain.to_world, [0.0, 0.0, -1.0]), [0.0, 0.0, 1.0]);
    assert_eq!(world(plain.to_world, [1.0, 0.0, 0.0]), [-1.0, 0.0, 0.0]);
    // Turned by 90 degrees about y, the middle column is at +x.
    let turned = picture("<transform name=\"to_world\"><rotate y=\"1\" angle=\"90\"/></transform>");
    assert_eq!(world(turned.to_world, [0.0, 0.0, -1.0]), [1.0, 0.0, 0.0]);
    // Mirrored: columns change places, and the rest is a rotation; three quarters along the old picture is now +x.
    let mirrored = picture("<transform name=\"to_world\"><scale x=\"-1\"/></transform>");
    assert_eq!(mirrored.texels[0], plain.texels[1]);
    assert_eq!(world(mirrored.to_world, [0.0, 0.0, -1.0]), [0.0, 0.0, 1.0]);
    assert_eq!(world(mirrored.to_world, [-1.0, 0.0, 0.0]), [1.0, 0.0, 0.0]);
    // A light on a shape; one surface with and without light is two materials.
    let d = desc(
        "<bsdf type=\"diffuse\" id=\"white\"/><emitter type=\"area\" id=\"lamp\"><rgb name=\"radiance\" value=\"1 2 3\"/></emitter>\
         <shape type=\"sphere\"><ref id=\"white\"/><ref id=\"lamp\"/></shape><shape type=\"disk\"><ref id=\"white\"/></shape>\
         <shape type=\"disk\"><emitter type=\"area\"/></shape>",
    );
    assert_eq!(d.lights.len(), 0);
    let seen: Vec<(&str, [f32; 3], [f32; 3])> =
        d.materials.iter().map(|m| (m.name.as_str(), m.emission, color(&m.kind))).collect();
    assert_eq!(
        seen,
        [
            ("white (light)", [1.0, 2.0, 3.0], [0.5; 3]),
            ("white", [0.0; 3], [0.5; 3]),
            ("black (light)", [1.0; 3], [0.0; 3])
        ]
    );
}
