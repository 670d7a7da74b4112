//! From a scene file to an open session, with the seconds of each stage; and what every working verb reports.

use super::args::{BackendArgs, Size, TalkArgs};
use super::error::CliError;
use super::output::scene_hash;
use crate::driver::{CONFIDENCE, Outcome};
use crate::io::load_scene;
use etendue_core::backend::{BackendInfo, Session};
use etendue_core::scene::{CompileReport, CompiledScene, compile};
use serde_json::{Map, Value, json};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// Seconds by stage, in order.
#[derive(Debug)]
pub(super) struct Stages {
    start: Instant,
    last: Instant,
    list: Vec<(&'static str, f64)>,
}

impl Stages {
    pub(super) fn new() -> Self {
        let now = Instant::now();
        Self { start: now, last: now, list: Vec::new() }
    }

    /// Ends a stage that began when the last one ended.
    pub(super) fn done(&mut self, name: &'static str) {
        let now = Instant::now();
        self.list.push((name, (now - self.last).as_secs_f64()));
        self.last = now;
    }

    /// Stages that ended meanwhile, by their own clock.
    pub(super) fn add(&mut self, list: &[(&'static str, f64)]) {
        self.list.extend(list);
        self.last = Instant::now();
    }

    pub(super) fn json(&self) -> Value {
        let mut map = Map::new();
        map.insert("total".into(), json!(self.start.elapsed().as_secs_f64()));
        for (name, seconds) in &self.list {
            map.insert((*name).into(), json!(seconds));
        }
        Value::Object(map)
    }

    pub(super) fn text(&self) -> String {
        let parts: Vec<_> = self.list.iter().map(|(n, s)| format!("{n} {s:.2} s")).collect();
        parts.join(", ")
    }
}

/// Reads and compiles a scene; prints what was noted and mended.
pub(super) fn read_scene(
    path: &Path,
    size: Option<Size>,
    talk: &TalkArgs,
    stages: &mut Stages,
) -> Result<(CompiledScene, CompileReport), CliError> {
    read_scene_with(path, None, size, talk, stages)
}

/// The same, with the lights without size and the environment of another file.
pub(super) fn read_scene_with(
    path: &Path,
    lights: Option<&Path>,
    size: Option<Size>,
    talk: &TalkArgs,
    stages: &mut Stages,
) -> Result<(CompiledScene, CompileReport), CliError> {
    let mut loaded = load_scene(path)?;
    if let Some(lights) = lights {
        let other = load_scene(lights)?.desc;
        if !(other.meshes.is_empty() && other.shapes.is_empty()) {
            let text = format!("{}: found surfaces, expected lights alone", lights.display());
            return Err(CliError::Input(text));
        }
        loaded.desc.lights = other.lights;
    }
    stages.done("load");
    if !talk.quiet {
        for note in &loaded.notes {
            eprintln!("note: {note}");
        }
    }
    let (mut scene, report) =
        compile(&loaded.desc).map_err(|error| CliError::Scene { file: path.display().to_string(), error })?;
    if let (Some(camera), Some(Size(w, h))) = (&mut scene.camera, size) {
        *camera = camera.with_resolution(w, h);
    }
    stages.done("compile");
    if !talk.quiet {
        for (what, count) in &report.cleanups {
            eprintln!("note: {}: {count} {what}", path.display());
        }
    }
    Ok((scene, report))
}

/// A scene that is ready for jobs.
pub(super) struct Opened {
    pub session: Box<dyn Session>,
    pub info: BackendInfo,
    pub hash: String,
}

/// Starts the backend and opens the scene on it.
pub(super) fn open(
    scene: CompiledScene,
    backend: &BackendArgs,
    talk: &TalkArgs,
    stages: &mut Stages,
) -> Result<Opened, CliError> {
    if scene.needs.dark() && !talk.quiet {
        eprintln!("note: nothing in the scene emits light; the result is black");
    }
    let hash = scene_hash(&scene);
    let engine = backend.open()?;
    let session = engine.open(Arc::new(scene))?;
    stages.done("prepare");
    Ok(Opened { session, info: engine.info(), hash })
}

/// The fields that every working verb reports.
pub(super) fn heading(opened: &Opened, seed: u64, stages: &Stages) -> Map<String, Value> {
    let mut map = Map::new();
    map.insert("version".into(), json!(env!("CARGO_PKG_VERSION")));
    map.insert("backend".into(), json!(opened.info.name));
    map.insert("adapter".into(), json!(opened.info.adapter));
    map.insert("scene_hash".into(), json!(opened.hash));
    map.insert("seed".into(), json!(seed));
    map.insert("seconds".into(), stages.json());
    map
}

/// Those, and what every verb that samples reports.
pub(super) fn report(opened: &Opened, outcome: &Outcome, seed: u64, stages: &Stages) -> Map<String, Value> {
    let mut map = heading(opened, seed, stages);
    map.insert("samples".into(), json!(outcome.film.samples()));
    map.insert("block_length".into(), json!(outcome.film.settings().block_length));
    map.insert("rays".into(), json!(outcome.stats.rays));
    map.insert("rel_error".into(), json!(outcome.error.map(|e| e.rel_error)));
    let confidence = outcome.error.map(|e| json!({ "level": CONFIDENCE, "interval": e.interval }));
    map.insert("confidence".into(), json!(confidence));
    map.insert("saturated".into(), json!(outcome.film.saturated()));
    map.insert("invalid".into(), json!(outcome.film.invalid()));
    map.insert("cancelled".into(), json!(outcome.cancelled));
    map
}

/// One line for people.
pub(super) fn summary(outcome: &Outcome, stages: &Stages) -> String {
    let error =
        outcome.error.map_or_else(String::new, |e| format!(", rel_error {:.3} %", 100.0 * e.rel_error));
    let rate = outcome.stats.rays as f64 / outcome.seconds.max(1e-9) * 1e-6;
    format!(
        "{} samples, {:.1} M rays at {rate:.2} M/s{error} ({})",
        outcome.film.samples(),
        outcome.stats.rays as f64 * 1e-6,
        stages.text()
    )
}

/// Warns about sums that were clipped or numbers that were dropped.
pub(super) fn warn_about(outcome: &Outcome) {
    if outcome.film.saturated() > 0 {
        eprintln!("warning: {} sums were clipped", outcome.film.saturated());
    }
    if outcome.film.invalid() > 0 {
        eprintln!("warning: {} block means were not finite and count as 0", outcome.film.invalid());
    }
}
