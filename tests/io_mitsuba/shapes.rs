//! Shapes: where they are, where their front is, how textures lie on them.

use super::*;

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
