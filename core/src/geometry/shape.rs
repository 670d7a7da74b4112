//! Spheres and disks, tested analytically.

use super::ray::{Aabb, PreparedRay, slab_interval};
use crate::math::{Vec3, sqrt};
use bytemuck::{Pod, Zeroable};

/// [`RoundShape::kind`] of a sphere (its surface).
pub const SPHERE: u32 = 0;
/// [`RoundShape::kind`] of a flat disk.
pub const DISK: u32 = 1;

/// A sphere or a disk: 32 bytes, the same on the host and in shaders.
///
/// A radius that is not above zero, a disk without a normal, or an unknown kind is a shape that nothing hits.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct RoundShape {
    /// [`SPHERE`] or [`DISK`].
    pub kind: u32,
    /// Radius, metres.
    pub radius: f32,
    /// Centre, metres.
    pub center: [f32; 3],
    /// Normal of a disk (any length between 1e-15 and 1e15); unused by spheres.
    pub normal: [f32; 3],
}

impl RoundShape {
    /// A sphere.
    pub const fn sphere(center: [f32; 3], radius: f32) -> Self {
        Self { kind: SPHERE, radius, center, normal: [0.0; 3] }
    }
    /// A disk.
    pub const fn disk(center: [f32; 3], normal: [f32; 3], radius: f32) -> Self {
        Self { kind: DISK, radius, center, normal }
    }
}

/// Conservative box of a shape: each face is at or outside the true one, by at most 4 ulp. A disk in an axis plane
/// has a flat box. Empty for a shape that nothing hits.
pub fn bounds(shape: &RoundShape) -> Aabb {
    let r = shape.radius;
    let c = Vec3::from_array(shape.center);
    // NaN is refused with the rest.
    if !(r > 0.0 && r < f32::INFINITY) {
        return Aabb::EMPTY;
    }
    let half = match shape.kind {
        SPHERE => Vec3::splat(r),
        DISK => {
            let n = Vec3::from_array(shape.normal);
            let len2 = n.dot(n);
            if !(len2 > 0.0 && len2 < f32::INFINITY) {
                return Aabb::EMPTY;
            }
            // r sqrt(1 - n_i^2 / |n|^2), without the cancellation; widened by its own few roundings.
            let grow = r * (1.0 + 4.0 * f32::EPSILON);
            let (xx, yy, zz) = (n.x * n.x, n.y * n.y, n.z * n.z);
            Vec3::new(
                grow * sqrt((yy + zz) / len2),
                grow * sqrt((zz + xx) / len2),
                grow * sqrt((xx + yy) / len2),
            )
        }
        _ => return Aabb::EMPTY,
    };
    let down = |c: f32, h: f32| if h > 0.0 { (c - h).next_down() } else { c };
    let up = |c: f32, h: f32| if h > 0.0 { (c + h).next_up() } else { c };
    Aabb {
        lo: Vec3::new(down(c.x, half.x), down(c.y, half.y), down(c.z, half.z)),
        hi: Vec3::new(up(c.x, half.x), up(c.y, half.y), up(c.z, half.z)),
    }
}

/// Exact power of two `s` with `1 <= |x| s < 2`; `x` normal and below 8e37.
#[inline(always)]
pub(super) fn power_of_two_scale(x: f32) -> f32 {
    let exponent = (x.to_bits() >> 23) & 0xff;
    f32::from_bits((254 - exponent.clamp(1, 253)) << 23)
}

/// Smallest `t` in `[0, t_max]` at which the ray meets the shape.
///
/// Sphere: the discriminant is `r^2 - |f - (f.d/d.d) d|^2`, the distance of the line from the centre, not the
/// textbook `b^2 - 4ac` (Haines, Günther and Akenine-Möller, "Precision Improvements for Ray/Sphere Intersection",
/// Ray Tracing Gems, 2019, eq. 5), and the roots are `q/a` and `c/q` (their eq. 10), so neither a far nor a huge
/// sphere cancels. From inside, the far root is the hit; on the surface, 0.
/// Disk: the plane's `t`, then the distance from the centre, rim included.
/// As with triangles, `t` is clamped from below to the entry into the shape's own [`bounds`], and missing those is
/// a miss. NaN anywhere is a miss.
#[inline]
pub fn intersect_shape(ray: &PreparedRay, shape: &RoundShape, t_max: f32) -> Option<f32> {
    let own = bounds(shape);
    let (enter, leave) = slab_interval(ray, own.lo, own.hi);
    // The shear is NaN for directions outside the accepted range.
    if !(enter <= leave && leave >= 0.0 && enter <= t_max && ray.shear.z.abs() > 0.0) {
        return None;
    }
    let dominant = ray.direction.abs().max_element();
    let scale = power_of_two_scale(dominant);
    let d = ray.direction * scale;
    let f = ray.origin - Vec3::from_array(shape.center);
    let t = if shape.kind == SPHERE { sphere(f, d, shape.radius) } else { disk(f, d, shape) } * scale;
    let t = if t < enter { enter } else { t };
    if t >= 0.0 && t <= t_max && t < f32::INFINITY { Some(t + 0.0) } else { None }
}

/// First root at or above 0, or NaN. `f` is the origin seen from the centre, `d` has a largest component in [1, 2).
#[inline]
fn sphere(f: Vec3, d: Vec3, r: f32) -> f32 {
    let a = d.dot(d);
    let b = -f.dot(d);
    let line = f + d * (b / a);
    let distance = sqrt(line.dot(line));
    let discriminant = (r - distance) * (r + distance);
    if discriminant < 0.0 {
        return f32::NAN;
    }
    let root = sqrt(a * discriminant);
    let q = if b < 0.0 { b - root } else { b + root };
    let length = sqrt(f.dot(f));
    let c = (length - r) * (length + r);
    if q == 0.0 {
        // The line touches the sphere, and does so at the origin.
        return 0.0;
    }
    let (t0, t1) = (q / a, c / q);
    let (t0, t1) = if t0 < t1 { (t0, t1) } else { (t1, t0) };
    if t0 >= 0.0 { t0 } else { t1 }
}

/// The plane's root when it lies within the rim, or NaN.
#[inline]
fn disk(f: Vec3, d: Vec3, shape: &RoundShape) -> f32 {
    let n = Vec3::from_array(shape.normal);
    let t = -n.dot(f) / n.dot(d);
    let q = f + d * t;
    if q.dot(q) <= shape.radius * shape.radius { t } else { f32::NAN }
}

/// Unit geometric normal of a shape at the surface point `p`: away from the centre of a sphere, the disk's own
/// normal. `None` at the centre of a sphere or for a shape that nothing hits.
pub fn shape_normal(shape: &RoundShape, p: Vec3) -> Option<Vec3> {
    let n = match shape.kind {
        SPHERE => p - Vec3::from_array(shape.center),
        DISK => Vec3::from_array(shape.normal),
        _ => return None,
    };
    super::surface::unit(n)
}
