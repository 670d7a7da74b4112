//! The error function and its inverse, as the visible slopes of a Gaussian surface need them.

use crate::math;

/// 1 / sqrt(pi).
pub(super) const INV_SQRT_PI: f32 = 0.564_189_6;

/// erf x = 2 / sqrt(pi) Int_0^x exp(-t^2) dt, within 4e-7. Abramowitz and Stegun (1964), 7.1.26.
pub(super) fn erf(x: f32) -> f32 {
    let t = 1.0 / (1.0 + 0.327_591_1 * math::abs(x));
    let mut sum = 0.0;
    for c in [1.061_405_4, -1.453_152, 1.421_413_7, -0.284_496_74, 0.254_829_6] {
        sum = (sum + c) * t;
    }
    math::copysign(1.0 - sum * math::exp(-x * x), x)
}

/// The x of an erf x in (-1, 1), within 4e-6 of it; beyond, that of the nearest such number (about 3.9 in size).
/// M. Giles, "Approximating the erfinv function" (2010), single precision.
pub(super) fn erf_inverse(y: f32) -> f32 {
    let y = math::clamp(y, -math::ONE_MINUS_EPSILON, math::ONE_MINUS_EPSILON);
    let w = -math::ln((1.0 - y) * (1.0 + y));
    let near: [f32; 9] = [
        2.810_226_4e-8,
        3.432_739_4e-7,
        -3.523_387_7e-6,
        -4.391_506_5e-6,
        2.185_808_7e-4,
        -1.253_725_e-3,
        -4.177_681_6e-3,
        0.246_640_73,
        1.501_409_4,
    ];
    let far: [f32; 9] = [
        -2.002_142_6e-4,
        1.009_505_6e-4,
        1.349_343_2e-3,
        -3.673_428_4e-3,
        5.739_507_7e-3,
        -7.622_461_3e-3,
        9.438_870_5e-3,
        1.001_674,
        2.832_976_8,
    ];
    let (w, list) = if w < 5.0 { (w - 2.5, near) } else { (math::sqrt(w) - 3.0, far) };
    let mut sum = 0.0;
    for c in list {
        sum = sum * w + c;
    }
    sum * y
}

#[cfg(test)]
mod tests {
    #![allow(clippy::disallowed_methods, reason = "truth in f64")]

    use super::*;

    /// Taylor's series, in f64.
    fn truth(x: f64) -> f64 {
        let (mut term, mut sum) = (x, x);
        for n in 1..200 {
            term *= -x * x / f64::from(n);
            sum += term / f64::from(2 * n + 1);
        }
        sum * 2.0 / std::f64::consts::PI.sqrt()
    }

    #[test]
    fn values_are_those_of_the_series_and_come_back() {
        for i in -350..=350 {
            let x = i as f32 / 100.0;
            let (found, expected) = (f64::from(erf(x)), truth(f64::from(x)));
            assert!((found - expected).abs() <= 4e-7, "erf {x}: {found} {expected}");
            let y = expected as f32;
            // Near 1 the number itself says little of x.
            let slack = 1.3e-7 / (1.13 * (-f64::from(x) * f64::from(x)).exp());
            let back = f64::from(erf_inverse(y));
            assert!((back - f64::from(x)).abs() <= 4e-6 + slack, "inverse at {x}: {back}");
        }
        assert!(erf(0.0).abs() < 1e-7);
        assert!(erf(50.0) == 1.0 && erf(-f32::INFINITY) == -1.0);
        assert!(erf_inverse(1.0) > 3.8 && erf_inverse(-2.0) < -3.8);
    }
}
