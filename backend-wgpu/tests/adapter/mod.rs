//! The adapter of this machine, for every test of this package.

use etendue_core::backend::BackendError;
use etendue_wgpu::{Options, WgpuBackend};

/// Set to 1, a missing adapter is a failure; otherwise tests without one are skipped.
pub const REQUIRE: &str = "ETENDUE_REQUIRE_WGPU";

/// Whether a missing adapter is a failure.
pub fn is_required() -> bool {
    std::env::var(REQUIRE).is_ok_and(|x| x == "1")
}

/// Skips a test, visibly; fails where adapters must be there.
pub fn skip(why: &str) {
    assert!(!is_required(), "{why}, and {REQUIRE}=1 wants one");
    eprintln!("SKIPPED: {why} ({REQUIRE}=1 makes this a failure)");
}

/// A backend on the best adapter. `None` where there is none: the test has said so and ends.
pub fn backend_with(options: Options) -> Option<WgpuBackend> {
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
pub fn backend() -> Option<WgpuBackend> {
    backend_with(Options::default())
}
