//! The CPU backend of etendue: rayon schedules core's scalar functions over fixed chunks, obvhs builds the trees.
//!
//! The same job gives the same bits for any number of threads: chunks are fixed, each sample depends on its own
//! indices only, and films add integers.

pub mod bc1;
mod bidirectional;
mod blocks;
mod kept;
mod linear;
pub mod linear_triangle;
pub mod log_offset;
mod photons;
mod radiosity;
mod schedule;
mod session;
mod simd;
mod stripes;

use etendue_core::backend::{Arithmetic, Backend, BackendError, BackendInfo, Capabilities, Session};
use etendue_core::kernel::{self, Kernel};
use etendue_core::scene::CompiledScene;
use rayon::prelude::*;
use std::sync::Arc;

/// The trees that sessions walk.
pub use etendue_tree as tree;
pub use kept::Kept;
pub use linear::{Linear, ParallelOperator, WideOperator, WideStripe};
pub use photons::first_shot;
pub use radiosity::{Radiosity, Walker};
pub use session::CpuSession;

/// Items per task of [`Backend::map`].
const MAP_CHUNK: usize = 4096;

/// The backend: a pool of threads.
#[derive(Clone, Debug)]
pub struct CpuBackend {
    pool: Arc<rayon::ThreadPool>,
}

/// The pool of threads could not be started.
#[derive(Debug, thiserror::Error)]
#[error("cannot start {threads} worker threads: {source}")]
pub struct ThreadError {
    threads: usize,
    source: rayon::ThreadPoolBuildError,
}

impl CpuBackend {
    /// A backend with this many threads; `None` for one per core.
    ///
    /// # Errors
    /// When the system refuses the threads.
    pub fn new(threads: Option<usize>) -> Result<Self, ThreadError> {
        let threads = threads.unwrap_or(0);
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .thread_name(|i| format!("etendue-{i}"))
            .build()
            .map_err(|source| ThreadError { threads, source })?;
        Ok(Self { pool: Arc::new(pool) })
    }

    /// Number of worker threads.
    pub fn threads(&self) -> usize {
        self.pool.current_num_threads()
    }

    /// Linear algebra on this backend's threads.
    pub fn linear(&self) -> Linear {
        Linear::on(self.pool.clone())
    }

    /// Opens a scene, with the concrete session type.
    ///
    /// # Errors
    /// As [`Backend::open`].
    pub fn open_session(&self, scene: Arc<CompiledScene>) -> Result<CpuSession, BackendError> {
        CpuSession::new(self.pool.clone(), scene)
    }
}

impl Backend for CpuBackend {
    fn info(&self) -> BackendInfo {
        BackendInfo {
            name: "cpu",
            adapter: format!("{} threads", self.threads()),
            version: env!("CARGO_PKG_VERSION"),
        }
    }

    fn capabilities(&self) -> Capabilities {
        Capabilities { path: true, bidirectional: true, volume: true, kernels: true }
    }

    fn arithmetic(&self) -> Arithmetic {
        Arithmetic::Ieee
    }

    fn open(&self, scene: Arc<CompiledScene>) -> Result<Box<dyn Session>, BackendError> {
        Ok(Box::new(self.open_session(scene)?))
    }

    fn map(
        &self,
        kernel: Kernel,
        constants: &[u32],
        items: &[u32],
        out: &mut [u32],
    ) -> Result<(), BackendError> {
        let shape = kernel.check(constants, items, out)?;
        if shape.out == 0 || shape.item == 0 {
            return kernel::evaluate(kernel, constants, items, out);
        }
        self.pool.install(|| {
            items
                .par_chunks(MAP_CHUNK * shape.item)
                .zip(out.par_chunks_mut(MAP_CHUNK * shape.out))
                .try_for_each(|(items, out)| kernel::evaluate(kernel, constants, items, out))
        })
    }
}
