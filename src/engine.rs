//! Choosing a backend at run time.

use etendue_core::backend::{Backend, BackendError};
use std::fmt;
use std::str::FromStr;

/// The backends that this library knows, whether or not they are compiled in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BackendKind {
    /// rayon + obvhs.
    #[default]
    Cpu,
    /// wgpu.
    Wgpu,
}

impl BackendKind {
    /// The name by which users choose it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cpu => "cpu",
            Self::Wgpu => "wgpu",
        }
    }
}

impl fmt::Display for BackendKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for BackendKind {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        match s {
            "cpu" => Ok(Self::Cpu),
            "wgpu" => Ok(Self::Wgpu),
            other => Err(format!("unknown backend `{other}`, expected `cpu` or `wgpu`")),
        }
    }
}

/// Starts a backend. `threads` is for the CPU's workers; `None` means one per core.
///
/// # Errors
/// When the backend is not compiled in, has no device or cannot start.
pub fn open_backend(kind: BackendKind, threads: Option<usize>) -> Result<Box<dyn Backend>, BackendError> {
    open_backend_on(kind, threads, None)
}

/// The same on the adapter whose description ([`adapters`]) has `adapter` in it; `None` for the best. The CPU has none.
///
/// # Errors
/// As [`open_backend`].
pub fn open_backend_on(
    kind: BackendKind,
    threads: Option<usize>,
    adapter: Option<&str>,
) -> Result<Box<dyn Backend>, BackendError> {
    match kind {
        BackendKind::Cpu => cpu(threads),
        BackendKind::Wgpu => wgpu(adapter),
    }
}

/// Descriptions of the adapters that the wgpu backend can use here.
pub fn adapters() -> Vec<String> {
    #[cfg(feature = "wgpu")]
    {
        etendue_wgpu::adapters().iter().map(ToString::to_string).collect()
    }
    #[cfg(not(feature = "wgpu"))]
    Vec::new()
}

/// Whether the adapter of this description (as of [`adapters`]) is the processor playing a GPU: right, but its speed says nothing about GPUs.
pub fn is_software(adapter: &str) -> bool {
    #[cfg(feature = "wgpu")]
    {
        etendue_wgpu::adapters().iter().any(|a| a.software && a.to_string() == adapter)
    }
    #[cfg(not(feature = "wgpu"))]
    {
        let _ = adapter;
        false
    }
}

#[cfg(feature = "cpu")]
fn cpu(threads: Option<usize>) -> Result<Box<dyn Backend>, BackendError> {
    match etendue_cpu::CpuBackend::new(threads) {
        Ok(backend) => Ok(Box::new(backend)),
        Err(e) => Err(BackendError::NoAdapter { wanted: e.to_string() }),
    }
}

#[cfg(not(feature = "cpu"))]
fn cpu(_threads: Option<usize>) -> Result<Box<dyn Backend>, BackendError> {
    Err(absent("cpu"))
}

#[cfg(feature = "wgpu")]
fn wgpu(adapter: Option<&str>) -> Result<Box<dyn Backend>, BackendError> {
    let options = etendue_wgpu::Options::default();
    Ok(Box::new(etendue_wgpu::WgpuBackend::with_options(adapter, options)?))
}

#[cfg(not(feature = "wgpu"))]
fn wgpu(_adapter: Option<&str>) -> Result<Box<dyn Backend>, BackendError> {
    Err(absent("wgpu"))
}

#[cfg(not(all(feature = "cpu", feature = "wgpu")))]
fn absent(backend: &'static str) -> BackendError {
    BackendError::Unsupported {
        backend,
        what: "anything: it is not compiled in (a feature of that name)".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_compiled_in_opens_and_the_rest_says_so() {
        for (kind, there) in
            [(BackendKind::Cpu, cfg!(feature = "cpu")), (BackendKind::Wgpu, cfg!(feature = "wgpu"))]
        {
            assert_eq!(kind.name().parse(), Ok(kind));
            match open_backend(kind, Some(1)) {
                Ok(backend) => {
                    assert!(there);
                    assert_eq!(backend.info().name, kind.name());
                }
                // A machine may have no adapter.
                Err(BackendError::NoAdapter { wanted }) => {
                    assert!(there && kind == BackendKind::Wgpu, "{kind}: {wanted}");
                    assert!(std::env::var_os("ETENDUE_REQUIRE_WGPU").is_none(), "{wanted}");
                }
                Err(BackendError::Unsupported { backend, .. }) => assert!(!there && backend == kind.name()),
                Err(e) => panic!("{kind}: {e}"),
            }
        }
    }
}
