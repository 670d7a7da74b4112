//! From a point to a polygon, in closed form.

use crate::math;

type V = [f64; 3];

/// 1 / (2 pi).
const INV_TAU: f64 = core::f64::consts::FRAC_1_PI / 2.0;

pub(super) fn sub(a: V, b: V) -> V {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(super) fn dot(a: V, b: V) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: V, b: V) -> V {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Form factor from a small patch at `point` with unit normal `normal` to a triangle, both of whose sides count, without anything in the way; what lies below the point's
/// horizon is cut off. In \[0, 1\]; 0 for a triangle of no area or of numbers that are not finite.
///
/// Sum over the edges a, b of what is left of angle(a, b) n . (a x b) / |a x b| / (2 pi), a and b as seen from the point (J. H. Lambert, Photometria, 1760).
/// Absolute error about 1e-8 times the edges' lengths over their distances, that of an angle of f32; all else is f64.
pub fn point_to_triangle(point: V, normal: V, vertices: [V; 3]) -> f64 {
    let from = vertices.map(|v| sub(v, point));
    let heights = from.map(|v| dot(v, normal));
    // A triangle cut by a plane has at most four corners.
    let mut corners = [[0.0; 3]; 4];
    let mut count = 0;
    for i in 0..3 {
        let (a, b, ha, hb) = (from[i], from[(i + 1) % 3], heights[i], heights[(i + 1) % 3]);
        if ha >= 0.0 && count < 4 {
            corners[count] = a;
            count += 1;
        }
        if (ha > 0.0 && hb < 0.0 || ha < 0.0 && hb > 0.0) && count < 4 {
            let s = ha / (ha - hb);
            corners[count] = [0, 1, 2].map(|k| a[k] + s * (b[k] - a[k]));
            count += 1;
        }
    }
    let mut sum = 0.0;
    for i in 0..count {
        let (a, b) = (corners[i], corners[(i + 1) % count]);
        let scale = math::sqrt64(dot(a, a)) * math::sqrt64(dot(b, b));
        let c = cross(a, b);
        let sine = math::sqrt64(dot(c, c));
        if sine > 0.0 && scale > 0.0 {
            let angle = math::atan2((sine / scale) as f32, (dot(a, b) / scale) as f32);
            sum += f64::from(angle) * (dot(normal, c) / sine);
        }
    }
    let found = INV_TAU * if sum < 0.0 { -sum } else { sum };
    // False for NaN.
    if found > 0.0 { found.min(1.0) } else { 0.0 }
}
