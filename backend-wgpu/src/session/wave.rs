//! The shaders of a wave, and what the words of its states and probes are.

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

/// One of the tracers of paths: surfaces alone need smaller states than media, and what reads a map others.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Form {
    /// The file of its entry points.
    module: &'static str,
    /// Words of a state.
    pub(crate) rows: u64,
    /// Probes say what they lie in.
    media: bool,
    features: &'static [&'static str],
}

const SURFACES: Form = Form { module: "wavefront::path", rows: 33, media: false, features: &[] };
const VOLUME: Form = Form { module: "wavefront::volume", rows: 45, media: true, features: &[] };
pub(crate) const GATHER: Form =
    Form { module: "wavefront::gather", rows: 45, media: false, features: &["GATHER", "JOB_COUNTS"] };

pub(crate) const GATHER_VOLUME: Form = Form { rows: 65, ..GATHER };

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
    /// That which carries what a scene needs.
    pub(crate) fn of(scene: &CompiledScene) -> &'static Self {
        if scene.needs.volume() { &VOLUME } else { &SURFACES }
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
    pub(crate) trace: Arc<Pipeline>,
    pub(crate) advance: Arc<Pipeline>,
    pub(crate) turn: Arc<Pipeline>,
}

impl Wave {
    pub(crate) fn new(
        gpu: &Gpu,
        form: &Form,
        scene: &CompiledScene,
        stack: usize,
    ) -> Result<Self, BackendError> {
        let mut features = features::of(scene);
        features.extend(form.features);
        let module = form.module;
        let root = format!("{OFFSETS}const TREE_STACK: u32 = {stack}u;\n//: use {module}\n");
        let name = format!("path {} stack {stack}", features.join(" "));
        let link = Link { root: &root, features: &features, mutations: &[] };
        let bindings = bindings([Binding::Write, Binding::Write]);
        let pipeline = |entry| gpu.pipeline(PipelineKey { name: name.clone(), entry }, link, &bindings);
        let turn = Link { root: "//: use wavefront::turn\n", features: &[], mutations: &[] };
        let key = PipelineKey { name: "turn".into(), entry: "turn" };
        Ok(Self {
            start: pipeline("start")?,
            trace: pipeline("trace")?,
            advance: pipeline("advance")?,
            turn: gpu.pipeline(key, turn, &[Binding::Write, Binding::Write])?,
        })
    }
}
