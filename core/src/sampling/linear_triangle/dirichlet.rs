//! The linear density as a mixture of Dirichlet densities: an oracle that shares no formula with the other samplers.

use super::robust::{scaled, unit};
use crate::math::{asin, sin_cos, sqrt};

/// sqrt(3).
const SQRT_3: f32 = 1.732_050_8;

/// The x of 3 x^2 - 2 x^3 = r, r in [0, 1]: with r = sin^2(3 g), x = 1/2 - sin(pi/6 - 2 g), written without a difference.
#[inline]
fn beta(r: f32) -> f32 {
    let (sin, cos) = sin_cos(asin(sqrt(r)) * (1.0 / 3.0));
    unit(sin * sin + SQRT_3 * (sin * cos))
}

#[inline]
pub(super) fn sample(weights: [f32; 3], u: [f32; 2]) -> [f32; 3] {
    let [a, b, c] = scaled(weights);
    let x = unit(u[0]) * (a + b + c);
    let split = unit(u[1]);
    // A vertex of no weight is not picked, the ends of the interval included.
    let (vertex, left, weight) = if x < a || b + c <= 0.0 {
        (0, x, a)
    } else if x - a < b || c <= 0.0 {
        (1, x - a, b)
    } else {
        (2, (x - a) - b, c)
    };
    let own = beta(unit(left / weight));
    let rest = 1.0 - own;
    let (next, last) = (rest * (1.0 - split), rest * split);
    match vertex {
        0 => [own, next, last],
        1 => [last, own, next],
        _ => [next, last, own],
    }
}

/// The densities 3 b_i of the three vertices, mixed.
#[inline]
pub(super) fn pdf(weights: [f32; 3], bary: [f32; 3]) -> f32 {
    let w = scaled(weights);
    if !bary.iter().all(|b| *b >= 0.0) {
        return 0.0;
    }
    let sum = w[0] + w[1] + w[2];
    let part = |i: usize| w[i] / sum * (3.0 * unit(bary[i]));
    part(0) + part(1) + part(2)
}
