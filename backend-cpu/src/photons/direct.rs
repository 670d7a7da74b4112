//! Direct irradiance on elements, summed as photons are.

use super::Meter;
use super::sums::Sums;
use crate::tree::Tree;
use etendue_core::backend::{BackendError, Control, JobStats, PathJob};
use etendue_core::direct::irradiance::{flux_unit, primitive_block};
use etendue_core::film::Film;
use etendue_core::illumination::Elements;
use etendue_core::scene::CompiledScene;
use etendue_core::transport::volume::LightMedia;
use rayon::prelude::*;

/// Primitives of one task: neighbours in most files.
const PRIMITIVES: usize = 256;

/// Runs a job; the film is changed at the end or not at all.
pub(crate) fn direct(
    pool: &rayon::ThreadPool,
    (scene, tree, media, elements): (&CompiledScene, &Tree, &LightMedia, &Elements),
    job: &PathJob,
    control: &dyn Control,
    film: &mut Film,
) -> Result<JobStats, BackendError> {
    let unit = flux_unit(scene);
    let mut sums = Sums::new(pool, elements.count());
    let mut part = Film::new(*film.settings());
    let primitives = scene.primitives().count();
    let meter = Meter::new(control, primitives as u64 * u64::from(job.blocks.end - job.blocks.start));
    for block in job.blocks.clone() {
        pool.install(|| {
            (0..primitives.div_ceil(PRIMITIVES)).into_par_iter().with_max_len(1).for_each(|task| {
                if meter.stopped() {
                    return;
                }
                let mut mine = sums.mine();
                let (mut rays, range) = (0, task * PRIMITIVES..primitives.min((task + 1) * PRIMITIVES));
                for primitive in range.clone() {
                    rays += primitive_block(
                        scene,
                        (tree, media),
                        elements,
                        primitive as u32,
                        job,
                        block,
                        |hit, from_front, flux| {
                            elements.deposit(hit, from_front, |e, factor| mine.add(e, flux * factor, unit));
                        },
                    );
                }
                drop(mine);
                meter.count(rays, 0, range.len() as u64);
            });
        });
        if meter.stopped() {
            return Err(BackendError::Cancelled);
        }
        let means = pool.install(|| sums.take(elements, unit));
        part.add_blocks(block..block + 1, &means)?;
    }
    film.merge(&part)?;
    Ok(JobStats { rays: meter.rays.into_inner(), paths: meter.all * u64::from(job.block_length), hits: 0 })
}
