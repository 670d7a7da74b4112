//! Illumination maps by photons over a pool of threads.

use crate::simd::widest;
use crate::tree::Tree;
use etendue_core::backend::{BackendError, Control, JobStats, PhotonJob, PhotonStart};
use etendue_core::direct::subdivide::Workspace;
use etendue_core::film::Film;
use etendue_core::geometry::Intersector;
use etendue_core::illumination::{FluxUnit, element_areas, irradiance};
use etendue_core::sampling::sobol::BlockSampler;
use etendue_core::scene::CompiledScene;
use etendue_core::transport::TransportCode;
use etendue_core::transport::first_shot::{FirstShot, FirstShotError, LitPiece, Subdivision, lit_pieces};
use etendue_core::transport::photon::{LightPlan, PhotonTracer};
use etendue_core::with_photon_tracer;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicI64, AtomicU64, Ordering};

/// Photons of one task, and between two looks at the control.
const TASK: u32 = 1 << 12;

/// Sums of arrivals per primitive and channel; integers, so that any order gives the same.
struct Sums(Vec<[AtomicI64; 3]>);

impl Sums {
    fn new(count: usize) -> Self {
        Self((0..count).map(|_| [const { AtomicI64::new(0) }; 3]).collect())
    }

    #[inline(always)]
    fn add(&self, element: u32, units: [i64; 3]) {
        if let Some(sums) = self.0.get(element as usize) {
            for (sum, x) in sums.iter().zip(units) {
                sum.fetch_add(x, Ordering::Relaxed);
            }
        }
    }

    fn take(&mut self) -> Vec<[i64; 3]> {
        self.0.iter_mut().map(|s| s.each_mut().map(|x| core::mem::take(x.get_mut()))).collect()
    }
}

/// Where photons start.
#[derive(Clone, Copy)]
enum Start<'a> {
    Lights { plan: &'a LightPlan, registers_direct: bool },
    Surfaces(&'a FirstShot),
}

/// What all tasks of a job share.
struct Shared<'a> {
    scene: &'a CompiledScene,
    tree: &'a Tree,
    start: Start<'a>,
    job: &'a PhotonJob,
    unit: FluxUnit,
    sums: &'a Sums,
}

widest! {
    /// Photons `first .. first + count` of a replicate; the rays that they took and the arrivals that count.
    fn trace[const L: bool, const T: bool, const S: bool](
        tracer: &PhotonTracer<'_, L, T, S>,
        shared: &Shared<'_>,
        replicate: u32,
        first: u32,
        count: u32,
    ) -> [u64; 2] {
        let (mut rays, mut hits) = (0, 0);
        let named = BlockSampler::new(shared.job.seed, 0, replicate, 0);
        for index in first..first + count {
            let sampler = named.with_index(index);
            let started = match shared.start {
                Start::Lights { plan, registers_direct } => {
                    Some(tracer.start_from_lights(plan, sampler, registers_direct))
                }
                Start::Surfaces(shot) => shot.start(shared.scene, tracer, sampler),
            };
            let Some(mut photon) = started else { continue };
            loop {
                rays += 1;
                let hit = shared.tree.closest_hit(&photon.ray);
                let (arrival, lives) = tracer.advance(&mut photon, hit);
                if let Some(a) = arrival {
                    hits += 1;
                    let [x, y, z] = a.flux.to_array();
                    shared.sums.add(a.primitive, [shared.unit.units(x), shared.unit.units(y), shared.unit.units(z)]);
                }
                if !lives {
                    break;
                }
            }
        }
        [rays, hits]
    }
}

/// Triangles of one task of the precomputation.
const TRIANGLES: usize = 256;

/// The density of starts on surfaces, and the shadow rays it took. The same for any number of threads.
pub(crate) fn first_shot(
    pool: &rayon::ThreadPool,
    scene: &CompiledScene,
    tree: &Tree,
    subdivision: &Subdivision,
) -> Result<(FirstShot, u64), FirstShotError> {
    let triangles: Vec<u32> = (0..scene.triangles.len() as u32).collect();
    let parts: Vec<(Vec<LitPiece>, u64)> = pool.install(|| {
        triangles
            .par_chunks(TRIANGLES)
            .map_init(Workspace::new, |workspace, triangles| {
                let (mut pieces, mut rays) = (Vec::new(), 0);
                for triangle in triangles {
                    rays += lit_pieces(scene, tree, *triangle, subdivision, workspace, |p| pieces.push(p));
                }
                (pieces, rays)
            })
            .collect()
    });
    let rays = parts.iter().map(|p| p.1).sum();
    Ok((FirstShot::new(scene, parts.into_iter().flat_map(|p| p.0).collect())?, rays))
}

/// Runs a job; the film is changed at the end or not at all. `shot` is the density of a job that starts on surfaces.
pub(crate) fn run(
    pool: &rayon::ThreadPool,
    (scene, tree, shot): (&CompiledScene, &Tree, Option<&FirstShot>),
    code: TransportCode,
    job: &PhotonJob,
    control: &dyn Control,
    film: &mut Film,
) -> Result<JobStats, BackendError> {
    let plan = LightPlan::new(scene).map_err(|_| BackendError::Dark)?;
    let start = match (&job.start, shot) {
        (PhotonStart::Surfaces(_), Some(shot)) => Start::Surfaces(shot),
        (PhotonStart::Surfaces(_), None) => {
            return Err(BackendError::BadJob { reason: "no density of starts" });
        }
        (PhotonStart::Lights { registers_direct }, _) => {
            Start::Lights { plan: &plan, registers_direct: *registers_direct }
        }
    };
    let total = plan.total().into_iter().fold(0.0, f64::max);
    let unit = FluxUnit::new(total, job.photons);
    let areas = element_areas(scene);
    let mut sums = Sums::new(areas.len());
    let mut part = Film::new(*film.settings());
    let (rays, hits, done) = (AtomicU64::new(0), AtomicU64::new(0), AtomicU64::new(0));
    let cancelled = AtomicBool::new(false);
    let replicates = u64::from(job.replicates.end - job.replicates.start);
    let all = replicates * u64::from(job.photons);
    for replicate in job.replicates.clone() {
        let shared = Shared { scene, tree, start, job, unit, sums: &sums };
        with_photon_tracer!(code, shared.scene, job.max_hits, |tracer| {
            pool.install(|| {
                (0..job.photons.div_ceil(TASK)).into_par_iter().with_max_len(1).for_each(|task| {
                    if cancelled.load(Ordering::Relaxed) {
                        return;
                    }
                    let first = task * TASK;
                    let count = TASK.min(job.photons - first);
                    let [traced, arrived] = trace(&tracer, &shared, replicate, first, count);
                    rays.fetch_add(traced, Ordering::Relaxed);
                    hits.fetch_add(arrived, Ordering::Relaxed);
                    let now = done.fetch_add(u64::from(count), Ordering::Relaxed) + u64::from(count);
                    if control.advance(now, all).is_break() {
                        cancelled.store(true, Ordering::Relaxed);
                    }
                });
            });
        });
        if cancelled.load(Ordering::Relaxed) {
            return Err(BackendError::Cancelled);
        }
        part.add_blocks(replicate..replicate + 1, &irradiance(&sums.take(), &areas, unit))?;
    }
    film.merge(&part)?;
    Ok(JobStats { rays: rays.into_inner(), paths: all, hits: hits.into_inner() })
}
