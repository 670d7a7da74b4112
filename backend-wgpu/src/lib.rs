//! The wgpu backend of etendue: WGSL twins of core's functions, held by the same conformance suite.
//!
//! [`WgpuBackend::request`] looks for an adapter; [`WgpuBackend::from_device`] computes on the device of a host, beside
//! whatever else it does there. Nothing of this panics: what a device refuses is an error with its words.

mod gpu;
mod kernels;
mod relight;
mod shaders;

pub use gpu::{AdapterName, adapters};
pub use relight::{BlocksOperator, Operator, RelightFailure};
pub use shaders::Mutation;
/// The version of wgpu whose [`wgpu::Device`] a host can share.
pub use wgpu;

use etendue_core::backend::{Backend, BackendError, BackendInfo, Capabilities, Session};
use etendue_core::kernel::Kernel;
use etendue_core::radiosity::blocks::BlockOperator;
use etendue_core::radiosity::relight::Relighter;
use etendue_core::scene::CompiledScene;
use gpu::Gpu;
use std::sync::{Arc, Mutex, PoisonError};

const NAME: &str = "wgpu";

fn unsupported(what: impl Into<String>) -> BackendError {
    BackendError::Unsupported { backend: NAME, what: what.into() }
}

/// How a lost device is replaced.
#[derive(Clone, Debug)]
enum Origin {
    /// The host's affair.
    Host,
    /// A new one of the same adapter.
    Adapter(Option<String>),
}

/// What a backend is made with beside its adapter; the default is right but for tests.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Limits below those of the device.
    pub limits: Option<wgpu::Limits>,
    /// Shaders made wrong, to see that the suite notices.
    pub mutations: Vec<Mutation>,
}

/// The backend.
#[derive(Debug)]
pub struct WgpuBackend {
    origin: Origin,
    options: Options,
    gpu: Mutex<Arc<Gpu>>,
    prepared: relight::Prepared,
}

impl WgpuBackend {
    /// The best adapter of this machine.
    ///
    /// # Errors
    /// [`BackendError::NoAdapter`], which names those that are there.
    pub fn request() -> Result<Self, BackendError> {
        Self::with_options(None, Options::default())
    }

    /// The adapter whose description ([`adapters`]) has `name` in it.
    ///
    /// # Errors
    /// As [`Self::request`].
    pub fn request_named(name: &str) -> Result<Self, BackendError> {
        Self::with_options(Some(name), Options::default())
    }

    /// The same with options.
    ///
    /// # Errors
    /// As [`Self::request`].
    pub fn with_options(name: Option<&str>, options: Options) -> Result<Self, BackendError> {
        pollster::block_on(Self::request_async(name, options))
    }

    /// The same without blocking, for hosts with an executor.
    ///
    /// # Errors
    /// As [`Self::request`].
    pub async fn request_async(name: Option<&str>, options: Options) -> Result<Self, BackendError> {
        let origin = Origin::Adapter(name.map(Into::into));
        let gpu = make(&origin, &options).await?;
        Ok(Self { origin, options, gpu: Mutex::new(Arc::new(gpu)), prepared: relight::Prepared::default() })
    }

    /// Computes on a host's device. Its errors are caught in scopes of this backend's own; if the device is lost, so are the
    /// sessions, and the host makes a new backend of a new device.
    pub fn from_device(device: wgpu::Device, queue: wgpu::Queue) -> Self {
        let options = Options::default();
        let gpu = Gpu::new((device, queue), None, Vec::new());
        let gpu = Mutex::new(Arc::new(gpu));
        Self { origin: Origin::Host, options, gpu, prepared: relight::Prepared::default() }
    }

    fn gpu(&self) -> Arc<Gpu> {
        self.gpu.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Runs a job; if its device is lost and is ours to replace, once more on a fresh one.
    fn on_device<T>(
        &self,
        mut job: impl FnMut(&Gpu) -> Result<T, BackendError>,
    ) -> Result<T, BackendError> {
        let gpu = self.gpu();
        match job(&gpu) {
            Err(BackendError::DeviceLost { .. }) if matches!(self.origin, Origin::Adapter(_)) => {
                job(&*self.replace(&gpu)?)
            }
            other => other,
        }
    }

    /// A fresh device in place of a lost one, unless another thread has replaced it already.
    fn replace(&self, lost: &Arc<Gpu>) -> Result<Arc<Gpu>, BackendError> {
        let mut gpu = self.gpu.lock().unwrap_or_else(PoisonError::into_inner);
        if Arc::ptr_eq(&gpu, lost) {
            *gpu = Arc::new(pollster::block_on(make(&self.origin, &self.options))?);
        }
        Ok(gpu.clone())
    }

    /// The relighter on the device, where the last one that was asked for stays.
    ///
    /// # Errors
    /// When it does not fit the device.
    #[doc(hidden)]
    pub fn operator(&self, relighter: &Relighter) -> Result<Arc<Operator>, BackendError> {
        self.prepared.tiles(&self.gpu(), relighter)
    }

    /// The same for an operator in blocks.
    ///
    /// # Errors
    /// As [`Self::operator`].
    #[doc(hidden)]
    pub fn blocks_operator(&self, operator: &BlockOperator) -> Result<Arc<BlocksOperator>, BackendError> {
        self.prepared.blocks(&self.gpu(), operator)
    }

    /// Destroys the device, as if it had been lost.
    #[doc(hidden)]
    pub fn lose_device(&self) {
        self.gpu().device.destroy();
    }
}

async fn make(origin: &Origin, options: &Options) -> Result<Gpu, BackendError> {
    let name = match origin {
        Origin::Adapter(name) => name.as_deref(),
        Origin::Host => None,
    };
    let device = gpu::request(name).await?;
    Ok(Gpu::new(device, options.limits.clone(), options.mutations.clone()))
}

impl Backend for WgpuBackend {
    fn info(&self) -> BackendInfo {
        BackendInfo { name: NAME, adapter: self.gpu().name.clone(), version: env!("CARGO_PKG_VERSION") }
    }

    fn capabilities(&self) -> Capabilities {
        Capabilities { kernels: true, ..Capabilities::default() }
    }

    fn open(&self, _scene: Arc<CompiledScene>) -> Result<Box<dyn Session>, BackendError> {
        Err(unsupported("opening scenes"))
    }

    fn map(
        &self,
        kernel: Kernel,
        constants: &[u32],
        items: &[u32],
        out: &mut [u32],
    ) -> Result<(), BackendError> {
        self.on_device(|gpu| kernels::map(gpu, kernel, constants, items, out))
    }
}
