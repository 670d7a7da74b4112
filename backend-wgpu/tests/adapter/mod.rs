//! The adapter of this machine, for every test of this package.

#![allow(dead_code, reason = "each test takes what it needs")]

use etendue_core::backend::{Arithmetic, Backend, BackendError};
use etendue_wgpu::{Options, WgpuBackend};

/// Set to 1, a missing adapter is a failure; otherwise tests without one are skipped.
pub(crate) const REQUIRE: &str = "ETENDUE_REQUIRE_WGPU";

/// Whether a missing adapter is a failure.
pub(crate) fn is_required() -> bool {
    std::env::var(REQUIRE).is_ok_and(|x| x == "1")
}

/// Skips a test, visibly; fails where adapters must be there.
pub(crate) fn skip(why: &str) {
    assert!(!is_required(), "{why}, and {REQUIRE}=1 wants one");
    eprintln!("SKIPPED: {why} ({REQUIRE}=1 makes this a failure)");
}

/// A backend on the best adapter. `None` where there is none: the test has said so and ends.
pub(crate) fn backend_with(options: Options) -> Option<WgpuBackend> {
    match WgpuBackend::with_options(None, options) {
        Ok(backend) => Some(backend),
        Err(BackendError::NoAdapter { wanted }) => {
            skip(&format!("no adapter ({wanted})"));
            None
        }
        Err(e) => panic!("an adapter without a device: {e}"),
    }
}

/// The same without options.
pub(crate) fn backend() -> Option<WgpuBackend> {
    backend_with(Options::default())
}

/// The same for what is true of the reference's bits alone. `None` where the device rounds otherwise, too: no failure, the suite's
/// tolerances hold it.
pub(crate) fn exact_with(options: Options) -> Option<WgpuBackend> {
    let backend = backend_with(options)?;
    let kind = backend.arithmetic();
    if kind != Arithmetic::Ieee {
        eprintln!(
            "SKIPPED: bits are the reference's on IEEE 754 alone, {} is {}",
            backend.info().adapter,
            kind.describe()
        );
        return None;
    }
    Some(backend)
}

/// The same for what holds no number below 2^-126: devices that take those for zero have the reference's bits as well.
pub(crate) fn exact_or_flushing() -> Option<WgpuBackend> {
    let backend = backend()?;
    if backend.arithmetic() == Arithmetic::Loose {
        eprintln!("SKIPPED: {} is {}", backend.info().adapter, backend.arithmetic().describe());
        return None;
    }
    Some(backend)
}
