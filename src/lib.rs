//! Global illumination that states its error.
//!
//! The facade of the workspace: it re-exports the exact math ([`core`]), chooses a backend at run time
//! ([`engine`]), drives jobs to a number of samples, a time or an error ([`driver`]), reads and writes files ([`io`])
//! and compares images ([`metrics`]), and measures speed against error on a scene (`report`).
//!
//! The README has an example in twenty lines; it is a test of this crate.

pub use etendue_core as core;

#[cfg(feature = "cpu")]
pub use etendue_cpu as cpu;
#[cfg(feature = "wgpu")]
pub use etendue_wgpu as wgpu;

pub mod driver;
pub mod engine;
#[cfg(feature = "io")]
pub mod io;
pub mod metrics;
#[cfg(feature = "report")]
pub mod report;

#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod cli;

/// Runs the README's example.
#[cfg(all(doctest, feature = "cpu"))]
#[doc = include_str!("../README.md")]
pub struct Readme;
