//! The reference backend: core alone, one thread, nothing clever. It makes the goldens; all others are compared to it.

use etendue_core::backend::{
    self, Arithmetic, Backend, BackendError, BackendInfo, BidirectionalJob, Capabilities, Control, JobStats,
    PathJob, Probe, Session,
};
use etendue_core::film::{Film, FilmSettings};
use etendue_core::geometry::Bvh2;
use etendue_core::kernel::{self, Kernel};
use etendue_core::medium::Inside;
use etendue_core::scene::CompiledScene;
use etendue_core::transport::bidirectional::{SplatUnit, State};
use etendue_core::transport::volume::{Surroundings, probe_starts};
use etendue_core::transport::{Paths, TransportCode};
use etendue_core::{with_bidirectional, with_tracer};
use std::sync::Arc;

/// Core's functions in plain loops.
#[derive(Clone, Copy, Debug, Default)]
pub struct ReferenceBackend;

impl Backend for ReferenceBackend {
    fn info(&self) -> BackendInfo {
        BackendInfo { name: "reference", adapter: "1 thread".to_string(), version: env!("CARGO_PKG_VERSION") }
    }

    fn capabilities(&self) -> Capabilities {
        Capabilities { path: true, bidirectional: true, volume: true, kernels: true }
    }

    fn arithmetic(&self) -> Arithmetic {
        Arithmetic::Ieee
    }

    fn open(&self, scene: Arc<CompiledScene>) -> Result<Box<dyn Session>, BackendError> {
        Ok(Box::new(ReferenceSession { scene }))
    }

    fn map(
        &self,
        kernel: Kernel,
        constants: &[u32],
        items: &[u32],
        out: &mut [u32],
    ) -> Result<(), BackendError> {
        kernel::evaluate(kernel, constants, items, out)
    }
}

/// A scene in plain loops.
#[derive(Debug)]
pub struct ReferenceSession {
    scene: Arc<CompiledScene>,
}

/// What every session checks before a job.
///
/// # Errors
/// As [`Session::path_image`].
pub fn check_job(
    scene: &CompiledScene,
    job: &PathJob,
    film: &Film,
    expected: &FilmSettings,
) -> Result<(), BackendError> {
    job.check()?;
    BackendError::unless_covered("path", scene.needs.beyond_paths())?;
    Ok(film.check(expected)?)
}

/// Computes the blocks of a job one after the other and adds them at the end.
///
/// `mean(element, block)` is the mean of one block of samples and the rays that it took.
///
/// # Errors
/// When the control cancels or the film does not fit.
pub fn serial_blocks(
    job: &PathJob,
    control: &dyn Control,
    film: &mut Film,
    mut mean: impl FnMut(u32, u32) -> ([f64; 3], u64),
) -> Result<JobStats, BackendError> {
    let elements = film.len() as u32;
    serial_rows(job, control, film, |block| (0..elements).map(|element| mean(element, block)).collect())
}

/// The same where a block's means are known all at once: `row(block)` gives them with their rays.
///
/// # Errors
/// As [`serial_blocks`].
pub fn serial_rows(
    job: &PathJob,
    control: &dyn Control,
    film: &mut Film,
    mut row: impl FnMut(u32) -> Vec<([f64; 3], u64)>,
) -> Result<JobStats, BackendError> {
    let mut part = Film::new(*film.settings());
    let mut stats = JobStats::default();
    let total = u64::from(job.blocks.end - job.blocks.start);
    for block in job.blocks.clone() {
        let row = row(block);
        for (_, rays) in &row {
            stats += JobStats { rays: *rays, paths: u64::from(job.block_length), hits: 0 };
        }
        let means: Vec<_> = row.iter().map(|(mean, _)| *mean).collect();
        part.add_blocks(block..block + 1, &means)?;
        if control.advance(u64::from(block - job.blocks.start) + 1, total).is_break() {
            return Err(BackendError::Cancelled);
        }
    }
    film.merge(&part)?;
    Ok(stats)
}

impl Session for ReferenceSession {
    fn scene(&self) -> &CompiledScene {
        &self.scene
    }

    fn preparation(&self) -> &[(&'static str, f64)] {
        &[]
    }

    fn path_image(
        &self,
        job: &PathJob,
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let expected = backend::image_film_settings(&self.scene, job)?;
        check_job(&self.scene, job, film, &expected)?;
        let tree = Bvh2::new(self.scene.primitives());
        let code = TransportCode::of(&self.scene.needs);
        let camera = Surroundings::of(&self.scene, &tree).camera;
        with_tracer!(code, (&*self.scene, job.max_depth, camera), |tracer| {
            serial_blocks(job, control, film, |element, block| {
                let pixel = [element % expected.width, element / expected.width];
                tracer.pixel_block(&tree, pixel, job.seed, block, job.block_length)
            })
        })
    }

    fn path_probes(
        &self,
        job: &PathJob,
        probes: &[Probe],
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let expected = backend::probe_film_settings(&self.scene, job, probes.len());
        check_job(&self.scene, job, film, &expected)?;
        let tree = Bvh2::new(self.scene.primitives());
        let probes = backend::check_probes(probes)?;
        let outside = Surroundings::of(&self.scene, &tree).outside;
        let starts = probe_starts(&self.scene, &tree, outside, &probes);
        let code = TransportCode::of(&self.scene.needs);
        with_tracer!(code, (&*self.scene, job.max_depth, Inside::NOTHING), |tracer| {
            serial_blocks(job, control, film, |element, block| {
                let probe = (element, &starts[element as usize]);
                tracer.probe_block(&tree, probe, job.seed, block, job.block_length)
            })
        })
    }

    fn bidirectional_image(
        &self,
        job: &BidirectionalJob,
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let path = &job.path;
        let expected = backend::image_film_settings(&self.scene, path)?;
        check_job(&self.scene, path, film, &expected)?;
        let tree = Bvh2::new(self.scene.primitives());
        let code = TransportCode::of(&self.scene.needs);
        let surroundings = Surroundings::of(&self.scene, &tree);
        let width = expected.width;
        let unit = SplatUnit::new(expected.scale_exponent);
        let mut state = State::default();
        with_bidirectional!(self.scene, code, (&*self.scene, &tree, job.settings(), surroundings), |tracer| {
            let elements = expected.width * expected.height;
            // What lands in a pixel is known when all samples of the block are.
            serial_rows(path, control, film, |block| {
                let mut splats = vec![[0_i64; 3]; elements as usize];
                let mut row: Vec<_> = (0..elements)
                    .map(|e| {
                        let splat = |[x, y]: [u32; 2], value| {
                            unit.add(&mut splats[(y * width + x) as usize], value);
                        };
                        let names = (path.seed, block, path.block_length);
                        tracer.pixel_block(&mut state, &tree, [e % width, e / width], names, splat)
                    })
                    .collect();
                for ((mean, _), landed) in row.iter_mut().zip(&splats) {
                    let landed = unit.mean(landed, path.block_length);
                    *mean = [0, 1, 2].map(|c| mean[c] + landed[c]);
                }
                row
            })
        })
    }

    fn bidirectional_probes(
        &self,
        job: &BidirectionalJob,
        probes: &[Probe],
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let path = &job.path;
        let expected = backend::probe_film_settings(&self.scene, path, probes.len());
        check_job(&self.scene, path, film, &expected)?;
        let tree = Bvh2::new(self.scene.primitives());
        let probes = backend::check_probes(probes)?;
        let surroundings = Surroundings::of(&self.scene, &tree);
        let starts = probe_starts(&self.scene, &tree, surroundings.outside, &probes);
        let code = TransportCode::of(&self.scene.needs);
        let mut state = State::default();
        with_bidirectional!(self.scene, code, (&*self.scene, &tree, job.settings(), surroundings), |tracer| {
            serial_blocks(path, control, film, |element, block| {
                let probe = (element, &starts[element as usize]);
                tracer.probe_block(&mut state, &tree, probe, (path.seed, block, path.block_length))
            })
        })
    }
}
