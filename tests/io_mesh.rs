//! OBJ, MTL and PLY: what they mean, and that defects are mended or named.
#![cfg(feature = "io")]
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use std::path::Path;
use std::time::{Duration, Instant};

use etendue::io::{
    MemorySource, Obj, load_scene, parse_mtl, parse_obj, parse_ply, parse_scene_toml, write_ply,
};
use etendue_core::scene::{MaterialKind, SceneDesc};

fn obj(text: &str) -> Obj {
    parse_obj(text.as_bytes(), Path::new("a.obj")).unwrap()
}

fn refused(text: &str) -> (Option<usize>, String) {
    let err = parse_obj(text.as_bytes(), Path::new("a.obj")).unwrap_err();
    (err.line, err.to_string())
}

/// Twice the area of all triangles, along +z.
fn area_z(o: &Obj) -> f64 {
    let p = |i: u32| o.positions[i as usize].map(f64::from);
    o.triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(p);
            (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        })
        .sum()
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn negative_indices_count_back_from_the_face() {
    let text = format!("{SQUARE}f -4 -3 -2\nv 9 9 9\nf -5 -3 -2\n");
    let o = obj(&text);
    assert_eq!(o.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(o.positions.len(), 4, "the vertex that no face uses is left out");
}

#[test]
fn equal_triples_share_a_vertex_and_others_do_not() {
    let text = format!(
        "{SQUARE}vt 0 0\nvt 1 1\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\nf 1/1/1 3/1/1 4/2/1\nf 1/2/1 2/1/1 3/1/1\n"
    );
    let o = obj(&text);
    assert_eq!(o.positions.len(), 5);
    assert_eq!((o.texcoords.len(), o.normals.len()), (5, 5));
    assert_eq!(o.texcoords[3], [1.0, 1.0]);
}

#[test]
fn concave_faces_are_clipped_not_fanned() {
    let o = obj("v 0 0 0\nv 4 -2 0\nv 1 0 0\nv 4 2 0\nf 1 2 3 4\n");
    assert_eq!((o.triangles.len(), area_z(&o)), (2, 4.0));
    let comb: String =
        (0..8).map(|i| format!("v {} {} 0\n", 15 - i, if i % 2 == 0 { 5 } else { 1 })).collect::<String>()
            + "v 0 0 0\nv 15 0 0\nf 1 2 3 4 5 6 7 8 9 10\n";
    let o = obj(&comb);
    assert_eq!(o.triangles.len(), 8);
    // Shoelace formula over the outline.
    let p: Vec<[f64; 2]> = (0..8)
        .map(|i| [f64::from(15 - i), if i % 2 == 0 { 5.0 } else { 1.0 }])
        .chain([[0.0, 0.0], [15.0, 0.0]])
        .collect();
    let expected: f64 = (0..10).map(|i| p[i][0] * p[(i + 1) % 10][1] - p[i][1] * p[(i + 1) % 10][0]).sum();
    assert!((area_z(&o) - expected).abs() <= 1e-9 * expected);
    assert!(o.notes.is_empty(), "{:?}", o.notes);
    let bow_tie = obj("v 0 0 0\nv 4 4 0\nv 4 0 0\nv 0 2 0\nf 1 2 3 4\n");
    assert!(bow_tie.notes[0].to_string().starts_with("a.obj:5: 1 faces that cross themselves"));
}

#[test]
fn what_is_no_surface_is_left_out_and_said() {
    let text = format!("{SQUARE}l 1 2 3\np 1\nf 1\nf 1 2\nf 1 1 2\nf 1 2 3\nusemtl none\n");
    let o = obj(&text);
    assert_eq!(o.triangles, [[0, 1, 2]]);
    let said: Vec<(Option<usize>, &str)> = o.notes.iter().map(|n| (n.line, n.message.as_str())).collect();
    assert_eq!(said.len(), 3, "{said:?}");
    assert!(said.contains(&(
        Some(5),
        "2 lines and points, left out because they are no surfaces (this is the first)"
    )));
    assert!(said.contains(&(Some(7), "2 faces with fewer than three corners, dropped (this is the first)")));
    assert!(said.contains(&(Some(9), "1 faces without area, dropped (this is the first)")));
}

#[test]
fn weights_and_colours_do_not_move_vertices() {
    let o = obj("v 1 2 3 0.5\nv 4 5 6 1 0 0\nv 0 0 9\nf 1 2 3\n");
    assert_eq!(o.positions, [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [0.0, 0.0, 9.0]]);
    assert_eq!(o.notes.len(), 2);
}

#[test]
fn blanks_comments_and_continued_lines_are_tolerated() {
    let text = "\u{feff}# c\n\tv 0 0 0 # origin\r\nv\t1 0 0\r\n  v 0 1 0\r\nusemtl   two words \r\nf 1 \\\r\n2 \\\r\n 3 # end\r\n";
    // A continued line ends in a backslash before CR LF.
    let o = obj(text);
    assert_eq!(o.triangles.len(), 1);
    assert_eq!(o.materials, [("two words".to_owned(), 5)]);
    assert_eq!(obj("v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r").triangles.len(), 1, "old line ends");
    assert_eq!(obj("").triangles.len(), 0);
}

#[test]
fn defects_are_refused_with_their_line() {
    for (text, line, words) in [
        ("v 0 0 0\nv nan 0 0\n", 2, vec!["vertex", "NaN", "finite"]),
        ("v 1e99 0 0\n", 1, vec!["inf"]),
        ("v 1 2\n", 1, vec!["2 numbers", "3 coordinates"]),
        ("v 1 2 1.#IND\n", 1, vec!["\"1.#IND\""]),
        (&format!("{SQUARE}f 0 1 2\n"), 5, vec!["face", "\"0\"", "count from 1"]),
        (&format!("{SQUARE}f 1/0 2/1 3/1\n"), 5, vec!["\"1/0\""]),
        (&format!("{SQUARE}\nf 1 2 5\n"), 6, vec!["vertex 5", "at most 4"]),
        (&format!("{SQUARE}f 1 2 -5\n"), 5, vec!["\"-5\""]),
        (&format!("{SQUARE}f 1 2 -9223372036854775808\n"), 5, vec!["negative"]),
        (&format!("{SQUARE}f 1 2 99999999999\n"), 5, vec!["vertex"]),
        (&format!("{SQUARE}f 1 2 99999999999999999999\n"), 5, vec!["v/vt/vn"]),
        (&format!("{SQUARE}f 1 2 x\n"), 5, vec!["\"x\""]),
        (&format!("{SQUARE}f 1/1/1/1 2 3\n"), 5, vec!["v/vt/vn"]),
    ] {
        let (at, message) = refused(text);
        assert_eq!(at, Some(line), "{message}");
        for word in words {
            assert!(message.contains(word), "no {word:?} in {message}");
        }
    }
}

#[test]
fn missing_normals_and_texture_coordinates_are_said_and_harmless() {
    let o = obj(&format!("{SQUARE}vn 0 0 1\nvn nan 0 0\nf 1//1 2//1 3//7\nf 1//1 3//2 4\n"));
    assert_eq!(o.normals, [[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0; 3], [0.0; 3], [0.0; 3]]);
    assert!(o.texcoords.is_empty());
    assert_eq!(o.notes.len(), 2);
}

#[test]
fn the_worst_polygons_take_less_than_a_second() {
    // A comb of as many corners as are accepted, and a star that crosses itself everywhere.
    let comb: Vec<(f64, f64)> = (0..4_998)
        .map(|i| (f64::from(i), if i % 2 == 0 { 1e3 } else { 1e-3 * f64::from(i) }))
        .chain([(4_999.0, -1.0), (-1.0, -1.0)])
        .rev()
        .collect();
    let star: Vec<(f64, f64)> = (0..4_999)
        .map(|i| {
            let a = f64::from(i) * 2_499.0 / 4_999.0 * std::f64::consts::TAU;
            (a.cos(), a.sin())
        })
        .collect();
    let noise: Vec<(f64, f64)> = (0..5_000u64)
        .map(|i| {
            let h = i.wrapping_mul(0x9e37_79b9_7f4a_7c15);
            ((h >> 40) as f64, (h & 0xff_ffff) as f64)
        })
        .collect();
    for (name, outline) in [("comb", comb), ("star", star), ("noise", noise)] {
        let mut text: String = outline.iter().map(|(x, y)| format!("v {x} {y} 0\n")).collect();
        text.push('f');
        for i in 1..=outline.len() {
            text += &format!(" {i}");
        }
        let start = Instant::now();
        let o = obj(&text);
        let took = start.elapsed();
        println!("{name}: {} triangles in {took:?}", o.triangles.len());
        assert!(took < Duration::from_secs(1), "{name} took {took:?}");
        if name != "comb" {
            // The budget is one of the file, not of the face.
            let face = text[text.find('f').unwrap()..].to_owned();
            let start = Instant::now();
            let (line, message) = refused(&format!("{text}\n{face}\n"));
            assert_eq!(line, Some(outline.len() + 2));
            assert!(message.contains("concave faces, expected at most"), "{message}");
            assert!(start.elapsed() < Duration::from_secs(1));
        }
    }
}

#[test]
fn a_second_reader_sees_the_same_triangles() {
    // A grid of triangles with shared and unshared attributes, in two materials.
    let mut text = String::from("mtllib m.mtl\n");
    for y in 0..12 {
        for x in 0..12 {
            text += &format!("v {x} {y} {}\nvt {} {}\n", (x * y) % 5, x as f32 / 11.0, y as f32 / 11.0);
        }
    }
    text += "vn 0 0 1\nvn 0 1 0\n";
    for y in 0..11 {
        text += &format!("usemtl {}\n", if y % 2 == 0 { "a" } else { "b" });
        for x in 0..11 {
            let (i, n) = (y * 12 + x + 1, 1 + x % 2);
            let c = |j: usize| format!("{j}/{j}/{n}");
            text += &format!("f {} {} {}\n", c(i), c(i + 1), c(i + 13));
            text += &format!("f {} {} {}\n", c(i), c(i + 13), c(i + 12));
        }
    }
    let ours = obj(&text);
    let (models, materials) = tobj::load_obj_buf(&mut text.as_bytes(), &tobj::GPU_LOAD_OPTIONS, |_| {
        tobj::load_mtl_buf(&mut "newmtl a\nnewmtl b\n".as_bytes())
    })
    .unwrap();
    let materials = materials.unwrap();
    let mut theirs = Vec::new();
    for model in &models {
        let m = &model.mesh;
        for corner in &m.indices {
            let i = *corner as usize;
            let position = [m.positions[3 * i], m.positions[3 * i + 1], m.positions[3 * i + 2]];
            let normal = [m.normals[3 * i], m.normals[3 * i + 1], m.normals[3 * i + 2]];
            let texcoord = [m.texcoords[2 * i], m.texcoords[2 * i + 1]];
            theirs.push((position, normal, texcoord, materials[m.material_id.unwrap()].name.clone()));
        }
    }
    let mut mine = Vec::new();
    for (t, m) in ours.triangles.iter().zip(&ours.face_materials) {
        for i in t.map(|i| i as usize) {
            let name = ours.materials[*m as usize].0.clone();
            mine.push((ours.positions[i], ours.normals[i], ours.texcoords[i], name));
        }
    }
    assert_eq!(mine.len(), 11 * 11 * 2 * 3);
    assert_eq!(mine, theirs);
}

#[test]
fn mtl_defects_are_refused_with_their_line() {
    for (text, line) in [
        ("newmtl a\nKd nan 0 0\n", 2),
        ("newmtl a\n\nKd 1 2\n", 3),
        ("newmtl a\nKs x y z\n", 2),
        ("newmtl a\nNs\n", 2),
        ("newmtl a\nNs inf\n", 2),
        ("newmtl a\nillum two\n", 2),
    ] {
        let err = parse_mtl(text.as_bytes(), Path::new("a.mtl")).unwrap_err();
        assert_eq!(err.line, Some(line), "{err}");
    }
    let mtl =
        parse_mtl(b"Kd 1 1 1\nnewmtl  a b\n Kd 0.5 # grey\nnewmtl a b\nbump x.png\n", Path::new("a.mtl"))
            .unwrap();
    assert_eq!(mtl.materials.len(), 1);
    assert_eq!((mtl.materials[0].name.as_str(), mtl.materials[0].kd), ("a b", Some([0.5; 3])));
    assert_eq!((mtl.notes.len(), mtl.other_maps), (1, true));
}

/// A scene of one triangle in material `m`, which `mtl` defines.
fn with_material(mtl: &str, mode: &str) -> (SceneDesc, Vec<String>) {
    let source = MemorySource::new()
        .with("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n")
        .with("a.mtl", format!("newmtl m\n{mtl}"));
    let text = format!("[[mesh]]\nfile = \"a.obj\"\nmtl = \"{mode}\"\n");
    let scene = parse_scene_toml(&text, Path::new("s.toml"), &source).unwrap();
    (scene.desc, scene.notes.iter().map(|n| n.to_string()).collect())
}

#[test]
fn materials_follow_the_mode() {
    let shiny = "Kd 0.5 0.5 0.5\nKs 0.25 0.25 0.75\nNs 20\nillum 2\n";
    let (d, notes) = with_material(shiny, "diffuse");
    assert!(matches!(&d.materials[0].kind, MaterialKind::Diffuse { albedo } if albedo.color == [0.5; 3]));
    assert!(d.materials[0].two_sided && notes.is_empty(), "{notes:?}");

    let (d, notes) = with_material(shiny, "full");
    match &d.materials[0].kind {
        MaterialKind::DiffusePhong { albedo, specular, exponent } => {
            assert_eq!((albedo.color, *specular, *exponent), ([0.5, 0.5, 0.4], [0.25, 0.25, 0.6], 20.0));
            assert!(albedo.color[2] + specular[2] <= 1.0);
        }
        other => panic!("{other:?}"),
    }
    assert!(notes[0].contains("scaled down to 1"), "{notes:?}");

    let kind = |mtl: &str| with_material(mtl, "full").0.materials[0].kind.clone();
    assert!(
        matches!(kind("Kd 0.1 0 0\nKs 0.5 0.5 0.5\nillum 3\n"), MaterialKind::Mirror { albedo } if albedo.color == [0.5; 3])
    );
    let glass = |n: f32| MaterialKind::Dielectric { ior: [n; 3], schlick: false };
    assert_eq!(kind("Kd 0.1 0 0\nillum 7\nNi 1.33\n"), glass(1.33));
    for wrong in ["", "Ni 0\n", "Ni -1\n", "Ni 1e9\n"] {
        assert_eq!(kind(&format!("Kd 0.1 0 0\nillum 4\n{wrong}")), glass(1.5), "{wrong}");
    }
    assert_eq!(
        kind("Kd 0 0 0\nKs 0.5 0.5 0.5\nNs 9\n"),
        MaterialKind::Phong { specular: [0.5; 3], exponent: 9.0 }
    );
    assert!(matches!(kind("Kd 0.5 0 0\n"), MaterialKind::Diffuse { .. }));

    let (d, notes) = with_material("Kd 2 0.5 -1\n", "diffuse");
    assert!(
        matches!(&d.materials[0].kind, MaterialKind::Diffuse { albedo } if albedo.color == [1.0, 0.5, 0.0])
    );
    assert!(notes[0].starts_with("a.mtl:1: ") && notes[0].contains("clamped"), "{notes:?}");
    let (_, notes) = with_material("Kd 1 1 1\nmap_Kd gone.png\nbump b.png\n", "diffuse");
    assert_eq!(notes.len(), 2, "{notes:?}");
    assert!(notes.iter().any(|n| n.starts_with("a.mtl:3: ") && n.contains("gone.png")));
}

#[test]
fn faces_without_a_known_material_use_the_default() {
    let mesh = |mtl: Option<&str>, uses: &str| {
        let mut source = MemorySource::new()
            .with("a.obj", format!("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n{uses}f 1 3 2\n"));
        if let Some(mtl) = mtl {
            source = source.with("a.mtl", mtl);
        }
        let scene = parse_scene_toml("[[mesh]]\nfile = \"a.obj\"\n", Path::new("s.toml"), &source).unwrap();
        let m = scene.desc.meshes[0].clone();
        (m.material_names, m.face_materials, scene.notes)
    };
    let (names, faces, notes) = mesh(None, "usemtl red\n");
    assert!(names.is_empty() && faces.is_empty());
    assert_eq!(notes.len(), 2, "the file and the name: {notes:?}");
    let (names, faces, notes) = mesh(Some("newmtl red\nKd 1 0 0\n"), "usemtl red # dark\n");
    assert_eq!(names, ["a.obj:(default)", "a.obj:red"]);
    assert_eq!((faces, notes.len()), (vec![0, 1], 0));
    let (names, _, notes) = mesh(Some("newmtl red\nKd 1 0 0\n"), "usemtl green\n");
    assert!(names.is_empty());
    assert!(notes[0].to_string().contains("\"green\""), "{notes:?}");
}

const PLY: &str = "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 5\nproperty float x\nproperty double y\n\
    property float z\nproperty float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\n\
    element face 2\nproperty list uchar int vertex_index\nproperty float weight\nend_header\n\
    0 0 0 0 0 1 0 0\n4 -2 0 0 0 1 1 0\n1 0 0 0 0 1 1 1\n4 2 0 0 0 1 0 1\n0 0 5 0 0 1 0 0\n\
    4 0 1 2 3 7.5\n3 0 1 4 2\n";

#[test]
fn ascii_ply_with_a_concave_face() {
    let (mesh, notes) = parse_ply(PLY.as_bytes(), Path::new("a.ply")).unwrap();
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (5, 3));
    assert_eq!((mesh.normals.len(), mesh.texcoords[2]), (5, [1.0, 1.0]));
    assert!(!mesh.triangles[..2].contains(&[0, 1, 3]), "no triangle across the notch");
    assert!(notes.is_empty());
}

/// The same triangle in both byte orders.
fn binary_ply(big: bool) -> Vec<u8> {
    let order = if big { "big" } else { "little" };
    let mut out = format!(
        "ply\nformat binary_{order}_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
         element face 1\nproperty list uchar uint vertex_indices\nend_header\n"
    )
    .into_bytes();
    for x in [0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 2.0, 0.0] {
        out.extend(if big { x.to_be_bytes() } else { x.to_le_bytes() });
    }
    out.push(3);
    for i in [0u32, 1, 2] {
        out.extend(if big { i.to_be_bytes() } else { i.to_le_bytes() });
    }
    out
}

#[test]
fn binary_ply_in_both_byte_orders() {
    let [big, little] = [true, false].map(|b| parse_ply(&binary_ply(b), Path::new("a.ply")).unwrap().0);
    assert_eq!(big, little);
    assert_eq!(big.positions[2], [0.0, 2.0, 0.0]);
    assert_eq!(big.triangles, [[0, 1, 2]]);
}

#[test]
fn bad_ply_is_refused() {
    let cases: &[(&str, String)] = &[
        ("at most", PLY.replace("element face 2", "element face 99999999999")),
        ("at most", PLY.replace("element face 2", "element void 18446744073709551615\nelement face 2")),
        ("vertex 9", PLY.replace("3 0 1 4 2", "3 0 1 9 2")),
        ("whole number", PLY.replace("3 0 1 4 2", "3 0 1 -4 2")),
        ("a.ply:20", PLY.replace("4 2 0 0 0 1 0 1", "4 inf 0 0 0 1 0 1")),
        ("not finite", PLY.replace("4 2 0 0 0 1 0 1", "4 1e999 0 0 0 1 0 1")),
        ("x, y and z", PLY.replace("property float x", "property float w")),
        ("vertices", PLY.replace("element vertex", "element point")),
        ("PLY", PLY[..PLY.len() - 12].to_owned()),
        ("PLY", "ply".into()),
    ];
    for (word, text) in cases {
        let start = Instant::now();
        let err = parse_ply(text.as_bytes(), Path::new("a.ply")).unwrap_err().to_string();
        assert!(err.contains(word), "no {word:?} in {err}");
        assert!(start.elapsed() < Duration::from_secs(1));
    }
}

#[test]
fn written_ply_reads_back_and_has_the_same_bytes_each_time() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.ply");
    let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.1]];
    let vertex = [("direct_r", vec![1.0, 2.0, 3.0]), ("nx", vec![0.0; 3])];
    let face = [("stderr", vec![0.5])];
    write_ply(&path, &positions, &[[0, 1, 2]], &vertex, &face).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    write_ply(&path, &positions, &[[0, 1, 2]], &vertex, &face).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), bytes);
    let (mesh, _) = parse_ply(&bytes, &path).unwrap();
    assert_eq!(mesh.positions, positions);
    assert_eq!(mesh.triangles, [[0, 1, 2]]);
    // Header, then 5 floats per vertex, then 1 + 12 + 4 bytes.
    let header = bytes.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
    assert_eq!(bytes.len(), header + 3 * 20 + 17);
    assert_eq!(bytes[header + 12..header + 16], 1f32.to_le_bytes());

    let scene = load_scene(&path).unwrap();
    assert_eq!(scene.desc.meshes[0].positions, positions);
    assert!(scene.desc.camera.is_some() && scene.desc.lights.len() == 1);

    for (vertex, face, triangles) in [
        (vec![("a", vec![1.0])], vec![], vec![[0, 1, 2]]),
        (vec![("x", vec![1.0; 3])], vec![], vec![]),
        (vec![("a b", vec![1.0; 3])], vec![], vec![]),
        (vec![], vec![], vec![[0, 1, 3]]),
    ] {
        assert!(write_ply(&path, &positions, &triangles, &vertex, &face).is_err());
    }
    assert_eq!(std::fs::read(&path).unwrap(), bytes, "a refused write leaves the file alone");
}
