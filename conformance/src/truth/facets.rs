//! Microfacets from their definitions, by sines and cosines in f64.

use super::bsdf::to_world;
use super::vec::{self, V};
use super::{Answer, Expect, Words};
use etendue_core::kernel::Kernel;
use std::f64::consts::{PI, TAU};

/// Unit roundoff of f32.
const U: f64 = 1.0 / 16_777_216.0;

struct Facets {
    beckmann: bool,
    alpha: f64,
}

/// Taylor's series below 4; beyond, 1 to 2e-8.
fn erf(x: f64) -> f64 {
    if x > 4.0 {
        return 1.0;
    }
    let (mut term, mut sum) = (x, x);
    for n in 1..120 {
        term *= -x * x / f64::from(n);
        sum += term / f64::from(2 * n + 1);
    }
    sum * 2.0 / PI.sqrt()
}

fn cos_sin(n: V, v: V) -> (f64, f64) {
    let across = vec::cross(n, v);
    (vec::dot(n, v), vec::dot(across, across).sqrt())
}

impl Facets {
    fn density(&self, cos: f64, sin: f64) -> f64 {
        if cos <= 0.0 {
            return 0.0;
        }
        let (a2, t2) = (self.alpha * self.alpha, (sin / cos).powi(2));
        if self.beckmann {
            (-t2 / a2).exp() / (PI * a2 * cos.powi(4))
        } else {
            1.0 / (PI * a2 * cos.powi(4) * (1.0 + t2 / a2).powi(2))
        }
    }

    /// The density, and the scale of what the roundings of sine and cosine do to it.
    fn scaled(&self, n: V, m: V) -> (f64, f64) {
        let (cos, sin) = cos_sin(n, m);
        let value = self.density(cos, sin);
        let moved = [(0.0, U), (0.0, -U), (U, 0.0), (-U, 0.0)]
            .map(|(c, s)| (self.density(cos + c, sin + s) - value).abs() / U);
        // The exponential's own argument, too.
        let own = if self.beckmann { (sin / (cos * self.alpha)).powi(2) } else { 0.0 };
        (value, moved.iter().fold(value * (1.0 + own), |a, b| a + b))
    }

    fn masking(&self, cos: f64, sin: f64) -> f64 {
        let spread = self.alpha * sin;
        if !self.beckmann {
            return 2.0 * cos / (cos + (cos * cos + spread * spread).sqrt());
        }
        let a = cos / spread;
        if a >= 1.6 || spread == 0.0 {
            return 1.0;
        }
        ((3.535 * a + 2.181 * a * a) / (1.0 + 2.276 * a + 2.577 * a * a)).min(1.0)
    }

    /// G1 / cos of the distribution itself.
    fn seen(&self, cos: f64, sin: f64) -> f64 {
        let spread = self.alpha * sin;
        if !self.beckmann {
            return 2.0 / (cos + (cos * cos + spread * spread).sqrt());
        }
        let a = if spread > 0.0 { cos / spread } else { 1e9 };
        2.0 / (cos * (1.0 + erf(a)) + spread * (-a * a).exp() / PI.sqrt())
    }

    fn sample(&self, n: V, wo: V, [u, turn]: [f64; 2]) -> Answer {
        if self.beckmann {
            // Inverted by steps in f32: its distribution is tested elsewhere.
            return Answer::Is(vec![Expect::Finite; 3]);
        }
        let (b, t) = (to_world([0.0, 1.0, 0.0], n), to_world([1.0, 0.0, 0.0], n));
        let local = [vec::dot(wo, t), vec::dot(wo, b), vec::dot(wo, n).max(0.0)];
        let v = vec::unit([self.alpha * local[0], self.alpha * local[1], local[2]]);
        let h = u * (1.0 + v[2]);
        let s = (h * (2.0 - h)).max(0.0).sqrt();
        let m = [s * (TAU * turn).cos() + v[0], s * (TAU * turn).sin() + v[1], (1.0 - u) * (1.0 + v[2])];
        let m = [self.alpha * m[0], self.alpha * m[1], m[2]];
        let length = vec::dot(m, m).sqrt();
        if length < 1e-4 || 2.0 - h < 1e-4 {
            return Answer::Undecided;
        }
        // Directions at grazing angles are stretched together with their roundings.
        let flat = (local[0] * local[0] + local[1] * local[1]).sqrt() * self.alpha + local[2];
        let scale = (1.0 + 1.0 / flat) * (1.0 + 1.0 / length);
        let world = to_world(m.map(|x| x / length), n);
        Answer::Is(world.map(|x| Expect::Scaled(x, scale)).to_vec())
    }
}

pub(super) fn truth(kernel: Kernel, r: &mut Words<'_>) -> Answer {
    use Kernel as K;
    let f = Facets { beckmann: r.word() != 0, alpha: r.real() };
    let n = r.vec3();
    match kernel {
        K::FacetsDensity => {
            let m = r.vec3();
            let (value, scale) = f.scaled(n, m);
            Answer::Is(vec![Expect::Scaled(value, scale + 1e-30)])
        }
        K::FacetsMasking => {
            let (cos, sin) = cos_sin(n, r.vec3());
            let value = f.masking(cos, sin);
            // The rounding of the cosine.
            let step = (f.masking(cos + U, sin) - value).abs() / U;
            Answer::Is(vec![Expect::Scaled(value, 1.0 + step)])
        }
        K::PdfVisible => {
            let (wo, m) = (r.vec3(), r.vec3());
            let (value, scale) = f.scaled(n, m);
            let (cos, sin) = cos_sin(n, wo);
            let (seen, moved) = (f.seen(cos, sin), f.seen(cos + U, sin + U));
            let facing = vec::dot(wo, m).max(0.0);
            let condition = scale * seen + value * (seen + (moved - seen).abs() / U);
            Answer::Is(vec![Expect::Scaled(value * seen * facing, condition + 1e-30)])
        }
        _ => {
            let wo = r.vec3();
            f.sample(n, wo, [r.real(), r.real()])
        }
    }
}
