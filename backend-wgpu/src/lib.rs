//! The wgpu backend of etendue: WGSL twins of core's functions, held by the same conformance suite.
//!
//! [`WgpuBackend::request`] looks for an adapter; [`WgpuBackend::from_device`] computes on the device of a host, beside
//! whatever else it does there. Nothing of this panics: what a device refuses is an error with its words.
//!
//! On Vulkan the shaders keep their arithmetic as written, and where division and square root are correctly rounded, results have
//! the bits of the CPU. Elsewhere they agree within the tolerances of `etendue-conformance`.

mod display;
mod gpu;
mod kernels;
mod relight;
mod session;
mod shaders;

#[cfg(test)]
#[path = "../tests/adapter/mod.rs"]
mod adapter;
#[cfg(test)]
extern crate self as etendue_wgpu;

pub use display::Picture;
pub use gpu::{AdapterName, Bc1Texture, adapters};
pub use relight::{BlocksOperator, Operator};
pub use session::{DirectTask, FirstShotTask, PathTask, PhotonTask, Step, WgpuSession};
pub use shaders::Mutation;
/// The version of wgpu whose [`wgpu::Device`] a host can share.
pub use wgpu;

use etendue_core::backend::{Arithmetic, Backend, BackendError, BackendInfo, Capabilities, Session};
use etendue_core::kernel::Kernel;
use etendue_core::radiosity::blocks::{BlockOperator, Format};
use etendue_core::radiosity::relight::Relighter;
use etendue_core::scene::CompiledScene;
use gpu::Source;
use std::sync::Arc;

const NAME: &str = "wgpu";

fn unsupported(what: impl Into<String>) -> BackendError {
    BackendError::Unsupported { backend: NAME, what: what.into() }
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
    source: Arc<Source>,
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
        Ok(Self {
            source: Arc::new(Source::request(name, options).await?),
            prepared: relight::Prepared::default(),
        })
    }

    /// Computes on a host's device. Errors are caught in scopes of this backend's own; if the device is lost, so are the
    /// sessions, and the host makes a new backend of a new device.
    pub fn from_device(device: wgpu::Device, queue: wgpu::Queue) -> Self {
        let source = Arc::new(Source::of_host(device, queue, Options::default()));
        Self { source, prepared: relight::Prepared::default() }
    }

    /// Opens a scene; [`Backend::open`] gives the same behind the common trait.
    ///
    /// # Errors
    /// [`BackendError::LimitExceeded`] with what is missing where the scene does not fit the device.
    pub fn open_scene(&self, scene: Arc<CompiledScene>) -> Result<WgpuSession, BackendError> {
        WgpuSession::new(self.source.clone(), scene)
    }

    /// Whether shaders keep their arithmetic as written, so that sums and products have the CPU's bits.
    pub fn is_exact(&self) -> bool {
        self.source.gpu().is_exact()
    }

    /// The shaders that were made so far: name, entry point and the bytes that the device was given (SPIR-V, or the text where it takes none).
    pub fn shaders(&self) -> Vec<(String, &'static str, usize)> {
        let made = self.source.gpu().shader_bytes();
        made.into_iter().map(|(key, bytes)| (key.name, key.entry, bytes)).collect()
    }

    /// How the device decodes textures of BC1. The first call tries it; the answer is kept.
    ///
    /// # Errors
    /// The device's.
    pub fn bc1_texture(&self) -> Result<Bc1Texture, BackendError> {
        self.source.run(|gpu| gpu.bc1_texture())
    }

    /// The relighter on the device, where the last one that was asked for stays.
    ///
    /// # Errors
    /// When it does not fit the device.
    #[doc(hidden)]
    pub fn operator(&self, relighter: &Relighter) -> Result<Arc<Operator>, BackendError> {
        self.source.run(|gpu| self.prepared.tiles(gpu, relighter))
    }

    /// The same for an operator in blocks.
    ///
    /// # Errors
    /// As [`Self::operator`].
    #[doc(hidden)]
    pub fn blocks_operator(&self, operator: &BlockOperator) -> Result<Arc<BlocksOperator>, BackendError> {
        self.source.run(|gpu| self.prepared.blocks(gpu, operator))
    }

    /// The same with blocks in a texture, by whatever rule the device decodes it. They are made anew each time.
    ///
    /// # Errors
    /// As [`Self::operator`]; or blocks that are not BC1, or a device without such textures.
    #[doc(hidden)]
    pub fn texture_operator(&self, operator: &BlockOperator) -> Result<BlocksOperator, BackendError> {
        self.source.run(|gpu| {
            if operator.parts().format != Format::Bc1 || gpu.bc1_texture()? == Bc1Texture::Missing {
                return Err(unsupported("textures of these blocks"));
            }
            BlocksOperator::new(gpu, operator, relight::Decoder::Texture)
        })
    }

    /// Destroys the device, as if it had been lost.
    #[doc(hidden)]
    pub fn lose_device(&self) {
        self.source.gpu().device.destroy();
    }
}

impl Backend for WgpuBackend {
    fn info(&self) -> BackendInfo {
        let adapter = self.source.gpu().name.clone();
        BackendInfo { name: NAME, adapter, version: env!("CARGO_PKG_VERSION") }
    }

    fn capabilities(&self) -> Capabilities {
        Capabilities { path: true, bidirectional: true, volume: true, kernels: true }
    }

    fn arithmetic(&self) -> Arithmetic {
        // A device that does not answer promises nothing.
        self.source.run(|gpu| gpu.arithmetic()).unwrap_or_default()
    }

    fn open(&self, scene: Arc<CompiledScene>) -> Result<Box<dyn Session>, BackendError> {
        Ok(Box::new(self.open_scene(scene)?))
    }

    fn map(
        &self,
        kernel: Kernel,
        constants: &[u32],
        items: &[u32],
        out: &mut [u32],
    ) -> Result<(), BackendError> {
        self.source.run(|gpu| kernels::map(gpu, kernel, constants, items, out))
    }
}
