//! Sampling: random bits, low-discrepancy points, discrete choice, and warps of the unit square.
//!
//! - [`counter`]: random bits as a pure function of (seed, stream, sample, dimension), and integer hashes.
//! - [`sobol`]: Owen-scrambled Sobol' points, in small padded groups for paths and in many dimensions for photons.
//! - [`discrete`]: choice among weighted entries by an integer cumulative distribution.
//! - [`linear_triangle`]: points with linear density over a triangle.
//! - [`warp`]: trios `sample_ / pdf_ / invert_` of densities on the sphere, the disk and flat shapes.
//!
//! Every random number starts as 32 bits and becomes a float only at the end, by [`u32_to_unit`]; all of the integer part uses 32-bit words
//! (a product's high word included), so that a shader computes the same bits.

pub mod counter;
pub mod discrete;
pub mod linear_triangle;
pub mod numbers;
pub mod sobol;
pub mod warp;

/// The largest value of a unit number: 1 - 2^-24.
pub const ONE_MINUS_EPSILON: f32 = 1.0 - 1.0 / 16_777_216.0;

// from math once merged
/// The unit number `(x >> 8) * 2^-24` in `[0, 1 - 2^-24]`. Exact; dividing by 2^32 instead would return 1.0 for the largest `x`.
#[inline(always)]
pub const fn u32_to_unit(x: u32) -> f32 {
    (x >> 8) as f32 * (1.0 / 16_777_216.0)
}
