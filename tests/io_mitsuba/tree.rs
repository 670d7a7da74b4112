//! Mitsuba scenes as XML: parameters, includes, identifiers, old versions, limits and broken bytes.

use std::path::Path;

use etendue::io::{LoadError, LoadedScene, MemorySource, MitsubaOptions, load_scene, parse_scene_mitsuba};
use etendue_core::scene::{MaterialKind, ShapeKind};
use proptest::prelude::*;

fn parse_in(source: &MemorySource, text: &str, options: &MitsubaOptions) -> Result<LoadedScene, LoadError> {
    parse_scene_mitsuba(text.as_bytes(), Path::new("s/scene.xml"), source, options)
}

fn parse(text: &str) -> Result<LoadedScene, LoadError> {
    parse_in(&MemorySource::new(), text, &MitsubaOptions::default())
}

fn scene(inner: &str) -> String {
    format!("<scene version=\"3.0.0\">{inner}</scene>")
}

fn radius(scene: &LoadedScene) -> f32 {
    match scene.desc.shapes[0].kind {
        ShapeKind::Sphere { radius, .. } => radius,
        _ => panic!(),
    }
}

const SPHERE: &str = "<shape type=\"sphere\"><float name=\"radius\" value=\"$r\"/></shape>";

#[test]
fn the_first_value_of_a_name_counts() {
    let text = scene(&format!(
        "<default name=\"r\" value=\"2\"/><default name=\"r\" value=\"3\"/><default name=\"ra\" value=\"9\"/>{SPHERE}"
    ));
    assert_eq!(radius(&parse(&text).unwrap()), 2.0);
    let options = MitsubaOptions { parameters: vec![("r".into(), "5".into())], ..MitsubaOptions::default() };
    assert_eq!(radius(&parse_in(&MemorySource::new(), &text, &options).unwrap()), 5.0);
    // The longest name that fits, and names within values of names.
    let text = scene(&format!(
        "<default name=\"b\" value=\"1\"/><default name=\"bb\" value=\"4\"/><default name=\"r\" value=\"$bb$b\"/>{SPHERE}"
    ));
    assert_eq!(radius(&parse(&text).unwrap()), 41.0);
    let e = parse(&format!("<scene version=\"3.0.0\">\n\n{SPHERE}</scene>")).unwrap_err();
    let expected = "s/scene.xml:3: <float>: found \"$r\", expected a <default> of that name further up";
    assert!(e.to_string().starts_with(expected), "{e}");
}

#[test]
fn includes_are_found_beside_the_scene_and_stay_there() {
    let inner = "<scene version=\"3.0.0\">\n<default name=\"r\" value=\"7\"/>\n<include filename=\"parts/deep.xml\"/></scene>";
    let deep = format!("<scene version=\"3.0.0\">\n<default name=\"r\" value=\"8\"/>{SPHERE}</scene>");
    let source = MemorySource::new()
        .with("s/parts/inner.xml", inner)
        .with("s/parts/deep.xml", deep)
        .with("s/parts/bsdf.xml", "<bsdf version=\"3.0.0\" type=\"null\" id=\"none\"/>")
        .with("s/parts/bad.xml", "<scene version=\"3.0.0\">\n<shape type=\"teapot\"/></scene>")
        .with("s/parts/round.xml", scene("<include filename=\"round.xml\"/>"))
        .with("s/parts/back.xml", scene("<include filename=\"scene.xml\"/>"))
        .with("s/scene.xml", scene(""))
        .with("secret.xml", scene(""));
    let options = MitsubaOptions::default();
    let include = |name: &str| scene(&format!("\n<include filename=\"{name}\"/>"));
    let loaded = parse_in(&source, &include("parts/inner.xml"), &options).unwrap();
    assert_eq!(radius(&loaded), 7.0);
    let text = scene("<include filename=\"parts/bsdf.xml\"/><shape type=\"disk\"><ref id=\"none\"/></shape>");
    assert_eq!(parse_in(&source, &text, &options).unwrap().desc.materials[0].kind, MaterialKind::Null);
    let e = parse_in(&source, &include("parts/bad.xml"), &options).unwrap_err();
    assert!(e.to_string().starts_with("s/parts/bad.xml:2: <shape type=\"teapot\">: "), "{e}");
    for (name, words) in [
        ("parts/round.xml", "does not include itself"),
        ("parts/back.xml", "does not include itself"),
        ("no.xml", "s/scene.xml:2: <include>: found \"no.xml\", expected a file beside"),
        ("../secret.xml", "expected a file in s or in a folder of it"),
        ("parts/../../secret.xml", "expected a file in s"),
        ("/secret.xml", "expected a file in s"),
        ("parts\\..\\..\\secret.xml", "expected a file in s"),
    ] {
        let e = parse_in(&source, &include(name), &options).unwrap_err();
        assert!(e.to_string().contains(words), "{name}: {e}");
    }
}

#[test]
fn includes_do_not_follow_links_out() {
    let folder = tempfile::tempdir().unwrap();
    let (inside, outside) = (folder.path().join("in"), folder.path().join("out.xml"));
    std::fs::create_dir(&inside).unwrap();
    std::fs::write(&outside, scene("")).unwrap();
    std::fs::write(inside.join("a.xml"), scene("<include filename=\"link.xml\"/>")).unwrap();
    std::fs::write(inside.join("link.xml"), scene("")).unwrap();
    assert!(load_scene(&inside.join("a.xml")).is_ok());
    #[cfg(unix)]
    {
        std::fs::remove_file(inside.join("link.xml")).unwrap();
        std::os::unix::fs::symlink(&outside, inside.join("link.xml")).unwrap();
        let e = load_scene(&inside.join("a.xml")).unwrap_err();
        assert!(e.to_string().contains("expected a file in"), "{e}");
        let options = MitsubaOptions { outside_includes: true, ..MitsubaOptions::default() };
        let bytes = std::fs::read(inside.join("a.xml")).unwrap();
        let source = etendue::io::DiskSource;
        assert!(parse_scene_mitsuba(&bytes, &inside.join("a.xml"), &source, &options).is_ok());
    }
}

#[test]
fn identifiers_have_other_names_and_are_unique() {
    let d = parse(&scene(
        "<bsdf type=\"null\" id=\"a\"/><alias id=\"a\" as=\"b\"/><shape type=\"disk\"><ref id=\"b\"/></shape>",
    ))
    .unwrap()
    .desc;
    assert_eq!((d.materials[0].name.as_str(), &d.materials[0].kind), ("a", &MaterialKind::Null));
    for (inner, words) in [
        (
            "<bsdf type=\"null\" id=\"a\"/>\n<bsdf type=\"diffuse\" id=\"a\"/>",
            "the first is in s/scene.xml:1",
        ),
        ("<alias id=\"a\" as=\"b\"/>", "an id that stands further up"),
        ("<bsdf type=\"null\" id=\"a\"/><alias id=\"a\" as=\"a\"/>", "an id of its own"),
    ] {
        let e = parse(&scene(inner)).unwrap_err();
        assert!(e.to_string().contains(words), "{e}");
    }
}

#[test]
fn versions_before_2_are_understood() {
    let d = parse(
        "<scene version=\"0.6.0\"><shape type=\"sphere\">\
         <transform name=\"toWorld\"><scale value=\"2\"/></transform>\
         <medium type=\"homogeneous\" name=\"interior\"><rgb name=\"sigmaS\" value=\"1\"/><rgb name=\"sigmaA\" value=\"2\"/></medium>\
         </shape><shape type=\"disk\"><bsdf type=\"dielectric\"><float name=\"intIOR\" value=\"1.5\"/><float name=\"extIOR\" value=\"1\"/></bsdf></shape>\
         <integrator type=\"path\"><integer name=\"maxDepth\" value=\"-1\"/></integrator></scene>",
    )
    .unwrap();
    assert_eq!((radius(&d), d.max_depth), (2.0, None));
    let d = d.desc;
    assert_eq!((d.media[0].sigma_s, d.media[0].sigma_a), ([1.0; 3], [2.0; 3]));
    assert_eq!(d.materials[0].kind, MaterialKind::Null);
    assert_eq!(d.materials[1].kind, MaterialKind::Dielectric { ior: [1.5; 3], schlick: false });
}

#[test]
fn limits_hold() {
    // Values that multiply.
    let mut inner = "<default name=\"a0\" value=\"xxxxxxxxxx\"/>".to_owned();
    for i in 1..20 {
        let value = format!("$a{}", i - 1).repeat(10);
        inner += &format!("<default name=\"a{i}\" value=\"{value}\"/>");
    }
    let e = parse(&scene(&inner)).unwrap_err();
    assert!(e.to_string().contains("bytes in a value"), "{e}");
    // Entities.
    let e = parse("<!DOCTYPE a [<!ENTITY b \"c\">]><scene version=\"3.0.0\">&b;</scene>").unwrap_err();
    assert!(e.to_string().contains("XML"), "{e}");
    // Depth, of elements that mean nothing and of includes.
    let deep = "<texture type=\"x\">".repeat(100_000);
    assert!(parse(&scene(&deep)).is_err());
    let deep = scene(&("<texture type=\"x\">".repeat(65) + &"</texture>".repeat(65)));
    let e = parse(&deep).unwrap_err();
    assert!(e.to_string().contains("within each other"), "{e}");
    let source = (0..20).fold(MemorySource::new(), |source, i| {
        source.with(format!("s/{i}.xml"), scene(&format!("<include filename=\"{}.xml\"/>", i + 1)))
    });
    let e =
        parse_in(&source, &scene("<include filename=\"0.xml\"/>"), &MitsubaOptions::default()).unwrap_err();
    assert!(e.to_string().contains("includes within each other"), "{e}");
}

#[test]
fn broken_files_are_named_with_their_line() {
    for (text, start) in [
        ("", "s/scene.xml:1: is not a readable XML file"),
        ("<scene version=\"3.0.0\">\n<shape type=/></scene>", "s/scene.xml:2: is not a readable XML file"),
        ("<scene>", "s/scene.xml:1: is not a readable XML file"),
        ("<scene/>", "s/scene.xml:1: <scene>: found no version"),
        ("<scene version=\"new\"/>", "s/scene.xml:1: <scene>: found \"new\""),
        (
            "<bsdf version=\"3.0.0\" type=\"diffuse\"/>",
            "s/scene.xml:1: <bsdf type=\"diffuse\">: found <bsdf>",
        ),
        (
            "<scene version=\"3.0.0\">\n<shape type=\"sphere\">\n<float name=\"radius\" value=\"big\"/></shape></scene>",
            "s/scene.xml:3: <shape type=\"sphere\"> radius: found \"big\", expected a finite number",
        ),
        (
            "<scene version=\"3.0.0\">\n<shape type=\"sphere\">\n<string name=\"radius\" value=\"1\"/></shape></scene>",
            "s/scene.xml:3: <shape type=\"sphere\"> radius: found <string>, expected <float> or <integer>",
        ),
        (
            "<scene version=\"3.0.0\">\n<shape type=\"sphere\"><float name=\"radius\" value=\"1\"/>\n<float name=\"radius\" value=\"1\"/></shape></scene>",
            "s/scene.xml:3: <shape type=\"sphere\"> radius: found a second value (the first is in line 2)",
        ),
    ] {
        let e = parse(text).unwrap_err();
        assert!(e.to_string().starts_with(start), "{text}\n{e}");
    }
    let e = parse_scene_mitsuba(
        b"<scene>\n\xff",
        Path::new("a.xml"),
        &MemorySource::new(),
        &MitsubaOptions::default(),
    );
    assert!(e.unwrap_err().to_string().starts_with("a.xml:2: found bytes that are not UTF-8"));
}

/// A scene with a bit of everything.
const ALL: &str = include_str!("../../fuzz/seeds/mitsuba/all.xml");

fn everything(bytes: &[u8]) -> Result<LoadedScene, LoadError> {
    let mut vol = b"VOL\x03".to_vec();
    [1, 1, 1, 1, 1].iter().for_each(|w| vol.extend(i32::to_le_bytes(*w)));
    [0.0f32, 0.0, 0.0, 1.0, 1.0, 1.0, 0.5].iter().for_each(|f| vol.extend(f.to_le_bytes()));
    let source = MemorySource::new()
        .with("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        .with("a.vol", vol)
        .with("a.xml", "<scene version=\"3.0.0\"><bsdf type=\"diffuse\" id=\"other\"/></scene>");
    parse_scene_mitsuba(bytes, Path::new("scene.xml"), &source, &MitsubaOptions::default())
}

#[test]
fn the_seed_of_the_fuzzer_loads() {
    let loaded = everything(ALL.as_bytes()).unwrap_or_else(|e| panic!("{e}"));
    assert!(loaded.desc.meshes.len() + loaded.desc.shapes.len() >= 5);
    assert_eq!(loaded.desc.media.len(), 2);
}

#[test]
fn every_truncation_returns() {
    for end in 0..ALL.len() {
        let _ = everything(&ALL.as_bytes()[..end]);
    }
}

proptest! {
    #[test]
    fn any_bytes_return(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        let _ = everything(&bytes);
    }

    #[test]
    fn edited_scenes_return(edits in proptest::collection::vec((any::<prop::sample::Index>(), any::<prop::sample::Index>(), 0usize..8), 1..6)) {
        let words = ["", "\"", "<ref id=\"white\"/>", "nan", "1e39", "-1", "0 0 0", "</shape>"];
        let mut text = ALL.to_owned();
        for (at, length, word) in edits {
            let starts: Vec<usize> = text.char_indices().map(|(i, _)| i).collect();
            if starts.is_empty() {
                break;
            }
            let start = *at.get(&starts);
            let end = (start + length.index(12)).min(text.len());
            if text.is_char_boundary(end) {
                text.replace_range(start..end, words[word]);
            }
        }
        if let Ok(scene) = everything(text.as_bytes()) {
            // What loads is what compile() can judge.
            let _ = etendue_core::scene::compile(&scene.desc);
        }
    }
}
