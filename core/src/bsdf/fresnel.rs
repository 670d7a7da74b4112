//! How much a smooth boundary reflects: Fresnel's equations for light without polarisation, and Schlick's fit.
//!
//! `cos` is that of the angle between the normal and the direction from which light is looked at, in \[0, 1\]; `ratio` is the index of refraction beyond the boundary over that before it.

use crate::math::{self, Vec3};

/// Cosine beyond the boundary by Snell's law; `None` where all is reflected.
#[inline(always)]
pub fn refracted_cos(cos: f32, ratio: f32) -> Option<f32> {
    // sin^2 from (1 - cos)(1 + cos): exact at grazing incidence and near the normal.
    let sin2 = (1.0 - cos) * (1.0 + cos) / (ratio * ratio);
    (sin2 < 1.0).then(|| math::sqrt(1.0 - sin2))
}

/// Reflectance of a dielectric boundary in \[0, 1\], the mean of both polarisations; 1 at total reflection. (Fresnel 1823.)
#[inline(always)]
pub fn dielectric(cos: f32, ratio: f32) -> f32 {
    let Some(beyond) = refracted_cos(cos, ratio) else { return 1.0 };
    let senkrecht = (cos - ratio * beyond) / (cos + ratio * beyond);
    let parallel = (ratio * cos - beyond) / (ratio * cos + beyond);
    // Of nothing on both sides at grazing incidence.
    let both = 0.5 * (senkrecht * senkrecht + parallel * parallel);
    if both <= 1.0 { both } else { 1.0 }
}

/// Schlick's fit of the same (1994): R0 + (1 - R0)(1 - c)^5, R0 = ((1 - ratio) / (1 + ratio))^2; into the rarer medium c is the cosine beyond, and 1 is reflected where there
/// is none.
#[inline(always)]
pub fn schlick(cos: f32, ratio: f32) -> f32 {
    let c = if ratio < 1.0 {
        match refracted_cos(cos, ratio) {
            Some(beyond) => beyond,
            None => return 1.0,
        }
    } else {
        cos
    };
    let r = (1.0 - ratio) / (1.0 + ratio);
    let (r0, m) = (r * r, 1.0 - c);
    let m2 = m * m;
    r0 + (1.0 - r0) * (m2 * m2 * m)
}

/// Reflectance of a metal of refractive index eta + i k, relative to what is before it.
#[inline(always)]
pub fn conductor(cos: f32, eta: f32, k: f32) -> f32 {
    let cos2 = cos * cos;
    let sin2 = (1.0 - cos) * (1.0 + cos);
    let difference = (eta - k) * (eta + k) - sin2;
    let product = eta * k;
    let a2_b2 = math::sqrt(difference * difference + 4.0 * product * product);
    // (a2_b2 + difference) / 2, without its cancellation where little is lost in the metal.
    let a2 = if difference < 0.0 {
        2.0 * product * product / (a2_b2 - difference)
    } else {
        0.5 * (a2_b2 + difference)
    };
    let a = math::sqrt_clamped(a2);
    let senkrecht = (a2_b2 + cos2 - 2.0 * a * cos) / (a2_b2 + cos2 + 2.0 * a * cos);
    let (s, t) = (cos2 * a2_b2 + sin2 * sin2, 2.0 * a * cos * sin2);
    let parallel = senkrecht * (s - t) / (s + t);
    let both = 0.5 * (senkrecht + parallel);
    if both <= 1.0 { both.max(0.0) } else { 1.0 }
}

/// [`conductor`] per channel.
#[inline(always)]
pub fn conductor_rgb(cos: f32, eta: Vec3, k: Vec3) -> Vec3 {
    Vec3::new(conductor(cos, eta.x, k.x), conductor(cos, eta.y, k.y), conductor(cos, eta.z, k.z))
}

/// Direction refracted at a boundary with normal `n` on the side of `wo` (both unit, away from the surface); `None` at total reflection.
#[inline(always)]
pub fn refract(n: Vec3, wo: Vec3, ratio: f32) -> Option<Vec3> {
    let cos = wo.dot(n).clamp(0.0, 1.0);
    let beyond = refracted_cos(cos, ratio)?;
    Some(math::normalize_or((n * cos - wo) / ratio - n * beyond, -n))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::disallowed_methods, reason = "truth in f64")]

    use super::*;

    /// Fresnel's equations in f64, angles first.
    fn truth(theta: f64, ratio: f64) -> f64 {
        let sin = theta.sin() / ratio;
        if sin >= 1.0 {
            return 1.0;
        }
        let beyond = sin.asin();
        if theta == 0.0 {
            return ((1.0 - ratio) / (1.0 + ratio)).powi(2);
        }
        let s = (theta - beyond).sin() / (theta + beyond).sin();
        let p = (theta - beyond).tan() / (theta + beyond).tan();
        0.5 * (s * s + p * p)
    }

    #[test]
    fn reflectances_are_those_of_fresnels_equations() {
        for ratio in [1.5, 1.0 / 1.5, 1.33, 1.0 / 1.33, 2.42, 1.001] {
            for k in 0..900 {
                let theta = (f64::from(k) / 10.0).to_radians();
                let cos = theta.cos() as f32;
                let found = f64::from(dielectric(cos, ratio as f32));
                let around = [-1e-6, 0.0, 1e-6].map(|d| {
                    truth(
                        (f64::from(cos).acos() + d).clamp(0.0, std::f64::consts::FRAC_PI_2 - 1e-9),
                        f64::from(ratio as f32),
                    )
                });
                let lo = around.iter().fold(1.0_f64, |a, b| a.min(*b));
                let hi = around.iter().fold(0.0_f64, |a, b| a.max(*b));
                assert!(found > lo - 2e-6 && found < hi + 2e-6, "{ratio} {k}: {found} {lo} {hi}");
            }
        }
    }

    #[test]
    fn tabulated_reflectances_are_found() {
        // n, degrees, R of a dielectric; then a metal like copper.
        for (n, degrees, r) in [
            (1.5, 0.0, 0.04),
            (1.5, 30.0, 0.041_522_625_98),
            (1.5, 45.0, 0.050_239_911_01),
            (1.33, 0.0, 0.020_059_312_2),
        ] {
            let cos = f64::to_radians(degrees).cos() as f32;
            assert!((f64::from(dielectric(cos, n)) - r).abs() < 1e-6, "{n} {degrees}");
        }
        for (degrees, r) in [(0.0, 0.918_435_163_5), (45.0, 0.915_801_058_6), (75.0, 0.912_312_007_1)] {
            let cos = f64::to_radians(degrees).cos() as f32;
            assert!((f64::from(conductor(cos, 0.27, 3.41)) - r).abs() < 1e-6, "{degrees}");
        }
    }

    #[test]
    fn mean_reflectances_are_their_closed_form() {
        // Of diffuse light from outside and from inside, 2 Int R cos d(cos), for n = 1.5 and 1.33.
        for (n, outside, inside) in
            [(1.5_f32, 0.091_777_959_3, 0.596_345_759_7), (1.33, 0.065_930_849_3, 0.471_949_148_8)]
        {
            for (ratio, expected) in [(n, outside), (1.0 / n, inside)] {
                let steps = 200_000;
                let sum: f64 = (0..steps)
                    .map(|i| {
                        let cos = (f64::from(i) + 0.5) / f64::from(steps);
                        2.0 * cos * f64::from(dielectric(cos as f32, ratio)) / f64::from(steps)
                    })
                    .sum();
                assert!((sum - expected).abs() < 1e-5, "{ratio}: {sum}");
            }
        }
    }

    #[test]
    fn schlick_is_near_and_reflects_all_where_all_is_reflected() {
        for cos in [0.01_f32, 0.3, 0.7, 1.0] {
            assert!((schlick(cos, 1.5) - dielectric(cos, 1.5)).abs() < 0.04, "{cos}");
        }
        assert_eq!(schlick(0.5, 1.0 / 1.5), 1.0);
        assert!((schlick(1.0, 1.0 / 1.5) - 0.04).abs() < 1e-7);
        // The same boundary from both sides: the cosine of the rarer medium counts.
        let beyond = refracted_cos(0.6, 1.5).unwrap();
        assert!((schlick(0.6, 1.5) - schlick(beyond, 1.0 / 1.5)).abs() < 1e-6);
    }

    #[test]
    fn refraction_keeps_the_tangential_part() {
        for ratio in [1.5, 0.8, 1.0 / 1.5] {
            for k in 0..50 {
                let angle = 0.031 * k as f32;
                let (n, wo) = (Vec3::Z, Vec3::new(angle.sin(), 0.0, angle.cos()));
                let Some(wi) = refract(n, wo, ratio) else {
                    assert!(angle.sin() / ratio > 0.999_999);
                    continue;
                };
                assert!((wi.x * ratio + wo.x).abs() < 1e-6 && wi.z < 0.0 && (wi.length() - 1.0).abs() < 1e-6);
            }
        }
    }
}
