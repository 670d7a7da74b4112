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
    /// Largest distance from the point to a vertex of its triangle (more for slivers, see [`hit_point`]), or the
    /// diameter of its round shape, metres: the rounding errors of the ray test scale with it. Not negative.
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

/// Unit vector `v / |v|`, or `None` for zero, NaN or infinite `v`. Scaled by a power of two first, so that neither
/// tiny nor huge vectors lose digits; within 2 ulp.
#[inline]
pub(super) fn unit(v: Vec3) -> Option<Vec3> {
    let v = scaled(v)?.0;
    Some(v / sqrt(v.dot(v)))
}

/// `x 2^n` in exact steps as long as the result is normal.
fn times_power_of_two(mut x: f32, mut n: i32) -> f32 {
    let (up, down) = (f32::from_bits((127 + 64) << 23), f32::from_bits((127 - 64) << 23));
    // At most five steps: n lies within +-300.
    while n > 64 {
        x *= up;
        n -= 64;
    }
    while n < -64 {
        x *= down;
        n += 64;
    }
    x * f32::from_bits(((127 + n) as u32) << 23)
}

/// `v` times the power of two that brings its largest component into [1, 2), and the exponent of that power.
#[inline]
fn scaled(v: Vec3) -> Option<(Vec3, i32)> {
    let largest = v.abs().max_element();
    if !(largest > 0.0 && largest < f32::INFINITY) || v.is_nan() {
        return None;
    }
    // A first step brings subnormals and the largest floats into the range of the second.
    let first: i32 = if largest < 1e-30 {
        100
    } else if largest > 1e30 {
        -100
    } else {
        0
    };
    let v = v * f32::from_bits(((127 + first) as u32) << 23);
    let second = power_of_two_scale(v.abs().max_element());
    Some((v * second, first + (second.to_bits() >> 23) as i32 - 127))
}

/// Edge from `a` to `b`, scaled; halved first where the difference overflows.
#[inline]
fn scaled_edge(a: Vec3, b: Vec3) -> Option<(Vec3, i32)> {
    let e = b - a;
    if e.is_finite() {
        return scaled(e);
    }
    scaled(b * 0.5 - a * 0.5).map(|(e, n)| (e, n - 1))
}

/// Unit geometric normal, `(v1 - v0) x (v2 - v0) / |..|`, or `None` for a degenerate triangle.
///
/// Taken at the vertex opposite the longest edge, whose two edges cancel least; the edges are scaled by powers of
/// two first, so that neither tiny nor huge triangles under- or overflow. Error as an angle: within 4 eps / sine of
/// the angle at that vertex, the largest (so slivers are bad only when they are obtuse), for finite vertices.
pub fn geometric_normal(v: [Vec3; 3]) -> Option<Vec3> {
    let size = |a: Vec3, b: Vec3| (b * 0.5 - a * 0.5).abs().max_element();
    let (s0, s1, s2) = (size(v[1], v[2]), size(v[2], v[0]), size(v[0], v[1]));
    let v = if s0 >= s1 && s0 >= s2 {
        v
    } else if s1 >= s2 {
        [v[1], v[2], v[0]]
    } else {
        [v[2], v[0], v[1]]
    };
    let (e1, _) = scaled_edge(v[0], v[1])?;
    let (e2, _) = scaled_edge(v[0], v[2])?;
    unit(e1.cross(e2))
}

/// Area of a triangle, square metres: `|(v1 - v0) x (v2 - v0)| / 2`.
///
/// Zero for a degenerate triangle; infinite only where the area itself exceeds f32. Relative error within
/// 4 eps / sine of the angle at `v0` where the area is a normal float.
pub fn triangle_area(v: [Vec3; 3]) -> f32 {
    let (Some((e1, n1)), Some((e2, n2))) = (scaled_edge(v[0], v[1]), scaled_edge(v[0], v[2])) else {
        return 0.0;
    };
    let n = e1.cross(e2);
    times_power_of_two(sqrt(n.dot(n)), -(n1 + n2 + 1))
}

/// `v0 + b1 (v1 - v0) + b2 (v2 - v0)`: exact in every coordinate that the vertices share, so a point of a triangle
/// in an axis plane lies in that plane. Precondition: coordinates below 1.7e38, so that the edges are finite.
#[inline]
pub fn interpolate(v: [Vec3; 3], b1: f32, b2: f32) -> Vec3 {
    v[0] + ((v[1] - v[0]) * b1 + (v[2] - v[0]) * b2)
}

/// The point of a triangle at barycentrics `b1`, `b2` with its extent (both metres): the distance to the farthest
/// vertex, times `0.2 longest^2 / (2 area)` between 1 and 32 for slivers.
///
/// In the ray test the edge functions of a triangle round by `u longest^2` against a `det` of `2 area cosine`, so
/// the error of `t` grows with the ratio of length to height; triangles fatter than 1 to 5 are not concerned.
/// Precondition as for [`interpolate`].
#[inline]
pub fn hit_point(v: [Vec3; 3], b1: f32, b2: f32) -> SurfacePoint {
    hit_point_with(v, b1, b2, sliver_factor(v))
}

/// By how much the extent of a triangle counts more because it is thin, 1 to 32: 0.2 longest^2 / (2 area).
pub fn sliver_factor(v: [Vec3; 3]) -> f32 {
    let squared = |q: Vec3| q.dot(q);
    let (e1, e2, e3) = (v[1] - v[0], v[2] - v[0], v[2] - v[1]);
    let longest = squared(e1).max(squared(e2)).max(squared(e3));
    let sliver = 0.2 * longest / sqrt(squared(e1.cross(e2)));
    // The NaN of a degenerate triangle takes the largest factor.
    if sliver < 32.0 { sliver.max(1.0) } else { 32.0 }
}

/// As [`hit_point`], with the [`sliver_factor`] of the triangle at hand.
#[inline]
pub fn hit_point_with(v: [Vec3; 3], b1: f32, b2: f32, factor: f32) -> SurfacePoint {
    let p = interpolate(v, b1, b2);
    let squared = |q: Vec3| q.dot(q);
    let reach = squared(v[0] - p).max(squared(v[1] - p)).max(squared(v[2] - p));
    SurfacePoint { position: p, extent: sqrt(reach) * factor }
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
    SurfacePoint { position, extent: 2.0 * shape.radius.max(0.0) }
}

/// Start of a new ray from the surface point `p` with unit normal `ng`, on the side that `toward` points to
/// (the side of `ng` when it points along the surface).
///
/// The point is moved along the normal by `u (6 sum |ng_i| |p_i| + 8 extent)`, `u = 2^-24`: 0.5 micrometres per
/// metre of extent, and nothing for the position along the plane. Where the terms come from, as displacements along
/// the normal: the rounding of the point, of the moved point, and of the vertices themselves (coplanar neighbours
/// are so only to the rounding of their coordinates), at most 6 u of each coordinate; the ray test, which decides
/// exactly for vertices displaced by at most 4 u reach (difference, slope, product, sum), and whose `t` rounds by
/// another 3 u reach. `reach` is the extent, up to a factor for neighbours.
///
/// A ray that leaves it into the hemisphere, at any angle down to a cosine of 1e-6, then meets neither its own
/// triangle, nor coincident ones, nor the other half of its quad. Measured: none of 10^7 rays in each of unit
/// scenes, scenes moved by 1e5, sizes 1e-3 and 1e3 together, quads of 1e5, oblique or in axis planes, and for
/// spheres and disks; with 0.35 of this offset still none of 10^6, with 0.25 the first. Limits: triangles thinner
/// than 1 to 150; and a coplanar neighbour that is many times larger than the triangle itself may be met, since the
/// error of its test is larger.
#[inline]
pub fn offset_origin(p: &SurfacePoint, ng: Vec3, toward: Vec3) -> Vec3 {
    let side = if toward.dot(ng) < 0.0 { -ng } else { ng };
    let height = U * (COORDINATE * ng.abs().dot(p.position.abs()) + EXTENT * p.extent);
    // An extent that overflowed must not turn a zero of the normal into NaN.
    p.position + side * height.min(U * f32::MAX)
}

/// Shadow ray from one offset point to another: `origin = from`, `direction = to - from` and
/// `t_max = 1 - 8 eps`, so that it ends just before `to`.
///
/// Offset both ends towards each other, with [`SurfacePoint::within`] their distance: seen from afar, the error of
/// the test at the far end scales with the distance, and at grazing incidence on the target no `t_max` makes up for
/// it. Then neither end's surface occludes: none of 10^7 segments, cosines down to 1e-4 at either end. An occluder
/// closer to the target than the offset there (0.5 micrometres per metre of distance) is not seen.
#[inline]
pub fn segment(from: Vec3, to: Vec3) -> Ray {
    Ray { origin: from, direction: to - from, t_max: SEGMENT_END }
}
