//! Vectors of three floats: what glam leaves open, in scalar operations of a fixed order.

use super::bits::{exponent, pow2};
use super::root_functions::sqrt;
use glam::Vec3;

#[inline(always)]
fn dot(a: Vec3, b: Vec3) -> f32 {
    a.x * b.x + a.y * b.y + a.z * b.z
}

/// The largest of the three components; NaN components count as absent (unless all are).
#[inline]
#[must_use]
pub fn max_component(v: Vec3) -> f32 {
    v.x.max(v.y).max(v.z)
}

/// The smallest of the three components; NaN components count as absent (unless all are).
#[inline]
#[must_use]
pub fn min_component(v: Vec3) -> f32 {
    v.x.min(v.y).min(v.z)
}

/// The mean of the three channels, (r + g + b) / 3: the project's scalar importance (unweighted, unlike luminance).
/// Products by 1/3 before the sum, so that three f32::MAX do not overflow.
#[inline]
#[must_use]
pub fn mean(rgb: Vec3) -> f32 {
    const THIRD: f32 = 1.0 / 3.0;
    rgb.x * THIRD + rgb.y * THIRD + rgb.z * THIRD
}

/// `v` divided by its length, or `fallback` if `v` is zero or not finite. Works for every other length, subnormal to
/// f32::MAX: where the square would leave the normal range `v` is first scaled by a power of two. Each component is within 3 ulp.
#[inline]
#[must_use]
pub fn normalize_or(v: Vec3, fallback: Vec3) -> Vec3 {
    let square = dot(v, v);
    if square > 1.0e-24 && square < 1.0e36 {
        let length = sqrt(square);
        return Vec3::new(v.x / length, v.y / length, v.z / length);
    }
    normalize_scaled(v, fallback)
}

#[cold]
fn normalize_scaled(v: Vec3, fallback: Vec3) -> Vec3 {
    let largest = v.x.abs().max(v.y.abs()).max(v.z.abs());
    if !(v.x.is_finite() && v.y.is_finite() && v.z.is_finite()) || largest == 0.0 {
        return fallback;
    }
    // Two factors, as 2^-(exponent) alone may lie outside the normal range.
    let k = -exponent(largest);
    let (f1, f2) = (pow2(k >> 1), pow2(k - (k >> 1)));
    let w = Vec3::new(v.x * f1 * f2, v.y * f1 * f2, v.z * f1 * f2);
    let length = sqrt(dot(w, w));
    Vec3::new(w.x / length, w.y / length, w.z / length)
}

/// Two unit vectors (t, b) with `n` a right-handed orthonormal basis, t x b = n. Precondition: `n` of unit length.
///
/// Duff et al. 2017, "Building an Orthonormal Basis, Revisited" (JCGT 6(1)), the branchless form; continuous but
/// across n.z = 0, no singular direction. n.z = -0 takes the lower hemisphere's branch; both are valid.
#[inline]
#[must_use]
pub fn orthonormal_basis(n: Vec3) -> (Vec3, Vec3) {
    let sign = f32::copysign(1.0, n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    (Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), Vec3::new(b, sign + n.y * n.y * a, -n.y))
}

/// Components of `v` along (t, b, n).
#[inline]
#[must_use]
pub fn to_local(v: Vec3, t: Vec3, b: Vec3, n: Vec3) -> Vec3 {
    Vec3::new(dot(v, t), dot(v, b), dot(v, n))
}

/// The vector with components `v` along (t, b, n): v.x t + v.y b + v.z n.
#[inline]
#[must_use]
pub fn from_local(v: Vec3, t: Vec3, b: Vec3, n: Vec3) -> Vec3 {
    Vec3::new(
        t.x * v.x + b.x * v.y + n.x * v.z,
        t.y * v.x + b.y * v.y + n.y * v.z,
        t.z * v.x + b.z * v.y + n.z * v.z,
    )
}

/// The mirror direction of `w` about `n`, 2 (w . n) n - w: both point away from the surface. Precondition: `n` of unit length.
#[inline]
#[must_use]
pub fn reflect(w: Vec3, n: Vec3) -> Vec3 {
    let twice = 2.0 * dot(w, n);
    Vec3::new(twice * n.x - w.x, twice * n.y - w.y, twice * n.z - w.z)
}
