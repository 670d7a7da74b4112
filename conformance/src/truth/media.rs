//! Flights, phase functions and Fresnel's equations from their definitions.

use super::bsdf::to_world;
use super::vec;
use super::{Answer, Expect, Words};
use etendue_core::kernel::Kernel;
use std::f64::consts::{PI, TAU};

/// Unit roundoff of f32.
const U: f64 = 1.0 / 16_777_216.0;

/// Reflectance by the ratio of cosines, sin^2 beyond the boundary moved by `off`.
fn dielectric(cos: f64, ratio: f64, off: f64) -> f64 {
    let sin2 = ((1.0 - cos * cos) / (ratio * ratio)) * (1.0 + off) + off;
    if sin2 >= 1.0 {
        return 1.0;
    }
    let beyond = (1.0 - sin2.max(0.0)).sqrt();
    let s = (cos - ratio * beyond) / (cos + ratio * beyond);
    let p = (ratio * cos - beyond) / (ratio * cos + beyond);
    if cos + beyond == 0.0 { 1.0 } else { 0.5 * (s * s + p * p) }
}

/// |r|^2 of both polarisations with complex numbers, as the definition has it.
fn conductor(cos: f64, eta: f64, k: f64, off: f64) -> f64 {
    type C = (f64, f64);
    let mul = |a: C, b: C| (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0);
    let norm2 = |a: C| a.0 * a.0 + a.1 * a.1;
    let n2 = mul((eta, k), (eta, k));
    let (x, y) = (n2.0 * (1.0 + off) - (1.0 - cos * cos), n2.1);
    let r = x.hypot(y);
    // The root with a positive real part.
    let root = ((0.5 * (r + x)).max(0.0).sqrt(), (0.5 * (r - x)).max(0.0).sqrt());
    let s = norm2((cos - root.0, -root.1)) / norm2((cos + root.0, root.1));
    let (a, b) = ((n2.0 * cos, n2.1 * cos), root);
    let p = norm2((a.0 - b.0, a.1 - b.1)) / norm2((a.0 + b.0, a.1 + b.1));
    0.5 * (s + p)
}

pub(super) fn truth(kernel: Kernel, r: &mut Words<'_>) -> Answer {
    use Kernel as K;
    match kernel {
        K::EvalPhase => {
            let (g, wo, wi) = (r.real(), r.vec3(), r.vec3());
            // Unit vectors are so up to rounding: the angle is that of their sum, which is right for both.
            let sum = if g < 0.0 { vec::sub(wi, wo) } else { vec::add(wi, wo) };
            let cos = (1.0 - 0.5 * vec::dot(sum, sum)) * if g < 0.0 { -1.0 } else { 1.0 };
            let p = (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * cos).powf(1.5));
            Answer::Is(vec![Expect::Scaled(p, p)])
        }
        K::SamplePhase => {
            let (g, wo, u, turn) = (r.real(), r.vec3(), r.real(), r.real());
            if wo[2] != 0.0 && wo[2].abs() <= 8.0 * U {
                // The frame jumps across z = 0.
                return Answer::Undecided;
            }
            let x = 2.0 * u - 1.0;
            let d = 1.0 + g * x;
            let cos = (x + 0.5 * g * (x * x + 3.0) + g * g * x + 0.5 * g * g * g * (x * x - 1.0)) / (d * d);
            let cos = cos.clamp(-1.0, 1.0);
            let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
            let local = [sin * (TAU * turn).cos(), sin * (TAU * turn).sin(), cos];
            let w = to_world(local, wo.map(|x| -x));
            // What the rounding of 1 - g and of 2 g u does to the angle.
            Answer::Is(w.map(|x| Expect::Scaled(x, 1.0 + 2.0 * sin / d)).to_vec())
        }
        K::Transmittance => {
            let (sigma, length) = (r.vec3(), r.real());
            let one = |s: f64| {
                let tau = s * length;
                let t = if s > 0.0 { (-tau).exp() } else { 1.0 };
                // The rounding of the product; what is below the smallest normal number may be 0.
                Expect::Scaled(t, t * (1.0 + tau) + f64::from(f32::MIN_POSITIVE) / U)
            };
            Answer::Is(sigma.map(one).to_vec())
        }
        K::FresnelDielectric => {
            let (cos, ratio) = (r.real(), r.real());
            let value = dielectric(cos, ratio, 0.0);
            let moved = [-4.0 * U, 4.0 * U].map(|off| (dielectric(cos, ratio, off) - value).abs());
            Answer::Is(vec![Expect::Scaled(value, 1.0 + moved[0].max(moved[1]) / U)])
        }
        K::FresnelConductor => {
            let (cos, eta, k) = (r.real(), r.real(), r.real());
            let value = conductor(cos, eta, k, 0.0);
            // Where a metal is nearly none, its critical angle amplifies roundings.
            let moved = [-U, U].map(|off| (conductor(cos, eta, k, off) - value).abs());
            Answer::Is(vec![Expect::Scaled(value, 1.0 + moved[0].max(moved[1]) / U)])
        }
        _ => Answer::Undecided,
    }
}
