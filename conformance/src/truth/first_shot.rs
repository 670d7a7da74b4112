//! The truth of the kernels of `first_shot`: areas of pieces in whole steps, everything else in f64 from the definitions.

use super::linear_triangle::{place, relative};
use super::vec::V;
use super::{Answer, Expect, Words, nothing, ulp};
use etendue_core::kernel::Kernel;

/// Unit roundoff of f32.
const U: f64 = 1.0 / 16_777_216.0;
/// Steps along an edge.
const GRID: f64 = 16_777_216.0;
/// Beyond a piece's edge by no more than this counts as on it.
const SLACK: f64 = 1e-4_f32 as f64;
const MAX: f64 = f32::MAX as f64;

/// Second and third barycentric of each corner, in steps; none where a corner is outside.
fn corners(r: &mut Words<'_>) -> Option<[[i64; 2]; 3]> {
    let c = [(); 3].map(|()| [i64::from(r.word()), i64::from(r.word())]);
    c.iter().all(|[x, y]| x + y <= 1 << 24).then_some(c)
}

/// Where a point of the triangle lies on a piece.
enum Where {
    /// The piece has no area.
    Nowhere,
    /// So thin that the products of its sides round to the same.
    Unknown,
    /// Barycentrics, and what the roundings of each amount to, in units of U.
    At([f64; 3], [f64; 3]),
}

/// By ratios of areas; `all` is exact.
fn locate([a, b, c]: [[i64; 2]; 3], [x, y]: [f64; 2]) -> Where {
    let (u, v) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
    let (first, second) = (u[0] * v[1], u[1] * v[0]);
    let all = first - second;
    if all <= 0 {
        return Where::Nowhere;
    }
    let (all, both) = (all as f64, (first.abs() + second.abs()) as f64);
    if all <= 2.0 * U * both {
        return Where::Unknown;
    }
    let p = [x * GRID - a[0] as f64, y * GRID - a[1] as f64];
    let (u, v) = (u.map(|x| x as f64), v.map(|x| x as f64));
    let l1 = (p[0] * v[1] - p[1] * v[0]) / all;
    let l2 = (u[0] * p[1] - u[1] * p[0]) / all;
    let thin = both / all;
    // Differences of coordinates are rounded once, products once, and the denominator as much as it is thin.
    let s1 = ((p[0] * v[1]).abs() + (p[1] * v[0]).abs()) / all + l1.abs() * thin;
    let s2 = ((u[0] * p[1]).abs() + (u[1] * p[0]).abs()) / all + l2.abs() * thin;
    Where::At([1.0 - l1 - l2, l1, l2], [1.0 + s1 + s2, s1, s2])
}

/// Negative and NaN count as 0, infinity as the largest number, three zeros as ones.
fn weights(w: V) -> V {
    let w = w.map(|x| if x > 0.0 { x.min(MAX) } else { 0.0 });
    if w == [0.0; 3] { [1.0; 3] } else { w }
}

fn density(r: &mut Words<'_>) -> Answer {
    let corners = corners(r);
    let (w, area, pmf, at) = (weights(r.vec3()), r.real(), r.real(), [r.real(), r.real()]);
    let Some(corners) = corners else { return ulp(0.0) };
    let (local, scales) = match locate(corners, at) {
        Where::Nowhere => return ulp(0.0),
        Where::Unknown => return Answer::Undecided,
        Where::At(local, scales) => (local, scales),
    };
    let edge = |i: usize| local[i] + SLACK;
    if (0..3).any(|i| edge(i) < -8.0 * U * scales[i]) || area.is_nan() || area <= 0.0 {
        return ulp(0.0);
    }
    if (0..3).any(|i| edge(i) <= 8.0 * U * scales[i]) {
        return Answer::Undecided;
    }
    let whole: f64 = w.iter().sum();
    let mean = |x: V| 3.0 * (0..3).map(|i| w[i] / whole * x[i]).sum::<f64>();
    let front = pmf / area;
    let value = front * mean(local.map(|l| l.clamp(0.0, 1.0))).min(3.0);
    let scale = front * mean(scales) + value;
    // What overflows is the largest number; how near it is to doing so is not resolved.
    if value + 8.0 * U * scale >= MAX {
        return Answer::Is(vec![Expect::Scaled(MAX, MAX.max(scale.min(1e300)))]);
    }
    Answer::Is(vec![Expect::Scaled(value, scale.max(f64::from(f32::MIN_POSITIVE)))])
}

/// Both densities: that of the light, that of the pieces.
fn densities(e: V, density: f64, per_watt: f64) -> [f64; 2] {
    let counted = |x: f64| if x > 0.0 { x } else { 0.0 };
    [counted(per_watt * ((e[0] + e[1] + e[2]) / 3.0)).min(MAX), counted(density)]
}

pub(super) fn truth(kernel: Kernel, _constants: &[u32], r: &mut Words<'_>) -> Answer {
    match kernel {
        Kernel::StartPlace => {
            let corners = corners(r);
            let local = place(r.vec3(), [r.real(), r.real()]);
            let Some(c) = corners else { return nothing(3) };
            let steps = c.map(|[x, y]| [(1 << 24) - x - y, x, y].map(|s| s as f64 / GRID));
            Answer::Is((0..3).map(|k| relative((0..3).map(|j| local[j] * steps[j][k]).sum())).collect())
        }
        Kernel::StartWithin => {
            let corners = corners(r);
            let at = [r.real(), r.real()];
            match corners.map_or(Where::Nowhere, |c| locate(c, at)) {
                Where::Nowhere => nothing(4),
                Where::Unknown => Answer::Undecided,
                Where::At(local, scales) => {
                    let mut out = vec![Expect::Word(1)];
                    out.extend((0..3).map(|i| Expect::Scaled(local[i], scales[i].max(1e-30))));
                    Answer::Is(out)
                }
            }
        }
        Kernel::StartDensity => density(r),
        Kernel::StartFlux => {
            let (e, density, per_watt) = (r.vec3(), r.real(), r.real());
            let [light, pieces] = densities(e, density, per_watt);
            let all = light + pieces;
            let sense = all > 0.0 && e.iter().all(|x| x.is_finite());
            Answer::Is(e.map(|x| Expect::Ulp(if sense { (x / all).clamp(0.0, MAX) } else { 0.0 })).to_vec())
        }
        Kernel::LightShare => {
            let [light, pieces] = densities(r.vec3(), r.real(), r.real());
            ulp(if light + pieces > 0.0 { light / (light + pieces) } else { 1.0 })
        }
        Kernel::LookFactor => {
            let (chance, blocked) = (r.real(), r.word() != 0);
            // What is never asked about, or always, carries nothing where it is hidden.
            let inverse = if chance > 0.0 && chance < 1.0 { (1.0 / chance).min(MAX) } else { 1.0 };
            Answer::Is(vec![Expect::Scaled(if blocked { 1.0 - inverse } else { 1.0 }, inverse)])
        }
        _ => {
            let (colour, w, area, pmf) = (r.vec3(), r.vec3(), r.real(), r.real());
            let mean = (w[0] + w[1] + w[2]) / 3.0;
            let flux = mean * area / pmf;
            let flux = if pmf > 0.0 && flux > 0.0 { flux.min(MAX) } else { 0.0 };
            let counted = |x: f64| if x > 0.0 { x.min(MAX) } else { 0.0 };
            Answer::Is(colour.map(|c| Expect::Ulp(counted(c * flux))).to_vec())
        }
    }
}
