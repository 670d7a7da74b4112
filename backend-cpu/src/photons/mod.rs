//! Illumination maps by photons over a pool of threads.

mod direct;
mod starts;
mod sums;
mod walk;
mod wave;

use crate::tree::Tree;
use etendue_core::backend::{BackendError, Control, JobStats, PhotonJob, PhotonStart};
use etendue_core::film::Film;
use etendue_core::illumination::{Elements, FluxUnit};
use etendue_core::sampling::numbers::Numbers;
use etendue_core::scene::CompiledScene;
use etendue_core::transport::TransportCode;
use etendue_core::transport::first_shot::FirstShot;
use etendue_core::transport::photon::{LightPlan, Sequence};
use etendue_core::with_photon_tracer;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

pub(crate) use direct::direct;
pub(crate) use starts::first_shot;
use starts::{Replicate, Source};
use sums::Sums;

/// Photons of one task, and between two looks at the control.
const TASK: u32 = 1 << 12;

/// What all tasks of a job share.
struct Shared<'a> {
    scene: &'a CompiledScene,
    tree: &'a Tree,
    elements: &'a Elements,
    source: Source<'a>,
    job: &'a PhotonJob,
    unit: FluxUnit,
    sums: &'a Sums,
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
    let replicate = Replicate::new(shared, number);
    let random = Numbers::random(job.seed, number);
    with_photon_tracer!(code, shared.scene, job.max_hits, |tracer| {
        pool.install(|| match job.sequence {
            Sequence::Sorted => wave::walk(&tracer, shared, &replicate, &random, meter),
            Sequence::Sobol | Sequence::Random => {
                (0..job.photons.div_ceil(TASK)).into_par_iter().with_max_len(1).for_each(|task| {
                    if meter.stopped() {
                        return;
                    }
                    let photons = task * TASK..job.photons.min((task + 1) * TASK);
                    let count = u64::from(photons.end - photons.start);
                    let [rays, hits] =
                        walk::walk(&tracer, shared, &replicate, photons, &mut shared.sums.mine());
                    meter.count(rays, hits, count);
                });
            }
        });
    });
}

/// Runs a job; the film is changed at the end or not at all. `shot` is the density of a job that starts on surfaces.
pub(crate) fn run(
    pool: &rayon::ThreadPool,
    (scene, tree, elements, shot): (&CompiledScene, &Tree, &Elements, Option<&FirstShot>),
    code: TransportCode,
    job: &PhotonJob,
    control: &dyn Control,
    film: &mut Film,
) -> Result<JobStats, BackendError> {
    let plan = LightPlan::new(scene).map_err(|_| BackendError::Dark)?;
    let source = match (&job.start, shot) {
        (PhotonStart::Surfaces { .. }, Some(shot)) => Source::Surfaces(shot),
        (PhotonStart::Surfaces { .. }, None) => {
            return Err(BackendError::BadJob { reason: "no density of starts" });
        }
        (PhotonStart::Lights { registers_direct, survives_first }, _) => Source::Lights {
            plan: &plan,
            registers_direct: *registers_direct,
            survives_first: *survives_first,
        },
    };
    let total = plan.total().into_iter().fold(0.0, f64::max);
    let unit = FluxUnit::new(total, job.photons);
    let mut sums = Sums::new(pool, elements.count());
    let mut part = Film::new(*film.settings());
    let all = u64::from(job.replicates.end - job.replicates.start) * u64::from(job.photons);
    let meter = Meter::new(control, all);
    for number in job.replicates.clone() {
        let shared = Shared { scene, tree, elements, source, job, unit, sums: &sums };
        replicate(pool, code, &shared, number, &meter);
        if meter.stopped() {
            return Err(BackendError::Cancelled);
        }
        let means = pool.install(|| sums.take(elements, unit));
        part.add_blocks(number..number + 1, &means)?;
    }
    film.merge(&part)?;
    Ok(JobStats { rays: meter.rays.into_inner(), paths: all, hits: meter.hits.into_inner() })
}
