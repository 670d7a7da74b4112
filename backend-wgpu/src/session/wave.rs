//! The shaders of a wave, and what the words of its states and probes are.

use super::bidirectional::BothEnds;
use super::elements::ElementBuffers;
use super::features;
use super::scene::OFFSETS;
use super::task::bindings;
use crate::gpu::{Binding, Gpu, Pipeline, PipelineKey};
use crate::shaders::Link;
use etendue_core::backend::BackendError;
use etendue_core::medium::Inside;
use etendue_core::scene::CompiledScene;
use etendue_core::transport::ProbeStart;
use etendue_core::transport::volume::{Rule, SingleScatter};
use std::sync::Arc;

/// What the paths of a job start from.
#[derive(Clone, Debug)]
pub(crate) enum PathStart {
    /// The camera, and what it stands in.
    Image {
        width: u32,
        inside: Inside,
    },
    Probes(Vec<ProbeStart>),
}

/// What waves estimate.
#[derive(Clone, Debug)]
pub(crate) enum Estimator {
    /// Paths from the sensor.
    Path,
    /// The same with summed airlight, of a camera.
    Airlight(SingleScatter),
    /// Samples from both ends.
    BothEnds(BothEnds),
}

/// A rule and its nodes, as shaders have them (`transport/volume/airlight/rule.wgsl`).
pub(super) fn airlight_words(single: SingleScatter) -> [u32; 2] {
    let rule = match single.rule {
        Rule::Trapezoid => 0,
        Rule::PlainTrapezoid => 1,
        Rule::Equiangular => 2,
    };
    [rule, single.nodes]
}

/// One of the tracers: surfaces alone need smaller states than media, and what reads a map others.
#[derive(Clone, Debug)]
pub(crate) struct Form {
    /// The file of its entry points, and those of a step after `trace`.
    module: &'static str,
    parts: &'static [&'static str],
    /// Words of a state.
    pub(crate) rows: u64,
    /// Probes say what they lie in.
    media: bool,
    features: Vec<&'static str>,
}

/// What the paths of a job read beside the scene, behind their states: words, and where among them those of probes begin.
#[derive(Clone, Debug, Default)]
pub(super) struct Behind {
    pub(super) words: Vec<u32>,
    pub(super) probes: usize,
    /// Words of elements, which are on the device, and where among these words they belong.
    pub(super) elements: Option<(usize, Arc<ElementBuffers>)>,
    /// The last slot of each block is no sample but what all samples have: it is added to their mean.
    pub(super) once: bool,
}

impl Form {
    /// Paths, with what a scene needs.
    pub(crate) fn paths(scene: &CompiledScene) -> Self {
        let media = scene.needs.volume();
        let (module, rows) = if media { ("wavefront::volume", 45) } else { ("wavefront::path", 33) };
        Self { module, parts: &["advance"], rows, media, features: features::of(scene) }
    }

    /// Paths that read a map.
    pub(crate) fn gather(scene: &CompiledScene) -> Self {
        let mut features = features::of(scene);
        features.extend(["GATHER", "JOB_COUNTS"]);
        let rows = if scene.needs.volume() { 65 } else { 45 };
        Self { module: "wavefront::gather", parts: &["advance"], rows, media: false, features }
    }

    /// Paths through media with summed airlight.
    pub(crate) fn airlight(scene: &CompiledScene) -> Self {
        let mut features = features::of(scene);
        features.push("AIRLIGHT");
        let parts = &["advance", "airlight"];
        Self { module: "wavefront::volume", parts, rows: 82, media: true, features }
    }

    /// Samples from both ends, with states of so many words.
    pub(crate) fn both_ends(scene: &CompiledScene, features: Vec<&'static str>, rows: u64) -> Self {
        let media = scene.needs.volume();
        let parts: &[_] = if features.contains(&"SEARCH") {
            &["arrive", "scatter", "join", "search"]
        } else {
            &["arrive", "scatter", "join"]
        };
        Self { module: "wavefront::bidirectional", parts, rows, media, features }
    }

    /// Position, extent and normal of each probe, and what it lies in.
    pub(crate) fn probe_words(&self, start: &PathStart) -> Vec<u32> {
        let mut words = Vec::new();
        let PathStart::Probes(list) = start else { return words };
        for p in list {
            words.extend(p.point.position.to_array().map(f32::to_bits));
            words.push(p.point.extent.to_bits());
            words.extend(p.normal.to_array().map(f32::to_bits));
            if self.media {
                words.extend(p.inside.packed());
            }
        }
        words
    }
}

/// The pipelines of a wave.
#[derive(Debug)]
pub(crate) struct Wave {
    pub(crate) start: Arc<Pipeline>,
    /// The parts of a step, in their order.
    pub(crate) step: Vec<Arc<Pipeline>>,
    pub(crate) turn: Arc<Pipeline>,
}

impl Wave {
    pub(crate) fn new(gpu: &Gpu, form: &Form, stack: usize) -> Result<Self, BackendError> {
        let Form { module, features, .. } = form;
        let root = format!("{OFFSETS}const TREE_STACK: u32 = {stack}u;\n//: use {module}\n");
        let name = format!("path {} stack {stack}", features.join(" "));
        let link = Link { root: &root, features, mutations: &[] };
        let bindings = bindings([Binding::Write, Binding::Write]);
        let pipeline = |entry| gpu.pipeline(PipelineKey { name: name.clone(), entry }, link, &bindings);
        // Rays are the same for all scenes.
        let root = format!("{OFFSETS}const TREE_STACK: u32 = {stack}u;\n//: use wavefront::slots\n");
        let rays = Link { root: &root, features: &[], mutations: &[] };
        let key = PipelineKey { name: format!("rays stack {stack}"), entry: "trace" };
        let mut step = vec![gpu.pipeline(key, rays, &bindings)?];
        for entry in form.parts {
            step.push(pipeline(entry)?);
        }
        let turn = Link { root: "//: use wavefront::turn\n", features: &[], mutations: &[] };
        let key = PipelineKey { name: "turn".into(), entry: "turn" };
        Ok(Self {
            start: pipeline("start")?,
            step,
            turn: gpu.pipeline(key, turn, &[Binding::Write, Binding::Write])?,
        })
    }
}
