//! Densities of points on flat shapes, per unit of area.

use super::{PI, unit};
use crate::math::{self, Vec3};

/// Half the spacing of unit numbers, doubled by the map from [0, 1] to [-1, 1].
const HALF_CELL: f32 = 1.0 / 16_777_216.0;

/// The concentric map, with the signed radius clamped off: the point and its radius, at most 1 - 2^-24.
///
/// `u` is taken at the centre of its cell, 2 u - 1 + 2^-24 (exact for multiples of 2^-24): the map is then symmetric about the centre, and
/// neither reaches the rim nor divides by zero at the centre.
#[inline]
pub(super) fn concentric(u: [f32; 2]) -> ([f32; 2], f32) {
    let a = (2.0 * u[0] - 1.0) + HALF_CELL;
    let b = (2.0 * u[1] - 1.0) + HALF_CELL;
    if a.abs() > b.abs() {
        let (s, c) = math::sin_cos_quarter((0.25 * PI) * (b / a));
        ([a * c, a * s], a.abs())
    } else if b != 0.0 {
        let (s, c) = math::sin_cos_quarter((0.25 * PI) * (a / b));
        ([b * s, b * c], b.abs())
    } else {
        ([0.0, 0.0], 0.0)
    }
}

/// A point uniform over the unit disk: the concentric map of P. Shirley and K. Chiu, "A low distortion map between disk and square",
/// Journal of Graphics Tools 2(3), 1997.
#[inline]
pub fn sample_disk(u: [f32; 2]) -> [f32; 2] {
    concentric(u).0
}

/// Density of [`sample_disk`] per unit of area: 1 / pi inside, else 0. Rounding may lift a sample to the rim, so x^2 + y^2 <= 1 + 2^-20 counts
/// as inside.
#[inline]
pub fn pdf_area_disk(p: [f32; 2]) -> f32 {
    if p[0] * p[0] + p[1] * p[1] <= 1.0 + 1.0 / 1_048_576.0 { 1.0 / PI } else { 0.0 }
}

/// The `u` of [`sample_disk`]; round trip to 4 ulp of 1 (2.4e-7).
#[inline]
pub fn invert_disk(p: [f32; 2]) -> [f32; 2] {
    let [x, y] = p;
    let r = math::sqrt(x * x + y * y);
    let (a, b) = if r == 0.0 {
        (0.0, 0.0)
    } else if x.abs() > y.abs() {
        let a = r.copysign(x);
        (a, r * (math::atan2(y, x.abs()) * (4.0 / PI)))
    } else {
        let b = r.copysign(y);
        (r * (math::atan2(x, y.abs()) * (4.0 / PI)), b)
    };
    [unit(0.5 * (a - HALF_CELL) + 0.5), unit(0.5 * (b - HALF_CELL) + 0.5)]
}

/// Length of `v` without overflow or underflow of the squares.
#[inline]
fn length(v: Vec3) -> f32 {
    let largest = v.x.abs().max(v.y.abs()).max(v.z.abs());
    if largest > 0.0 {
        let s = v / largest;
        largest * math::sqrt(s.x * s.x + s.y * s.y + s.z * s.z)
    } else {
        0.0
    }
}

/// 1 / `area`, 0 for a shape of no area.
#[inline]
fn per_area(area: f32) -> f32 {
    if area > 0.0 { (1.0 / area).min(f32::MAX) } else { 0.0 }
}

/// A point uniform over the parallelogram `origin + s edge0 + t edge1`, s and t in [0, 1).
#[inline]
pub fn sample_parallelogram(u: [f32; 2], origin: Vec3, edge0: Vec3, edge1: Vec3) -> Vec3 {
    origin + edge0 * u[0] + edge1 * u[1]
}

/// Density of [`sample_parallelogram`] per square metre on the parallelogram: 1 / |edge0 x edge1|; 0 for one of no area.
///
/// Edge lengths in [1e-18, 1e18] m.
#[inline]
pub fn pdf_area_parallelogram(edge0: Vec3, edge1: Vec3) -> f32 {
    per_area(length(edge0.cross(edge1)))
}

/// The `u` of [`sample_parallelogram`] of a point in its plane; `[0, 0]` for a parallelogram of no area.
///
/// Round trip to 16 ulp of the largest coordinate over the height of the parallelogram on that edge.
#[inline]
pub fn invert_parallelogram(origin: Vec3, edge0: Vec3, edge1: Vec3, point: Vec3) -> [f32; 2] {
    let normal = edge0.cross(edge1);
    let area = length(normal);
    if area <= 0.0 {
        return [0.0, 0.0];
    }
    let (n, d) = (normal / area, point - origin);
    [unit(d.cross(edge1).dot(n) / area), unit(edge0.cross(d).dot(n) / area)]
}

/// Barycentric coordinates (summing to 1) of a point uniform over a triangle.
///
/// The area-preserving low-distortion map of E. Heitz, "A low-distortion map between triangle and square", 2019: the square folded along its
/// diagonal, without a square root; exact in f32 for multiples of 2^-24, and continuous. The third coordinate is at least 2^-24.
#[inline]
pub fn sample_triangle(u: [f32; 2]) -> [f32; 3] {
    let [u0, u1] = u;
    if u0 < u1 {
        let b0 = 0.5 * u0;
        [b0, u1 - b0, 1.0 - u1]
    } else {
        let b1 = 0.5 * u1;
        [u0 - b1, b1, 1.0 - u0]
    }
}

/// Density of [`sample_triangle`] per square metre on the triangle of edge vectors `edge0`, `edge1` (any two): 2 / |edge0 x edge1|;
/// 0 for one of no area. Edge lengths in [1e-18, 1e18] m.
#[inline]
pub fn pdf_area_triangle(edge0: Vec3, edge1: Vec3) -> f32 {
    per_area(0.5 * length(edge0.cross(edge1)))
}

/// The `u` of [`sample_triangle`]; round trip to 1 ulp of 1 (6e-8).
#[inline]
pub fn invert_triangle(bary: [f32; 3]) -> [f32; 2] {
    let [b0, b1, _] = bary;
    let sum = b0 + b1;
    if b0 < b1 { [unit(2.0 * b0), unit(sum)] } else { [unit(sum), unit(2.0 * b1)] }
}
