//! What the command refuses, with which exit code and in which words.
#![cfg(feature = "cli")]

mod common;

use common::{FLOOR, FOG, Folder, POINTS, closed_cornell, endless_glow, run};
use std::collections::BTreeSet;
use std::path::Path;

/// The verbs that `--help` lists.
fn verbs_of_help() -> BTreeSet<String> {
    let help = run(&["--help"]).exits(0);
    assert!(help.stderr.is_empty(), "{}", help.stderr);
    let verbs: BTreeSet<String> = help
        .stdout
        .lines()
        .skip_while(|line| !line.starts_with("Commands:"))
        .skip(1)
        .take_while(|line| !line.trim().is_empty())
        // Descriptions that run on are indented further.
        .filter(|line| line.starts_with("  ") && !line.starts_with("   "))
        .filter_map(|line| line.split_whitespace().next())
        .filter(|verb| *verb != "help")
        .map(str::to_owned)
        .collect();
    assert!(verbs.len() >= 5, "{}", help.stdout);
    verbs
}

/// The verbs that a README promises: WORD wherever code begins with `etendue WORD`, in an inline span or on a line of
/// a fenced block (after an optional `$`). Lines that say "(later)" promise nothing.
fn verbs_of_readme(text: &str) -> BTreeSet<String> {
    let mut verbs = BTreeSet::new();
    let mut fenced = false;
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            fenced = !fenced;
            continue;
        }
        if line.contains("(later)") {
            continue;
        }
        let code: Vec<&str> =
            if fenced { vec![line.trim_start()] } else { line.split('`').skip(1).step_by(2).collect() };
        for code in code {
            let code = code.strip_prefix("$ ").unwrap_or(code);
            let Some(rest) = code.strip_prefix("etendue ") else { continue };
            // `plan|run` names two.
            for verb in rest.split_whitespace().next().unwrap_or_default().split('|') {
                if !verb.is_empty() && verb.bytes().all(|b| b.is_ascii_lowercase()) {
                    verbs.insert(verb.to_owned());
                }
            }
        }
    }
    verbs
}

#[test]
fn the_rule_for_readmes_reads_tables_fences_and_spans() {
    let text = "| `etendue info SCENE` | x |\n```sh\n$ etendue render a -o b\netendue = \"0.1\"\netendue plan|run (later)\n\
                etendue merge|verify\n```\nThe word etendue means `etendue --help`; see `etendue probe`.\n";
    let verbs: Vec<String> = verbs_of_readme(text).into_iter().collect();
    assert_eq!(verbs, ["info", "merge", "probe", "render", "verify"]);
}

#[test]
fn help_and_readme_list_the_same_verbs() {
    let readme = std::fs::read_to_string(common::root().join("README.md")).expect("there is a README.md");
    assert_eq!(verbs_of_help(), verbs_of_readme(&readme), "--help on the left, README.md on the right");
}

#[test]
fn every_verb_explains_itself() {
    for verb in verbs_of_help() {
        let help = run(&[verb.as_str(), "--help"]).exits(0);
        assert!(help.stdout.contains(&format!("Usage: etendue {verb}")), "{}", help.stdout);
        assert!(help.stdout.contains("--json") && help.stdout.contains("--quiet"), "{}", help.stdout);
    }
    let version = run(&["--version"]).exits(0);
    assert_eq!(version.stdout, format!("etendue {}\n", env!("CARGO_PKG_VERSION")));
}

#[test]
fn a_map_needs_light_and_known_options() {
    let folder = Folder::new();
    let ply = folder.arg("a.ply");
    let line = ["illuminate", &closed_cornell(), "-o", &ply, "--from", "surfaces", "--weights", "fair"];
    run(&line).exits(2).says(&["fair", "exact", "density"]);
    run(&["illuminate", &closed_cornell(), "-o", &ply, "--photons", "0"]).exits(2).says(&["--photons"]);
    folder.write("floor.obj", "v -1 0 -1\nv -1 0 1\nv 1 0 1\nf 1 2 3\n");
    let dark = folder.write("dark.toml", "[[mesh]]\nfile = \"floor.obj\"\n");
    run(&["illuminate", &dark, "-o", &ply]).exits(3).says(&["nothing in the scene emits"]);
    let glow = folder.write("glow.toml", &endless_glow());
    run(&["illuminate", &glow, "-o", &ply]).exits(3).says(&["media that emit light without bounds"]);
    assert!(!std::path::Path::new(&ply).exists());
}

#[test]
fn bad_usage_exits_with_2() {
    let scene = closed_cornell();
    let scene = scene.as_str();
    let render = |more: &[&'static str]| [&["render", scene, "-o", "never.exr"], more].concat();
    let lines: Vec<(Vec<&str>, &str)> = vec![
        (vec![], "Usage"),
        (vec!["paint", scene], "paint"),
        (vec!["render", scene], "--output"),
        (vec!["probe", scene, "-o", "never.json"], "--points"),
        (vec!["compare", "a.exr"], "<B>"),
        (render(&["--colour", "red"]), "--colour"),
        (render(&["--samples", "0"]), "--samples"),
        (render(&["--samples", "many"]), "--samples"),
        (render(&["--samples", "16", "--time", "1"]), "--time"),
        (render(&["--time", "1", "--error", "0.1"]), "--error"),
        (render(&["--time=-1"]), "above 0"),
        (render(&["--error", "0"]), "above 0"),
        (render(&["--error", "nan"]), "above 0"),
        (render(&["--size", "640"]), "640x480"),
        (render(&["--size", "0x480"]), "640x480"),
        (render(&["--size", "40000x40000"]), "640x480"),
        (render(&["--threads", "0"]), "--threads"),
        (render(&["--max-depth", "0"]), "--max-depth"),
        (render(&["--seed=-1"]), "--seed"),
        (render(&["--tone", "filmic"]), "reinhard"),
        (render(&["--method", "magic"]), "path"),
        (render(&["--single-scatter", "simpson"]), "equiangular"),
        (render(&["--scatter-nodes", "4"]), "--single-scatter"),
        (render(&["--single-scatter", "plain", "--scatter-nodes", "0"]), "--scatter-nodes"),
        (render(&["--single-scatter", "plain", "--method", "bdpt"]), "--single-scatter needs --method path"),
        (
            vec!["probe", scene, "--points", "p.json", "-o", "never.json", "--single-scatter", "plain"],
            "--single-scatter",
        ),
        (render(&["--backend", "cuda"]), "expected `cpu` or `wgpu`"),
        (render(&["--adapter", "any"]), "--adapter needs --backend wgpu"),
        (vec!["compare", "a.exr", "b.exr", "--fail-above", "flip"], "METRIC=NUMBER"),
        (vec!["compare", "a.exr", "b.exr", "--fail-above", "flip=much"], "METRIC=NUMBER"),
        (vec!["compare", "a.exr", "b.exr", "--variance-samples", "4"], "--variance"),
    ];
    for (args, word) in lines {
        let refused = run(&args).exits(2).says(&[word]);
        assert!(refused.stdout.is_empty(), "{args:?}: {}", refused.stdout);
    }
    assert!(!std::path::Path::new("never.exr").exists());
}

#[test]
fn heuristics_are_for_bidirectional_paths() {
    let folder = Folder::new();
    let points = folder.write("points.json", POINTS);
    let says = ["--heuristic", "--method bdpt"];
    let balance = ["--heuristic", "balance"];
    let scene = closed_cornell();
    let (image, list) = (folder.arg("a.exr"), folder.arg("a.json"));
    run(&[&["render", &scene, "-o", &image], &balance[..]].concat()).exits(2).says(&says);
    let probe = ["probe", &scene, "--points", &points, "-o", &list];
    run(&[&probe[..], &["--method", "path"], &balance].concat()).exits(2).says(&says);
    assert_eq!(folder.names(), ["points.json"]);
    run(&[&probe[..], &["--method", "bdpt", "--samples", "16", "--quiet"], &balance].concat()).exits(0);
    assert_eq!(folder.names(), ["a.json", "points.json"]);
}

#[test]
fn bad_input_exits_with_3_and_names_file_line_and_what_was_expected() {
    let folder = Folder::new();
    let out = folder.arg("out.exr");
    let syntax = folder.write("syntax.toml", "version = 1\n\n[camera\n");
    let field = folder.write(
        "field.toml",
        "version = 1\n[camera]\nposition = [0, 0, 0]\nlook_at = [0, 0]\nfov_x_deg = 40\n",
    );
    let unknown = folder.write("unknown.toml", &format!("{FLOOR}\n[[shape]]\nkind = \"torus\"\n"));
    let misspelt = folder
        .write("misspelt.toml", &format!("{FLOOR}\n[camera]\nposition = [0, 1, 0]\nfov_x_deg = 40\nlook_at = [0, 0, 0]\nresolution = [8, 8]\napperture = 2\n"));
    let mesh = folder.write("mesh.toml", "[[mesh]]\nfile = \"nowhere.obj\"\n");
    let suffix = folder.write("scene.xyz", "");
    let cases: Vec<(&str, Vec<&str>)> = vec![
        ("nowhere.toml", vec!["nowhere.toml"]),
        (&syntax, vec!["syntax.toml:3"]),
        (&field, vec!["field.toml:4", "look_at", "expected"]),
        (&unknown, vec!["unknown.toml:14", "torus", "sphere"]),
        (&misspelt, vec!["misspelt.toml:18", "apperture"]),
        (&mesh, vec!["nowhere.obj"]),
        (&suffix, vec!["scene.xyz", "expected"]),
    ];
    for (scene, words) in cases {
        run(&["info", scene]).exits(3).says(&words);
        run(&["render", scene, "-o", &out, "--quiet"]).exits(3).says(&words);
    }
    assert!(!folder.join("out.exr").exists());
}

#[test]
fn an_image_needs_a_camera_and_probes_do_not() {
    let folder = Folder::new();
    let scene = folder.write("floor.toml", FLOOR);
    let points = folder.write("points.json", POINTS);
    run(&["render", &scene, "-o", &folder.arg("out.exr")]).exits(3).says(&["camera"]);
    run(&["probe", &scene, "--points", &points, "-o", &folder.arg("out.json"), "--samples", "16"]).exits(0);
    assert_eq!(folder.names(), ["floor.toml", "out.json", "points.json"]);
}

#[test]
fn fog_is_rendered_and_a_grid_of_it() {
    let folder = Folder::new();
    let grid = FOG.replacen("sigma_a", "density = \"smoke.vol\"\nsigma_a", 1);
    let fog = folder.write("fog.toml", FOG);
    let smoke = folder.write("smoke.toml", &grid);
    let (exr, few) = (folder.arg("fog.exr"), ["--samples", "16"]);
    run(&["render", &smoke, "-o", &exr]).exits(3).says(&["smoke.vol", "density"]);
    let volume = etendue::io::Volume {
        size: [2, 1, 1],
        channels: 1,
        bounds: [[0.0; 3], [1.0; 3]],
        values: vec![0.25, 4.0],
    };
    etendue::io::write_vol(Path::new(&folder.arg("smoke.vol")), &volume).unwrap();
    for scene in [fog, smoke] {
        run(&[&["render", &scene, "-o", &exr][..], &few].concat()).exits(0);
        let methods = run(&["info", &scene, "--json"]).exits(0).json()["methods"].clone();
        assert_eq!(methods, serde_json::json!(["path", "bdpt", "photon"]));
    }
    assert_eq!(folder.names(), ["fog.exr", "fog.toml", "smoke.toml", "smoke.vol"]);
}

#[test]
fn bad_points_exit_with_3() {
    let folder = Folder::new();
    let scene = folder.write("floor.toml", FLOOR);
    let cases = [
        ("empty.json", r#"{"probes": []}"#, "at least one"),
        ("syntax.json", "{\"probes\": [\n{\"position\": [0, 0, 0]\n", "syntax.json:3"),
        ("short.json", "{\"probes\": [\n{\"position\": [0, 0], \"normal\": [0, 1, 0]}]}", "short.json:2"),
        ("normal.json", r#"{"probes": [{"position": [0, 0, 0], "normal": [0, 0, 0]}]}"#, "probe 1"),
        ("huge.json", r#"{"probes": [{"position": [0, 0, 1e60], "normal": [0, 1, 0]}]}"#, "probe 1"),
    ];
    for (name, text, word) in cases {
        let points = folder.write(name, text);
        run(&["probe", &scene, "--points", &points, "-o", &folder.arg("out.json")])
            .exits(3)
            .says(&[name, word]);
    }
    run(&["probe", &scene, "--points", "nowhere.json", "-o", &folder.arg("out.json")])
        .exits(3)
        .says(&["nowhere.json"]);
    assert!(!folder.join("out.json").exists());
}

#[test]
fn what_is_missing_exits_with_4() {
    let folder = Folder::new();
    let scene = closed_cornell();
    let small = ["--size", "2x2", "--samples", "16"];
    let wanted = ["--backend", "wgpu", "--adapter", "an adapter that nobody has"];
    run(&[&["render", &scene, "-o", &folder.arg("a.exr")][..], &wanted].concat())
        .exits(4)
        .says(&["an adapter that nobody has", "there are"]);
    let missing = folder.arg("nowhere/a.exr");
    run(&[&["render", &scene, "-o", &missing][..], &small].concat())
        .exits(4)
        .says(&["nowhere", "does not exist"]);
    let here = folder.arg("");
    run(&[&["render", &scene, "-o", &here][..], &small].concat()).exits(4).says(&["folder"]);
    let floor = folder.write("floor.toml", FLOOR);
    let points = folder.write("points.json", POINTS);
    let out = folder.arg("nowhere/a.json");
    run(&["probe", &floor, "--points", &points, "-o", &out, "--samples", "16"]).exits(4).says(&["nowhere"]);
    assert_eq!(folder.names(), ["floor.toml", "points.json"]);
}

#[test]
fn a_failing_run_leaves_what_was_there() {
    let folder = Folder::new();
    let good = "a good result of yesterday";
    let (exr, json) = (folder.write("out.exr", good), folder.write("out.json", good));
    // A grid that is not there.
    let scene = folder.write("fog.toml", &FOG.replacen("sigma_a", "density = \"smoke.vol\"\nsigma_a", 1));
    let points = folder.write("points.json", POINTS);
    run(&["render", &scene, "-o", &exr]).exits(3);
    run(&["render", "nowhere.toml", "-o", &exr]).exits(3);
    let nobody = ["--backend", "wgpu", "--adapter", "an adapter that nobody has"];
    run(&[&["render", &closed_cornell(), "-o", &exr][..], &nobody].concat()).exits(4);
    run(&["probe", &scene, "--points", &points, "-o", &json]).exits(3);
    for path in [&exr, &json] {
        assert_eq!(std::fs::read_to_string(path).unwrap(), good);
    }
    // The parts of a result are whole or absent, each for itself.
    let png = folder.arg("nowhere/out.png");
    run(&["render", &closed_cornell(), "-o", &exr, "--png", &png, "--size", "2x2", "--samples", "16"])
        .exits(4);
    assert!(std::fs::read(&exr).unwrap() == good.as_bytes() || etendue::io::read_exr(exr.as_ref()).is_ok());
    assert_eq!(folder.names(), ["fog.toml", "out.exr", "out.json", "points.json"]);
}
