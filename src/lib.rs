//! Etendue.
#[cfg(feature = "io")]
pub mod io;
pub mod metrics;
