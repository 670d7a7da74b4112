//! Warps of the unit square, from their densities.

use super::vec::{self, V};
use super::{Answer, Expect, Words, scaled, ulp};
use etendue_core::kernel::Kernel;
use std::f64::consts::PI;

/// Half a cell of unit numbers on [-1, 1]: core's concentric map takes `u` at the centre of its cell.
const HALF_CELL: f64 = 1.0 / 16_777_216.0;

fn direction(turn: f64, sin: f64, cos: f64) -> V {
    let (s, c) = (2.0 * PI * turn).sin_cos();
    [c * sin, s * sin, cos]
}

fn vector(v: V) -> Answer {
    Answer::Is(scaled(v, 1.0))
}

/// 1 - cos to +z without cancellation.
fn one_minus_cos(w: V) -> f64 {
    let w = vec::unit(w);
    if w[2] > 0.0 { (w[0] * w[0] + w[1] * w[1]) / (1.0 + w[2]) } else { 1.0 - w[2] }
}

/// -ln cos to +z.
fn neg_ln_cos(w: V) -> f64 {
    let cos = vec::unit(w)[2];
    if cos < 0.5 {
        return -cos.ln();
    }
    -(-one_minus_cos(w)).ln_1p()
}

/// Shirley and Chiu 1997: polar form, radius the larger coordinate, angle pi/4 of the ratio.
pub(super) fn concentric(u: [f64; 2]) -> ([f64; 2], f64) {
    let [a, b] = u.map(|u| 2.0 * u - 1.0 + HALF_CELL);
    let (r, phi) = if a.abs() > b.abs() {
        (a, 0.25 * PI * b / a)
    } else if b != 0.0 {
        (b, 0.5 * PI - 0.25 * PI * a / b)
    } else {
        (0.0, 0.0)
    };
    ([r * phi.cos(), r * phi.sin()], r.abs())
}

pub(super) fn cosine_hemisphere(u: [f64; 2]) -> V {
    let ([x, y], r) = concentric(u);
    [x, y, ((1.0 - r) * (1.0 + r)).sqrt()]
}

pub(super) fn power_cosine(u: [f64; 2], exponent: f64) -> V {
    let t = -(-u[0]).ln_1p() / (exponent.max(0.0) + 1.0);
    direction(u[1], (-(-2.0 * t).exp_m1()).sqrt(), (-t).exp())
}

pub(super) fn cone(u: [f64; 2], size: f64) -> V {
    let h = u[0] * size;
    direction(u[1], (h * (2.0 - h)).sqrt(), 1.0 - h)
}

fn invert_disk(p: [f64; 2]) -> [f64; 2] {
    let r = p[0].hypot(p[1]);
    let [a, b] = if r == 0.0 {
        [0.0, 0.0]
    } else if p[0].abs() > p[1].abs() {
        let a = r.copysign(p[0]);
        [a, a * (p[1] / p[0]).atan() * 4.0 / PI]
    } else {
        let b = r.copysign(p[1]);
        [b * (p[0] / p[1]).atan() * 4.0 / PI, b]
    };
    [a, b].map(|x| (0.5 * (x - HALF_CELL + 1.0)).clamp(0.0, 1.0))
}

fn inverse(u0: f64, w: V) -> Answer {
    let turn = if w[0] == 0.0 && w[1] == 0.0 { 0.0 } else { w[1].atan2(w[0]) / (2.0 * PI) };
    Answer::Is(vec![Expect::Scaled(u0.clamp(0.0, 1.0), 1.0), Expect::Turn(turn.rem_euclid(1.0))])
}

/// `factor` over the length of the cross product, which cancels as the edges become parallel.
fn per_area(e0: V, e1: V, factor: f64) -> Answer {
    let twice = vec::length(vec::cross(e0, e1));
    let density = if twice > 0.0 { (factor / twice).min(f64::from(f32::MAX)) } else { 0.0 };
    let condition = if twice > 0.0 { vec::length(e0) * vec::length(e1) / twice } else { 1.0 };
    Answer::Is(vec![Expect::Scaled(density, density * condition)])
}

pub(super) fn truth(kernel: Kernel, constants: &[u32], r: &mut Words<'_>) -> Answer {
    use Kernel as K;
    match kernel {
        K::SampleSphere => {
            let (u0, u1) = (r.real(), r.real());
            vector(direction(u1, 2.0 * (u0 * (1.0 - u0)).sqrt(), 1.0 - 2.0 * u0))
        }
        K::PdfSphere => ulp(0.25 / PI),
        K::InvertSphere => {
            let w = r.vec3();
            inverse(0.5 * one_minus_cos(w), w)
        }
        K::SampleHemisphere => {
            let (u0, u1) = (r.real(), r.real());
            vector(direction(u1, (u0 * (2.0 - u0)).sqrt(), 1.0 - u0))
        }
        K::PdfHemisphere => ulp(if r.vec3()[2] > 0.0 { 0.5 / PI } else { 0.0 }),
        K::InvertHemisphere => {
            let w = r.vec3();
            inverse(one_minus_cos(w), w)
        }
        K::SampleCosineHemisphere => vector(cosine_hemisphere([r.real(), r.real()])),
        K::PdfCosineHemisphere => ulp(r.vec3()[2].max(0.0) / PI),
        K::InvertCosineHemisphere => {
            let w = r.vec3();
            Answer::Is(scaled(invert_disk([w[0], w[1]]), 1.0))
        }
        K::SampleCone => vector(cone([r.real(), r.real()], r.real())),
        K::PdfCone => {
            let (w, size) = (r.vec3(), r.real());
            let d = one_minus_cos(w);
            // The rim counts as inside within 2^-20; the band about that margin is rounding's.
            let rim = size * (1.0 + 1.0 / 1_048_576.0);
            let band = 8.0 / 16_777_216.0;
            if (d - rim).abs() <= band * rim.max(if w[2] > 0.0 { 0.0 } else { 1.0 }) && size > 0.0 {
                Answer::Undecided
            } else if d <= rim && size > 0.0 {
                ulp((0.5 / PI / size).min(f64::from(f32::MAX)))
            } else {
                ulp(0.0)
            }
        }
        K::InvertCone => {
            let (w, size) = (r.vec3(), r.real());
            inverse(if size > 0.0 { one_minus_cos(w) / size } else { 0.0 }, w)
        }
        K::SamplePowerCosine => vector(power_cosine([r.real(), r.real()], r.real())),
        K::PdfPowerCosine => {
            let (w, n) = (r.vec3(), r.real());
            if w[2] <= 0.0 {
                return ulp(0.0);
            }
            let (n, log) = (n.max(0.0), neg_ln_cos(w));
            let value = (n + 1.0) * 0.5 / PI * (-n * log).exp();
            // An exponential is as good as its argument; a length off 1 by an ulp adds n sin^2 / cos^2 of them.
            let length_error = vec::dot(w, w) - 1.0;
            let s = (w[0] * w[0] + w[1] * w[1]) / (w[2] * w[2]);
            let condition = 1.0 + n * log + n * s * (1.0 + length_error.abs() * 16_777_216.0);
            // Below the normal range exp has the grid of subnormals.
            Answer::Is(vec![Expect::Scaled(value, (value * condition).max(1e-38 * (n + 1.0)))])
        }
        K::InvertPowerCosine => {
            let (w, n) = (r.vec3(), r.real());
            let u0 = if w[2] > 0.0 { -(-(n.max(0.0) + 1.0) * neg_ln_cos(w)).exp_m1() } else { 1.0 };
            // The slope of u0 in the rounding of w: that of (n+1) ln cos times the rest.
            let s = (w[0] * w[0] + w[1] * w[1]) / (w[2] * w[2]).max(1e-30);
            let condition = 1.0 + (n + 1.0) * s.min(1e6) * (1.0 - u0) * 4.0;
            let Answer::Is(mut list) = inverse(u0, w) else { unreachable!("inverse always decides") };
            list[0] = Expect::Scaled(u0.clamp(0.0, 1.0), condition);
            Answer::Is(list)
        }
        K::SampleDisk => Answer::Is(scaled(concentric([r.real(), r.real()]).0, 1.0)),
        K::PdfDisk => {
            let q = r.real().powi(2) + r.real().powi(2);
            let rim = 1.0 + 1.0 / 1_048_576.0;
            if (q - rim).abs() <= 4.0 / 16_777_216.0 {
                Answer::Undecided
            } else {
                ulp(if q <= rim { 1.0 / PI } else { 0.0 })
            }
        }
        K::InvertDisk => Answer::Is(scaled(invert_disk([r.real(), r.real()]), 1.0)),
        K::SampleTriangle => {
            let (u0, u1) = (r.real(), r.real());
            let b = if u0 < u1 { [0.5 * u0, u1 - 0.5 * u0] } else { [u0 - 0.5 * u1, 0.5 * u1] };
            Answer::Is([b[0], b[1], 1.0 - b[0] - b[1]].map(Expect::Ulp).to_vec())
        }
        K::InvertTriangle => {
            let b = r.vec3();
            let sum = b[0] + b[1];
            let u = if b[0] < b[1] { [2.0 * b[0], sum] } else { [sum, 2.0 * b[1]] };
            Answer::Is(scaled(u.map(|u| u.clamp(0.0, 1.0)), 1.0))
        }
        K::PdfTriangle => per_area(r.vec3(), r.vec3(), 2.0),
        K::PdfParallelogram => per_area(r.vec3(), r.vec3(), 1.0),
        K::SampleParallelogram => {
            let mut c = Words::new(constants);
            let (origin, e0, e1) = (c.vec3(), c.vec3(), c.vec3());
            let p = vec::add(origin, vec::add(vec::mul(e0, r.real()), vec::mul(e1, r.real())));
            let size = vec::largest(origin) + vec::largest(e0) + vec::largest(e1);
            Answer::Is(scaled(p, size))
        }
        _ => {
            let mut c = Words::new(constants);
            let (origin, e0, e1) = (c.vec3(), c.vec3(), c.vec3());
            let p = r.vec3();
            let (d, n) = (vec::sub(p, origin), vec::cross(e0, e1));
            let area2 = vec::dot(n, n);
            if area2 == 0.0 {
                return Answer::Is(scaled([0.0, 0.0], 1.0));
            }
            let s = vec::dot(vec::cross(d, e1), n) / area2;
            let t = vec::dot(vec::cross(e0, d), n) / area2;
            // Rounding of the difference over the height on the other edge.
            let size = vec::largest(p).max(vec::largest(origin)).max(vec::largest(e0)).max(vec::largest(e1));
            let area = area2.sqrt();
            let scale = |edge: V| 1.0 + size * vec::length(edge) / area;
            Answer::Is(vec![
                Expect::Scaled(s.clamp(0.0, 1.0), scale(e1)),
                Expect::Scaled(t.clamp(0.0, 1.0), scale(e0)),
            ])
        }
    }
}
