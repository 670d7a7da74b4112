//! Fixed chunks of work over a pool, with progress and cancellation.

use etendue_core::backend::{BackendError, Control, JobStats, PathJob};
use etendue_core::film::Film;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Side of a tile of pixels: neighbours in the image meet the same part of the tree.
const TILE: u32 = 16;
/// Elements whose means are held at a time: bounds memory, and gives small jobs enough tasks for all threads.
const BATCH: usize = 1 << 16;

/// Samples between two looks at the control.
const REPORT_SAMPLES: usize = 4096;

/// The elements of an image in tiles: (x, y) of each pixel, tile after tile.
pub(crate) fn image_chunks(width: u32, height: u32) -> Vec<Vec<u32>> {
    let mut chunks = Vec::new();
    for ty in (0..height).step_by(TILE as usize) {
        for tx in (0..width).step_by(TILE as usize) {
            let rows = ty..height.min(ty + TILE);
            let cols = tx..width.min(tx + TILE);
            chunks.push(rows.flat_map(|y| cols.clone().map(move |x| y * width + x)).collect());
        }
    }
    chunks
}

/// One chunk per element: for elements that are expensive by themselves.
pub(crate) fn single_chunks(count: usize) -> Vec<Vec<u32>> {
    (0..count as u32).map(|i| vec![i]).collect()
}

/// Computes all blocks of a job and adds them to the film at the end, or leaves the film as it was.
///
/// `block_mean(element, block)` returns the mean of one block of samples and the rays that it took.
pub(crate) fn run_blocks(
    pool: &rayon::ThreadPool,
    job: &PathJob,
    chunks: &[Vec<u32>],
    block_mean: impl Fn(u32, u32) -> ([f64; 3], u64) + Sync,
    control: &dyn Control,
    film: &mut Film,
) -> Result<JobStats, BackendError> {
    let mean = |element: u32, block: u32, _: u32, _: u32| block_mean(element, block);
    run_blocks_with(pool, job, chunks, mean, |_| {}, control, film)
}

/// As [`run_blocks`], in batches of blocks: `block_mean` is also told the first block of its batch and their number, and `finish` sees the means of each batch, block after block.
pub(crate) fn run_blocks_with(
    pool: &rayon::ThreadPool,
    job: &PathJob,
    chunks: &[Vec<u32>],
    block_mean: impl Fn(u32, u32, u32, u32) -> ([f64; 3], u64) + Sync,
    finish: impl Fn(&mut [[f64; 3]]),
    control: &dyn Control,
    film: &mut Film,
) -> Result<JobStats, BackendError> {
    let elements = film.len();
    let total = elements as u64 * u64::from(job.blocks.end - job.blocks.start);
    let per_batch = (BATCH / elements.max(1)).max(1) as u32;
    // A report every few thousand samples: often enough to stop at once, rarely enough to cost nothing.
    let per_report = (REPORT_SAMPLES / job.block_length as usize).max(1);
    let mut part = Film::new(*film.settings());
    let done = AtomicU64::new(0);
    let rays = AtomicU64::new(0);
    let cancelled = AtomicBool::new(false);
    let mut means: Vec<[f64; 3]> = Vec::new();

    let mut first = job.blocks.start;
    while first < job.blocks.end {
        let last = first.saturating_add(per_batch).min(job.blocks.end);
        let tasks: Vec<(u32, &Vec<u32>)> =
            (first..last).flat_map(|b| chunks.iter().map(move |c| (b, c))).collect();
        let results: Vec<Vec<[f64; 3]>> = pool.install(|| {
            tasks
                .par_iter()
                .with_max_len(1)
                .map(|(block, chunk)| {
                    let mut means = Vec::with_capacity(chunk.len());
                    for elements in chunk.chunks(per_report) {
                        if cancelled.load(Ordering::Relaxed) {
                            return Vec::new();
                        }
                        let mut traced = 0;
                        for &element in elements {
                            let (mean, n) = block_mean(element, *block, first, last - first);
                            traced += n;
                            means.push(mean);
                        }
                        rays.fetch_add(traced, Ordering::Relaxed);
                        let count = elements.len() as u64;
                        let now = done.fetch_add(count, Ordering::Relaxed) + count;
                        if control.advance(now, total).is_break() {
                            cancelled.store(true, Ordering::Relaxed);
                        }
                    }
                    means
                })
                .collect()
        });
        if cancelled.load(Ordering::Relaxed) {
            return Err(BackendError::Cancelled);
        }
        means.clear();
        means.resize(elements * (last - first) as usize, [0.0; 3]);
        for ((block, chunk), result) in tasks.iter().zip(&results) {
            let row = (block - first) as usize * elements;
            for (element, mean) in chunk.iter().zip(result) {
                means[row + *element as usize] = *mean;
            }
        }
        finish(&mut means);
        part.add_blocks(first..last, &means)?;
        first = last;
    }
    film.merge(&part)?;
    let paths = total * u64::from(job.block_length);
    Ok(JobStats { rays: rays.into_inner(), paths, hits: 0 })
}
