//! Illumination maps by photons over a pool of threads.

mod direct;
mod gather;
mod starts;
mod sums;
mod walk;
mod wave;

use crate::tree::Tree;
use etendue_core::backend::{BackendError, Control, JobStats, PhotonJob, PhotonStart};
use etendue_core::film::Film;
use etendue_core::geometry::Hit;
use etendue_core::illumination::{Elements, FluxUnit};
use etendue_core::medium::Inside;
use etendue_core::scene::CompiledScene;
use etendue_core::transport::TransportCode;
use etendue_core::transport::first_shot::FirstShot;
use etendue_core::transport::photon::{Arrival, LightPlan, Replicate, Sequence};
use etendue_core::transport::volume::LightMedia;
use etendue_core::with_photon_tracer;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

pub(crate) use direct::direct;
pub(crate) use gather::{Target, gather, read};
use starts::Source;
pub use starts::first_shot;
use sums::{Part, Sums};

/// Photons of one task, and between two looks at the control.
const TASK: u32 = 1 << 12;

/// What all tasks of a job share.
struct Shared<'a> {
    scene: &'a CompiledScene,
    tree: &'a Tree,
    media: &'a LightMedia,
    elements: &'a Elements,
    source: Source<'a>,
    job: &'a PhotonJob,
    unit: FluxUnit,
    sums: &'a Sums,
    /// Where the second sums of caustics begin, if they are kept.
    caustics: Option<u32>,
}

impl Shared<'_> {
    /// Registers an arrival.
    #[inline(always)]
    fn register(&self, hit: &Hit, a: &Arrival, sums: &mut Part) {
        self.elements.deposit(hit, a.from_front, |element, factor| {
            let flux = a.flux * factor;
            sums.add(element, flux, self.unit);
            if let Some(first) = self.caustics
                && a.caustic
            {
                sums.add(first + element, flux, self.unit);
            }
        });
    }
}

/// Counts what is done, and passes on that it shall stop.
struct Meter<'a> {
    control: &'a dyn Control,
    rays: AtomicU64,
    hits: AtomicU64,
    done: AtomicU64,
    all: u64,
    cancelled: AtomicBool,
}

impl<'a> Meter<'a> {
    fn new(control: &'a dyn Control, all: u64) -> Self {
        let zero = || AtomicU64::new(0);
        Self { control, rays: zero(), hits: zero(), done: zero(), all, cancelled: AtomicBool::new(false) }
    }

    fn stopped(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    fn count(&self, rays: u64, hits: u64, photons: u64) {
        self.rays.fetch_add(rays, Ordering::Relaxed);
        self.hits.fetch_add(hits, Ordering::Relaxed);
        let now = self.done.fetch_add(photons, Ordering::Relaxed) + photons;
        if self.control.advance(now, self.all).is_break() {
            self.cancelled.store(true, Ordering::Relaxed);
        }
    }
}

/// Walks the photons of one replicate of a job; only some of them where the meter says stop.
fn replicate(
    pool: &rayon::ThreadPool,
    code: TransportCode,
    shared: &Shared<'_>,
    number: u32,
    meter: &Meter<'_>,
) {
    let job = shared.job;
    let replicate = Replicate::new(job.seed, job.sequence, job.photons, number);
    with_photon_tracer!(code, shared.scene, job.max_hits, |tracer| {
        let flight = tracer.flight(shared.media);
        pool.install(|| match job.sequence {
            Sequence::Sorted => wave::walk((&tracer, &flight), shared, &replicate, meter),
            Sequence::Sobol | Sequence::Random => {
                (0..job.photons.div_ceil(TASK)).into_par_iter().with_max_len(1).for_each(|task| {
                    if meter.stopped() {
                        return;
                    }
                    let photons = task * TASK..job.photons.min((task + 1) * TASK);
                    let count = u64::from(photons.end - photons.start);
                    let [rays, hits] =
                        walk::walk((&tracer, &flight), shared, &replicate, photons, &mut shared.sums.mine());
                    meter.count(rays, hits, count);
                });
            }
        });
    });
}

/// What photons of a job need to walk.
#[derive(Clone, Copy)]
pub(crate) struct Photons<'a> {
    pub scene: &'a CompiledScene,
    pub tree: &'a Tree,
    /// What the lights send into, and what the camera stands in.
    pub media: &'a LightMedia,
    pub camera: Inside,
    pub elements: &'a Elements,
    pub code: TransportCode,
    pub job: &'a PhotonJob,
    /// The density of a job that starts on surfaces.
    pub shot: Option<&'a FirstShot>,
}

/// Makes a job's maps, one after another.
struct Maps<'a> {
    pool: &'a rayon::ThreadPool,
    photons: Photons<'a>,
    source: Source<'a>,
    unit: FluxUnit,
    sums: Sums,
    caustics: Option<u32>,
}

impl<'a> Maps<'a> {
    /// With a second set of sums for caustics, behind the first, or without.
    fn new(
        pool: &'a rayon::ThreadPool,
        photons: Photons<'a>,
        plan: &'a LightPlan,
        caustics: bool,
    ) -> Result<Self, BackendError> {
        let source = match (&photons.job.start, photons.shot) {
            (PhotonStart::Surfaces { .. }, Some(shot)) => Source::Surfaces(shot),
            (PhotonStart::Surfaces { .. }, None) => {
                return Err(BackendError::BadJob { reason: "no density of starts" });
            }
            (PhotonStart::Lights { registers_direct, survives_first }, _) => {
                Source::Lights { plan, registers_direct: *registers_direct, survives_first: *survives_first }
            }
        };
        let total = plan.total().into_iter().fold(0.0, f64::max);
        let count = photons.elements.count();
        Ok(Self {
            pool,
            photons,
            source,
            unit: FluxUnit::new(total, photons.job.photons),
            sums: Sums::new(pool, if caustics { 2 * count } else { count }),
            caustics: caustics.then_some(count as u32),
        })
    }

    /// Irradiance \[W/m^2\] per element by one replicate.
    fn make(&mut self, number: u32, meter: &Meter<'_>) -> Result<Vec<[f64; 3]>, BackendError> {
        let Photons { scene, tree, media, elements, code, job, .. } = self.photons;
        let (source, unit, caustics) = (self.source, self.unit, self.caustics);
        let shared = Shared { scene, tree, media, elements, source, job, unit, sums: &self.sums, caustics };
        replicate(self.pool, code, &shared, number, meter);
        if meter.stopped() {
            return Err(BackendError::Cancelled);
        }
        let sums = &mut self.sums;
        Ok(self.pool.install(|| sums.take(elements, unit)))
    }
}

/// Runs a job; the film is changed at the end or not at all.
pub(crate) fn run(
    pool: &rayon::ThreadPool,
    photons: Photons<'_>,
    control: &dyn Control,
    film: &mut Film,
) -> Result<JobStats, BackendError> {
    let plan = LightPlan::new(photons.scene).map_err(|_| BackendError::Dark)?;
    let mut maps = Maps::new(pool, photons, &plan, false)?;
    let mut part = Film::new(*film.settings());
    let job = photons.job;
    let all = u64::from(job.replicates.end - job.replicates.start) * u64::from(job.photons);
    let meter = Meter::new(control, all);
    for number in job.replicates.clone() {
        part.add_blocks(number..number + 1, &maps.make(number, &meter)?)?;
    }
    film.merge(&part)?;
    Ok(JobStats { rays: meter.rays.into_inner(), paths: all, hits: meter.hits.into_inner() })
}
