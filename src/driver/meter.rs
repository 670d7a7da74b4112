//! Irradiance meters as large as a surface: means over all of it.
//!
//! A block of samples looks at points of its own, uniform over the surface by a scrambled Sobol' sequence, a few samples at each; their mean is the block's. So the spread of the blocks is the error of
//! points and samples together, and any method that knows probes can be asked.

use super::{GatherSettings, Outcome, Settings, Watcher, both_ends, drive, even, first_job};
use etendue_core::backend::{self, BackendError, Control, JobStats, PathJob, Probe, Session};
use etendue_core::direct::irradiance::place_on;
use etendue_core::film::Film;
use etendue_core::math::u32_to_unit;
use etendue_core::sampling::discrete::IntegerCdf;
use etendue_core::sampling::numbers::Numbers;
use etendue_core::scene::CompiledScene;
use etendue_core::transport::bidirectional::Heuristic;
use std::ops::ControlFlow;

/// Samples at each point, if a block has as many.
const SAMPLES: u32 = 4;
/// The group of numbers that names a place, far from those of photons of the same seed.
const PLACE_GROUP: u32 = 1 << 30;

/// A surface whose mean irradiance is asked for.
#[derive(Clone, Debug)]
pub struct Meter {
    primitives: Vec<u32>,
    density: IntegerCdf,
    area: f64,
    back: bool,
}

impl Meter {
    /// All surfaces of a material, at their fronts or at their backs. `None` where no surface with an area has it.
    pub fn of_material(scene: &CompiledScene, name: &str, back: bool) -> Option<Self> {
        let material = scene.material_names.iter().position(|n| n == name)?;
        let primitives: Vec<u32> = (0_u32..)
            .zip(&scene.surfaces)
            .filter(|(_, s)| s.material as usize == material)
            .map(|(id, _)| id)
            .collect();
        let areas: Vec<f32> = primitives.iter().map(|id| scene.primitive_area(*id)).collect();
        let density = IntegerCdf::try_new(&areas).ok()?;
        Some(Self { primitives, density, area: areas.iter().map(|a| f64::from(*a)).sum(), back })
    }

    /// Its area \[m^2\].
    pub fn area(&self) -> f64 {
        self.area
    }

    /// A place on it, uniform for uniform words.
    fn place(&self, scene: &CompiledScene, numbers: &Numbers) -> Option<Probe> {
        let [pick, u, v, _] = numbers.bits4(PLACE_GROUP);
        let primitive = *self.primitives.get(self.density.pick(pick).index as usize)?;
        let (position, normal) = place_on(scene, primitive, [u, v].map(u32_to_unit))?;
        let normal = if self.back { -normal } else { normal };
        Some(Probe { position: position.to_array(), normal: normal.to_array() })
    }
}

/// How meters are read.
#[derive(Clone, Copy, Debug)]
pub enum MeterMethod<'a> {
    /// By paths from the meter.
    Path,
    /// By paths from both ends.
    Bidirectional(Heuristic),
    /// By gathering from maps of photons.
    Photon(&'a GatherSettings),
}

/// Passes on the progress of one block as that of its pass.
struct Portion<'a> {
    control: &'a dyn Control,
    before: u64,
    blocks: u64,
}

impl Control for Portion<'_> {
    fn advance(&self, done: u64, total: u64) -> ControlFlow<()> {
        self.control.advance(self.before * total + done, self.blocks * total)
    }
}

/// Mean irradiance \[W/m^2\] of each meter.
///
/// # Errors
/// As for probes; being stopped is no error.
pub fn meters(
    session: &dyn Session,
    meters: &[Meter],
    settings: &Settings,
    method: MeterMethod<'_>,
    watcher: &dyn Watcher,
) -> Result<Outcome, BackendError> {
    let first = first_job(settings);
    let film = Film::new(backend::probe_film_settings(session.scene(), &first, meters.len()));
    let budget = settings.budget;
    drive(film, first, budget, watcher, &even, |job, control, film| {
        let mut part = Film::new(*film.settings());
        let mut stats = JobStats::default();
        let blocks = u64::from(job.blocks.end - job.blocks.start);
        for (before, block) in (0_u64..).zip(job.blocks.clone()) {
            let control = &Portion { control, before, blocks };
            let (points, inner) = points(session.scene(), meters, job, block);
            let probes: Vec<Probe> = points.iter().map(|p| p.1).collect();
            let mut seen = Film::new(backend::probe_film_settings(session.scene(), &inner, probes.len()));
            stats += match method {
                MeterMethod::Path => session.path_probes(&inner, &probes, control, &mut seen)?,
                MeterMethod::Bidirectional(heuristic) => {
                    let inner = both_ends(&inner, heuristic);
                    session.bidirectional_probes(&inner, &probes, control, &mut seen)?
                }
                MeterMethod::Photon(gather) => {
                    session.photon_probes(&gather.job(&inner, budget), &probes, control, &mut seen)?
                }
            };
            let mean = |meter: u32| {
                let mine = || points.iter().enumerate().filter(move |(_, p)| p.0 == meter);
                let count = mine().count().max(1) as f64;
                [0, 1, 2].map(|c| mine().map(|(i, _)| seen.mean(i)[c]).sum::<f64>() / count)
            };
            let means: Vec<[f64; 3]> = (0..meters.len() as u32).map(mean).collect();
            part.add_blocks(block..block + 1, &means)?;
        }
        film.merge(&part)?;
        Ok(stats)
    })
}

/// The points of a block with the numbers of their meters, and what is asked there.
fn points(
    scene: &CompiledScene,
    meters: &[Meter],
    job: &PathJob,
    block: u32,
) -> (Vec<(u32, Probe)>, PathJob) {
    let samples = SAMPLES.min(job.block_length);
    let count = job.block_length / samples;
    let numbers = Numbers::sobol(job.seed, block);
    let places = (0_u32..).zip(meters).flat_map(|(number, meter)| {
        (0..count).filter_map(move |i| Some((number, meter.place(scene, &numbers.with_index(i))?)))
    });
    (places.collect(), PathJob { blocks: block..block + 1, block_length: samples, ..job.clone() })
}
