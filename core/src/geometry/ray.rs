//! Rays, what is computed once per ray, and the conservative box test.

use crate::math::Vec3;

/// Smallest magnitude of a direction component in the box test; smaller ones are replaced by it, sign kept.
const TINY_DIRECTION: f32 = 1e-18;
/// Largest direction component accepted: above it the reciprocal is subnormal and has lost its precision.
const HUGE_DIRECTION: f32 = 8e37;
/// Near planes are moved toward the origin by this factor. The four roundings of `(b - o) * (r * k)` with
/// `r = fl(1/d)` amount to at most 2 eps, so 3 eps leave one to spare.
const NEAR: f32 = 1.0 - 3.0 * f32::EPSILON;
/// Far planes are moved away by this factor.
const FAR: f32 = 1.0 + 3.0 * f32::EPSILON;

/// The half line or segment `origin + t direction`, `0 <= t <= t_max`, both ends included.
///
/// Lengths in metres. `direction` need not be unit length: `t` counts in units of `|direction|`, so a segment from
/// `p` to `q` is `direction = q - p`, `t_max = 1`. Accuracy holds while the largest component of `direction` is
/// between 1e-9 and 1e9 and distances stay below 1e18 m; outside these the result is still a value without NaN.
/// A ray whose largest direction component is below 1e-18 (in particular zero) or above 8e37 hits nothing, and so
/// does one whose `t_max` is negative or NaN. `t_max` may be infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Start, metres.
    pub origin: Vec3,
    /// Direction; its length is the unit of `t`.
    pub direction: Vec3,
    /// Largest accepted `t`.
    pub t_max: f32,
}

/// Everything about a ray that does not depend on what it is tested against: 64 bytes.
///
/// The fields are public because a backend's vector code reads them; they hold together, so build them only with
/// [`PreparedRay::new`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct PreparedRay {
    /// Start, metres.
    pub origin: Vec3,
    /// Direction as given.
    pub direction: Vec3,
    /// `(1/d) (1 - 3 eps)` per axis, for the planes where the ray enters; its sign says which those are.
    pub near: Vec3,
    /// `(1/d) (1 + 3 eps)` per axis, for the planes where the ray leaves.
    pub far: Vec3,
    /// Shear of Woop et al. 2013: `(dx/dz, dy/dz, 1/dz)` after the axes are rotated so that z dominates.
    /// NaN for a direction outside the accepted range, which makes every test a miss.
    pub shear: Vec3,
    /// The dominant axis, 0, 1 or 2: the axes are rotated to `(axis + 1, axis + 2, axis)` modulo 3.
    pub axis: u32,
}

/// Reciprocal with the smallest magnitudes replaced, so that it is finite and never zero.
#[inline(always)]
fn reciprocal(d: f32) -> f32 {
    1.0 / if d.abs() < TINY_DIRECTION { TINY_DIRECTION.copysign(d) } else { d }
}

impl PreparedRay {
    /// Prepares `ray`; `t_max` is not kept, since it shrinks while a tree is walked.
    #[inline]
    pub fn new(ray: &Ray) -> Self {
        let d = ray.direction;
        let r = Vec3::new(reciprocal(d.x), reciprocal(d.y), reciprocal(d.z));
        let (ax, ay, az) = (d.x.abs(), d.y.abs(), d.z.abs());
        // Selections, no branches: which axis dominates is as good as random.
        let (a, first) = if ax > ay { (ax, 0) } else { (ay, 1) };
        let axis = if a > az { first } else { 2 };
        let mut prepared =
            Self { origin: ray.origin, direction: d, near: r * NEAR, far: r * FAR, shear: Vec3::NAN, axis };
        let (dx, dy, dz) = prepared.rotate_once(d);
        if dz.abs() >= TINY_DIRECTION && dz.abs() <= HUGE_DIRECTION {
            prepared.shear = Vec3::new(dx / dz, dy / dz, 1.0 / dz);
        }
        prepared
    }

    /// `1/d` per axis, within 2 ulp of what [`near`](Self::near) and [`far`](Self::far) come from.
    #[inline(always)]
    pub fn reciprocal(&self) -> Vec3 {
        self.near * (1.0 + 3.0 * f32::EPSILON)
    }

    /// [`rotate`](Self::rotate) by selections: slower again and again, where the processor learns the branch, but
    /// quicker once.
    #[inline(always)]
    pub fn rotate_once(&self, v: Vec3) -> (f32, f32, f32) {
        let (first, second) = (self.axis == 0, self.axis == 1);
        let pick = |a: f32, b: f32, c: f32| {
            let c = if second { b } else { c };
            if first { a } else { c }
        };
        (pick(v.y, v.z, v.x), pick(v.z, v.x, v.y), pick(v.x, v.y, v.z))
    }

    /// Components of `v` with the dominant axis last (a rotation of the axes, so handedness is kept).
    #[inline(always)]
    pub fn rotate(&self, v: Vec3) -> (f32, f32, f32) {
        match self.axis {
            0 => (v.y, v.z, v.x),
            1 => (v.z, v.x, v.y),
            _ => (v.x, v.y, v.z),
        }
    }
}

/// Axis-aligned box, metres; empty when `lo > hi` on any axis.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Aabb {
    /// Smallest corner.
    pub lo: Vec3,
    /// Largest corner.
    pub hi: Vec3,
}

impl Aabb {
    /// The box of nothing: `lo = +inf`, `hi = -inf`. Every ray misses it, and a union with it changes nothing.
    pub const EMPTY: Self = Self { lo: Vec3::INFINITY, hi: Vec3::NEG_INFINITY };

    /// Smallest box around both. Exact.
    #[inline]
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// Whether the box holds no point.
    #[inline]
    pub fn is_empty(&self) -> bool {
        !(self.lo.x <= self.hi.x && self.lo.y <= self.hi.y && self.lo.z <= self.hi.z)
    }
}

/// One-instruction maximum; the second operand when either is NaN.
#[inline(always)]
fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// One-instruction minimum; the second operand when either is NaN.
#[inline(always)]
fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// Where the line of the ray enters and leaves the box, in `t`, before any clamping to the ray's interval.
///
/// The sign of a positive or zero entry and exit is exact, because differences and products of floats keep theirs.
#[inline(always)]
pub(super) fn slab_interval(ray: &PreparedRay, lo: Vec3, hi: Vec3) -> (f32, f32) {
    let o = ray.origin;
    let (nx, fx) = if ray.near.x > 0.0 { (lo.x, hi.x) } else { (hi.x, lo.x) };
    let (ny, fy) = if ray.near.y > 0.0 { (lo.y, hi.y) } else { (hi.y, lo.y) };
    let (nz, fz) = if ray.near.z > 0.0 { (lo.z, hi.z) } else { (hi.z, lo.z) };
    let enter = max(max((nx - o.x) * ray.near.x, (ny - o.y) * ray.near.y), (nz - o.z) * ray.near.z);
    let leave = min(min((fx - o.x) * ray.far.x, (fy - o.y) * ray.far.y), (fz - o.z) * ray.far.z);
    (enter, leave)
}

/// Conservative ray-box test: the entry `t >= 0` if the ray may touch the box within `[0, t_max]`, else `None`.
///
/// The entry is never later than the true one and no touched box is missed (four roundings, at most 2 eps, against
/// a margin of 3 eps on each side), for direction components of at least 1e-18. The value does not depend on
/// `t_max`. An origin inside the box, or on a flat one, enters at 0. The empty box is missed. A direction component
/// of zero counts as 1e-18 with its sign, so a ray that runs within the plane of a face has the box on the side to
/// which that sign points, and not the one on the other side.
#[inline(always)]
pub fn slab_entry(ray: &PreparedRay, lo: Vec3, hi: Vec3, t_max: f32) -> Option<f32> {
    let (enter, leave) = slab_interval(ray, lo, hi);
    let enter = max(enter, 0.0);
    if enter <= min(leave, t_max) { Some(enter) } else { None }
}
