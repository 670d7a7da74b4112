//! Images and probes from maps: for each block of samples one map, then all pixels or probes from it.

use super::{Maps, Meter, Photons};
use crate::schedule::{image_chunks, run_blocks, single_chunks};
use crate::simd::widest;
use crate::tree::Tree;
use etendue_core::backend::{BackendError, Control, GatherJob, JobStats, PathJob};
use etendue_core::film::Film;
use etendue_core::medium::Inside;
use etendue_core::scene::CompiledScene;
use etendue_core::transport::TransportCode;
use etendue_core::transport::gather::{GatherLights, GatherTracer, MapView, ProbePlace};
use etendue_core::transport::photon::LightPlan;
use etendue_core::with_gather_tracer;
use std::ops::ControlFlow;

/// Where light is asked for.
#[derive(Clone, Copy)]
pub(crate) enum Target<'a> {
    /// At the pixels of the camera.
    Image { width: u32, height: u32 },
    /// At probes.
    Probes(&'a [ProbePlace]),
}

impl Target<'_> {
    /// Edges from the sensor to the first surface.
    pub(crate) fn edges(self) -> u32 {
        match self {
            Self::Image { .. } => 1,
            Self::Probes(_) => 0,
        }
    }

    fn chunks(self) -> Vec<Vec<u32>> {
        match self {
            Self::Image { width, height } => image_chunks(width, height),
            Self::Probes(places) => single_chunks(places.len()),
        }
    }
}

/// What all blocks read from.
struct Ground<'a> {
    tree: &'a Tree,
    target: Target<'a>,
    job: &'a PathJob,
}

/// Passes on the progress of one part of a job as that of all of it.
struct Portion<'a> {
    control: &'a dyn Control,
    before: u64,
    factor: u64,
    all: u64,
}

impl Control for Portion<'_> {
    fn advance(&self, done: u64, _: u64) -> ControlFlow<()> {
        self.control.advance(self.before + done * self.factor, self.all)
    }
}

widest! {
    /// One block of samples of a pixel or a probe.
    fn element_block[const V: bool, const L: bool, const T: bool, const S: bool](
        tracer: &GatherTracer<'_, V, L, T, S>,
        ground: &Ground<'_>,
        map: &MapView<'_>,
        element: u32,
        block: u32,
    ) -> ([f64; 3], u64) {
        let (tree, job) = (ground.tree, ground.job);
        match ground.target {
            Target::Image { width, .. } => {
                let pixel = [element % width, element / width];
                tracer.pixel_block(tree, map, pixel, job.seed, block, job.block_length)
            }
            Target::Probes(places) => {
                let probe = (element, &places[element as usize]);
                tracer.probe_block(tree, map, probe, job.seed, block, job.block_length)
            }
        }
    }
}

/// Runs a job whose map is given; the film is changed at the end or not at all.
pub(crate) fn read(
    pool: &rayon::ThreadPool,
    (scene, tree, code): (&CompiledScene, &Tree, TransportCode),
    job: &PathJob,
    (map, gather): (&MapView<'_>, bool),
    target: Target<'_>,
    control: &dyn Control,
    film: &mut Film,
) -> Result<JobStats, BackendError> {
    let lights = GatherLights::new(scene);
    let chunks = target.chunks();
    let ground = Ground { tree, target, job };
    with_gather_tracer!(code, (scene, &lights, job.max_depth, gather, Inside::NOTHING), |tracer| {
        let mean = |element, block| element_block(&tracer, &ground, map, element, block);
        run_blocks(pool, job, &chunks, mean, control, film)
    })
}

/// Runs a job whose maps `photons` makes; the film is changed at the end or not at all.
pub(crate) fn gather(
    pool: &rayon::ThreadPool,
    photons: Photons<'_>,
    job: &GatherJob,
    target: Target<'_>,
    control: &dyn Control,
    film: &mut Film,
) -> Result<JobStats, BackendError> {
    let Photons { scene, tree, elements, code, camera, .. } = photons;
    let plan = LightPlan::new(scene).map_err(|_| BackendError::Dark)?;
    let lights = GatherLights::new(scene);
    // Only where rays gather they are needed apart: what is read itself has them in the map.
    let gathers = job.gather || scene.needs.round_shapes;
    let needs = &scene.needs;
    let sent_on = needs.mirrors || needs.refraction || needs.panes;
    let caustics = gathers && sent_on && needs.point_like_lights;
    let mut maps = Maps::new(pool, photons, &plan, caustics)?;
    let mut part = Film::new(*film.settings());
    let chunks = target.chunks();
    let ground = Ground { tree, target, job: &job.path };
    let photons_each = u64::from(job.photons);
    let samples_each = film.len() as u64 * u64::from(job.path.block_length);
    let all = u64::from(job.path.blocks.end - job.path.blocks.start) * (photons_each + samples_each);
    let mut stats = JobStats::default();
    for (done, block) in (0_u64..).zip(job.path.blocks.clone()) {
        let before = done * (photons_each + samples_each);
        let walking = Portion { control, before, factor: 1, all };
        let meter = Meter::new(&walking, photons_each);
        let values = maps.make(block, &meter)?;
        stats += JobStats { rays: meter.rays.into_inner(), paths: 0, hits: meter.hits.into_inner() };
        let values: Vec<[f32; 3]> = values.iter().map(|v| v.map(|x| x as f32)).collect();
        let (all_light, caustics) = values.split_at(elements.count());
        let map = MapView { elements, all: all_light, caustics };
        let gathering =
            Portion { control, before: before + photons_each, factor: u64::from(job.path.block_length), all };
        let one = PathJob { blocks: block..block + 1, ..job.path.clone() };
        stats += with_gather_tracer!(code, (scene, &lights, one.max_depth, job.gather, camera), |tracer| {
            let mean = |element, block| element_block(&tracer, &ground, &map, element, block);
            run_blocks(pool, &one, &chunks, mean, &gathering, &mut part)
        })?;
    }
    film.merge(&part)?;
    Ok(stats)
}
