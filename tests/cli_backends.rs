//! What runs on which backend: the table in the README, tried out.
#![cfg(all(feature = "cli", feature = "wgpu"))]

mod common;

use common::{FOG, Folder, device, root, run};
use std::sync::atomic::{AtomicUsize, Ordering};

/// A room's corner under a lamp, small enough for every method.
const CORNER: &str = r#"
[camera]
position = [1.5, 1.2, 1.6]
look_at = [0, 0.4, 0]
fov_x_deg = 60.0
resolution = [4, 4]

[[shape]]
kind = "rectangle"
center = [0, 0, 0]
u = [0, 0, 2]
v = [2, 0, 0]

[[shape]]
kind = "rectangle"
center = [-1, 1, 0]
u = [0, 1, 0]
v = [0, 0, 2]

[[light]]
kind = "point"
position = [0.5, 1.5, 0.3]
intensity = [9, 8, 7]
"#;

const POINTS: &str = r#"{"probes": [{"position": [0.4, 0, 0.1], "normal": [0, 1, 0]}]}"#;

/// Options of each line of the table, as the README has them in the first column; the last word of a line's file says what it is given to do.
const LINES: &[(&str, &str)] = &[
    ("`render`", "render S -o exr --samples 16"),
    ("`render` through media", "render FOG -o exr --samples 16"),
    ("`render --single-scatter`", "render LIT -o exr --samples 16 --single-scatter equiangular"),
    ("`render --method bdpt`", "render S -o exr --samples 16 --method bdpt"),
    ("`render --method photon`", "render S -o exr --samples 16 --method photon --photons 4096"),
    (
        "`render --method photon --gather`",
        "render S -o exr --samples 16 --method photon --photons 4096 --gather",
    ),
    ("`render --method radiosity`", "render S -o exr --samples 16 --method radiosity BAKE"),
    ("`render --method radiosity --gather`", "render S -o exr --samples 16 --method radiosity --gather BAKE"),
    ("`probe`", "probe S --points P -o json --samples 16"),
    ("`probe` through media", "probe FOGGY --points P -o json --samples 16"),
    ("`probe --method bdpt`", "probe S --points P -o json --samples 16 --method bdpt"),
    ("`probe --method photon`", "probe S --points P -o json --samples 16 --method photon --photons 4096"),
    ("`probe --method radiosity`", "probe S --points P -o json --samples 16 --method radiosity BAKE"),
    ("`illuminate`", "illuminate S -o ply --photons 4096"),
    ("`illuminate --from lights`", "illuminate S -o ply --photons 4096 --from lights"),
    ("`bake`", "bake S -o etd BAKE"),
    ("`bake --codec published`", "bake S -o etd --codec published BAKE"),
    ("`bake --codec bc1`", "bake S -o etd --codec bc1 BAKE"),
    ("`bake --codec bc4`", "bake S -o etd --codec bc4 BAKE"),
    ("`relight` to a mesh", "relight OP --scene S -o ply"),
    ("`relight` to points", "relight OP --scene S --points P -o json --samples 16"),
    ("`relight` to an image", "relight OP --scene S -o exr --samples 16"),
];

/// First column, `cpu` and `wgpu` of the README's table.
fn table() -> Vec<[String; 3]> {
    let readme = std::fs::read_to_string(root().join("README.md")).unwrap();
    let body = readme.split_once("| | `cpu` | `wgpu` |").expect("the README's table").1;
    let lines = body.lines().skip(2).take_while(|l| l.starts_with('|'));
    lines
        .map(|line| {
            let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
            <[&str; 3]>::try_from(cells).unwrap_or_else(|_| panic!("{line}")).map(Into::into)
        })
        .collect()
}

#[test]
fn the_table_of_the_readme_is_what_happens() {
    if device().is_none() {
        return;
    }
    let folder = Folder::new();
    let lamp = "\n[[light]]\nkind = \"point\"\nposition = [0, 3, 0]\nintensity = [9, 9, 9]\n";
    let [s, fog] = [("s", CORNER), ("fog", FOG)].map(|(n, t)| folder.write(&format!("{n}.toml"), t));
    let lit = folder.write("lit.toml", &format!("{FOG}{lamp}"));
    let floor = "\n[[shape]]\nkind = \"rectangle\"\ncenter = [0, 0, 0]\nu = [0, 0, 2]\nv = [2, 0, 0]\n";
    let foggy = folder.write("foggy.toml", &format!("{FOG}{lamp}{floor}"));
    let points = folder.write("p.json", POINTS);
    let operator = folder.arg("op.etd");
    let small = ["--patches", "40", "--pair-samples", "1"];
    run(&[&["bake", &s, "-o", &operator][..], &small].concat()).exits(0);
    let words = |line: &str, output: &str| -> Vec<String> {
        line.split(' ')
            .flat_map(|word| match word {
                "S" => vec![s.clone()],
                "FOG" => vec![fog.clone()],
                "LIT" => vec![lit.clone()],
                "FOGGY" => vec![foggy.clone()],
                "P" => vec![points.clone()],
                "OP" => vec![operator.clone()],
                "BAKE" => small.map(Into::into).to_vec(),
                "exr" | "json" | "ply" | "etd" => vec![format!("{output}.{word}")],
                word => vec![word.into()],
            })
            .collect()
    };
    let table = table();
    // What is wrong with a line of the table.
    let mistakes = |i: usize, (name, line): (&str, &str)| -> Vec<String> {
        let Some([_, cpu, wgpu]) = table.iter().find(|row| row[0] == name) else {
            return vec![format!("{name} is not in the table")];
        };
        let tried = [("cpu", cpu), ("wgpu", wgpu)].map(|(backend, said)| {
            let output = folder.arg(&format!("{i}-{backend}"));
            let args = [words(line, &output), vec!["--backend".into(), backend.into()]].concat();
            let done = run(&args);
            let found = match done.code {
                Some(0) => "yes",
                // A resource is missing: the backend has no such job, and says so.
                Some(4) if done.stderr.contains("backend does not support") => "no",
                _ => "fails",
            };
            println!("{name}, {backend}: {found} {}", done.stderr.trim());
            let told = || format!("{name}, {backend}: the table says {said}, but {found}: {}", done.stderr);
            (!said.starts_with(found)).then(told)
        });
        tried.into_iter().flatten().collect()
    };
    // Two at a time: most of it is compilers of shaders, which have one thread each.
    let next = AtomicUsize::new(0);
    let work = || {
        let mut wrong = Vec::new();
        loop {
            let i = next.fetch_add(1, Ordering::Relaxed);
            let Some(line) = LINES.get(i) else { return wrong };
            wrong.extend(mistakes(i, *line));
        }
    };
    let wrong = std::thread::scope(|scope| {
        [scope.spawn(work), scope.spawn(work)].map(|worker| worker.join().unwrap()).concat()
    });
    let untried: Vec<_> = table.iter().filter(|row| LINES.iter().all(|l| l.0 != row[0])).collect();
    assert!(wrong.is_empty() && untried.is_empty(), "{wrong:#?} {untried:?}");
}
