//! What an analytic case is.

use super::{closed, direct, media, open};
use etendue_core::backend::Probe;
use etendue_core::scene::SceneDesc;

/// What is measured.
#[derive(Clone, Debug)]
pub enum Measure {
    /// Irradiance \[W/m^2\] at points; one truth per probe.
    Probes(Vec<Probe>),
    /// Radiance \[W m^-2 sr^-1\] of each pixel of the scene's camera; one truth for all pixels.
    Pixels,
    /// The mean of all pixels; one truth.
    ImageMean,
    /// The mean of the irradiance at the probes; one truth.
    ProbeMean(Vec<Probe>),
}

/// A scene with an exact answer.
#[derive(Clone, Debug)]
pub struct Case {
    /// Name, stable across versions.
    pub name: String,
    /// Where the answer comes from.
    pub source: &'static str,
    /// The scene.
    pub scene: SceneDesc,
    /// What is measured.
    pub measure: Measure,
    /// Largest number of edges.
    pub max_depth: u32,
    /// The answers, per element, the same in every channel unless stated.
    pub truth: Vec<[f64; 3]>,
    /// Samples per element, before the multiple of the level: what the noise of this case asks for.
    pub samples: u32,
    /// Relative error allowed beyond the statistical one: rounding of f32, facets.
    pub rounding: f64,
    /// Largest relative standard error with which a quick run still has power.
    pub power: f64,
}

/// Relative error that sums of some ten f32 factors may have.
pub(super) const ROUNDING: f64 = 3e-6;
/// Standard errors stay below this share of the truth, or the test says nothing.
pub(super) const POWER: f64 = 0.005;

/// A case of irradiance at probes.
pub(super) fn probes(
    name: impl Into<String>,
    source: &'static str,
    scene: SceneDesc,
    list: Vec<(Probe, f64)>,
    max_depth: u32,
    samples: u32,
) -> Case {
    let truth = list.iter().map(|(_, e)| [*e; 3]).collect();
    Case {
        name: name.into(),
        source,
        scene,
        measure: Measure::Probes(list.into_iter().map(|(p, _)| p).collect()),
        max_depth,
        truth,
        samples,
        rounding: ROUNDING,
        power: POWER,
    }
}

/// Every case.
pub fn cases() -> Vec<Case> {
    let mut all = closed::cases();
    all.extend(direct::cases());
    all.extend(open::cases());
    all.extend(media::cases());
    all
}
