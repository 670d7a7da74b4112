//! `bake`, `relight`, and `render` and `probe` with `--method radiosity`.
#![cfg(feature = "cli")]
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

mod common;

use common::{Folder, closed_cornell, run};
use etendue::io::{RenderImage, read_exr, read_points};
use serde_json::{Value, json};

const POINTS: &str = r#"{"probes": [
    {"position": [2.7, 2.0, 5.592], "normal": [0, 0, -1]},
    {"position": [1.0, 5.488, 1.0], "normal": [0, -1, 0]}]}"#;
const BAKE: [&str; 4] = ["--patches", "600", "--pair-samples", "2"];

fn mean(image: &RenderImage) -> f64 {
    image.radiance.iter().flatten().map(|x| f64::from(*x)).sum::<f64>() / image.radiance.len() as f64
}

fn bake(etd: &str, more: &[&str]) -> Value {
    let scene = closed_cornell();
    let line = ["bake", &scene, "-o", etd, "--json", "--quiet"];
    run(&[&line[..], &BAKE, more].concat()).exits(0).json()
}

#[test]
fn a_baked_room_is_seen_relit_and_told_about() {
    let (folder, scene) = (Folder::new(), closed_cornell());
    let [etd, exr, png, ply] = ["a.etd", "a.exr", "a.png", "a.ply"].map(|n| folder.arg(n));
    let baked = bake(&etd, &[]);
    assert_eq!(baked["bytes"], json!(std::fs::metadata(&etd).unwrap().len()));
    let n = baked["patches"].as_u64().unwrap();
    assert!((300..=900).contains(&n), "{n}");
    assert!(
        baked["bytes_per_pair"].as_f64().unwrap() < 0.5
            && baked["codec_error"]["rms"].as_f64().unwrap() < 0.01
    );
    assert!(baked["seconds"]["rays"].as_f64().is_some());
    // The same job, the same bytes.
    let again = folder.arg("b.etd");
    bake(&again, &["--threads", "1"]);
    assert!(std::fs::read(&etd).unwrap() == std::fs::read(&again).unwrap());

    let info = run(&["info", &etd, "--json"]).exits(0).json();
    for name in ["patches", "passes", "bytes_per_pair", "codec_error", "seed", "rays"] {
        assert_eq!(info[name], baked[name], "{name}");
    }
    run(&["info", &etd]).exits(0);

    let view = ["--size", "24x24", "--samples", "64"];
    let render = [&["render", &scene, "-o", &exr][..], &view].concat();
    run(&render).exits(0);
    let truth = mean(&read_exr(exr.as_ref()).unwrap());
    for more in [&["--operator", &etd][..], &["--operator", &etd, "--gather"], &BAKE] {
        let report = run(&[&render[..], &["--method", "radiosity", "--json"], more].concat()).exits(0).json();
        assert_eq!((&report["method"], &report["patches"]), (&json!("radiosity"), &json!(n)));
        let ratio = mean(&read_exr(exr.as_ref()).unwrap()) / truth;
        assert!((ratio - 1.0).abs() < 0.03, "{more:?}: {ratio}");
    }
    let relight = ["relight", &etd, "--scene", &scene, "-o"];
    run(&[&relight[..], &[&exr, "--png", &png], &view].concat()).exits(0);
    let ratio = mean(&read_exr(exr.as_ref()).unwrap()) / truth;
    assert!((ratio - 1.0).abs() < 0.03 && std::fs::metadata(&png).is_ok(), "{ratio}");
    run(&[&relight[..], &[&ply]].concat()).exits(0);
    let bytes = std::fs::read(&ply).unwrap();
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(900)]).into_owned();
    assert!(head.contains("direct_r") && head.contains("indirect_b"), "{head}");

    let points = folder.write("p.json", POINTS);
    let [a, b] = ["a.json", "b.json"].map(|n| folder.arg(n));
    run(&["probe", &scene, "--points", &points, "-o", &a, "--samples", "16384"]).exits(0);
    run(&[&relight[..], &[&b, "--points", &points, "--samples", "2048"]].concat()).exits(0);
    let [a, b] = [a, b].map(|f| read_points(f.as_ref()).unwrap());
    for (a, b) in a.iter().zip(&b) {
        let (x, y) = (a.irradiance.unwrap(), b.irradiance.unwrap());
        assert!((y[0] / x[0] - 1.0).abs() < 0.05, "{x:?} by paths, {y:?} by the operator");
    }
}

#[test]
fn new_lights_relight_an_old_bake() {
    let (folder, scene) = (Folder::new(), closed_cornell());
    let [etd, exr] = ["a.etd", "a.exr"].map(|n| folder.arg(n));
    bake(&etd, &[]);
    let lamp = |power: f32| {
        let text = format!(
            "[[light]]\nkind = \"point\"\nposition = [2.0, 3.0, 2.0]\nintensity = [{power}, {power}, {power}]\n"
        );
        folder.write(&format!("l{power}.toml"), &text)
    };
    let line =
        ["relight", &etd, "--scene", &scene, "-o", &exr, "--size", "16x16", "--samples", "16", "--lights"];
    let of = |lights: &str| {
        run(&[&line[..], &[lights]].concat()).exits(0);
        mean(&read_exr(exr.as_ref()).unwrap())
    };
    // The lamp that is a surface stays; a light without size adds to it, linearly.
    let [none, one, two] = [0.0, 40.0, 80.0].map(|p| of(&lamp(p)));
    assert!(one > 1.05 * none, "{none} {one}");
    assert!(((two - none) / (one - none) - 2.0).abs() < 0.01, "{none} {one} {two}");
    let room = folder.write("room.toml", "[[shape]]\nkind = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\n");
    run(&[&line[..], &[&room]].concat()).exits(3).says(&["room.toml", "expected lights alone"]);
    let other = folder.write(
        "other.toml",
        "[[shape]]\nkind = \"box\"\nmin = [0, 0, 0]\nmax = [1, 1, 1]\n[[light]]\nkind = \"environment\"\nradiance = [1, 1, 1]\n",
    );
    run(&["relight", &etd, "--scene", &other, "-o", &folder.arg("a.ply")])
        .exits(3)
        .says(&["other geometry or materials"]);
}

#[test]
fn what_does_not_fit_is_refused() {
    let (folder, scene) = (Folder::new(), closed_cornell());
    let [etd, exr] = ["a.etd", "a.exr"].map(|n| folder.arg(n));
    let bake = |more: &[&'static str]| [&["bake", scene.as_str(), "-o", etd.as_str()], more].concat();
    let render = |more: &[&'static str]| [&["render", scene.as_str(), "-o", exr.as_str()], more].concat();
    for (line, said) in [
        (bake(&["--codec", "f32", "--max-error", "0.1"]), "--max-error needs --codec auto"),
        (bake(&["--keep", "0.1"]), "--keep needs --codec published, bc1 or bc4"),
        (bake(&["--codec", "bc1", "--keep", "2"]), "from 0 to 1"),
        (bake(&["--codec", "bc1", "--order", "kd"]), "--order needs --codec published"),
        (bake(&["--codec", "bc1", "--bounces", "3"]), "all bounces"),
        (bake(&["--bounces", "0"]), "1 to 1000, or inf"),
        (bake(&["--patches", "0"]), "--patches"),
        (bake(&["--ktx2", "a.ktx2"]), "--ktx2 needs --codec published, bc1 or bc4"),
        (render(&["--patches", "5"]), "--patches needs --method radiosity"),
        (render(&["--method", "photon", "--operator", "x.etd"]), "--operator needs --method radiosity"),
        (render(&["--method", "radiosity", "--photons", "5"]), "--photons needs --method photon"),
        (render(&["--method", "radiosity", "--max-depth", "5"]), "--bounces"),
        (
            render(&["--method", "radiosity", "--operator", "x.etd", "--codec", "f32"]),
            "--codec has no use with --operator",
        ),
        (vec!["relight", "x.etd", "--scene", &scene, "-o", "a.txt"], "expected .ply, .json or .exr"),
        (vec!["relight", "x.etd", "--scene", &scene, "-o", "a.json"], "--points"),
        (vec!["relight", "x.etd", "--scene", &scene, "-o", "a.ply", "--samples", "5"], "no use"),
    ] {
        run(&line).exits(2).says(&[said]);
    }
    let wrong = folder.write("wrong.etd", "not an operator");
    run(&["info", &wrong]).exits(3).says(&["wrong.etd"]);
    run(&["relight", &wrong, "--scene", &scene, "-o", &exr]).exits(3).says(&["wrong.etd"]);
    let ball = folder.write(
        "ball.toml",
        "[[shape]]\nkind = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\n[[light]]\nkind = \"environment\"\nradiance = [1, 1, 1]\n",
    );
    run(&["bake", &ball, "-o", &etd]).exits(3).says(&["spheres and disks"]);
    assert!(!std::path::Path::new(&etd).exists());
}

#[test]
fn blocks_are_textures_too() {
    let folder = Folder::new();
    let [etd, ktx] = ["a.etd", "a.ktx2"].map(|n| folder.arg(n));
    for codec in ["published", "bc1", "bc4"] {
        let baked = bake(&etd, &["--codec", codec, "--ktx2", &ktx]);
        let bytes = std::fs::read(&ktx).unwrap();
        let texture = ktx2::Reader::new(&bytes[..]).unwrap();
        let side = baked["patches"].as_u64().unwrap() as u32;
        let head = texture.header();
        assert_eq!((head.pixel_width, head.pixel_height), (side, side), "{codec}");
        let level = texture.levels().next().unwrap();
        assert_eq!(level.data.len() as u32, 8 * side.div_ceil(4).pow(2), "{codec}");
    }
}
