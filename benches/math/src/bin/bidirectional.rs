//! `cargo run --release -p etendue-benches --bin bidirectional [-- SCENE ...]`: writes `docs/bidirectional.md` with its figures.
//!
//! With names of scenes it prints only their tables. `ETENDUE_SCENES` names the folder of the shared scenes; without it only those of the project are measured.
#![allow(clippy::disallowed_methods, reason = "a program that prints")]

use cpu_time::ProcessTime;
use etendue::core::backend::{BidirectionalJob, NoControl, PathJob, Session, image_film_settings};
use etendue::core::film::Film;
use etendue::core::scene::{CompiledScene, compile};
use etendue::core::transport::TransportCode;
use etendue::core::transport::bidirectional::Heuristic;
use etendue::cpu::{CpuBackend, CpuSession};
use etendue_benches::draw;
use etendue_benches::figure::{Curves, Series};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

const SIDE: u32 = 64;
/// Samples per pixel of the rungs of both ladders.
const PATHS: [u32; 3] = [16, 64, 256];
const BOTH: [u32; 2] = [16, 64];
const TURNS: u64 = 2;
/// Samples of the reference, from both ends.
const REFERENCE: u32 = 512;

struct Scene {
    name: &'static str,
    title: &'static str,
    file: PathBuf,
    max_depth: u32,
}

fn scenes() -> Vec<Scene> {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let mut list = vec![Scene {
        name: "caustic",
        title: "glass ball and film under a small lamp",
        file: own.join("caustic/caustic.toml"),
        max_depth: u32::MAX,
    }];
    if let Some(shared) = std::env::var_os("ETENDUE_SCENES").map(PathBuf::from) {
        for (name, title, file, max_depth) in [
            ("area", "closed Cornell box, area light", "closed_cornell/area.toml", u32::MAX),
            ("point", "closed Cornell box, point light", "closed_cornell/point.toml", u32::MAX),
            ("fog", "closed Cornell box in fog", "closed_cornell/fog.toml", u32::MAX),
            ("volume", "caustic in a gas, seven edges", "bitterli/volumetric-caustic/scene_mitsuba05.xml", 7),
            ("veach", "Veach's room, six edges", "bitterli/veach-bidir/scene.xml", 6),
        ] {
            list.push(Scene { name, title, file: shared.join(file), max_depth });
        }
    }
    list
}

fn open(scene: &Arc<CompiledScene>, threads: usize) -> CpuSession {
    CpuBackend::new(Some(threads)).expect("a backend").open_session(scene.clone()).expect("a session")
}

fn load(scene: &Scene) -> Arc<CompiledScene> {
    let loaded = etendue::io::load_scene(&scene.file).unwrap_or_else(|e| panic!("{e}"));
    let (mut compiled, _) = compile(&loaded.desc).unwrap_or_else(|e| panic!("{e}"));
    compiled.camera = compiled.camera.map(|c| c.with_resolution(SIDE, SIDE));
    Arc::new(compiled)
}

/// How a film is made.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Method {
    Path,
    Both(Heuristic),
}

/// A film, and the CPU seconds that it took.
fn render(session: &CpuSession, method: Method, seed: u64, samples: u32, max_depth: u32) -> (Film, f64) {
    let block_length = (samples / 16).max(16).min(samples);
    let job = PathJob { seed, block_length, blocks: 0..(samples / block_length).max(1), max_depth };
    let mut film = Film::new(image_film_settings(session.scene(), &job).expect("a camera"));
    let start = ProcessTime::now();
    match method {
        Method::Path => session.path_image(&job, &NoControl, &mut film),
        Method::Both(heuristic) => {
            let job = BidirectionalJob { heuristic, ..BidirectionalJob::new(job) };
            session.bidirectional_image(&job, &NoControl, &mut film)
        }
    }
    .expect("a film");
    (film, start.elapsed().as_secs_f64())
}

/// Squared relative error: of the film against the reference, whose own noise is taken off.
fn squared_error(film: &Film, reference: &Film) -> f64 {
    let (mut difference, mut signal) = (0.0, 0.0);
    for i in 0..film.len() {
        let (x, r) = (film.mean(i), reference.mean(i));
        let v = reference.variance(i).unwrap_or([0.0; 3]);
        for c in 0..3 {
            difference += (x[c] - r[c]) * (x[c] - r[c]) - v[c];
            signal += r[c] * r[c] - v[c];
        }
    }
    difference / signal
}

/// Rungs of one method: samples, CPU seconds, squared error; means over the turns.
struct Ladder {
    name: &'static str,
    method: Method,
    rungs: Vec<(u32, f64, f64)>,
}

fn climb(scene: &Scene, compiled: &Arc<CompiledScene>) -> Vec<Ladder> {
    let session = open(compiled, 1);
    let all = std::thread::available_parallelism().map_or(1, |n| n.get());
    let both = Method::Both(Heuristic::Power);
    let (reference, _) = render(&open(compiled, all), both, 0xfeed, REFERENCE, scene.max_depth);
    let rungs = |list: &[u32]| list.iter().map(|n| (*n, 0.0, 0.0)).collect();
    let mut ladders = vec![
        Ladder { name: "path", method: Method::Path, rungs: rungs(&PATHS) },
        Ladder { name: "bdpt, power", method: both, rungs: rungs(&BOTH) },
        Ladder { name: "bdpt, balance", method: Method::Both(Heuristic::Balance), rungs: rungs(&BOTH) },
    ];
    for turn in 0..TURNS {
        for rung in 0..PATHS.len() {
            for ladder in &mut ladders {
                if let Some((samples, seconds, error)) = ladder.rungs.get_mut(rung) {
                    let (film, took) = render(&session, ladder.method, turn, *samples, scene.max_depth);
                    *seconds += took / TURNS as f64;
                    *error += squared_error(&film, &reference) / TURNS as f64;
                }
            }
        }
    }
    ladders
}

/// Variance times time at the last rung: what a method costs.
fn price(ladder: &Ladder) -> f64 {
    ladder.rungs.last().map_or(f64::NAN, |r| r.1 * r.2)
}

fn table(scene: &Scene, ladders: &[Ladder]) -> String {
    let mut out =
        format!("\n### {}\n\n| method | samples | CPU s | rel_error |\n|---|---|---|---|\n", scene.title);
    for l in ladders {
        for (n, seconds, error) in &l.rungs {
            writeln!(out, "| {} | {n} | {seconds:.2} | {:.3} % |", l.name, 100.0 * error.max(0.0).sqrt())
                .unwrap();
        }
    }
    let gain = price(&ladders[0]) / price(&ladders[1]);
    writeln!(out, "\nAt equal time the variance of `bdpt` is {}.", words(gain)).unwrap();
    out
}

fn words(gain: f64) -> String {
    if gain >= 1.0 {
        format!("{gain:.1} times less than that of `path`")
    } else {
        format!("{:.1} times that of `path`", 1.0 / gain)
    }
}

/// CPU seconds of the same job by code with more than the scene needs.
fn needs(sessions: &[(&str, CpuSession)], method: Method) -> String {
    let mut times = vec![Vec::new(); sessions.len()];
    for turn in 0..5 {
        for (times, (_, session)) in times.iter_mut().zip(sessions) {
            times.push(render(session, method, turn, 32, u32::MAX).1);
        }
    }
    let mut out = String::from("\n| code for | CPU s | ratio |\n|---|---|---|\n");
    let median = |t: &[f64]| etendue_benches::timing::median(t.iter().copied());
    for (times_of, (name, _)) in times.iter().zip(sessions) {
        let ratios = times_of.iter().zip(&times[0]).map(|(a, b)| a / b);
        let ratio = etendue_benches::timing::median(ratios);
        writeln!(out, "| {name} | {:.3} | {ratio:.2} |", median(times_of)).unwrap();
    }
    out
}

/// Of a scene of diffuse surfaces, and of the same in media.
fn all_needs(name: &str, compiled: &Arc<CompiledScene>) -> String {
    let both = Method::Both(Heuristic::Power);
    let full = || open(compiled, 1).with_code(TransportCode::FULL);
    let detail = TransportCode { lobes: false, ..TransportCode::FULL };
    match name {
        "area" => {
            let mut wide = (**compiled).clone();
            wide.needs.media = true;
            let wide = Arc::new(wide);
            let sessions = [
                ("what it needs: diffuse surfaces", open(compiled, 1)),
                ("bitmaps and interpolated normals too", open(compiled, 1).with_code(detail)),
                ("lobes, bitmaps and interpolated normals too", full()),
                ("media and boundaries too", open(&wide, 1)),
                ("all of it", open(&wide, 1).with_code(TransportCode::FULL)),
            ];
            format!("\nThe closed Cornell box by `bdpt`:\n{}", needs(&sessions, both))
        }
        "fog" => {
            let sessions =
                [("what it needs: media and diffuse surfaces", open(compiled, 1)), ("all of it", full())];
            let (path, both) = (needs(&sessions, Method::Path), needs(&sessions, both));
            format!("\nThe same in fog by `path`:\n{path}\nand by `bdpt`:\n{both}")
        }
        _ => String::new(),
    }
}

fn main() {
    let asked: Vec<String> = std::env::args().skip(1).collect();
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs");
    let mut page = String::from(include_str!("../bidirectional.md"));
    let mut summary = String::from("\n| scene | variance at equal time, `path` over `bdpt` |\n|---|---|\n");
    let (mut tables, mut cost) = (String::new(), String::new());
    for scene in scenes() {
        if !asked.is_empty() && !asked.iter().any(|a| a == scene.name) {
            continue;
        }
        let compiled = load(&scene);
        let ladders = climb(&scene, &compiled);
        let text = table(&scene, &ladders);
        print!("{text}");
        tables += &text;
        writeln!(summary, "| {} | {:.2} |", scene.title, price(&ladders[0]) / price(&ladders[1])).unwrap();
        let by_need = all_needs(scene.name, &compiled);
        print!("{by_need}");
        cost += &by_need;
        let curves = Curves {
            title: scene.title,
            file: scene.name,
            x_label: "CPU seconds, one thread",
            y_label: "relative error",
            series: ladders
                .iter()
                .map(|l| Series {
                    name: l.name.into(),
                    points: l.rungs.iter().map(|r| (r.1, r.2.max(0.0).sqrt())).collect(),
                })
                .collect(),
        };
        if asked.is_empty() {
            let folder = docs.join("bidirectional");
            std::fs::create_dir_all(&folder).expect("a folder");
            draw::curves(&curves, &folder.join(format!("{}.svg", scene.name))).expect("a figure");
            writeln!(tables, "\n![{}](bidirectional/{}.svg)", scene.title, scene.name).unwrap();
        }
    }
    if asked.is_empty() {
        page = page.replace("{summary}", &summary).replace("{tables}", &tables).replace("{needs}", &cost);
        std::fs::write(docs.join("bidirectional.md"), page).expect("the page");
    }
}
