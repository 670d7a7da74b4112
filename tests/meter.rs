//! Irradiance over whole surfaces, by every method that knows probes.

#![allow(clippy::disallowed_methods, reason = "truth in f64")]

mod common;

use common::{Folder, run};
use serde_json::Value;
use std::f64::consts::PI;

/// A closed box seen from inside, with a lossless fog in a part of it, and a lamp.
const ROOM: &str = r#"
[[shape]]
kind = "box"
min = [-1, -1, -1]
max = [1, 1, 2]
material = "wall"

[[shape]]
kind = "box"
min = [-0.5, -0.8, -0.7]
max = [0.6, 0.2, 0.8]
material = "boundary"
interior = "fog"

[[medium]]
name = "fog"
sigma_a = [0, 0, 0]
sigma_s = [1, 2, 0.5]
g = 0.3

[[light]]
kind = "point"
position = [0.3, 0.5, 0.2]
intensity = [1, 2, 3]

[[material]]
name = "wall"
kind = "diffuse"
albedo = [0.5, 0.25, 0.75]

[[material]]
name = "boundary"
kind = "null"
"#;

fn read(path: &str) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

#[test]
fn all_walls_of_a_closed_room_balance_what_is_emitted() {
    let folder = Folder::new();
    let scene = folder.write("room.toml", ROOM);
    let out = folder.arg("out.json");
    for method in ["path", "bdpt", "photon"] {
        let line = ["probe", &scene, "--surface", "wall:back", "-o", &out, "--method", method];
        let photons = ["--photons", "262144"];
        let more: &[&str] = if method == "photon" { &photons } else { &[] };
        run(&[&line[..], more, &["--samples", "16384", "--quiet"]].concat()).exits(0);
        let v = read(&out);
        let meter = &v["meters"][0];
        assert_eq!((&meter["surface"], &meter["side"]), (&"wall".into(), &"back".into()));
        assert!((meter["area"].as_f64().unwrap() - 32.0).abs() < 1e-4);
        for (c, (intensity, albedo)) in [(1.0, 0.5), (2.0, 0.25), (3.0, 0.75)].into_iter().enumerate() {
            let truth = 4.0 * PI * intensity / (32.0 * (1.0 - albedo));
            let [e, s] = ["E", "stderr"].map(|name| meter[name][c].as_f64().unwrap());
            println!("{method} {c}: {e} +- {s}, truth {truth}");
            // Student's t of 16 blocks: once in 10^4 by each.
            assert!((e - truth).abs() <= 5.2 * s && s <= 0.02 * truth, "{method} {c}: {e} +- {s}, {truth}");
        }
    }
}

/// A sphere seen from inside and a disk in it, both white from one side or the other.
#[test]
fn round_surfaces_are_meters_too() {
    let folder = Folder::new();
    let scene = folder.write(
        "ball.toml",
        r#"
[[shape]]
kind = "sphere"
center = [1, 2, 3]
radius = 1.5
material = "wall"

[[shape]]
kind = "disk"
center = [1, 1.5, 3]
normal = [0, 1, 0]
radius = 0.5
material = "table"

[[light]]
kind = "point"
position = [1, 2, 3]
intensity = [1, 2, 3]

[[material]]
name = "wall"
kind = "diffuse"
albedo = [0.5, 0.25, 0.75]

[[material]]
name = "table"
kind = "diffuse"
albedo = [1, 1, 1]
"#,
    );
    let out = folder.arg("out.json");
    let both = ["--surface", "wall:back", "--surface", "table"];
    run(&[&["probe", &scene, "-o", &out, "--samples", "16384", "--quiet"][..], &both].concat()).exits(0);
    let v = read(&out);
    let (wall, disk) = (4.0 * PI * 2.25, PI * 0.25);
    assert!((v["meters"][0]["area"].as_f64().unwrap() - wall).abs() < 1e-4);
    assert!((v["meters"][1]["area"].as_f64().unwrap() - disk).abs() < 1e-5);
    for (c, (intensity, albedo)) in [(1.0, 0.5), (2.0, 0.25), (3.0, 0.75)].into_iter().enumerate() {
        let [e, s] = ["E", "stderr"].map(|name| v["meters"][0][name][c].as_f64().unwrap());
        // The table loses nothing.
        let truth = 4.0 * PI * intensity / (wall * (1.0 - albedo));
        assert!((e - truth).abs() <= 5.2 * s && s <= 0.02 * truth, "{c}: {e} +- {s}, {truth}");
        // What comes straight to the table, 2 pi I (1 - cos), and from the walls.
        let e = v["meters"][1]["E"][c].as_f64().unwrap();
        let straight = 2.0 * PI * intensity * (1.0 - 0.5 / 0.5_f64.hypot(0.5)) / disk;
        assert!(e > straight && e < straight + 2.0 * truth, "{c}: {e}, {straight}");
    }
}

/// What a lamp without size sends through glass is found by photons alone: the walls balance, with glass, a pane and a film before them.
#[test]
fn photons_find_what_comes_through_glass() {
    let folder = Folder::new();
    let glass = r#"
[[shape]]
kind = "sphere"
center = [0.3, -0.5, 0.6]
radius = 0.35
material = "glass"

[[shape]]
kind = "rectangle"
center = [-0.3, 0.6, 0.8]
u = [0.4, 0, 0]
v = [0, 0.1, 0.4]
material = "film"

[[material]]
name = "glass"
kind = "dielectric"
ior = [1.4, 1.5, 1.6]

[[material]]
name = "film"
kind = "thin_film"
reflect = [0.2, 0.4, 0.6]
transmit = [0.8, 0.6, 0.4]
"#;
    let scene = folder.write("glass.toml", &(ROOM.to_string() + glass));
    let out = folder.arg("out.json");
    for gather in ["--gather=true", "--gather=false"] {
        let line = ["probe", &scene, "--surface", "wall:back", "-o", &out, "--method", "photon", gather];
        run(&[&line[..], &["--photons", "1048576", "--samples", "16384", "--quiet"]].concat()).exits(0);
        let v = read(&out);
        for (c, (intensity, albedo)) in [(1.0, 0.5), (2.0, 0.25), (3.0, 0.75)].into_iter().enumerate() {
            let truth = 4.0 * PI * intensity / (32.0 * (1.0 - albedo));
            let [e, s] = ["E", "stderr"].map(|name| v["meters"][0][name][c].as_f64().unwrap());
            println!("{gather} {c}: {e} +- {s}, truth {truth}");
            assert!((e - truth).abs() <= 5.2 * s && s <= 0.02 * truth, "{gather} {c}: {e} +- {s}, {truth}");
        }
    }
}

#[test]
fn the_front_of_a_box_in_the_dark_is_dark() {
    let folder = Folder::new();
    let scene = folder.write("room.toml", ROOM);
    let out = folder.arg("out.json");
    let both = ["probe", &scene, "--surface", "wall", "--surface", "wall:back", "-o", &out];
    let done = run(&[&both[..], &["--samples", "64", "--json"]].concat()).exits(0);
    assert_eq!(done.json()["surfaces"], 2);
    let v = read(&out);
    assert_eq!(v["meters"][0]["E"], serde_json::json!([0.0, 0.0, 0.0]));
    assert!(v["meters"][1]["E"][0].as_f64().unwrap() > 0.1);
    // Any number of threads gives the same bytes.
    let bytes = std::fs::read(&out).unwrap();
    for threads in ["1", "3"] {
        run(&[&both[..], &["--samples", "64", "--quiet", "--threads", threads]].concat()).exits(0);
        assert!(std::fs::read(&out).unwrap() == bytes, "{threads} threads");
    }
}

#[test]
fn what_is_no_surface_is_named() {
    let folder = Folder::new();
    let scene = folder.write("room.toml", ROOM);
    let out = folder.arg("out.json");
    let said = run(&["probe", &scene, "--surface", "flor", "-o", &out]).exits(3);
    assert!(said.stderr.contains("--surface flor") && said.stderr.contains("wall"), "{}", said.stderr);
    let said = run(&["probe", &scene, "-o", &out]).exits(2);
    assert!(said.stderr.contains("--points"), "{}", said.stderr);
    let said = run(&["probe", &scene, "--surface", "wall", "--points", &scene, "-o", &out]).exits(2);
    assert!(said.stderr.contains("--surface"), "{}", said.stderr);
    assert_eq!(folder.names(), ["room.toml"]);
}
