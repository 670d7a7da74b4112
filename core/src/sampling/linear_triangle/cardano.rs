//! The published form: the marginal distribution of one barycentric inverted by Cardano's formula in f32, without protection.

use super::LinearTriangle;
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
fn marginal(weights: [f32; 3], alpha: f32) -> f32 {
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

/// As published; see the module. Weights >= 0 with a positive sum; the result is NaN where the formula fails.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cardano;

impl Cardano {
    /// The barycentric of vertex 1 for the first random number, by Cardano's formula; NaN where it gives no root in [0, 1).
    #[inline]
    #[must_use]
    pub fn marginal(weights: [f32; 3], u: f32) -> f32 {
        marginal(weights, u)
    }
}

impl LinearTriangle for Cardano {
    /// Along the segment of constant x = bary 1 the density is linear, from X = A (1-x) + B x at v = 0 to Y = C (1-x) + B x at v = 1-x.
    #[inline]
    fn sample(weights: [f32; 3], u: [f32; 2]) -> [f32; 3] {
        let [a, b, c] = weights;
        let x = marginal(weights, u[0]);
        let rest = 1.0 - x;
        let (from, to) = (a * rest + b * x, c * rest + b * x);
        let d = sqrt(from * from * (1.0 - u[1]) + to * to * u[1]);
        let v = rest * (u[1] * (from + to) / (from + d));
        [rest - v, x, v]
    }

    #[inline]
    fn pdf(weights: [f32; 3], bary: [f32; 3]) -> f32 {
        let [a, b, c] = weights;
        3.0 * (a * bary[0] + b * bary[1] + c * bary[2]) / (a + b + c)
    }

    #[inline]
    fn invert(weights: [f32; 3], bary: [f32; 3]) -> [f32; 2] {
        let [a, b, c] = weights;
        let [_, x, v] = bary;
        let s = a + b + c;
        let rest = 1.0 - x;
        let (from, to) = (a * rest + b * x, c * rest + b * x);
        let share = v / rest;
        let xi = x * ((3.0 * (s - b)) - x * (3.0 * (s - 2.0 * b) - x * (s - 3.0 * b))) / s;
        [xi, share * (2.0 * from + (to - from) * share) / (from + to)]
    }
}
