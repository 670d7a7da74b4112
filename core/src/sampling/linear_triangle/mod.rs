//! Points of linear density over a triangle.
//!
//! A triangle with a value `w_i >= 0` at each vertex (an irradiance, say; any unit) is sampled in proportion to the linear interpolation
//! of the values. Points are barycentrics `b`; densities are with respect to the triangle of unit area (dimensionless: uniform is 1;
//! divide by the area in square metres for a density per square metre):
//!
//! ```text
//! pdf(b) = 3 (w0 b0 + w1 b1 + w2 b2) / (w0 + w1 + w2)
//! ```
//!
//! Three samplers share the trait [`LinearTriangle`]:
//! - [`Robust`], which the free functions use: the lightest vertex is the apex, and the two conditional distributions are inverted without
//!   cancellation (the published density, conditioned in another order). Total, and accurate for all weights.
//! - [`Cardano`], as published (E. A. Kopylov, light on triangle meshes as a probability density for rays, algorithm 2): the marginal distribution of
//!   one barycentric inverted by Cardano's formula. It gives NaN and wrong points where its cubic term or its discriminant vanishes; it is here to show that, and to be measured against.
//! - [`Dirichlet`], an independent oracle: the same density as a mixture, vertex `i` with probability `w_i / S` and then
//!   the Dirichlet density of exponents (2, 1, 1) about it.
//!
//! ```
//! use etendue_core::sampling::linear_triangle;
//!
//! let weights = [1.0, 4.0, 0.5];
//! let bary = linear_triangle::sample(weights, [0.25, 0.75]);
//! let u = linear_triangle::invert(weights, bary);
//! assert!((u[0] - 0.25).abs() < 1e-6 && (u[1] - 0.75).abs() < 1e-6);
//! assert!(linear_triangle::pdf(weights, bary) > 0.0);
//! ```
//!
//! # What counts as what
//! - Weights: negative and NaN count as 0, infinity as `f32::MAX`; three zeros count as three ones (uniform).
//!   Weights that are 2^-126 of the largest or less may count as 0.
//! - Random numbers: clamped to [0, 1], both ends included; NaN counts as 0.
//! - The apex is the lightest vertex, of equal ones that of least index; the others follow it in cyclic order.
//! - The first random number is the share of the density nearer to the apex: 0 gives the apex, 1 the opposite edge.
//!   The second runs along the segment from the next vertex to the one after it.
//! - Where the density is zero only at the ends of the unit interval lead: at the apex if its weight is 0 (`u[0] = 0`), and on an edge
//!   between two vertices of weight 0 (`u[1]` = 0 or 1).

mod cardano;
mod dirichlet;
mod robust;
mod slices;

pub use slices::{LANES, sample_lanes, sample_slice};

/// A sampler of the linear density over a triangle.
pub trait LinearTriangle {
    /// Its name, for tables.
    const NAME: &'static str;

    /// Barycentrics of a point, for two random numbers in [0, 1].
    fn sample(&self, weights: [f32; 3], u: [f32; 2]) -> [f32; 3];

    /// Density of [`Self::sample`] with respect to the triangle of unit area.
    fn pdf(&self, weights: [f32; 3], bary: [f32; 3]) -> f32;
}

/// A sampler whose map is one to one.
pub trait InvertLinearTriangle: LinearTriangle {
    /// The random numbers that give the point.
    fn invert(&self, weights: [f32; 3], bary: [f32; 3]) -> [f32; 2];
}

/// The lightest vertex as the apex: see [`sample`], [`pdf`] and [`invert`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Robust;

/// The published form, unprotected: bary 1 solves
/// `x^3 (S - 3 B) - 3 x^2 (S - 2 B) + 3 x (S - B) = alpha S` by Cardano's formula in f32, with S = A + B + C and `weights = [A, B, C]`; bary 2 then
/// has the linear density on [0, 1 - x] from A (1 - x) + B x to C (1 - x) + B x.
///
/// NaN where S = 3 B, where no root falls into [0, 1), and where a product over- or underflows; elsewhere errors up to 1 occur.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cardano;

/// The mixture of Dirichlet densities. `u[0]` picks the vertex, and what is left of it its barycentric; `u[1]` splits the rest evenly.
///
/// Vertex i's barycentric has the distribution 3 x^2 - 2 x^3, inverted by x = sin^2 g + sqrt(3) sin g cos g with
/// g = asin(sqrt(u)) / 3. Reusing `u[0]` costs the bits that the pick took. Weights count as for [`Robust`]. Not one to one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dirichlet;

impl LinearTriangle for Robust {
    const NAME: &'static str = "robust";

    #[inline]
    fn sample(&self, weights: [f32; 3], u: [f32; 2]) -> [f32; 3] {
        robust::sample(weights, u)
    }

    #[inline]
    fn pdf(&self, weights: [f32; 3], bary: [f32; 3]) -> f32 {
        robust::pdf(weights, bary)
    }
}

impl InvertLinearTriangle for Robust {
    #[inline]
    fn invert(&self, weights: [f32; 3], bary: [f32; 3]) -> [f32; 2] {
        robust::invert(weights, bary)
    }
}

impl LinearTriangle for Cardano {
    const NAME: &'static str = "cardano";

    #[inline]
    fn sample(&self, weights: [f32; 3], u: [f32; 2]) -> [f32; 3] {
        cardano::sample(weights, u)
    }

    #[inline]
    fn pdf(&self, weights: [f32; 3], bary: [f32; 3]) -> f32 {
        cardano::pdf(weights, bary)
    }
}

impl InvertLinearTriangle for Cardano {
    #[inline]
    fn invert(&self, weights: [f32; 3], bary: [f32; 3]) -> [f32; 2] {
        cardano::invert(weights, bary)
    }
}

impl LinearTriangle for Dirichlet {
    const NAME: &'static str = "dirichlet";

    #[inline]
    fn sample(&self, weights: [f32; 3], u: [f32; 2]) -> [f32; 3] {
        dirichlet::sample(weights, u)
    }

    #[inline]
    fn pdf(&self, weights: [f32; 3], bary: [f32; 3]) -> f32 {
        dirichlet::pdf(weights, bary)
    }
}

/// Barycentrics of a point of the linear density, for two random numbers in [0, 1].
///
/// No panic and no NaN for any input (see the module for what counts as what); each coordinate is in [0, 1], and the exact sum of the three
/// is 1 within 2^-23.
///
/// Accuracy (weights and `u` taken as exact, subnormals and the ends of the unit interval included): the apex's coordinate and the sum of the
/// other two are within 0.6 units of the true ones, in units of 2^-23 of their own size; each of the other two within 3.2, or 2^-149. Measured
/// over 10^8 hard inputs against f64 (`tests/linear_triangle_accuracy.rs`); the published form is NaN for 42 % of the same inputs.
#[inline]
#[must_use]
pub fn sample(weights: [f32; 3], u: [f32; 2]) -> [f32; 3] {
    robust::sample(weights, u)
}

/// Density of [`sample`] with respect to the triangle of unit area, in [0, 3]: 3 (w . b) / S, within 5 ulp.
///
/// `bary` is taken to sum to 1. Outside the triangle, where a coordinate is negative (or NaN), it is 0; coordinates above 1 count as 1.
#[inline]
#[must_use]
pub fn pdf(weights: [f32; 3], bary: [f32; 3]) -> f32 {
    robust::pdf(weights, bary)
}

/// The random numbers in [0, 1 - 2^-24] for which [`sample`] gives the point `bary`.
///
/// Only the ratios of the coordinates count; they are clamped to [0, 1] first, NaN to 0. At the apex `u[1]` is 0, and so is all of the
/// answer for three zeros.
///
/// Round trip through [`sample`]: both numbers within 4 units of 2^-24 (the second where the point is not the apex to f32's last bit), the first
/// within 8 units of 2^-23 of its own size.
#[inline]
#[must_use]
pub fn invert(weights: [f32; 3], bary: [f32; 3]) -> [f32; 2] {
    robust::invert(weights, bary)
}

/// The first half of [`sample`]: which vertex is the apex, and how far from it a share of the density lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ApexDistance {
    /// The lightest vertex, of equal ones that of least index.
    pub apex: usize,
    /// Distance from the apex, 1 on the opposite edge: the sum of the other two barycentrics.
    pub distance: f32,
    /// 1 minus the distance, to its own accuracy: the apex's barycentric.
    pub complement: f32,
}

/// The distance from the apex within which a share `u` in [0, 1] of the density lies.
///
/// Both numbers are within 0.6 units of 2^-23 of the true ones, relative to their own size (0.5 is what rounding alone does).
#[inline]
#[must_use]
pub fn apex_distance(weights: [f32; 3], u: f32) -> ApexDistance {
    let r = robust::rotated(weights);
    let [distance, complement] = robust::distance(r.w, robust::unit(u));
    ApexDistance { apex: r.apex(), distance, complement }
}
