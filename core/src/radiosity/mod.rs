//! Radiosity: light between patches as linear algebra.
//!
//! - [`lanes`]: sums in one fixed order, on which everything here rests;
//! - [`operator`]: form factors as a linear operator, dense or as the half that symmetry leaves;
//! - [`patches`]: what of the surfaces is one unknown, [`form_factors`] between them, and their [`order`];
//! - [`tiles`]: form factors in few bits; [`relight`]: all bounces in three passes over them; [`transfer`] from patches back to surfaces;
//! - [`blocks`]: the published codec, whole transport matrices in texture blocks, and what it becomes when mended;
//! - [`polynomial`]: all bounces of light as a sum of powers of one operator.

pub mod blocks;
pub mod form_factors;
mod identity;
pub mod lanes;
pub mod operator;
pub mod order;
pub mod patches;
pub mod polynomial;
pub mod relight;
pub mod tiles;
pub mod transfer;

pub use identity::Identity;
