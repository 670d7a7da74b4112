//! The conformance suite: what every backend must pass, callable from the installed binary and from tests.
//!
//! It looks at a backend only through [`etendue_core::backend::Backend`]: kernels through `map`, transport through
//! sessions. The truths are in f64 or closed form and are written here once more, independently of core; tolerances
//! are one table with reasons; random tests have fixed seeds and state their alpha. The suite is held to its own
//! claims by wrong backends that it must catch (`tests/mutants.rs`).

#![allow(
    clippy::disallowed_methods,
    reason = "truths and statistics are in f64; nothing here is shared with a shader"
)]

pub mod about;
pub mod accuracy;
pub mod analytic;
pub mod golden;
pub mod inputs;
pub mod invariance;
pub mod kernels;
pub mod reference;
pub mod scenes;
pub mod statistics;
mod suite;
pub mod tolerance;
pub mod trios;
pub mod truth;

pub use accuracy::{AccuracyReport, TABLE_COUNT, accuracy_report, drift, markdown};
pub use kernels::AccuracyRow;
pub use suite::{CheckResult, Group, Level, Summary, run, run_groups};
