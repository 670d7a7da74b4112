//! Points on surfaces, and rays that leave them without meeting what they leave.

use super::ray::Ray;
use super::shape::{RoundShape, SPHERE, power_of_two_scale};
use crate::math::{Vec3, sqrt};

/// Unit roundoff of f32, 2^-24.
const U: f32 = 0.5 * f32::EPSILON;
/// Offset per coordinate, in roundoffs.
const COORDINATE: f32 = 6.0;
/// Offset per extent, in roundoffs.
const EXTENT: f32 = 8.0;
/// End of a segment between offset points.
const SEGMENT_END: f32 = 1.0 - 8.0 * f32::EPSILON;

/// A point on a surface with what its rounding may amount to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Where, metres.
    pub position: Vec3,
    /// Largest distance from the point to a vertex of its triangle (or the diameter of its round shape), metres:
    /// the rounding errors of the ray test scale with it.
    pub extent: f32,
}

impl SurfacePoint {
    /// The same point as one end of a segment of length `distance`: the test against this end's triangle is made
    /// from the other end, so its rounding errors scale with the distance when that exceeds the extent.
    #[must_use]
    pub fn within(self, distance: f32) -> Self {
        Self { extent: self.extent.max(distance), ..self }
    }
}

/// `v / |v|`, or `None` for zero, NaN or infinite `v`. Scaled by a power of two first, so that neither tiny nor
/// huge vectors lose digits; within 2 ulp.
#[inline]
pub(super) fn unit(v: Vec3) -> Option<Vec3> {
    let v = scaled(v)?.0;
    Some(v / sqrt(v.dot(v)))
}

/// `v` times a power of two that brings its largest component into [1, 2), and that power.
#[inline]
fn scaled(v: Vec3) -> Option<(Vec3, f32)> {
    let largest = v.abs().max_element();
    if !(largest > 0.0 && largest < f32::INFINITY) || v.is_nan() {
        return None;
    }
    // Two steps reach subnormals; the largest floats are halved into the range of the scale first.
    let first = if largest < 1e-30 {
        f32::from_bits((127 + 100) << 23)
    } else if largest > 1e30 {
        f32::from_bits((127 - 100) << 23)
    } else {
        1.0
    };
    let v = v * first;
    let second = power_of_two_scale(v.abs().max_element());
    Some((v * second, first * second))
}

/// Unit geometric normal `(v1 - v0) x (v2 - v0) / |..|`, or `None` for a degenerate triangle.
///
/// The edges are scaled by powers of two first, so that neither tiny nor huge triangles under- or overflow.
pub fn geometric_normal(v: [Vec3; 3]) -> Option<Vec3> {
    let (e1, _) = scaled(v[1] - v[0])?;
    let (e2, _) = scaled(v[2] - v[0])?;
    unit(e1.cross(e2))
}

/// Area of a triangle, square metres: half the length of the cross product of two edges.
///
/// Zero for a degenerate triangle; infinite only where the area itself exceeds f32.
pub fn triangle_area(v: [Vec3; 3]) -> f32 {
    let (Some((e1, s1)), Some((e2, s2))) = (scaled(v[1] - v[0]), scaled(v[2] - v[0])) else { return 0.0 };
    let n = e1.cross(e2);
    0.5 * sqrt(n.dot(n)) / s1 / s2
}

/// `v0 + b1 (v1 - v0) + b2 (v2 - v0)`: exact in every coordinate that the vertices share.
#[inline]
pub fn interpolate(v: [Vec3; 3], b1: f32, b2: f32) -> Vec3 {
    v[0] + ((v[1] - v[0]) * b1 + (v[2] - v[0]) * b2)
}

/// The point of a triangle at barycentrics `b1`, `b2`, and its distance to the farthest vertex.
#[inline]
pub fn hit_point(v: [Vec3; 3], b1: f32, b2: f32) -> SurfacePoint {
    let p = interpolate(v, b1, b2);
    let far = |q: Vec3| (q - p).dot(q - p);
    SurfacePoint { position: p, extent: sqrt(far(v[0]).max(far(v[1])).max(far(v[2]))) }
}

/// The point of a round shape nearest to `p` (a computed hit), and the diameter of the shape.
pub fn shape_point(shape: &RoundShape, p: Vec3) -> SurfacePoint {
    let c = Vec3::from_array(shape.center);
    let position = match (shape.kind, unit(p - c), unit(Vec3::from_array(shape.normal))) {
        (SPHERE, Some(n), _) => c + n * shape.radius,
        (SPHERE, None, _) => p,
        (_, _, Some(n)) => p - n * n.dot(p - c),
        _ => p,
    };
    SurfacePoint { position, extent: 2.0 * shape.radius }
}

/// Start of a new ray from the surface point `p` with unit normal `ng`, on the side that `toward` points to.
#[inline]
pub fn offset_origin(p: &SurfacePoint, ng: Vec3, toward: Vec3) -> Vec3 {
    let side = if toward.dot(ng) < 0.0 { -ng } else { ng };
    let height = U * (COORDINATE * ng.abs().dot(p.position.abs()) + EXTENT * p.extent);
    p.position + side * height
}

/// Shadow ray from one offset point to another: `t_max` a little below 1.
#[inline]
pub fn segment(from: Vec3, to: Vec3) -> Ray {
    Ray { origin: from, direction: to - from, t_max: SEGMENT_END }
}
