//! The published form: the marginal distribution of one barycentric inverted by Cardano's formula in f32, without protection.

use crate::math::{PI, acos, cbrt, cos, sqrt};

/// The first of the roots in [0, 1), NaN if there is none.
#[inline]
fn first_in_unit(roots: [f32; 3]) -> f32 {
    let inside = |x: f32| (0.0..1.0).contains(&x);
    if inside(roots[0]) {
        roots[0]
    } else if inside(roots[1]) {
        roots[1]
    } else if inside(roots[2]) {
        roots[2]
    } else {
        f32::NAN
    }
}

/// The barycentric of vertex 1: the root in [0, 1) of x^3 (S - 3 B) - 3 x^2 (S - 2 B) + 3 x (S - B) - alpha S.
#[inline]
pub(super) fn marginal(weights: [f32; 3], alpha: f32) -> f32 {
    let [a, b, c] = weights;
    let s = a + b + c;
    let leading = s - 3.0 * b;
    let k2 = -3.0 * (s - 2.0 * b) / leading;
    let k1 = 3.0 * (s - b) / leading;
    let k0 = -alpha * s / leading;
    // x = y - k2/3 with y^3 + p y + q = 0.
    let shift = k2 / 3.0;
    let p = k1 - k2 * shift;
    let q = 2.0 * shift * shift * shift - shift * k1 + k0;
    let discriminant = 0.25 * q * q + p * p * p / 27.0;
    if discriminant >= 0.0 {
        let d = sqrt(discriminant);
        let y = cbrt(-0.5 * q + d) + cbrt(-0.5 * q - d);
        first_in_unit([y - shift, f32::NAN, f32::NAN])
    } else {
        let r = sqrt(-p / 3.0);
        let phi = acos(-0.5 * q / (r * r * r));
        let root = |k: f32| 2.0 * r * cos((phi + k * (2.0 * PI)) / 3.0) - shift;
        first_in_unit([root(0.0), root(1.0), root(2.0)])
    }
}

/// The coordinate along the segment of constant x = bary 1: linear from X at v = 0 to Y at v = 1 - x.
#[inline]
pub(super) fn sample(weights: [f32; 3], u: [f32; 2]) -> [f32; 3] {
    let [a, b, c] = weights;
    let x = marginal(weights, u[0]);
    let rest = 1.0 - x;
    let (from, to) = (a * rest + b * x, c * rest + b * x);
    let d = sqrt(from * from * (1.0 - u[1]) + to * to * u[1]);
    let v = rest * (u[1] * (from + to) / (from + d));
    [rest - v, x, v]
}

/// 3 (w . b) / S, as it stands.
#[inline]
pub(super) fn pdf(weights: [f32; 3], bary: [f32; 3]) -> f32 {
    let [a, b, c] = weights;
    3.0 * (a * bary[0] + b * bary[1] + c * bary[2]) / (a + b + c)
}

/// The two distributions, as they stand.
#[inline]
pub(super) fn invert(weights: [f32; 3], bary: [f32; 3]) -> [f32; 2] {
    let ([a, b, c], [_, x, v]) = (weights, bary);
    let s = a + b + c;
    let alpha = x * (x * (x * (s - 3.0 * b) - 3.0 * (s - 2.0 * b)) + 3.0 * (s - b)) / s;
    let rest = 1.0 - x;
    let (from, to) = (a * rest + b * x, c * rest + b * x);
    let t = v / rest;
    [alpha, t * (from * (2.0 - t) + to * t) / (from + to)]
}
