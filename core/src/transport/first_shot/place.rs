//! Where on a piece photons start, and with which density.
//!
//! Quantity: density per area \[1/m^2\] of starts, pmf pdf(l) / A: pmf the chance of the piece, pdf the linear density over the piece of unit
//! area ([`crate::sampling::linear_triangle`]) at the barycentrics l on the piece, A its area.

use crate::direct::subdivide::Bary;
use crate::math;
use crate::sampling::linear_triangle;

/// By how much of a barycentric a point may lie beyond a piece and still count as on its edge: what rounding leaves between neighbours.
pub const SLACK: f32 = 1e-4;

/// Barycentrics on the triangle of the point with barycentrics `local` on a piece with these corners.
///
/// Sums of products of numbers that are not negative: each within 3 units of 2^-24 of its size.
#[inline]
pub fn on_triangle(corners: [Bary; 3], local: [f32; 3]) -> [f32; 3] {
    let mut b = [0.0; 3];
    for (share, corner) in local.into_iter().zip(corners) {
        for (b, c) in b.iter_mut().zip(corner.to_f32()) {
            *b += share * c;
        }
    }
    b
}

/// Barycentrics on a piece of the point whose second and third barycentrics on the triangle are `x` and `y`, by Cramer's rule; `None` for a
/// piece without area or turned over.
///
/// A piece so thin on the triangle that its area is lost in the rounding of two products counts as without area, never as turned over.
#[inline]
pub fn within(corners: [Bary; 3], [x, y]: [f32; 2]) -> Option<[f32; 3]> {
    let [a, b, c] = corners.map(|c| {
        let [_, b1, b2] = c.to_f32();
        [b1, b2]
    });
    let (u, v, p) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]], [x - a[0], y - a[1]]);
    let all = u[0] * v[1] - u[1] * v[0];
    if all.is_nan() || all <= 0.0 {
        return None;
    }
    let (l1, l2) = ((p[0] * v[1] - p[1] * v[0]) / all, (u[0] * p[1] - u[1] * p[0]) / all);
    Some([1.0 - l1 - l2, l1, l2])
}

/// Density per area \[1/m^2\] of starts on a piece of chance `pmf` and `area` \[m^2\], with these weights at its corners, at the barycentrics `local`
/// on it.
///
/// Up to [`SLACK`] outside it is that of the nearest point by clamping, further out (and for NaN) 0. 0 for an area of 0 or NaN, at most `f32::MAX`, never NaN;
/// weights count as in [`linear_triangle`].
#[inline]
pub fn density(pmf: f32, weights: [f32; 3], area: f32, local: [f32; 3]) -> f32 {
    if !local.into_iter().all(|x| x >= -SLACK) {
        return 0.0;
    }
    let inside = local.map(|x| math::max(x, 0.0));
    let density = pmf * linear_triangle::pdf(weights, inside) / area;
    if area > 0.0 && density >= 0.0 { math::min(density, f32::MAX) } else { 0.0 }
}
