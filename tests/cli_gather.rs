//! `render` and `probe` with `--method photon`.
#![cfg(feature = "cli")]
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

mod common;

use common::{Folder, closed_cornell, endless_glow, run};
use etendue::io::{RenderImage, read_exr, read_points};
use serde_json::{Value, json};

const POINTS: &str = r#"{"probes": [
    {"position": [2.7, 2.0, 5.592], "normal": [0, 0, -1]},
    {"position": [1.0, 5.488, 1.0], "normal": [0, -1, 0]},
    {"position": [4.5, 0.0, 1.2], "normal": [0, 1, 0]}]}"#;

fn render(exr: &str, more: &[&str]) -> Value {
    let scene = closed_cornell();
    let line = ["render", &scene, "-o", exr, "--size", "16x16", "--samples", "64", "--json"];
    run(&[&line[..], more].concat()).exits(0).json()
}

fn mean(image: &RenderImage) -> f64 {
    image.radiance.iter().flatten().map(|x| f64::from(*x)).sum::<f64>() / image.radiance.len() as f64
}

#[test]
fn images_from_maps_agree_with_paths_and_say_what_they_took() {
    let folder = Folder::new();
    let exr = folder.arg("out.exr");
    render(&exr, &[]);
    let truth = mean(&read_exr(exr.as_ref()).unwrap());
    for gather in ["--gather=false", "--gather"] {
        let report = render(&exr, &["--method", "photon", gather, "--photons", "300000"]);
        assert_eq!(report["method"], json!("photon"));
        assert_eq!(report["gather"], json!(gather == "--gather"));
        // Four blocks of 16 samples, each with the next power of two above a quarter.
        assert_eq!((&report["samples"], &report["photons"]), (&json!(64), &json!(4 << 17)));
        assert_eq!(report["photons_per_block"], json!(1 << 17));
        assert!(report["hits"].as_u64().unwrap() > 1 << 18 && report["rel_error"].as_f64().unwrap() < 0.1);
        let image = read_exr(exr.as_ref()).unwrap();
        let ratio = mean(&image) / truth;
        assert!((ratio - 1.0).abs() < 0.02, "{gather}: {ratio}");
        let settings: Value = serde_json::from_str(&image.metadata).unwrap();
        for (name, value) in [
            ("method", json!("photon")),
            ("photons_per_block", json!(1 << 17)),
            ("gather", json!(gather == "--gather")),
            ("from", json!("lights")),
            ("basis", json!("constant")),
            ("sequence", json!("sorted")),
            ("max_depth", Value::Null),
        ] {
            assert_eq!(settings[name], value, "{name}");
        }
        assert!(settings["element_size"].as_f64().unwrap() > 0.0);
    }
}

/// Elements cut by shadows and corners hold the mean of both sides: with the size of elements that is chosen, an image of a scene of arches is within 2 % all the same (with elements four times as large it is 3 % off).
#[test]
fn the_default_size_of_elements_suits_a_scene_of_arches() {
    let folder = Folder::new();
    let exr = folder.arg("out.exr");
    let scene = common::root().join("scenes/colonnade/lamps.toml").display().to_string();
    let red = |more: &[&str]| {
        let line = ["render", &scene, "-o", &exr, "--size", "48x27", "--json"];
        let report = run(&[&line[..], more].concat()).exits(0).json();
        let image = read_exr(exr.as_ref()).unwrap();
        let mean = image.radiance.iter().map(|x| f64::from(x[0])).sum::<f64>() / image.radiance.len() as f64;
        println!("{more:?}: {mean}, rel_error of pixels {}", report["rel_error"]);
        mean
    };
    let truth = red(&["--samples", "1024"]);
    let found = red(&["--samples", "256", "--method", "photon", "--photons", "8388608"]);
    assert!((found / truth - 1.0).abs() < 0.02, "{found} by photons, {truth} by paths");
}

#[test]
fn probes_gather_unless_told_not_to() {
    let folder = Folder::new();
    let (points, out) = (folder.write("points.json", POINTS), folder.arg("out.json"));
    let probe = |more: &[&str]| {
        let scene = closed_cornell();
        let line = ["probe", &scene, "--points", &points, "-o", &out, "--json"];
        let report = run(&[&line[..], more].concat()).exits(0).json();
        (report, read_points(out.as_ref()).unwrap())
    };
    let (report, paths) = probe(&["--samples", "16384"]);
    assert_eq!(report["method"], json!("path"));
    assert!(report.get("photons").is_none() && report.get("gather").is_none());
    for (gather, more) in
        [(true, &["--samples", "4096"][..]), (false, &["--gather=false", "--element-size", "0.1"])]
    {
        let (report, found) = probe(&[&["--method", "photon"], more].concat());
        assert_eq!((&report["method"], &report["gather"]), (&json!("photon"), &json!(gather)));
        assert_eq!(report["photons"], json!(1 << 20));
        for (i, (p, q)) in found.iter().zip(&paths).enumerate() {
            let [x, dx, y, dy] = [p.irradiance, p.stderr, q.irradiance, q.stderr].map(Option::unwrap);
            for c in 0..3 {
                // Student's t of 16 blocks; elements may differ by 1 % at second hand and 5 % as they are.
                let allowed = 6.5 * dx[c].hypot(dy[c]) + if gather { 0.01 } else { 0.05 } * y[c];
                assert!(
                    (x[c] - y[c]).abs() <= allowed,
                    "{gather} {i}: {x:?} +- {dx:?} against {y:?} +- {dy:?}"
                );
            }
        }
    }
    // A time budget has maps, too.
    let (report, _) = probe(&["--method", "photon", "--time", "0.2"]);
    assert_eq!(report["photons_per_block"], json!(1 << 16));
}

#[test]
fn the_same_job_gives_the_same_bytes() {
    let folder = Folder::new();
    let (points, out, exr) =
        (folder.write("points.json", POINTS), folder.arg("out.json"), folder.arg("out.exr"));
    let mut first: Option<[Vec<u8>; 2]> = None;
    for threads in ["1", "2", "5"] {
        let more =
            ["--method", "photon", "--photons", "20000", "--gather", "--threads", threads, "--seed", "3"];
        render(&exr, &more);
        let scene = closed_cornell();
        let line = ["probe", &scene, "--points", &points, "-o", &out, "--samples", "100", "--quiet"];
        run(&[&line[..], &more].concat()).exits(0);
        let bytes = [&exr, &out].map(|path| std::fs::read(path).unwrap());
        assert!(first.get_or_insert_with(|| bytes.clone()) == &bytes, "{threads} threads differ");
    }
}

#[test]
fn what_maps_cannot_do_is_refused() {
    let folder = Folder::new();
    let exr = folder.arg("out.exr");
    let photon = |scene: &str, more: &[&str]| {
        run(&[&["render", scene, "-o", &exr, "--size", "4x4", "--method", "photon"], more].concat())
    };
    let scene = closed_cornell();
    photon(&scene, &["--photons", "0"]).exits(2).says(&["--photons"]);
    photon(&scene, &["--photons", "1000", "--time", "1"]).exits(2).says(&["--time"]);
    photon(&scene, &["--gather=perhaps"]).exits(2).says(&["true"]);
    for option in [
        "--photons=1000",
        "--gather",
        "--element-size=0.5",
        "--from=lights",
        "--weights=exact",
        "--subdivide=robust",
        "--basis=constant",
        "--sequence=sorted",
    ] {
        let name = option.split('=').next().unwrap();
        run(&["render", &scene, "-o", &exr, option]).exits(2).says(&[name, "--method photon"]);
    }
    let glow = folder.write("glow.toml", &endless_glow());
    photon(&glow, &[]).exits(3).says(&["media that emit light without bounds", "method `photon`"]);
    let camera = "[camera]\nposition = [0, 2, 0.1]\nlook_at = [0, 0, 0]\nup = [0, 1, 0]\nfov_x_deg = 60\nresolution = [4, 4]\n";
    let floor = "[[shape]]\nkind = \"rectangle\"\ncenter = [0, 0, 0]\nu = [0, 0, 1]\nv = [1, 0, 0]\n";
    let dark = folder.write("dark.toml", &format!("{camera}{floor}"));
    photon(&dark, &[]).exits(3).says(&["nothing in the scene emits"]);
    let mirror = format!(
        "{camera}{floor}material = \"m\"\n[[material]]\nname = \"m\"\nkind = \"mirror\"\nalbedo = [0.9, 0.9, 0.9]\n[[light]]\nkind = \"point\"\nposition = [0, 1, 0]\nintensity = [1, 1, 1]\n"
    );
    let mirror = folder.write("mirror.toml", &mirror);
    photon(&mirror, &["--max-depth", "3"]).exits(2).says(&["--max-depth", "diffuse surfaces"]);
    assert!(!std::path::Path::new(&exr).exists());
    photon(&mirror, &["--photons", "1000", "--samples", "16", "--gather"]).exits(0);
}
