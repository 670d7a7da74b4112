//! What a report measures of this program: every method that a scene allows, on every backend that is there.

use super::reference::{radiance_of, variance_of};
use super::{Contender, Curve, Picture, ReportError};
use crate::driver::radiosity::{self, BakeSettings, Codec, Counted, Operator, Order};
use crate::driver::{
    self, Budget, GatherSettings, Outcome, PhotonSettings, Settings, Watcher, choose_start, element_size,
};
use cpu_time::ProcessTime;
use etendue_core::backend::{BackendError, GivenMap, PhotonStart, Session};
use etendue_core::illumination::{Basis, ElementSettings, Sides};
use etendue_core::radiosity::patches::PatchSettings;
use etendue_core::transport::bidirectional::Heuristic;
use etendue_core::transport::first_shot::{Subdivision, Weights};
use etendue_core::transport::photon::Sequence;
use std::time::Instant;

/// Samples of the lowest rung.
const SAMPLES: u64 = 16;
/// Fewest blocks of a reference.
const BLOCKS_LEAST: u64 = 4;
/// Photons for each sample of a pixel: `render` has 2^20 for its 256.
const PHOTONS_PER_SAMPLE: u64 = 4096;
/// Patches of the lowest rung.
const PATCHES: u32 = 256;
/// Most patches, and samples of an image from their map.
const PATCHES_MOST: u32 = 1 << 14;
const MAP_SAMPLES_MOST: u64 = 64;
/// Rungs are below.
const RUNGS: u32 = 24;

fn samples_of(rung: u32) -> u64 {
    SAMPLES << rung.min(RUNGS)
}

/// How [`Sampling`] makes an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SamplingMethod {
    /// By paths from the sensor.
    Path,
    /// By paths from both ends.
    Bidirectional,
    /// From maps of photons.
    Photon {
        /// Where they start.
        start: PhotonStart,
        /// Whether the first diffuse surface gathers.
        gather: bool,
    },
}

impl SamplingMethod {
    fn curve(self, backend: &str) -> Curve {
        match self {
            Self::Path => Curve::new("path", "", backend),
            Self::Bidirectional => Curve::new("bdpt", "", backend),
            Self::Photon { start, gather } => {
                let from = match start {
                    PhotonStart::Lights { .. } => "from lights",
                    PhotonStart::Surfaces { .. } => "from surfaces",
                };
                let variant = if gather { format!("{from}, gather") } else { from.into() };
                Curve::new("photon", &variant, backend)
            }
        }
    }

    fn options(self, samples: u64) -> String {
        match self {
            Self::Path => format!("--method path --samples {samples}"),
            Self::Bidirectional => format!("--method bdpt --samples {samples}"),
            Self::Photon { start, gather } => {
                let from = if matches!(start, PhotonStart::Lights { .. }) { "lights" } else { "surfaces" };
                let gather = if gather { " --gather" } else { "" };
                let photons = samples * PHOTONS_PER_SAMPLE;
                format!("--method photon --from {from}{gather} --samples {samples} --photons {photons}")
            }
        }
    }
}

/// A method whose effort is its samples.
pub struct Sampling<'a> {
    session: &'a dyn Session,
    method: SamplingMethod,
    curves: [Curve; 1],
}

impl<'a> Sampling<'a> {
    /// On a session of this backend.
    pub fn new(session: &'a dyn Session, backend: &str, method: SamplingMethod) -> Self {
        Self { session, method, curves: [method.curve(backend)] }
    }

    fn render(&self, settings: &Settings, watcher: &dyn Watcher) -> Result<Outcome, BackendError> {
        match self.method {
            SamplingMethod::Path => driver::image(self.session, settings, watcher),
            SamplingMethod::Bidirectional => {
                driver::bidirectional_image(self.session, settings, Heuristic::Power, watcher)
            }
            SamplingMethod::Photon { start, gather } => {
                let Budget::Samples(samples) = settings.budget else {
                    return Err(BackendError::BadJob { reason: "maps of photons need a number of samples" });
                };
                let largest = element_size(self.session.scene());
                let elements = ElementSettings { basis: Basis::Constant, sides: Sides::Apart, largest };
                let photons = PhotonSettings { start, sequence: Sequence::Sorted, elements };
                let gather = GatherSettings { photons, count: samples * PHOTONS_PER_SAMPLE, gather };
                driver::photon_image(self.session, settings, &gather, watcher)
            }
        }
    }
}

impl Contender for Sampling<'_> {
    fn curves(&self) -> &[Curve] {
        &self.curves
    }

    fn converges(&self) -> bool {
        matches!(self.method, SamplingMethod::Path | SamplingMethod::Bidirectional)
    }

    fn for_seconds(
        &mut self,
        seconds: f64,
        seed: u64,
        watcher: &dyn Watcher,
    ) -> Result<Outcome, ReportError> {
        let settings = Settings { seed, budget: Budget::Seconds(seconds), ..Settings::default() };
        let outcome = self.render(&settings, watcher)?;
        if outcome.film.block_count() >= BLOCKS_LEAST || outcome.cancelled {
            return Ok(outcome);
        }
        // However long they take: without blocks nothing is known of its error.
        let budget = Budget::Samples(BLOCKS_LEAST * SAMPLES);
        Ok(self.render(&Settings { budget, ..settings }, watcher)?)
    }

    fn run(&mut self, rung: u32, seed: u64, watcher: &dyn Watcher) -> Result<Vec<Picture>, ReportError> {
        let samples = samples_of(rung);
        let settings = Settings { seed, budget: Budget::Samples(samples), ..Settings::default() };
        let (start, cpu) = (Instant::now(), ProcessTime::now());
        let outcome = self.render(&settings, watcher)?;
        if outcome.cancelled {
            return Err(BackendError::Cancelled.into());
        }
        Ok(vec![Picture {
            curve: 0,
            effort: format!("{samples} samples"),
            options: self.method.options(samples),
            samples,
            radiance: radiance_of(&outcome.film),
            variance: variance_of(&outcome.film),
            stages: vec![("sample", start.elapsed().as_secs_f64())],
            cpu_seconds: cpu.elapsed().as_secs_f64(),
            rays: outcome.stats.rays,
            bytes: None,
        }])
    }
}

/// The codecs of a report, by the names of `--codec`.
const CODECS: [(&str, Codec); 6] = [
    ("auto", Codec::Auto { max_error: 0.01 }),
    ("tiles", Codec::Tiles),
    ("f32", Codec::F32),
    ("published", Codec::Published { bounces: Some(3), keep: 0.04, order: Order::Kd }),
    ("bc1", Codec::Bc1 { keep: 0.04 }),
    ("bc4", Codec::Bc4 { keep: 0.04 }),
];

/// An image, and seconds by stage.
type Looked = (Outcome, Vec<(&'static str, f64)>);

/// Operators: effort is patches; one bake serves all codecs, each of which is counted as if it had baked alone.
pub struct Baking<'a> {
    session: &'a dyn Session,
    curves: Vec<Curve>,
}

impl<'a> Baking<'a> {
    /// On a session of this backend.
    pub fn new(session: &'a dyn Session, backend: &str) -> Self {
        let mut curves: Vec<Curve> =
            CODECS.iter().map(|(name, _)| Curve::new("radiosity", name, backend)).collect();
        curves.push(Curve::new("radiosity", "auto, gather", backend));
        Self { session, curves }
    }

    /// The image of one operator.
    fn look(
        &self,
        (operator, gather): (&Operator, bool),
        (samples, seed): (u64, u64),
        watcher: &dyn Watcher,
    ) -> Result<Looked, ReportError> {
        let relit = radiosity::relit(self.session, operator, seed, watcher)?;
        let elements = *operator.map.elements.settings();
        let map = GivenMap { elements, values: &relit.values, gather };
        let settings = Settings { seed, budget: Budget::Samples(samples), ..Settings::default() };
        let start = Instant::now();
        let outcome = radiosity::map_image(self.session, &settings, &map, watcher)?;
        if outcome.cancelled {
            return Err(BackendError::Cancelled.into());
        }
        let mut stages = relit.stages;
        stages.push(("sample", start.elapsed().as_secs_f64()));
        Ok((outcome, stages))
    }
}

impl Contender for Baking<'_> {
    fn curves(&self) -> &[Curve] {
        &self.curves
    }

    fn growth(&self) -> f64 {
        3.0
    }

    fn run(&mut self, rung: u32, seed: u64, watcher: &dyn Watcher) -> Result<Vec<Picture>, ReportError> {
        let patches = PATCHES << rung.min(RUNGS);
        if patches > PATCHES_MOST {
            return Ok(Vec::new());
        }
        let settings = BakeSettings {
            patches: PatchSettings { count: patches, seed },
            rays: patches,
            ..BakeSettings::default()
        };
        let cpu = ProcessTime::now();
        let counted: Counted = radiosity::count(self.session, &settings, watcher)?;
        let counted_cpu = cpu.elapsed().as_secs_f64();
        let shared: f64 = counted.stages.iter().map(|s| s.1).sum();
        let samples = samples_of(rung).min(MAP_SAMPLES_MOST);
        let mut pictures = Vec::new();
        for (number, (name, codec)) in CODECS.iter().enumerate() {
            let cpu = ProcessTime::now();
            // A codec that cannot hold these form factors leaves its curve without this point.
            let Ok((operator, _, encoding)) = counted.store(self.session, *codec, None) else { continue };
            let encoded_cpu = counted_cpu + cpu.elapsed().as_secs_f64();
            let gathers: &[bool] = if *name == "auto" { &[false, true] } else { &[false] };
            for gather in gathers {
                let cpu = ProcessTime::now();
                let (outcome, look) = self.look((&operator, *gather), (samples, seed), watcher)?;
                let mut stages = vec![("bake", shared), ("encode", encoding)];
                stages.extend(look);
                let flag = if *gather { " --gather" } else { "" };
                pictures.push(Picture {
                    curve: if *gather { CODECS.len() } else { number },
                    effort: format!("{} patches", operator.map.patches.len()),
                    options: format!(
                        "--method radiosity --patches {patches} --codec {name}{flag} --samples {samples}"
                    ),
                    samples,
                    radiance: radiance_of(&outcome.film),
                    // That of the samples alone: the operator is one.
                    variance: None,
                    stages,
                    cpu_seconds: encoded_cpu + cpu.elapsed().as_secs_f64(),
                    rays: counted.rays + outcome.stats.rays,
                    bytes: Some(operator.bytes() as u64),
                });
            }
        }
        Ok(pictures)
    }
}

/// Everything that can be asked of a session; `methods` (all where empty) says which of `path`, `bdpt`, `photon`, `radiosity`. What a scene or a backend refuses says so when it runs.
pub fn contenders<'a>(
    session: &'a dyn Session,
    backend: &str,
    methods: &[String],
) -> Vec<Box<dyn Contender + 'a>> {
    let wanted = |name: &str| methods.is_empty() || methods.iter().any(|m| m == name);
    let mut list: Vec<Box<dyn Contender + 'a>> = Vec::new();
    let mut add = |method| list.push(Box::new(Sampling::new(session, backend, method)));
    if wanted("path") {
        add(SamplingMethod::Path);
    }
    if wanted("bdpt") {
        add(SamplingMethod::Bidirectional);
    }
    if wanted("photon") {
        let weights = Weights::EXACT;
        let surfaces = PhotonStart::Surfaces { subdivision: Subdivision::robust(weights), weights };
        // Starts on surfaces where these are forecast to pay; always those at the lights.
        let mut starts = vec![PhotonStart::LIGHTS];
        let expected = Budget::Samples(PHOTONS_PER_SAMPLE * samples_of(4));
        if matches!(choose_start(session, expected), Ok(PhotonStart::Surfaces { .. })) {
            starts.push(surfaces);
        }
        for start in starts {
            for gather in [false, true] {
                add(SamplingMethod::Photon { start, gather });
            }
        }
    }
    if wanted("radiosity") {
        list.push(Box::new(Baking::new(session, backend)));
    }
    list
}
