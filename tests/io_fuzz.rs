//! Random and mutated bytes: readers return, whatever they are given. `PROPTEST_CASES=50000` for a long run.
#![cfg(feature = "io")]

use std::path::Path;

use etendue::io::{
    MemorySource, parse_exr, parse_mesh_scene, parse_mtl, parse_obj, parse_operator, parse_ply, parse_points,
    parse_scene_toml, parse_texture, parse_vol,
};
use proptest::prelude::*;

const OBJ: &str = "mtllib a.mtl\nv 0 0 0\nv 1 0 0 1\nv 1 1 0 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nusemtl m\ng x\ns 1\n\
    f 1/1/1 2/1/1 3/1/1\nf -4 -3 -2 -1\nf 1//1 2//1 3 4\nl 1 2\nv 0.3 0.5 \\\n 0\nf 1 2 5 3 4\n";
const MTL: &str =
    "newmtl m\nKd 0.5 0.5 0.5\nKs 0.1 0.1 0.1\nNs 20\nKe 1 1 1\nillum 2\nmap_Kd -o 0 1 -bm 2 a b.png\n";
const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
    element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";
const TOML: &str = "version = 1\n[camera]\nposition = [0, 0, 0]\nlook_at = [0, 0, 1]\nfov_x_deg = 40\n\
    [[mesh]]\nfile = \"a.obj\"\nscale = 2\n[[shape]]\nkind = \"box\"\nmin = [0, 0, 0]\nmax = [1, 1, 1]\n\
    [[light]]\nkind = \"point\"\nposition = [0, 0, 0]\nintensity = [1, 1, 1]\n\
    [[material]]\nname = \"m\"\nkind = \"phong\"\nspecular = [0, 0, 0]\nexponent = 1\n\
    [[medium]]\nname = \"fog\"\ng = 0.5\n";
const POINTS: &str = "{\"probes\": [{\"position\": [1, 2, 3], \"normal\": [0, 1, 0], \"E\": [1, 1, 1]}]}";

/// Feeds bytes to every reader; they decide for themselves what to make of them.
fn read_all(bytes: &[u8]) {
    let file = Path::new("a.obj");
    let source = MemorySource::new().with("a.obj", bytes).with("a.mtl", bytes).with("a b.png", bytes);
    let _ = parse_obj(bytes, file);
    let _ = parse_mtl(bytes, file);
    let _ = parse_ply(bytes, file);
    let _ = parse_points(bytes, file);
    let _ = parse_exr(bytes, file);
    let _ = parse_operator(bytes, file);
    let _ = parse_vol(bytes, file);
    let _ = parse_texture(bytes, "t", file);
    let _ = parse_mesh_scene(file, &source);
    let _ = parse_scene_toml(&String::from_utf8_lossy(bytes), Path::new("s.toml"), &source);
    // Good files around a bad one.
    let with = |name: &str| {
        let base = MemorySource::new().with("a.obj", OBJ).with("a.mtl", MTL);
        let _ = parse_scene_toml(TOML, Path::new("s.toml"), &base.with(name, bytes));
    };
    with("a.obj");
    with("a.mtl");
    with("a b.png");
}

/// One edit of a text: a byte replaced, a word inserted, a piece cut or doubled.
#[derive(Clone, Debug)]
enum Edit {
    Byte(usize, u8),
    Word(usize, &'static str),
    Cut(usize, usize),
    Double(usize, usize),
}

const WORDS: &[&str] = &[
    " ",
    "\n",
    "0",
    "-1",
    "99999999999999999999",
    "-9223372036854775808",
    "nan",
    "inf",
    "1e999",
    "1e-999",
    "/",
    "//",
    "\\\n",
    "#",
    "[",
    "[[",
    "]",
    "=",
    "\"",
    "-o",
    "f ",
    "v ",
    "usemtl ",
    "mtllib ",
    "newmtl ",
    "\u{fffd}",
    "\0",
    "4294967295",
];

fn edit() -> impl Strategy<Value = Edit> {
    prop_oneof![
        (any::<usize>(), any::<u8>()).prop_map(|(i, b)| Edit::Byte(i, b)),
        (any::<usize>(), prop::sample::select(WORDS)).prop_map(|(i, w)| Edit::Word(i, w)),
        (any::<usize>(), 0usize..40).prop_map(|(i, n)| Edit::Cut(i, n)),
        (any::<usize>(), 0usize..40).prop_map(|(i, n)| Edit::Double(i, n)),
    ]
}

fn apply(mut bytes: Vec<u8>, edits: &[Edit]) -> Vec<u8> {
    for e in edits {
        if bytes.is_empty() {
            break;
        }
        let n = bytes.len();
        match *e {
            Edit::Byte(i, b) => bytes[i % n] = b,
            Edit::Word(i, w) => drop(bytes.splice(i % n..i % n, w.bytes())),
            Edit::Cut(i, k) => drop(bytes.drain(i % n..(i % n + k).min(n))),
            Edit::Double(i, k) => {
                let piece = bytes[i % n..(i % n + k).min(n)].to_vec();
                drop(bytes.splice(i % n..i % n, piece));
            }
        }
    }
    bytes
}

/// Small files of the binary formats.
fn binary() -> Vec<Vec<u8>> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a");
    let image = etendue::io::RenderImage {
        width: 3,
        height: 2,
        radiance: vec![[0.5; 3]; 6],
        metadata: "{}".into(),
        ..Default::default()
    };
    etendue::io::write_exr(&path, &image).unwrap();
    let exr = std::fs::read(&path).unwrap();
    etendue::io::write_png(&path, 3, 2, &[[9; 3]; 6]).unwrap();
    let png = std::fs::read(&path).unwrap();
    etendue::io::write_ply(&path, &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]], &[], &[])
        .unwrap();
    let ply = std::fs::read(&path).unwrap();
    let operator = std::fs::read("fuzz/seeds/operator_file/tiny.etd").unwrap();
    let bounds = [[0.0; 3], [1.0; 3]];
    let volume = etendue::io::Volume { size: [2, 2, 1], channels: 1, bounds, values: vec![0.5; 4] };
    let vol = etendue::io::encode_vol(&volume, &path).unwrap();
    vec![exr, png, ply, operator, vol]
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_bytes_do_no_harm(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        read_all(&bytes);
    }

    #[test]
    fn random_text_does_no_harm(text in "[ -~\n]{0,300}") {
        read_all(text.as_bytes());
    }

    #[test]
    fn mutated_text_files_do_no_harm(
        which in 0usize..5,
        edits in prop::collection::vec(edit(), 1..8),
    ) {
        let seed = [OBJ, MTL, PLY, TOML, POINTS][which];
        read_all(&apply(seed.into(), &edits));
    }

    #[test]
    fn mutated_binary_files_do_no_harm(
        which in 0usize..5,
        edits in prop::collection::vec(edit(), 1..6),
    ) {
        static SEEDS: std::sync::OnceLock<Vec<Vec<u8>>> = std::sync::OnceLock::new();
        read_all(&apply(SEEDS.get_or_init(binary)[which].clone(), &edits));
    }

    #[test]
    fn triangles_of_any_polygon_refer_to_its_corners(
        corners in prop::collection::vec((-50i32..50, -50i32..50, -1i32..2), 3..40),
    ) {
        let mut text: String = corners.iter().map(|(x, y, z)| format!("v {x} {y} {z}\n")).collect();
        text += "f";
        for i in 1..=corners.len() {
            text += &format!(" {i}");
        }
        let obj = parse_obj(text.as_bytes(), Path::new("a.obj")).unwrap();
        prop_assert!(obj.triangles.len() <= corners.len() - 2);
        for t in &obj.triangles {
            prop_assert!(t.iter().all(|i| (*i as usize) < obj.positions.len()));
        }
    }
}

#[test]
fn the_seeds_themselves_are_good() {
    let source = MemorySource::new().with("a.obj", OBJ).with("a.mtl", MTL);
    let scene = parse_scene_toml(TOML, Path::new("s.toml"), &source).unwrap();
    assert_eq!(scene.desc.meshes[0].triangles.len(), 1 + 2 + 2 + 3);
    assert_eq!(parse_ply(PLY.as_bytes(), Path::new("a.ply")).unwrap().0.triangles.len(), 2);
    assert_eq!(parse_points(POINTS.as_bytes(), Path::new("a.json")).unwrap().len(), 1);
}
