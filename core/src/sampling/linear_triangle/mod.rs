//! Points of linear density over a triangle: a trio `sample / pdf / invert`.
//!
//! The density at barycentrics b is proportional to w . b, with weights w >= 0 at the vertices: where a surface is lit linearly,
//! such points are distributed as its light. Densities are with respect to the triangle of unit area (uniform is 1); divide by the area
//! for a density per square metre.
//!
//! Three implementations:
//!
//! - [`Robust`], what the free functions are: the marginal distribution about the *lightest* vertex, whose cubic is convex and increasing.
//!   Total: weights that are negative or NaN count as 0, infinite ones as `f32::MAX`, and three zeros as three ones; subnormals count in
//!   full (on a device that flushes them: as 0). Random numbers are clamped to [0, 1], NaN counts as 0.
//! - [`Cardano`], as published (source A, algorithm 2): the marginal distribution of the barycentric of vertex 1 by Cardano's formula in f32.
//!   Kept to show what it does: NaN for a tenth of hard inputs, errors up to the whole range for others.
//! - [`Mixture`]: the same density as a mixture of three Dirichlet densities, picked by weight. It shares no step with the others: their oracle.
//!
//! Accuracy of [`Robust`], over 10^8 hard inputs (flat, within 1e-7 of flat, one vertex alone, one vertex zero, ratios to 1e30; `u` at 0,
//! 2^-149, 1 - 2^-24), in units of 2^-23 relative, measured against f64: distance s from the apex 0.50, its complement (the apex's
//! barycentric) 0.57, the other two barycentrics 2.9; the sum of the three is 1 within 0.7 (`tests/linear_triangle_accuracy.rs`).
//!
//! Ties: of equal lightest vertices the one of least index is the apex; the first random number places the distance from it, the second runs
//! from the next vertex in cyclic order to the one after.

mod cardano;
mod mixture;
mod robust;
mod slices;

pub use cardano::Cardano;
pub use mixture::Mixture;
pub use robust::Robust;
pub use slices::sample_slice;

/// A way to sample a linear density over a triangle: all have the same density, each its own map from random numbers to points.
pub trait LinearTriangle {
    /// Barycentrics of a point for two random numbers in [0, 1).
    fn sample(weights: [f32; 3], u: [f32; 2]) -> [f32; 3];

    /// Density of [`LinearTriangle::sample`] at a point, with respect to the triangle of unit area: 3 (w . b) / (w0 + w1 + w2).
    fn pdf(weights: [f32; 3], bary: [f32; 3]) -> f32;

    /// The random numbers of a point.
    fn invert(weights: [f32; 3], bary: [f32; 3]) -> [f32; 2];
}

/// Barycentrics of a point of density proportional to `weights . bary`: each >= 0, their sum 1 within 2^-23.
///
/// Preconditions: none; what weights and `u` out of range count as, and the accuracy, is in the module's doc.
#[inline]
#[must_use]
pub fn sample(weights: [f32; 3], u: [f32; 2]) -> [f32; 3] {
    Robust::sample(weights, u)
}

/// Density of [`sample`] at `bary` with respect to the triangle of unit area (uniform is 1, at most 3): 3 (w . b) / (w0 + w1 + w2).
///
/// 0 where a barycentric is negative or NaN; barycentrics are taken to sum to 1. Within 5 ulp.
#[inline]
#[must_use]
pub fn pdf(weights: [f32; 3], bary: [f32; 3]) -> f32 {
    Robust::pdf(weights, bary)
}

/// The `u` of [`sample`], in `[0, 1 - 2^-24]^2`; where every `u` gives the same point (the apex), its second number is 0.
///
/// Barycentrics that are negative or NaN count as 0. The round trip [`sample`] then `invert` returns each number within 8 units of 2^-24,
/// and the first one within 8 units of 2^-23 relative too.
#[inline]
#[must_use]
pub fn invert(weights: [f32; 3], bary: [f32; 3]) -> [f32; 2] {
    Robust::invert(weights, bary)
}

/// Distance of [`sample`]'s point from the apex and its complement, in units of the height over the apex, for the first random number:
/// what the accuracy of the cubic's inversion is stated for. The apex is the lightest vertex: its index comes first.
#[inline]
#[must_use]
pub fn apex_distance(weights: [f32; 3], u: f32) -> (usize, [f32; 2]) {
    robust::apex_distance(weights, u)
}
