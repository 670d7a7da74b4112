//! Radiosity: light between patches as linear algebra.
//!
//! - [`lanes`]: sums in one fixed order, on which everything here rests;
//! - [`operator`]: form factors as a linear operator, dense or as the half that symmetry leaves;
//! - [`polynomial`]: all bounces of light as a sum of powers of one operator.

pub mod lanes;
pub mod operator;
pub mod polynomial;
