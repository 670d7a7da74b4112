//! Ctrl-C: what there is gets written, and said.
#![cfg(all(feature = "cli", unix))]

mod common;

use common::{Folder, closed_cornell, command};
use std::io::{BufRead as _, BufReader, Read as _};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A job that would take minutes, after `passes` of its passes have begun; the log is the witness, so nothing waits on
/// a clock. Also the reader of the rest of its stderr.
fn long_job(args: &[&str], passes: usize) -> (Child, BufReader<std::process::ChildStderr>) {
    let mut child = command(args)
        .env("ETENDUE_LOG", "debug")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut reader = BufReader::new(child.stderr.take().unwrap());
    let mut seen = 0;
    while seen < passes {
        let mut line = String::new();
        assert!(reader.read_line(&mut line).unwrap() > 0, "the job ended by itself");
        seen += usize::from(line.contains("pass"));
    }
    (child, reader)
}

/// Interrupts a job and returns its exit code and the rest of what it said.
fn interrupt(mut child: Child, mut reader: BufReader<std::process::ChildStderr>) -> (Option<i32>, String) {
    let start = Instant::now();
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    let mut rest = String::new();
    reader.read_to_string(&mut rest).unwrap();
    let status = child.wait().unwrap();
    assert!(start.elapsed() < Duration::from_secs(5), "{:?}", start.elapsed());
    (status.code(), rest)
}

#[test]
fn an_interrupted_render_leaves_a_valid_image() {
    let folder = Folder::new();
    let exr = folder.write("out.exr", "an older result");
    let args = ["render", &closed_cornell(), "-o", &exr, "--size", "16x16", "--time", "100"];
    let (child, reader) = long_job(&args, 2);
    let (code, said) = interrupt(child, reader);
    assert_eq!(code, Some(130), "{said}");
    assert!(said.contains("stopped early"), "{said}");
    let image = etendue::io::read_exr(exr.as_ref()).unwrap();
    let samples = image.sample_count.unwrap()[0];
    assert!(samples >= 64.0 && samples % 64.0 == 0.0, "{samples}");
    assert!(said.contains(&format!("holds {samples} samples")), "{said}");
    assert!(image.radiance.iter().flatten().all(|x| x.is_finite()));
    assert_eq!(folder.names(), ["out.exr"]);
}

#[test]
fn an_interrupted_job_reports_what_it_did() {
    let folder = Folder::new();
    let out = folder.arg("out.json");
    let points = folder.write("points.json", common::POINTS);
    let scene = folder.write("floor.toml", common::FLOOR);
    let args = ["probe", &scene, "--points", &points, "-o", &out, "--time", "100", "--json"];
    let (mut child, reader) = long_job(&args, 2);
    let mut stdout = child.stdout.take().unwrap();
    let (code, said) = interrupt(child, reader);
    assert_eq!(code, Some(130), "{said}");
    let mut text = String::new();
    stdout.read_to_string(&mut text).unwrap();
    let report: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(report["cancelled"], serde_json::json!(true));
    let probes = etendue::io::read_points(out.as_ref()).unwrap();
    assert!(probes.iter().all(|p| p.irradiance.is_some()));
}

#[test]
fn before_the_first_block_nothing_is_touched() {
    let folder = Folder::new();
    let exr = folder.write("out.exr", "an older result");
    // The first block alone is 512 samples of 65536 pixels.
    let args = ["render", &closed_cornell(), "-o", &exr, "--samples", "10000"];
    let (child, reader) = long_job(&args, 1);
    let (code, said) = interrupt(child, reader);
    assert_eq!(code, Some(130), "{said}");
    assert!(said.contains("nothing was written"), "{said}");
    assert_eq!(std::fs::read_to_string(&exr).unwrap(), "an older result");
    assert_eq!(folder.names(), ["out.exr"]);
}
