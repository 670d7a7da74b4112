//! The phase function of Henyey and Greenstein (1941): p = (1 - g^2) / (4 pi (1 + g^2 - 2 g cos)^(3/2)) \[1/sr\].
//!
//! `cos` is the cosine between the directions of travel before and after; g > 0 scatters forward, and g is the mean cosine. It is normalised over the sphere, and what
//! [`sample`] draws has just this density, so that a scattering multiplies what a path carries by 1.

use crate::math::{self, PI, TAU, Vec3};

/// p \[1/sr\], also the density of [`sample`] per solid angle. `wo` and `wi` are unit vectors away from the vertex.
///
/// The denominator is written as (1 - |g|)^2 + 2 |g| (1 -+ cos): sums of what is not negative, exact in the peak.
#[inline(always)]
pub fn eval(g: f32, wo: Vec3, wi: Vec3) -> f32 {
    // 1 - cos for g > 0 and 1 + cos for g < 0, from the sum or difference of unit vectors: without cancellation where they nearly agree.
    let turned = if g < 0.0 { wi - wo } else { wi + wo };
    let versine = 0.5 * turned.dot(turned);
    let (a, rest) = (math::abs(g), 1.0 - math::abs(g));
    let d = rest * rest + 2.0 * a * versine;
    (1.0 - a) * (1.0 + a) / (4.0 * PI * d * math::sqrt(d))
}

/// A unit direction `wi` for light that came from `wo` (both away from the vertex); u in [0, 1).
///
/// With x = 2 u - 1 the inverse of the distribution gives 1 - cos = 2 (1 - u) (1 - g)^2 (1 + g u) / (1 + g x)^2 and 1 + cos = 2 u (1 + g)^2 (1 - g (1 - u)) / (1 + g x)^2:
/// no division by g, and no cancellation at either pole.
#[inline(always)]
pub fn sample(g: f32, wo: Vec3, u: [f32; 2]) -> Vec3 {
    let (u, turn) = (u[0], u[1]);
    let rest = 1.0 - u;
    let d = (1.0 - g) + 2.0 * g * u;
    let scale = 2.0 / (d * d);
    let below = scale * rest * (1.0 - g) * (1.0 - g) * (1.0 + g * u);
    let above = scale * u * (1.0 + g) * (1.0 + g) * (1.0 - g * rest);
    // From the smaller one alone, so that the direction is of unit length whatever rounding did.
    let near = if below < above { below } else { above };
    let cos = if below < above { 1.0 - near } else { near - 1.0 };
    let sin = math::sqrt_clamped(near * (2.0 - near));
    let (y, x) = math::sin_cos(TAU * turn);
    let along = -wo;
    let (t, b) = math::orthonormal_basis(along);
    t * (sin * x) + b * (sin * y) + along * cos
}

#[cfg(test)]
mod tests {
    #![allow(clippy::disallowed_methods, reason = "truth in f64")]

    use super::*;
    use crate::sampling::counter::Counter;

    const GS: [f32; 11] = [-0.99, -0.9, -0.5, -1e-3, -1e-8, 0.0, 1e-12, 1e-3, 0.3, 0.9, 0.9999];

    fn truth(g: f64, cos: f64) -> f64 {
        (1.0 - g * g) / (4.0 * std::f64::consts::PI * (1.0 + g * g - 2.0 * g * cos).powf(1.5))
    }

    fn at(cos: f64) -> Vec3 {
        Vec3::new((1.0 - cos * cos).max(0.0).sqrt() as f32, 0.0, cos as f32)
    }

    #[test]
    fn values_are_those_of_the_formula() {
        for g in GS {
            for k in 0..=200 {
                let cos = -1.0 + f64::from(k) / 100.0;
                let found = f64::from(eval(g, -Vec3::Z, at(cos)));
                // Rounding of the directions moves the cosine by 1e-7.
                let slack = [-2e-7, 2e-7].map(|d| truth(f64::from(g), (cos + d).clamp(-1.0, 1.0)));
                let (lo, hi) = (slack[0].min(slack[1]), slack[0].max(slack[1]));
                assert!(
                    found >= lo * (1.0 - 2e-6) && found <= hi * (1.0 + 2e-6),
                    "{g} {cos}: {found} not in {lo}..{hi}"
                );
            }
        }
    }

    #[test]
    fn the_mean_cosine_is_g_and_the_distribution_is_inverted() {
        let numbers = Counter::new(3);
        let wo = math::normalize_or(Vec3::new(0.3, -0.5, 0.8), Vec3::Z);
        for g in GS {
            let (n, mut sum) = (20_000, 0.0);
            for i in 0..n {
                let u = (f64::from(i) + 0.5) / f64::from(n);
                let wi = sample(g, wo, [u as f32, numbers.unit(1, i, 0)]);
                assert!((wi.length() - 1.0).abs() < 3e-7, "{g} {u}");
                let cos = -f64::from(wi.dot(wo));
                sum += cos;
                // The share of directions with a smaller cosine, by its closed form in f64. In a peak the angle is known better than its cosine.
                let (g, u) = (f64::from(g), f64::from(u as f32));
                let apart = if g < 0.0 { wi - wo } else { wi + wo };
                let versine = 0.5 * apart.to_array().iter().map(|x| f64::from(*x).powi(2)).sum::<f64>();
                let d = ((1.0 - g.abs()).powi(2) + 2.0 * g.abs() * versine).sqrt();
                let share = if g.abs() < 1e-6 {
                    0.5 * (1.0 + cos)
                } else {
                    (1.0 - g * g) / (2.0 * g) * (1.0 / d - 1.0 / (1.0 + g))
                };
                let slack = if g.abs() < 0.99 { 1e-5 } else { 2e-3 };
                assert!((share - u).abs() < slack, "{g} {u}: {share}");
            }
            let mean = sum / f64::from(n);
            assert!((mean - f64::from(g)).abs() < 2e-4, "{g}: {mean}");
        }
    }
}
