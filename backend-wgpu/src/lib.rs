//! The wgpu backend of etendue: for now the place where it will stand.
//!
//! It answers every request with a typed refusal, never with wrong numbers. The WGSL twins of core's kernels, held by
//! the same conformance suite, arrive here; until then `capabilities()` says that there are none.

use etendue_core::backend::{Backend, BackendError, BackendInfo, Capabilities, Session};
use etendue_core::kernel::Kernel;
use etendue_core::scene::CompiledScene;
use std::sync::Arc;

const NAME: &str = "wgpu";

/// The backend.
#[derive(Clone, Debug)]
pub struct WgpuBackend {
    /// Kept so that the type cannot be made but by [`WgpuBackend::request`].
    _private: (),
}

fn unsupported(what: impl Into<String>) -> BackendError {
    BackendError::Unsupported { backend: NAME, what: what.into() }
}

impl WgpuBackend {
    /// Looks for an adapter.
    ///
    /// # Errors
    /// Always, in this version: no kernel has a shader yet.
    pub fn request() -> Result<Self, BackendError> {
        Err(unsupported("any job in this version: choose the cpu backend"))
    }
}

impl Backend for WgpuBackend {
    fn info(&self) -> BackendInfo {
        BackendInfo { name: NAME, adapter: String::new(), version: env!("CARGO_PKG_VERSION") }
    }

    fn capabilities(&self) -> Capabilities {
        Capabilities::default()
    }

    fn open(&self, _scene: Arc<CompiledScene>) -> Result<Box<dyn Session>, BackendError> {
        Err(unsupported("opening scenes"))
    }

    fn map(&self, kernel: Kernel, _: &[u32], _: &[u32], _: &mut [u32]) -> Result<(), BackendError> {
        Err(unsupported(format!("kernel {}", kernel.name())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_refuses_instead_of_guessing() {
        match WgpuBackend::request() {
            Err(BackendError::Unsupported { backend, .. }) => assert_eq!(backend, "wgpu"),
            other => panic!("{other:?}"),
        }
        let backend = WgpuBackend { _private: () };
        assert_eq!(backend.capabilities(), Capabilities::default());
        assert!(backend.map(Kernel::ALL[0], &[], &[], &mut []).is_err());
    }
}
