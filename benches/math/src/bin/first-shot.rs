//! `cargo run --release -p etendue-benches --bin first-shot [-- SCENE ...]`: writes `docs/first-shot.md` with its figures.
//!
//! With names of scenes it prints only their tables, with `reconstruct` among them only those of reconstruction; `needs` alone prints the cost by need. `ETENDUE_SCENES` names the folder of the shared scenes; without it Sponza is left out.
#![allow(clippy::disallowed_methods, reason = "a program that prints")]

use etendue::core::backend::PhotonStart;
use etendue::core::illumination::{Clustering, Clusters, ElementSettings, Elements};
use etendue::cpu::{CpuBackend, CpuSession};
use etendue::metrics::replicates::{bias, energy, noise, on};
use etendue_benches::draw;
use etendue_benches::figure::{Curves, Series};
use etendue_benches::first_shot::measure::{self, Method, Run};
use etendue_benches::first_shot::reconstruct::{self, Truth};
use etendue_benches::first_shot::{needs, precompute, scenes};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Photons of a replicate, few and many, and replicates of each.
const SIZES: [(u32, usize); 2] = [(1 << 16, 16), (1 << 20, 8)];
const TURNS: usize = 8;
/// Replicates of the reference, of many photons.
const REFERENCE: usize = 12;

/// A set of places where errors are asked for, and the errors at which costs are told.
struct Target {
    name: String,
    clusters: Option<Clusters>,
    errors: [f64; 3],
}

struct Row {
    method: Method,
    runs: [Run; 2],
    precompute: f64,
}

fn open(scene: &Arc<etendue::core::scene::CompiledScene>) -> CpuSession {
    CpuBackend::new(Some(1)).expect("a backend").open_session(scene.clone()).expect("a session")
}

/// Runs all methods in turns.
fn run_all(session: &CpuSession, elements: &Elements, times: &HashMap<&str, f64>) -> Vec<Row> {
    let mut rows: Vec<Row> = measure::methods()
        .into_iter()
        .map(|method| {
            let key = match method.start {
                PhotonStart::Lights { .. } => "",
                PhotonStart::Surfaces { .. } if method.name.contains("whole") => "none",
                PhotonStart::Surfaces { .. } if method.name.contains("published") => "published",
                PhotonStart::Surfaces { .. } if method.name.contains("exact") => "robust, exact",
                PhotonStart::Surfaces { .. } => "robust, density",
            };
            let precompute = times.get(key).copied().unwrap_or(0.0);
            Row { method, runs: [Run::default(), Run::default()], precompute }
        })
        .collect();
    for turn in 0..TURNS {
        for row in &mut rows {
            for (run, (photons, replicates)) in row.runs.iter_mut().zip(SIZES) {
                for _ in 0..replicates / TURNS {
                    run.add(session, elements, &row.method, 1, photons);
                }
            }
        }
        eprintln!("turn {} of {TURNS}", turn + 1);
    }
    rows
}

/// Photons for an error by the law between the two sizes, and whether that is beyond what was run.
fn photons_for(error: f64, errors: [f64; 2]) -> (f64, bool) {
    let [few, many] = SIZES.map(|s| f64::from(s.0));
    // Steeper than 1/N would be noise of the estimates, flatter than 1/sqrt(N) too.
    let slope = ((errors[0] / errors[1]).ln() / (many / few).ln()).clamp(0.4, 0.75);
    let photons = many * (errors[1] / error).powf(1.0 / slope);
    (photons, photons > 8.0 * many)
}

fn percent(x: f64) -> String {
    format!("{:.2} %", 100.0 * x)
}

fn table(rows: &[Row], target: &Target, elements: &Elements, reference: &Run) -> (String, Vec<Series>) {
    let far = on(target.clusters.as_ref(), elements, &reference.maps);
    let errors: Vec<[f64; 2]> = rows
        .iter()
        .map(|r| [0, 1].map(|k| noise(&on(target.clusters.as_ref(), elements, &r.runs[k].maps))))
        .collect();
    let mut out =
        String::from("| method | error at 2^20 | bias | photons, times fewer | tracing time, times less |");
    for e in target.errors {
        out += &format!(" {} %: M photons, M rays, s tracing, s in all |", 100.0 * e);
    }
    out += "\n|---|---:|---:|---:|---:|---:|---:|---:|\n";
    let mut series = Vec::new();
    let (base, base_time) = (errors[0][1], rows[0].runs[1].seconds_per_photon());
    for (row, errors) in rows.iter().zip(&errors) {
        let (run, time) = (&row.runs[1], row.runs[1].seconds_per_photon());
        let near = on(target.clusters.as_ref(), elements, &run.maps);
        let biased = if target.clusters.is_some() { percent(bias(&near, &far)) } else { "-".into() };
        let gain = (base / errors[1]).powi(2);
        out += &format!(
            "| {} | {} | {biased} | {gain:.2} | {:.2} |",
            row.method.name,
            percent(errors[1]),
            gain * base_time / time
        );
        let rays = run.rays as f64 / run.photons as f64;
        for e in target.errors {
            let (photons, beyond) = photons_for(e, *errors);
            let seconds = photons * time;
            out += &format!(
                " {}{:.3}, {:.2}, {seconds:.2}, {:.2} |",
                if beyond { "*" } else { "" },
                photons * 1e-6,
                photons * rays * 1e-6,
                seconds + row.precompute
            );
        }
        out += "\n";
        let points = [0, 1].map(|k| {
            let photons = f64::from(SIZES[k].0);
            (photons * row.runs[k].seconds_per_photon() + row.precompute, errors[k])
        });
        // Few enough curves to be told apart.
        if !row.method.name.contains("Sobol") || row.method.name.contains("published") {
            series.push(Series { name: row.method.name.into(), points: points.into() });
        }
    }
    (out, series)
}

/// Total errors on the elements, after reconstruction beside as they are.
fn reconstructed(
    session: &CpuSession,
    elements: &Elements,
    reference: &Run,
    times: &HashMap<&str, f64>,
) -> String {
    let n = reference.maps.len() as f64;
    let mean: Vec<[f64; 3]> = (0..elements.count())
        .map(|i| [0, 1, 2].map(|c| reference.maps.iter().map(|m| m[i][c]).sum::<f64>() / n))
        .collect();
    let variance = (0..elements.count())
        .map(|i| {
            [0, 1, 2].map(|c| {
                let spread: f64 = reference.maps.iter().map(|m| (m[i][c] - mean[i][c]).powi(2)).sum();
                spread / (n - 1.0) / n
            })
        })
        .collect();
    let truth = Truth { mean, variance };
    let all = measure::methods();
    let ways = [(&all[0], false), (&all[0], true), (&all[5], true), (&all[8], true)];
    let mut out = String::from(
        "| method | total error at 2^16 | at 2^18 | at 2^20 | stated | 20 %: M photons, s tracing, s in all | 10 % | 8 % |\n|---|---:|---:|---:|---:|---:|---:|---:|\n",
    );
    for (method, after) in ways {
        let points = reconstruct::points(session, elements, method, &truth);
        let error = |p: &reconstruct::Point| p.errors[usize::from(after)];
        let name = if after { format!("{}, reconstructed", method.name) } else { method.name.into() };
        out += &format!("| {name} |");
        for p in &points[2..] {
            out += &format!(" {} |", percent(error(p)));
        }
        let stated = if after { percent(points[4].errors[2]) } else { "-".into() };
        out += &format!(" {stated} |");
        let precompute = if method.name.contains("surfaces") { times["robust, exact"] } else { 0.0 };
        for wanted in [0.2, 0.1, 0.08] {
            let (photons, beyond) = reconstruct::photons_for(&points, error, wanted);
            let tracing = photons * points[4].seconds[0] / points[4].photons;
            let rest = precompute + if after { points[4].seconds[1] } else { 0.0 };
            out += &format!(
                " {}{:.3}, {tracing:.2}, {:.2} |",
                if beyond { "*" } else { "" },
                photons * 1e-6,
                tracing + rest
            );
        }
        out += "\n";
    }
    out
}

/// Tables and figures of a scene; of reconstruction alone where `only_reconstruct`.
fn chapter(
    case: &scenes::Case,
    figures: &Path,
    only_reconstruct: bool,
) -> Result<String, Box<dyn std::error::Error>> {
    eprintln!("{}", case.name);
    let scene = Arc::new(case.scene.clone());
    let mut out = format!("## {}\n\n{}; {} triangles.\n\n", case.name, case.about, scene.triangles.len());
    out += "| precomputation | CPU s | over the corners | shadow rays | pieces | MB | s |\n|---|---:|---:|---:|---:|---:|---:|\n";
    let rows = precompute::table(&scene, 5);
    for r in &rows {
        out += &format!(
            "| {} | {:.3} | {:.2} | {} | {} | {:.1} | {:.4} |\n",
            r.name, r.seconds, r.ratio, r.rays, r.pairs, r.megabytes, r.survival
        );
    }
    let survival = rows.last().map_or(0.0, |r| r.survival);
    out += &format!("\nThe law: photons by 1/s = {:.2} times fewer.\n\n", 1.0 / survival);
    let times: HashMap<&str, f64> = rows.iter().map(|r| (r.name, r.seconds)).collect();
    let session = open(&scene);
    let settings = ElementSettings { largest: case.largest, ..ElementSettings::default() };
    let elements = Elements::new(&scene, settings);
    let all = measure::methods();
    let mut reference = Run::default();
    for _ in 0..REFERENCE {
        reference.add(&session, &elements, &all[5], 77, SIZES[1].0);
    }
    if only_reconstruct {
        return Ok(out + &reconstructed(&session, &elements, &reference, &times));
    }
    let lit = |i: usize| reference.maps.iter().any(|m| m[i] != [0.0; 3]);
    let clustering = Clustering::new(&scene, &elements).retain(lit);
    let mut targets = Vec::new();
    for count in [2000, 200] {
        let clusters = clustering.by_count(count);
        let name = format!("{} clusters", clusters.count);
        targets.push(Target { name, clusters: Some(clusters), errors: [0.05, 0.02, 0.01] });
    }
    let name = if case.largest.is_finite() { "elements" } else { "triangles" };
    targets.push(Target { name: name.into(), clusters: None, errors: [0.2, 0.1, 0.08] });
    let rows = run_all(&session, &elements, &times);
    let per = |r: &Run| {
        (1e6 * r.seconds_per_photon(), r.rays as f64 / r.photons as f64, r.hits as f64 / r.photons as f64)
    };
    out += "| method | us a photon | rays a photon | hits a photon | energy |\n|---|---:|---:|---:|---:|\n";
    let whole = on(targets[1].clusters.as_ref(), &elements, &reference.maps);
    for row in &rows {
        let (us, rays, hits) = per(&row.runs[1]);
        let near = on(targets[1].clusters.as_ref(), &elements, &row.runs[1].maps);
        let energy = 100.0 * energy(&near, &whole);
        out += &format!("| {} | {us:.3} | {rays:.2} | {hits:.2} | {energy:+.2} % |\n", row.method.name);
    }
    for (k, target) in targets.iter().enumerate() {
        let (text, series) = table(&rows, target, &elements, &reference);
        let file = format!("{}_{}", case.name, ["2000", "200", "triangles"][k]);
        let curves = Curves {
            title: "Error against CPU seconds, the precomputation included",
            file: "",
            x_label: "CPU seconds",
            y_label: "relative error of one run",
            series,
        };
        draw::curves(&curves, &figures.join(&file).with_extension("svg"))?;
        out += &format!(
            "\n### {}: {}\n\n![error against seconds](first-shot/{file}.svg)\n\n{text}",
            case.name, target.name
        );
    }
    out += &format!(
        "\n### {}: elements after reconstruction (`--reconstruct`), bias in the error\n\n",
        case.name
    );
    out += &reconstructed(&session, &elements, &reference, &times);
    Ok(out + "\n")
}

/// What code costs that a scene does not need.
fn cost_by_need() -> String {
    const TURNS: usize = 9;
    let mut out = String::from(include_str!("../first_shot/needs.md"));
    for r in needs::table(&scenes::room(), 0.15, TURNS) {
        let [a, b] = r.nanoseconds;
        let [c, d] = r.ratios;
        out += &format!("| {} | {a:.1} | {c:.3} | {b:.1} | {d:.3} |\n", r.name);
    }
    out + "\n"
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let asked: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let only_reconstruct = asked.iter().any(|a| a == "reconstruct");
    let data = std::env::var_os("ETENDUE_SCENES").map(PathBuf::from);
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs");
    let figures = docs.join("first-shot");
    std::fs::create_dir_all(&figures)?;
    let mut page = include_str!("../first_shot/page.md").to_owned();
    for name in ["sponza", "colonnade", "room", "textured", "dark"] {
        if !asked.is_empty() && !asked.iter().any(|a| a == name) {
            continue;
        }
        let Some(case) = scenes::case(name, data.as_deref()) else {
            eprintln!("{name} is left out: ETENDUE_SCENES does not name the folder of the shared scenes");
            continue;
        };
        let text = chapter(&case, &figures, only_reconstruct)?;
        println!("{text}");
        page += &text;
    }
    if asked.is_empty() || asked.iter().any(|a| a == "needs") {
        let text = cost_by_need();
        println!("{text}");
        page += &text;
    }
    if asked.is_empty() {
        std::fs::write(docs.join("first-shot.md"), page.trim_end().to_owned() + "\n")?;
    }
    Ok(())
}
