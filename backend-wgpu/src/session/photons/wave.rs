//! The shaders of a wave of photons.

use crate::gpu::{Binding, Gpu, Pipeline, PipelineKey};
use crate::session::features;
use crate::session::scene::OFFSETS;
use crate::session::task::bindings;
use crate::shaders::Link;
use etendue_core::backend::BackendError;
use etendue_core::scene::CompiledScene;
use std::sync::Arc;

/// Words of a state: more where there are media.
pub(super) fn rows(scene: &CompiledScene) -> u64 {
    if scene.needs.volume() { 29 } else { 18 }
}

/// How the photons of a job walk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Kind {
    /// They wait for each other, and are put in order.
    pub(super) sorted: bool,
    /// They start on surfaces.
    pub(super) surfaces: bool,
    /// Ways are followed before they start.
    pub(super) follows: bool,
}

/// The pipelines of a wave.
#[derive(Debug)]
pub(super) struct Wave {
    pub(super) start: Arc<Pipeline>,
    pub(super) trace: Arc<Pipeline>,
    pub(super) arrive: Arc<Pipeline>,
    pub(super) scatter: Arc<Pipeline>,
    pub(super) landed: Arc<Pipeline>,
    pub(super) turn: Arc<Pipeline>,
    pub(super) order: Option<Order>,
}

/// Those of photons in order.
#[derive(Debug)]
pub(super) struct Order {
    pub(super) landed: [Arc<Pipeline>; 2],
    pub(super) digits: [Arc<Pipeline>; 2],
    pub(super) chances: [Arc<Pipeline>; 2],
    pub(super) scan: [Arc<Pipeline>; 3],
    pub(super) turn: Arc<Pipeline>,
}

impl Wave {
    pub(super) fn new(
        gpu: &Gpu,
        scene: &CompiledScene,
        stack: usize,
        kind: Kind,
    ) -> Result<Self, BackendError> {
        let mut features = features::of(scene);
        features.push("JOB_COUNTS");
        features.extend(kind.sorted.then_some("SORTED"));
        features.extend(kind.surfaces.then_some("SURFACES"));
        features.extend(kind.follows.then_some("FOLLOWS"));
        let root = format!("{OFFSETS}const TREE_STACK: u32 = {stack}u;\n//: use wavefront::photons\n");
        let name = format!("photons {} stack {stack}", features.join(" "));
        let bindings = bindings([Binding::Write, Binding::Write]);
        let link = Link { root: &root, features: &features, mutations: &[] };
        let pipeline = |entry| gpu.pipeline(PipelineKey { name: name.clone(), entry }, link, &bindings);
        let between = Link { root: "//: use wavefront::photons::turn\n", features: &[], mutations: &[] };
        let turn = |entry| {
            let key = PipelineKey { name: "photons' turn".into(), entry };
            gpu.pipeline(key, between, &[Binding::Write, Binding::Write])
        };
        let in_order =
            Link { root: "//: use wavefront::photons::order\n", features: &["JOB_COUNTS"], mutations: &[] };
        let order =
            |entry| gpu.pipeline(PipelineKey { name: "photons' order".into(), entry }, in_order, &bindings);
        Ok(Self {
            start: pipeline("start")?,
            trace: pipeline("trace")?,
            arrive: pipeline("arrive")?,
            scatter: pipeline("scatter")?,
            landed: turn("landed")?,
            turn: turn("turn")?,
            order: if kind.sorted {
                Some(Order {
                    landed: [order("landed_count")?, order("landed_move")?],
                    digits: [order("digit_count")?, order("digit_move")?],
                    chances: [order("chance_sum")?, order("survive")?],
                    scan: [order("scan_runs")?, order("scan_all")?, order("scan_back")?],
                    turn: order("order_turn")?,
                })
            } else {
                None
            },
        })
    }
}
