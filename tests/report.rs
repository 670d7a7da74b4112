//! `etendue report`: it tells a wrong method from right ones, leaves whole files however it ends, and draws what others measured.
#![cfg(feature = "cli")]
#![allow(clippy::disallowed_methods, reason = "test code, f64 on the host")]

mod common;

use common::{Folder, closed_cornell, path_text, root, run};
use etendue::core::backend::Session;
use etendue::core::scene::compile;
use etendue::driver::{Outcome, Progress, Silent, Watcher};
use etendue::engine::{BackendKind, open_backend};
use etendue::io::load_scene;
use etendue::report::{
    Contender, Curve, Measured, Picture, Plan, ReportError, Run, Sampling, SamplingMethod, measure, read_runs,
};
use std::sync::atomic::{AtomicU32, Ordering};

/// Side of the images of these tests.
const SIDE: u32 = 64;

fn session() -> Box<dyn Session> {
    let loaded = load_scene(&root().join("scenes/cornell/closed.toml")).unwrap();
    let (mut scene, _) = compile(&loaded.desc).unwrap();
    scene.camera = scene.camera.map(|c| c.with_resolution(SIDE, SIDE));
    open_backend(BackendKind::Cpu, None).unwrap().open(scene.into()).unwrap()
}

fn plan(seconds: f64) -> Plan {
    Plan { seconds, replicates: 5, seed: 0, size: (SIDE, SIDE), mask: None }
}

/// A path tracer that loses a hundredth of the light.
struct Mutant<'a> {
    inner: Sampling<'a>,
    curves: [Curve; 1],
}

impl Contender for Mutant<'_> {
    fn curves(&self) -> &[Curve] {
        &self.curves
    }

    fn run(&mut self, rung: u32, seed: u64, watcher: &dyn Watcher) -> Result<Vec<Picture>, ReportError> {
        // Numbers of its own: the same noise as another's would make the two too easy to tell apart.
        let mut made = self.inner.run(rung, seed + 1000, watcher)?;
        for picture in &mut made {
            picture.radiance.iter_mut().for_each(|p| *p = p.map(|x| 0.99 * x));
        }
        Ok(made)
    }
}

fn written(measured: &Measured) -> (Folder, etendue::report::Summary, Vec<String>) {
    let folder = Folder::new();
    let facts = etendue::report::Facts { scene: "test".into(), size: (SIDE, SIDE), ..Default::default() };
    let runs = (measured.runs.as_slice(), Some(measured));
    let (summary, sentences) = etendue::report::write(&folder.join(""), &facts, runs, None).unwrap();
    (folder, summary, sentences)
}

#[test]
fn a_method_that_loses_a_hundredth_is_named() {
    let session = session();
    let path = |backend| Sampling::new(&*session, backend, SamplingMethod::Path);
    let mutant = Mutant { inner: path("cpu"), curves: [Curve::new("mutant", "", "cpu")] };
    let bdpt = Sampling::new(&*session, "cpu", SamplingMethod::Bidirectional);
    let mut list: Vec<Box<dyn Contender + '_>> =
        vec![Box::new(path("cpu")), Box::new(bdpt), Box::new(mutant)];
    // More replicates than usual: few rungs have to do on a slow machine. One that is busy with other things besides gets more time.
    for seconds in [12.0, 40.0, 100.0] {
        let plan = Plan { replicates: 8, ..plan(seconds) };
        let measured = measure(&mut list, &plan, None, &Silent).unwrap();
        let (_folder, summary, sentences) = written(&measured);
        let mutant = Curve::new("mutant", "", "cpu");
        for curve in &summary.curves {
            let Some(bias) = curve.bias else { continue };
            println!("{}: {}", curve.name, bias.words());
            assert!(!bias.is_off() || curve.name == "mutant", "{}: {bias:?}", curve.name);
        }
        let told = summary.curves.len() == 3 && summary.curves.iter().all(|c| c.bias.is_some());
        let Some(bias) = summary.curve(&mutant).and_then(|c| c.bias).filter(|b| told && b.is_off()) else {
            println!("{seconds} s were too few");
            continue;
        };
        assert!(bias.energy.iter().all(|e| (e + 0.01).abs() < 0.005));
        assert!(sentences.iter().any(|s| s.contains("mutant (biased: -")), "{sentences:?}");
        return;
    }
    panic!("a bias of a hundredth was not named");
}

/// Stops after so many calls.
struct Impatient(AtomicU32);

impl Watcher for Impatient {
    fn progress(&self, progress: &Progress) {
        assert!(progress.fraction.is_some_and(|f| (0.0..=1.0).contains(&f)));
        self.0.fetch_add(1, Ordering::Relaxed);
    }

    fn cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed) > 400
    }
}

/// A contender that is stopped in the middle of its third run of a report.
struct Slow<'a> {
    inner: Sampling<'a>,
    runs: u32,
}

impl Contender for Slow<'_> {
    fn curves(&self) -> &[Curve] {
        self.inner.curves()
    }

    fn converges(&self) -> bool {
        true
    }

    fn for_seconds(&mut self, _: f64, seed: u64, watcher: &dyn Watcher) -> Result<Outcome, ReportError> {
        self.inner.for_seconds(0.3, seed, watcher)
    }

    fn run(&mut self, rung: u32, seed: u64, watcher: &dyn Watcher) -> Result<Vec<Picture>, ReportError> {
        self.runs += 1;
        let never = Impatient(AtomicU32::new(1000));
        self.inner.run(rung, seed, if self.runs == 8 { &never } else { watcher })
    }
}

#[test]
fn what_there_is_when_it_is_stopped_is_whole() {
    let session = session();
    let inner = Sampling::new(&*session, "cpu", SamplingMethod::Path);
    let mut list: Vec<Box<dyn Contender + '_>> = vec![Box::new(Slow { inner, runs: 0 })];
    let measured = measure(&mut list, &plan(1.0), None, &Silent).unwrap();
    // Three trials, then four runs and the one that is stopped.
    assert!(measured.cancelled);
    assert_eq!(measured.runs.len(), 4);
    let (folder, ..) = written(&measured);
    let page = std::fs::read_to_string(folder.join("report.html")).unwrap();
    assert!(page.contains("Stopped early") && page.trim_end().ends_with("</html>"));
    assert_eq!(read_runs(&folder.join("report.csv")).unwrap().len(), 4);
}

#[test]
fn the_command_measures_all_methods_and_keeps_its_reference() {
    let folder = Folder::new();
    let out = folder.join("deep/report");
    let (scene, to) = (closed_cornell(), path_text(&out));
    let base = ["report", &scene, "-o", &to];
    let small = ["--size", "32x32", "--replicates", "2", "--backends", "cpu"];
    let line = [&base[..], &small, &["--budget", "0.15", "--json"]].concat();
    let said = run(&line).exits(0).json();
    assert!(said["conclusion"].as_array().is_some_and(|c| !c.is_empty()), "{said}");
    let read = |name: &str| std::fs::read(out.join(name)).unwrap();
    let page = String::from_utf8(read("report.html")).unwrap();
    // Nothing is fetched: addresses are those of namespaces and of data.
    for part in page.split("http").skip(1) {
        assert!(part.starts_with("://www.w3.org/"), "{}", &part[..40.min(part.len())]);
    }
    assert!(page.contains("<svg") && page.contains("data:image/png;base64,"));
    let runs = read_runs(&out.join("report.csv")).unwrap();
    // A slow machine leaves out what takes long, and says so.
    for method in ["bdpt", "path", "photon", "radiosity"] {
        let left_out = page.contains(&format!("Not measured: {method}"));
        assert!(left_out || runs.iter().any(|r| r.method == method), "{method}");
    }
    let json: serde_json::Value = serde_json::from_slice(&read("report.json")).unwrap();
    assert_eq!(json["replicates"], 2);
    assert!(json["reference"]["rel_error"].as_f64().unwrap() > 0.0);
    for figure in ["error-over-seconds", "error-over-cpu-seconds"] {
        let png = read(&format!("{figure}.png"));
        assert!(png.starts_with(b"\x89PNG") && png.len() > 5000, "{figure}");
    }
    // The second time its reference stands in; and the table alone can be drawn.
    let reference = read("reference.exr");
    let again = [&base[..], &small, &["--budget", "0.05", "--methods", "path", "--quiet"]].concat();
    run(&again).exits(0);
    assert_eq!(read("reference.exr"), reference);
    assert!(String::from_utf8(read("report.html")).unwrap().contains("of an earlier report"));
    let table = out.join("report.csv");
    let drawn = folder.join("drawn");
    run(&["report", "--runs", &path_text(&table), "-o", &path_text(&drawn), "--quiet"]).exits(0);
    assert!(drawn.join("report.html").is_file() && drawn.join("error-over-seconds.png").is_file());
}

#[test]
fn bad_orders_are_refused() {
    let folder = Folder::new();
    let (out, scene) = (folder.arg("out"), closed_cornell());
    run(&["report", "-o", &out]).exits(2);
    run(&["report", &scene, "-o", &out, "--budget", "0"]).exits(2);
    run(&["report", &scene, "-o", &out, "--replicates", "1"]).exits(2);
    run(&["report", &scene, "-o", &out, "--runs", "x.csv"]).exits(2);
    run(&["report", "--runs", "missing.csv", "-o", &out]).exits(3).says(&["missing.csv"]);
    let png = folder.join("mask.png");
    etendue::io::write_png(&png, 2, 2, &[[255; 3]; 4]).unwrap();
    run(&["report", &scene, "-o", &out, "--mask", &path_text(&png)])
        .exits(3)
        .says(&["2 x 2 pixels, expected"]);
}

#[test]
fn tables_of_other_programs_need_only_its_columns() {
    let other = Run { method: "theirs".into(), backend: "theirs".into(), ..Run::default() };
    assert_eq!(other.curve().name(), "theirs (theirs)");
}
