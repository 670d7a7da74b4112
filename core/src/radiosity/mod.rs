//! Radiosity: light between patches as linear algebra.
//!
//! - [`polynomial`]: all bounces of light as a sum of powers of one operator.

pub mod polynomial;
