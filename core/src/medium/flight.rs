//! How far light flies in a homogeneous medium, drawn by one channel and weighted for all.
//!
//! Channel c is chosen with probability p_c, in proportion to what the path carries; then t = -ln(1 - u) / sigma_c. The density of t is sum p_c sigma_c exp(-sigma_c t),
//! the chance to get beyond d is sum p_c exp(-sigma_c d): dividing by these instead of by the chosen channel's own is the balance heuristic over channels (Wilkie et al. 2014), and no weight
//! exceeds 1 / p_c of the channel that it is of.

use crate::math::{self, Vec3};

/// A flight that was drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flight {
    /// Its length \[m\]; the distance to the surface where that was reached.
    pub length: f32,
    /// It ends in the medium.
    pub collided: bool,
    /// T / density \[m\] at a collision (scattering multiplies by sigma_s yet), T / chance at a surface; per channel.
    pub weight: Vec3,
    /// T, per channel; what null collisions estimate of it.
    pub left: Vec3,
}

/// T = exp(-sigma_t t) per channel. No extinction leaves all, even of an infinite length.
#[inline(always)]
pub fn transmittance(sigma_t: Vec3, length: f32) -> Vec3 {
    let one = |sigma: f32| if sigma > 0.0 { math::exp(-sigma * length) } else { 1.0 };
    Vec3::new(one(sigma_t.x), one(sigma_t.y), one(sigma_t.z))
}

/// Radiance that a medium sends along a length of ray \[W m^-2 sr^-1\]: emission x (1 - T) / sigma_t, by its series where little is absorbed.
/// On a way without end where nothing is absorbed that has no value: it gives 0.
#[inline(always)]
pub fn emitted(emission: Vec3, sigma_t: Vec3, length: f32) -> Vec3 {
    let one = |j: f32, sigma: f32| {
        let tau = sigma * length;
        if j <= 0.0 || (sigma <= 0.0 && length == f32::INFINITY) {
            0.0
        } else if tau < 0.1 {
            j * length
                * (1.0 - tau * (1.0 / 2.0 - tau * (1.0 / 6.0 - tau * (1.0 / 24.0 - tau * (1.0 / 120.0)))))
        } else {
            j / sigma * (1.0 - math::exp(-tau))
        }
    };
    Vec3::new(one(emission.x, sigma_t.x), one(emission.y, sigma_t.y), one(emission.z, sigma_t.z))
}

/// Probability of each channel: in proportion to what the path carries; alike where it carries nothing.
#[inline(always)]
pub fn channels(carried: Vec3) -> Vec3 {
    let sum = carried.x + carried.y + carried.z;
    if sum > 0.0 && sum < f32::INFINITY { carried / sum } else { Vec3::splat(1.0 / 3.0) }
}

/// T = exp(-sigma_t d) per channel, d the integral of a density \[m\] per channel. No extinction leaves all.
#[inline(always)]
pub(crate) fn transmittance_of(sigma_t: Vec3, optical: Vec3) -> Vec3 {
    let one = |sigma: f32, d: f32| if sigma > 0.0 { math::exp(-sigma * d) } else { 1.0 };
    Vec3::new(one(sigma_t.x, optical.x), one(sigma_t.y, optical.y), one(sigma_t.z, optical.z))
}

/// The channel that a number in [0, 1) picks.
#[inline(always)]
pub(crate) fn pick(p: Vec3, u: f32) -> usize {
    if u < p.x {
        0
    } else if u < p.x + p.y {
        1
    } else {
        2
    }
}

/// Draws a flight of at most `limit` (infinite where there is no surface) for a path that carries `carried`. u in [0, 1): the channel, the length.
#[inline(always)]
pub fn sample(sigma_t: Vec3, carried: Vec3, limit: f32, u: [f32; 2]) -> Flight {
    let p = channels(carried);
    let sigma = sigma_t[pick(p, u[0])];
    let length = if sigma > 0.0 { -math::ln(1.0 - u[1]) / sigma } else { f32::INFINITY };
    let collided = length < limit;
    let length = if collided { length } else { limit };
    let left = transmittance(sigma_t, length);
    let density = if collided { p.dot(sigma_t * left) } else { p.dot(left) };
    let weight = if density > 0.0 { left / density } else { Vec3::ZERO };
    Flight { length, collided, weight, left }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::disallowed_methods, reason = "truth in f64")]

    use super::*;
    use crate::sampling::counter::Counter;

    #[test]
    fn weights_average_to_one_and_to_the_collisions() {
        let numbers = Counter::new(8);
        let n = 200_000;
        for (sigma, carried, limit) in [
            (Vec3::new(0.5, 0.5, 0.5), Vec3::ONE, 2.0),
            (Vec3::new(0.1, 1.0, 6.0), Vec3::new(1.0, 0.2, 3.0), 0.7),
            (Vec3::new(0.0, 1.0, 2.0), Vec3::ONE, 3.0),
            (Vec3::new(0.4, 1.0, 2.0), Vec3::ONE, f32::INFINITY),
            (Vec3::new(0.4, 1.0, 2.0), Vec3::ZERO, 1.0),
        ] {
            let (mut through, mut hit, mut squares) = ([0.0; 3], [0.0; 3], [[0.0; 3]; 2]);
            for i in 0..n {
                let u = [numbers.unit(0, i, 0), numbers.unit(0, i, 1)];
                let f = sample(sigma, carried, limit, u);
                for c in 0..3 {
                    let w = f64::from(f.weight[c]);
                    assert!(w.is_finite() && w >= 0.0);
                    let collision = if f.collided { w * f64::from(sigma[c]) } else { 0.0 };
                    let passed = if f.collided { 0.0 } else { w };
                    squares[0][c] += collision * collision;
                    squares[1][c] += passed * passed;
                    hit[c] += collision;
                    through[c] += passed;
                }
            }
            let n = f64::from(n);
            for c in 0..3 {
                let truth = transmittance(sigma, limit)[c];
                let (through, hit) = (through[c] / n, hit[c] / n);
                let error = [0, 1].map(|k| 5.0 * (squares[k][c] / n / n).sqrt() + 1e-6);
                assert!((hit - (1.0 - f64::from(truth))).abs() < error[0], "{sigma} {c}: {hit}");
                assert!((through - f64::from(truth)).abs() < error[1], "{sigma} {c}: {through}");
            }
        }
    }

    #[test]
    fn grey_media_have_no_weight_of_their_own() {
        for u in [0.0, 0.3, 0.999] {
            let f = sample(Vec3::splat(0.7), Vec3::new(0.2, 0.9, 0.4), 1.5, [u, u]);
            let expected = if f.collided { 1.0 / 0.7 } else { 1.0 };
            assert!((f.weight - Vec3::splat(expected)).abs().max_element() < 1e-6, "{f:?}");
        }
        // Nothing in the way, and nothing to fly through.
        let f = sample(Vec3::ZERO, Vec3::ONE, f32::INFINITY, [0.5, 0.5]);
        assert!(!f.collided && f.weight == Vec3::ONE);
        // So much in the way that nothing is left.
        let f = sample(Vec3::new(0.0, 1e30, 1e30), Vec3::new(0.0, 1.0, 1.0), 1.0, [0.9, 0.5]);
        assert!(f.weight.is_finite());
    }

    #[test]
    fn emission_is_its_integral() {
        for tau in [0.0, 1e-6, 1e-3, 0.05, 0.0999, 0.1001, 1.0, 10.0, 200.0] {
            let found = f64::from(emitted(Vec3::splat(2.0), Vec3::splat(tau / 3.0), 3.0).x);
            let tau = f64::from(tau / 3.0) * 3.0;
            let truth = if tau > 0.0 { 2.0 * 3.0 * -(-tau).exp_m1() / tau } else { 6.0 };
            assert!((found / truth - 1.0).abs() < 1e-6, "{tau}: {found} {truth}");
        }
        assert_eq!(emitted(Vec3::ZERO, Vec3::ZERO, f32::INFINITY), Vec3::ZERO);
        let endless = emitted(Vec3::ONE, Vec3::new(0.0, 0.5, 1e-30), f32::INFINITY);
        assert!(endless.x == 0.0 && endless.y == 2.0 && endless.z > 0.9e30);
    }
}
