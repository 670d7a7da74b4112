//! Bidirectional jobs: samples of a block in parallel, what lands in other pixels gathered in fixed point.

use crate::schedule::{image_chunks, run_blocks, run_blocks_with, single_chunks};
use crate::tree::Tree;
use etendue_core::backend::{BackendError, BidirectionalJob, Control, JobStats};
use etendue_core::film::Film;
use etendue_core::math::Vec3;
use etendue_core::scene::CompiledScene;
use etendue_core::transport::bidirectional::{Bidirectional, SplatUnit, State};
use etendue_core::transport::volume::Surroundings;
use etendue_core::transport::{ProbeStart, TransportCode};
use etendue_core::with_bidirectional;
use rayon::prelude::*;
use std::cell::RefCell;
use std::sync::{Mutex, MutexGuard, PoisonError};

thread_local! {
    /// The walks of a thread's sample.
    static STATE: RefCell<State> = RefCell::new(State::default());
}

/// What lands in pixels from elsewhere, one set of sums a thread: integers, so that any order gives the same.
struct Splats {
    parts: Vec<Mutex<Vec<[i64; 3]>>>,
    elements: usize,
    unit: SplatUnit,
}

impl Splats {
    fn new(pool: &rayon::ThreadPool, film: &Film) -> Self {
        let parts = (0..pool.current_num_threads()).map(|_| Mutex::default()).collect();
        Self { parts, elements: film.len(), unit: SplatUnit::new(film.settings().scale_exponent) }
    }

    /// The sums of the calling thread, which no other thread asks for meanwhile, for so many blocks.
    fn mine(&self, blocks: usize) -> MutexGuard<'_, Vec<[i64; 3]>> {
        let index = rayon::current_thread_index().unwrap_or(0) % self.parts.len();
        let mut part = self.parts[index].lock().unwrap_or_else(PoisonError::into_inner);
        let length = (self.elements * blocks).max(part.len());
        part.resize(length, [0; 3]);
        part
    }

    /// Adds the sums of all threads to the means of blocks of a length, and forgets them.
    fn take(&self, means: &mut [[f64; 3]], block_length: u32) {
        let mut all = vec![[0_i64; 3]; means.len()];
        for part in &self.parts {
            let mut part = part.lock().unwrap_or_else(PoisonError::into_inner);
            for (all, sums) in all.iter_mut().zip(part.iter_mut()) {
                for (a, s) in all.iter_mut().zip(std::mem::take(sums)) {
                    *a = a.saturating_add(s);
                }
            }
        }
        means.par_iter_mut().zip(&all).for_each(|(mean, sums)| {
            for (m, s) in mean.iter_mut().zip(self.unit.mean(sums, block_length)) {
                *m += s;
            }
        });
    }
}

/// A scene on its tree.
#[derive(Clone, Copy)]
pub(crate) struct Place<'a> {
    pub pool: &'a rayon::ThreadPool,
    pub scene: &'a CompiledScene,
    pub tree: &'a Tree,
    pub code: TransportCode,
    pub surroundings: Surroundings,
}

fn pixel_block<const V: bool, const L: bool, const D: bool>(
    tracer: &Bidirectional<'_, V, L, D>,
    tree: &Tree,
    pixel: [u32; 2],
    names: (u64, u32, u32),
    splat: &mut dyn FnMut([u32; 2], Vec3),
) -> ([f64; 3], u64) {
    STATE.with_borrow_mut(|state| tracer.pixel_block(state, tree, pixel, names, splat))
}

fn probe_block<const V: bool, const L: bool, const D: bool>(
    tracer: &Bidirectional<'_, V, L, D>,
    tree: &Tree,
    probe: (u32, &ProbeStart),
    names: (u64, u32, u32),
) -> ([f64; 3], u64) {
    STATE.with_borrow_mut(|state| tracer.probe_block(state, tree, probe, names))
}

/// An image.
pub(crate) fn image(
    place: Place<'_>,
    job: &BidirectionalJob,
    control: &dyn Control,
    film: &mut Film,
) -> Result<JobStats, BackendError> {
    let (width, height) = (film.settings().width, film.settings().height);
    let chunks = image_chunks(width, height);
    let splats = Splats::new(place.pool, film);
    let elements = film.len();
    let path = &job.path;
    with_bidirectional!(
        place.scene,
        place.code,
        (place.scene, place.tree, job.settings(), place.surroundings),
        |tracer| {
            let block = |element: u32, block: u32, first: u32, blocks: u32| {
                let mut sums = splats.mine(blocks as usize);
                let row = (block - first) as usize * elements;
                let mut splat = |[x, y]: [u32; 2], value: Vec3| {
                    if let Some(sums) = sums.get_mut(row + (y * width + x) as usize) {
                        splats.unit.add(sums, value);
                    }
                };
                let pixel = [element % width, element / width];
                pixel_block(&tracer, place.tree, pixel, (path.seed, block, path.block_length), &mut splat)
            };
            let finish = |means: &mut [[f64; 3]]| splats.take(means, path.block_length);
            run_blocks_with(place.pool, path, &chunks, block, finish, control, film)
        }
    )
}

/// Probes.
pub(crate) fn probes(
    place: Place<'_>,
    job: &BidirectionalJob,
    starts: &[ProbeStart],
    control: &dyn Control,
    film: &mut Film,
) -> Result<JobStats, BackendError> {
    let chunks = single_chunks(starts.len());
    let path = &job.path;
    with_bidirectional!(
        place.scene,
        place.code,
        (place.scene, place.tree, job.settings(), place.surroundings),
        |tracer| {
            let mean = |element: u32, block: u32| {
                let probe = (element, &starts[element as usize]);
                probe_block(&tracer, place.tree, probe, (path.seed, block, path.block_length))
            };
            run_blocks(place.pool, path, &chunks, mean, control, film)
        }
    )
}
