//! What each verb does with good input.
#![cfg(feature = "cli")]
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

mod common;

use common::{FLOOR, FOG, Folder, POINTS, closed_cornell, run};
use etendue::io::{RenderImage, read_exr, read_png, read_points, write_exr, write_png};
use serde_json::{Value, json};
use std::path::Path;

/// Asserts that a working verb reported what scripts rely on.
#[track_caller]
fn check_report(report: &Value, samples: u64, stages: &[&str]) {
    let seconds = report["seconds"].as_object().unwrap();
    let total = seconds["total"].as_f64().unwrap();
    let sum: f64 =
        stages.iter().map(|s| seconds[*s].as_f64().unwrap_or_else(|| panic!("no stage {s}"))).sum();
    assert_eq!(seconds.len(), stages.len() + 1, "{seconds:?}");
    assert!(0.0 <= sum && sum <= total, "{seconds:?}");
    assert_eq!(report["samples"], json!(samples));
    assert!(report["rays"].as_u64().unwrap() > 0);
    let error = report["rel_error"].as_f64().unwrap();
    let interval: [f64; 2] = serde_json::from_value(report["confidence"]["interval"].clone()).unwrap();
    assert!(interval[0] <= error && error <= interval[1], "{error} {interval:?}");
    assert_eq!(report["confidence"]["level"], json!(0.99));
    assert_eq!(report["backend"], json!("cpu"));
    assert!(!report["adapter"].as_str().unwrap().is_empty());
    assert_eq!(report["version"], json!(env!("CARGO_PKG_VERSION")));
    for name in ["saturated", "invalid"] {
        assert_eq!(report[name], json!(0), "{name}");
    }
    assert_eq!(report["cancelled"], json!(false));
}

#[test]
fn info_tells_what_a_scene_holds() {
    let info = run(&["info", &closed_cornell(), "--json"]).exits(0);
    let v = info.json();
    assert!(v["seconds"]["total"].as_f64().unwrap() >= 0.0);
    assert_eq!(v["camera"], json!({"width": 256, "height": 256}));
    assert_eq!(v["media"], json!(0));
    assert_eq!(v["methods"], json!(["path", "bdpt", "photon", "radiosity"]));
    assert_eq!(v["needs"]["area_lights"], json!(true));
    assert_eq!(v["needs"]["media"], json!(false));
    assert!(v["lights"].as_object().unwrap().len() == 1, "{}", v["lights"]);
    let text = run(&["info", &closed_cornell()]).exits(0).stdout;
    for word in ["lights", "camera  256 x 256", "methods  path, bdpt, photon"] {
        assert!(text.contains(word), "no `{word}` in\n{text}");
    }
    let silent = run(&["info", &closed_cornell(), "--quiet"]).exits(0);
    assert_eq!((silent.stdout.as_str(), silent.stderr.as_str()), ("", ""));
}

#[test]
fn a_bare_mesh_gets_a_camera_and_a_sky_and_says_so() {
    let folder = Folder::new();
    let mesh = folder.write("floor.obj", "v -1 0 -1\nv -1 0 1\nv 1 0 1\nv 1 0 -1\nf 1 2 3 4\n");
    let info = run(&["info", &mesh, "--json"]).exits(0).says(&["camera", "environment"]);
    assert_eq!(info.json()["needs"]["environment"], json!(true));
    assert_eq!(info.json()["triangles"], json!(2));
}

#[test]
fn render_writes_an_image_and_reports() {
    let folder = Folder::new();
    let exr = folder.arg("out.exr");
    let line = [
        "render",
        &closed_cornell(),
        "-o",
        &exr,
        "--size",
        "12x8",
        "--samples",
        "40",
        "--seed",
        "5",
        "--json",
    ];
    let done = run(&line).exits(0);
    let v = done.json();
    // 40 samples are three blocks of 16.
    check_report(&v, 48, &["load", "compile", "prepare", "sample", "write"]);
    assert_eq!((&v["width"], &v["height"], &v["seed"]), (&json!(12), &json!(8), &json!(5)));
    assert_eq!((&v["method"], &v["output"]), (&json!("path"), &json!(exr)));
    let image = read_exr(exr.as_ref()).unwrap();
    assert_eq!((image.width, image.height), (12, 8));
    assert_eq!(image.sample_count, Some(vec![48.0; 96]));
    assert!(image.radiance.iter().flatten().all(|x| x.is_finite() && *x >= 0.0));
    assert!(image.variance.unwrap().iter().flatten().all(|x| x.is_finite() && *x >= 0.0));
    assert_eq!(folder.names(), ["out.exr"], "nothing half-written stays");
}

#[test]
fn the_settings_in_an_image_decide_its_bits_and_say_nothing_else() {
    let folder = Folder::new();
    let exr = folder.arg("out.exr");
    run(&[
        "render",
        &closed_cornell(),
        "-o",
        &exr,
        "--size",
        "4x4",
        "--samples",
        "32",
        "--max-depth",
        "3",
        "--quiet",
    ])
    .exits(0);
    let settings: Value = serde_json::from_str(&read_exr(exr.as_ref()).unwrap().metadata).unwrap();
    let names: Vec<&str> = settings.as_object().unwrap().keys().map(String::as_str).collect();
    for name in ["version", "method", "backend", "scene_hash", "seed", "samples", "block_length", "max_depth"]
    {
        assert!(names.contains(&name), "no {name} in {names:?}");
    }
    assert_eq!((&settings["samples"], &settings["max_depth"]), (&json!(32), &json!(3)));
    let text = settings.to_string();
    for word in ["second", "time", "date", "thread", "adapter", "host", "rays", "out.exr"] {
        assert!(!text.contains(word), "`{word}` in {text}");
    }
}

#[test]
fn an_image_names_the_rule_of_its_airlight() {
    let folder = Folder::new();
    let lamp = "\n[[light]]\nkind = \"point\"\nposition = [0.5, 2, -1]\nintensity = [5, 5, 5]\n";
    let scene = folder.write("fog.toml", &format!("{FOG}{lamp}"));
    let exr = folder.arg("out.exr");
    let render = |more: &[&str]| {
        run(&[&["render", &scene, "-o", &exr, "--samples", "64", "--quiet"], more].concat()).exits(0);
        read_exr(exr.as_ref()).unwrap()
    };
    let mean = |image: &RenderImage| image.radiance.iter().map(|x| f64::from(x[1])).sum::<f64>() / 64.0;
    let flights = render(&[]);
    assert!(!flights.metadata.contains("scatter"), "{}", flights.metadata);
    for (rule, nodes) in [("trapezoid", None), ("plain", Some("24")), ("equiangular", Some("8"))] {
        let mut more = vec!["--single-scatter", rule];
        more.extend(nodes.iter().flat_map(|n| ["--scatter-nodes", n]));
        let summed = render(&more);
        let settings: Value = serde_json::from_str(&summed.metadata).unwrap();
        let nodes: u32 = nodes.map_or(16, |n| n.parse().unwrap());
        assert_eq!((&settings["method"], &settings["single_scatter"]), (&json!("path"), &json!(rule)));
        assert_eq!(settings["scatter_nodes"], json!(nodes));
        assert!((mean(&summed) / mean(&flights) - 1.0).abs() < 0.03, "{rule}: {}", mean(&summed));
        assert_ne!(summed.radiance, flights.radiance);
    }
}

#[test]
fn quiet_is_silent_and_json_is_all_there_is() {
    let folder = Folder::new();
    let exr = folder.arg("out.exr");
    let scene = closed_cornell();
    let small = ["render", &scene, "-o", &exr, "--size", "2x2", "--samples", "16"];
    let silent = run(&[&small[..], &["--quiet"]].concat()).exits(0);
    assert_eq!((silent.stdout.as_str(), silent.stderr.as_str()), ("", ""));
    let json = run(&[&small[..], &["--quiet", "--json"]].concat()).exits(0);
    assert_eq!(json.stderr, "");
    assert_eq!(json.json()["samples"], json!(16));
    // One block has no variance and so no error.
    assert_eq!(json.json()["rel_error"], Value::Null);
    let spoken = run(&small).exits(0);
    assert!(spoken.stdout.contains("out.exr: 2x2, 16 samples"), "{}", spoken.stdout);
}

#[test]
fn depth_1_shows_the_lamp_and_nothing_else() {
    let folder = Folder::new();
    let exr = folder.arg("out.exr");
    // The closed box's camera does not see its lamp.
    let open = common::path_text(&common::root().join("scenes/cornell/open.toml"));
    run(&["render", &open, "-o", &exr, "--size", "32x32", "--samples", "16", "--max-depth", "1", "--quiet"])
        .exits(0);
    let image = read_exr(exr.as_ref()).unwrap();
    let share: Vec<f32> = image.radiance.iter().map(|p| p[0] / 17.0).collect();
    for (p, s) in image.radiance.iter().zip(&share) {
        assert!((0.0..=1.0).contains(s), "{p:?}");
        assert!((p[1] - 12.0 * s).abs() <= 1e-4 && (p[2] - 4.0 * s).abs() <= 1e-4, "{p:?}");
    }
    let lit = share.iter().filter(|s| **s > 0.0).count();
    assert!(share.contains(&1.0) && lit < 100, "{lit} pixels show the lamp");
}

#[test]
fn seeds_change_the_bits_and_nothing_but_them() {
    let folder = Folder::new();
    let render = |name: &str, seed: &str| {
        let exr = folder.arg(name);
        run(&[
            "render",
            &closed_cornell(),
            "-o",
            &exr,
            "--size",
            "16x16",
            "--samples",
            "64",
            "--seed",
            seed,
            "--quiet",
        ])
        .exits(0);
        read_exr(exr.as_ref()).unwrap()
    };
    let (a, b, again) = (render("a.exr", "0"), render("b.exr", "1"), render("c.exr", "0"));
    assert_eq!(a, again);
    let differ = a.radiance.iter().zip(&b.radiance).filter(|(a, b)| a != b).count();
    assert!(differ > 250, "{differ} of 256 pixels differ");
    let mean = |image: &RenderImage| image.radiance.iter().flatten().map(|x| f64::from(*x)).sum::<f64>();
    let ratio = mean(&a) / mean(&b);
    assert!((ratio - 1.0).abs() <= 0.05, "{ratio}");
}

#[test]
fn an_error_budget_reaches_its_target() {
    let folder = Folder::new();
    let render = |name: &str, seed: &str| {
        let exr = folder.arg(name);
        let line = [
            "render",
            &closed_cornell(),
            "-o",
            &exr,
            "--size",
            "8x8",
            "--error",
            "0.04",
            "--seed",
            seed,
            "--json",
        ];
        let v = run(&line).exits(0).json();
        assert!(v["rel_error"].as_f64().unwrap() <= 0.04, "{v}");
        let blocks = v["samples"].as_u64().unwrap() / 64;
        assert!(blocks >= 4 && blocks.is_power_of_two(), "{v}");
        exr
    };
    // The estimate is not a fiction: two renders that each claim 4 % differ by about sqrt(2) of it, and no more than
    // twice that.
    let (a, b) = (render("a.exr", "1"), render("b.exr", "2"));
    let v = run(&["compare", &a, &b, "--json"]).exits(0).json();
    let found = v["rel_error"].as_f64().unwrap();
    assert!(found <= 2.0 * 0.04 * f64::sqrt(2.0), "{found}");
}

#[test]
fn a_time_budget_ends_near_its_time() {
    let folder = Folder::new();
    let exr = folder.arg("out.exr");
    let line = ["render", &closed_cornell(), "-o", &exr, "--size", "8x8", "--time", "0.8", "--json"];
    let v = run(&line).exits(0).json();
    let seconds = v["seconds"]["sample"].as_f64().unwrap();
    println!("{seconds} s, {} samples", v["samples"]);
    // A block takes some milliseconds; on a busy machine one may wait for a core for seconds.
    assert!((0.4..=4.0).contains(&seconds), "{seconds} s");
    assert_eq!(v["cancelled"], json!(false));
}

/// The PNG of an image, by the definitions of the README in f64.
fn shown(tone: &str, exposure: f64, x: f32) -> f64 {
    let e = f64::from(x) * 2.0_f64.powf(exposure);
    let srgb = |v: f64| {
        let v = v.clamp(0.0, 1.0);
        if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 }
    };
    255.0
        * match tone {
            "reinhard" => srgb(e / (1.0 + e)),
            "gamma" => (0.8 * (e + 0.01).powf(0.5)).min(1.0),
            _ => srgb(e),
        }
}

#[test]
fn each_tone_makes_its_picture() {
    let folder = Folder::new();
    let (exr, png) = (folder.arg("out.exr"), folder.arg("out.png"));
    for (tone, exposure) in [("reinhard", 0.0), ("gamma", -1.0), ("none", 0.5)] {
        let stops = exposure.to_string();
        let line =
            ["render", &closed_cornell(), "-o", &exr, "--png", &png, "--size", "20x10", "--samples", "16"];
        let tones =
            ["--tone", tone, "--exposure", &stops, "--gamma-a", "0.8", "--gamma-c", "0.01", "--gamma", "0.5"];
        run(&[&line[..], &tones, &["--quiet"]].concat()).exits(0);
        let image = read_exr(exr.as_ref()).unwrap();
        let (width, height, pixels) = read_png(png.as_ref()).unwrap();
        assert_eq!((width, height), (20, 10));
        for (linear, byte) in image.radiance.iter().flatten().zip(pixels.iter().flatten()) {
            let truth = shown(tone, exposure, *linear);
            assert!((truth - f64::from(*byte)).abs() <= 0.501, "{tone}: {linear} became {byte}, not {truth}");
        }
    }
}

#[test]
fn probes_have_irradiance_and_errors() {
    let folder = Folder::new();
    let scene = folder.write("floor.toml", FLOOR);
    let points = folder.write("points.json", POINTS);
    let out = folder.arg("out.json");
    let done = run(&["probe", &scene, "--points", &points, "-o", &out, "--samples", "32", "--json"]).exits(0);
    let v = done.json();
    check_report(&v, 32, &["load", "compile", "prepare", "sample", "write"]);
    assert_eq!((&v["probes"], &v["output"]), (&json!(2), &json!(out)));
    let found = read_points(Path::new(&out)).unwrap();
    assert_eq!(found.len(), 2);
    // I h / d^3; nothing else shines.
    for (probe, d2) in found.iter().zip([10.0_f64, 25.0]) {
        let truth = 300.0 / d2.powf(1.5);
        for (e, s) in probe.irradiance.unwrap().iter().zip(probe.stderr.unwrap()) {
            assert!((f64::from(*e) - truth).abs() <= 1e-5 * truth, "{e} against {truth}");
            assert!(f64::from(s) <= 1e-5 * truth, "{s}");
        }
    }
    let silent =
        run(&["probe", &scene, "--points", &points, "-o", &out, "--samples", "16", "--quiet"]).exits(0);
    assert_eq!((silent.stdout.as_str(), silent.stderr.as_str()), ("", ""));
    assert_eq!(folder.names(), ["floor.toml", "out.json", "points.json"]);
}

/// An image of one colour per pixel.
fn write_flat(path: &str, value: f32, variance: Option<f32>) {
    let image = RenderImage {
        width: 40,
        height: 34,
        radiance: vec![[value, 2.0 * value, 3.0 * value]; 40 * 34],
        variance: variance.map(|v| vec![[v; 3]; 40 * 34]),
        ..RenderImage::default()
    };
    write_exr(path.as_ref(), &image).unwrap();
}

#[test]
fn compare_measures_and_judges() {
    let folder = Folder::new();
    let (a, b) = (folder.arg("a.exr"), folder.arg("b.exr"));
    write_flat(&a, 1.25, Some(0.01));
    write_flat(&b, 1.0, None);
    let v = run(&["compare", &a, &b, "--json"]).exits(0).json();
    for name in ["rel_error", "rel_mse", "bias", "bias_interval", "block_ratio", "z_pass", "flip"] {
        assert!(!v[name].is_null(), "no {name} in {v}");
    }
    assert!((v["rel_error"].as_f64().unwrap() - 0.25).abs() <= 1e-7, "{v}");
    let rel_mse = [1.0, 2.0, 3.0].map(|r: f64| (0.25 * r).powi(2) / (r * r + 0.01)).iter().sum::<f64>() / 3.0;
    assert!((v["rel_mse"].as_f64().unwrap() - rel_mse).abs() <= 1e-7, "{v}");
    assert_eq!(v["bias"], json!([0.25, 0.25, 0.25]));
    assert_eq!(v["block_ratio"], json!([1.25, 1.25, 1.25]));
    assert_eq!(v["exceeded"], json!([]));

    run(&["compare", &a, &b, "--fail-above", "rel_error=0.26", "--fail-above", "bias=0.26"]).exits(0);
    let no =
        run(&["compare", &a, &b, "--fail-above", "rel_error=0.24", "--fail-above", "bias=0.26", "--json"]);
    let no = no.exits(1).says(&["rel_error is above its limit 0.24"]);
    assert_eq!(no.json()["exceeded"], json!(["rel_error"]));
    assert!(!no.stderr.contains("bias"), "{}", no.stderr);
    run(&["compare", &a, &b, "--fail-above", "beauty=1"]).exits(2).says(&["beauty", "rel_mse"]);
    // b has no variance, so nothing is known of the noise of b against a.
    run(&["compare", &b, &a, "--fail-above", "z_fail=1"]).exits(2).says(&["z_fail", "variance"]);

    let same =
        run(&["compare", &b, &b, "--json", "--fail-above", "rel_error=0", "--fail-above", "flip=0"]).exits(0);
    assert_eq!(same.json()["rel_mse"], json!(0.0));
    let silent = run(&["compare", &a, &b, "--quiet"]).exits(0);
    assert_eq!((silent.stdout.as_str(), silent.stderr.as_str()), ("", ""));
    let text = run(&["compare", &a, &b]).exits(0).stdout;
    assert!(text.contains("rel_error  2.500000e-1"), "{text}");
}

#[test]
fn compare_takes_variance_and_mask() {
    let folder = Folder::new();
    let (a, b) = (folder.arg("a.exr"), folder.arg("b.exr"));
    write_flat(&a, 1.25, Some(0.0));
    write_flat(&b, 1.0, None);
    // z = 0.25, 0.5, 0.75 over sqrt(var): the mean of z^2 is 0.0625 (1 + 4 + 9) / 3 / var, with var = 8 (1, 2, 3) / 16.
    let variance = folder.arg("v.exr");
    write_flat(&variance, 8.0, None);
    let line = ["compare", &a, &b, "--json", "--variance", &variance, "--variance-samples", "16"];
    let v = run(&line).exits(0).json();
    let truth = 0.0625 / 0.5 * (1.0 + 2.0 + 3.0) / 3.0;
    assert!((v["mean_z2"].as_f64().unwrap() - truth).abs() <= 1e-6, "{v}");

    let mask = folder.arg("mask.png");
    let pixels: Vec<[u8; 3]> = (0..40 * 34).map(|i| if i < 100 { [255; 3] } else { [0; 3] }).collect();
    write_png(mask.as_ref(), 40, 34, &pixels).unwrap();
    let v = run(&["compare", &a, &b, "--json", "--mask", &mask]).exits(0).json();
    assert_eq!(v["pixels"], json!(100));

    write_png(mask.as_ref(), 40, 34, &[[0; 3]; 40 * 34]).unwrap();
    run(&["compare", &a, &b, "--mask", &mask]).exits(3).says(&["mask"]);
    write_png(mask.as_ref(), 2, 2, &[[255; 3]; 4]).unwrap();
    run(&["compare", &a, &b, "--mask", &mask]).exits(3).says(&["2 x 2", "40 x 34"]);
    run(&["compare", &a, "nowhere.exr"]).exits(3).says(&["nowhere.exr"]);
    run(&["compare", &a, &mask]).exits(3).says(&["mask.png"]);
}

/// Numbers of a PLY that `illuminate` wrote, by name: per face.
fn face_properties(file: &str) -> std::collections::BTreeMap<String, Vec<f32>> {
    let bytes = std::fs::read(file).unwrap();
    let end = bytes.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
    let header = std::str::from_utf8(&bytes[..end]).unwrap();
    let count = |element: &str| -> usize {
        let line = header.lines().find(|l| l.starts_with(&format!("element {element} "))).unwrap();
        line.rsplit(' ').next().unwrap().parse().unwrap()
    };
    let names: Vec<&str> = header
        .lines()
        .skip_while(|l| !l.starts_with("property list"))
        .filter_map(|l| l.strip_prefix("property float "))
        .collect();
    let faces = &bytes[end + 12 * count("vertex")..];
    let record = 13 + 4 * names.len();
    assert_eq!(faces.len(), record * count("face"));
    let number = |face: &[u8], k: usize| f32::from_le_bytes(face[13 + 4 * k..17 + 4 * k].try_into().unwrap());
    let values = |k: usize| faces.chunks(record).map(|face| number(face, k)).collect();
    names.iter().enumerate().map(|(k, name)| ((*name).to_owned(), values(k))).collect()
}

#[test]
fn illuminate_writes_a_mesh_with_irradiance() {
    let folder = Folder::new();
    let (ply, json) = (folder.arg("map.ply"), folder.arg("out.json"));
    // A square room by its two plates: a floor of two triangles under a lamp without size, 1 m above its middle, and nothing to reflect light back.
    let scene = folder.write(
        "scene.toml",
        "[[mesh]]\nfile = \"floor.obj\"\n[[light]]\nkind = \"point\"\nposition = [0, 1, 0]\nintensity = [1, 2, 3]\n",
    );
    folder.write("floor.obj", "v -1 0 -1\nv -1 0 1\nv 1 0 1\nv 1 0 -1\nf 1 2 3\nf 1 3 4\n");
    let report = run(&["illuminate", &scene, "-o", &ply, "--photons", "20000", "--json"]).exits(0).json();
    let seconds = report["seconds"].as_object().unwrap();
    for stage in ["load", "compile", "prepare", "direct", "photons", "write", "total"] {
        assert!(seconds.contains_key(stage), "{seconds:?}");
    }
    assert_eq!(report["photons"], json!(20 * 1024));
    assert_eq!(
        report["hits"],
        json!(0),
        "first arrivals from a light without size do not count, and there are no others"
    );
    let map = face_properties(&ply);
    assert_eq!(map.len(), 9);
    // Flux of a point light through a square plate of half side 1 at distance 1: a sixth of 4 pi I, over 4 m^2.
    let truth = std::f32::consts::PI / 6.0;
    for (name, intensity) in [("r", 1.0), ("g", 2.0), ("b", 3.0)] {
        let (direct, error) = (&map[&format!("direct_{name}")], &map[&format!("stderr_{name}")]);
        for face in 0..2 {
            assert!(error[face] > 0.0 && error[face] < 0.05 * intensity * truth, "{}", error[face]);
            // Eight nets, two faces (the channels are one): Student's t at alpha = 1e-3 altogether.
            let z = (direct[face] - intensity * truth).abs() / error[face];
            assert!(z < 6.1, "{name}: {} against {}", direct[face], intensity * truth);
            assert_eq!(map[&format!("indirect_{name}")][face], 0.0);
        }
    }
    // The closed box: what its lamp sends in must come out of the map and of probes alike.
    run(&["illuminate", &closed_cornell(), "-o", &ply, "--photons", "200000", "--quiet"]).exits(0);
    let map = face_properties(&ply);
    let probe = r#"{"probes": [{"position": [2.7, 2.0, 5.592], "normal": [0, 0, -1]}]}"#;
    let points = folder.write("points.json", probe);
    run(&["probe", &closed_cornell(), "--points", &points, "-o", &json, "--samples", "4096", "--quiet"])
        .exits(0);
    let at = read_points(json.as_ref()).unwrap()[0].irradiance.unwrap();
    // The middle of the back wall, and the two faces of that wall (the third pair of the file): not the same quantity, but within a third.
    for (c, name) in ["r", "g", "b"].iter().enumerate() {
        let both = &map[&format!("indirect_{name}")][4..6];
        let mean = 0.5 * (both[0] + both[1]);
        assert!((mean / at[c] - 1.0).abs() < 0.33, "{name}: {mean} on the wall, {} in its middle", at[c]);
    }
}

#[test]
fn illuminate_reconstructs_when_asked() {
    let folder = Folder::new();
    let ply = folder.arg("map.ply");
    let of = |photons: &str, more: &[&str]| {
        let line = [
            "illuminate",
            &closed_cornell(),
            "-o",
            &ply,
            "--photons",
            photons,
            "--element-size",
            "0.4",
            "--json",
        ];
        let report = run(&[&line[..], more].concat()).exits(0).json();
        (report, face_properties(&ply))
    };
    let (report, truth) = of("2000000", &[]);
    assert_eq!(report["reconstructed"], json!(false));
    let (before, raw) = of("15000", &["--seed", "2"]);
    let (after, found) = of("15000", &["--seed", "2", "--reconstruct"]);
    assert_eq!(after["reconstructed"], json!(true));
    assert_eq!(after["rel_error_before"], before["rel_error"]);
    assert!(after["seconds"]["reconstruct"].is_number() && after["confidence"].is_null());
    assert_eq!(found["direct_g"], raw["direct_g"]);
    let sum = |of: &dyn Fn(usize) -> f32| (0..truth["indirect_g"].len()).map(of).sum::<f32>();
    let distance = |map: &std::collections::BTreeMap<String, Vec<f32>>| {
        let square = |i: usize| (map["indirect_g"][i] - truth["indirect_g"][i]).powi(2);
        (sum(&square) / sum(&|i| truth["indirect_g"][i].powi(2))).sqrt()
    };
    let (e_raw, e_found) = (distance(&raw), distance(&found));
    // Faces of nearly one size: the plain mean over faces is the weighted one.
    assert!(e_found <= 0.6 * e_raw, "{e_raw} before, {e_found} after");
    let stated = after["rel_error"].as_f64().unwrap() as f32;
    assert!((stated / e_found - 1.0).abs() <= 0.3, "{stated} stated, {e_found} found");
    // One replicate has no noise that is known.
    let (one, _) = of("1", &["--reconstruct"]);
    assert_eq!(one["reconstructed"], json!(false));
}
