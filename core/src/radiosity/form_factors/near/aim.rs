//! Points on a triangle to which rays look whether anything is in the way.

use crate::geometry::{Ray, SurfacePoint, interpolate, offset_origin, segment};
use crate::math::{self, INV_PI, PI, Vec3};
use crate::radiosity::patches::MemberTriangle;
use crate::sampling::warp;

/// Longest edge over distance below which points are even over the area: there the solid angle would be a small difference of large angles, and what a point
/// counts varies little.
const FAR: f32 = 0.5;

/// A ray from `from` (unit normal `normal`) to a point of the triangle, chosen by two numbers, and what it counts: the mean over all choices is the form factor from the point.
/// `None` for what counts 0, as points below the horizon do.
#[inline]
pub(super) fn aim(
    from: &SurfacePoint,
    normal: Vec3,
    target: &MemberTriangle,
    u: [f32; 2],
) -> Option<(Ray, f32)> {
    let [v0, v1, v2] = target.vertices;
    let p = from.position;
    let squared = |e: Vec3| e.dot(e);
    let longest = squared(v1 - v0).max(squared(v2 - v0)).max(squared(v2 - v1));
    let centre = (v0 + v1 + v2) / 3.0 - p;
    let spherical =
        if longest < FAR * FAR * squared(centre) { None } else { solid_angle(p, target.vertices, u) };
    let (l1, l2) = match spherical {
        Some((direction, _)) => meet(p, direction, target.vertices)?,
        None => {
            let [_, l1, l2] = warp::sample_triangle(u);
            (l1, l2)
        }
    };
    let to = interpolate(target.vertices, l1, l2);
    let between = to - p;
    let distance = math::sqrt(squared(between));
    let (cos, cos_to) = (between.dot(normal) / distance, -between.dot(target.normal) / distance);
    if !(cos > 0.0 && cos_to > 0.0) {
        return None;
    }
    let weight = match spherical {
        Some((_, angle)) => cos * angle * INV_PI,
        None => {
            let cross = (v1 - v0).cross(v2 - v0);
            let area = 0.5 * math::sqrt(squared(cross));
            cos * cos_to * area * INV_PI / squared(between)
        }
    };
    let start = offset_origin(&from.within(distance), normal, between);
    let end = SurfacePoint { position: to, extent: target.reach(to) }.within(distance);
    Some((segment(start, offset_origin(&end, target.normal, -between)), weight))
}

/// Where a ray meets the plane of a triangle, as barycentrics of vertices 1 and 2 in the triangle.
fn meet(p: Vec3, direction: Vec3, [v0, v1, v2]: [Vec3; 3]) -> Option<(f32, f32)> {
    let (e1, e2, s) = (v1 - v0, v2 - v0, p - v0);
    let h = direction.cross(e2);
    let q = s.cross(e1);
    let scale = 1.0 / e1.dot(h);
    let (l1, l2) = ((s.dot(h) * scale).max(0.0), (direction.dot(q) * scale).max(0.0));
    let sum = (l1 + l2).max(1.0);
    (sum < f32::INFINITY).then(|| (l1 / sum, l2 / sum))
}

/// A direction even over the solid angle of a triangle, and that angle \[sr\]; `None` where there is none to speak of. J. Arvo, Stratified sampling of spherical triangles (1995).
fn solid_angle(p: Vec3, vertices: [Vec3; 3], [u, v]: [f32; 2]) -> Option<(Vec3, f32)> {
    let unit = |x: Vec3| {
        let length = math::sqrt(x.dot(x));
        (length > 0.0).then(|| x / length)
    };
    let (a, b, c) = (unit(vertices[0] - p)?, unit(vertices[1] - p)?, unit(vertices[2] - p)?);
    let (ab, ca) = (unit(a.cross(b))?, unit(c.cross(a))?);
    let alpha = math::acos((-ab.dot(ca)).clamp(-1.0, 1.0));
    // The sum of the angles less pi is this too, but loses all digits of a small one (A. van Oosterom and J. Strackee, 1983).
    let angle = 2.0 * math::atan2(math::abs(a.dot(b.cross(c))), 1.0 + a.dot(b) + b.dot(c) + c.dot(a));
    if angle.is_nan() || angle <= 1e-6 {
        return None;
    }
    let (sin_alpha, cos_alpha) = math::sin_cos(alpha);
    // The part of the triangle with an area of u: another vertex on the edge from a to c.
    let (sin_part, cos_part) = math::sin_cos(PI + u * angle);
    let sin_phi = sin_part * cos_alpha - cos_part * sin_alpha;
    let cos_phi = cos_part * cos_alpha + sin_part * sin_alpha;
    let k1 = cos_phi + cos_alpha;
    let k2 = sin_phi - sin_alpha * a.dot(b);
    let cos_b =
        (k2 + (k2 * cos_phi - k1 * sin_phi) * cos_alpha) / ((k2 * sin_phi + k1 * cos_phi) * sin_alpha);
    let cos_b = if cos_b.is_nan() { 1.0 } else { cos_b.clamp(-1.0, 1.0) };
    let along = |x: Vec3, from: Vec3| unit(x - from * x.dot(from)).unwrap_or(Vec3::ZERO);
    let part = a * cos_b + along(c, a) * math::sqrt_clamped(1.0 - cos_b * cos_b);
    // Along the arc from b to that vertex.
    let cos_t = 1.0 - v * (1.0 - part.dot(b));
    let direction = b * cos_t + along(part, b) * math::sqrt_clamped(1.0 - cos_t * cos_t);
    Some((direction, angle))
}
