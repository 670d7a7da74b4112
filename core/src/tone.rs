//! Tone mapping for display: images are stored linear (EXR); only what a person looks at is mapped.
//!
//! The way of a linear colour `x` (radiance, W m^-2 sr^-1 per channel) to a display value:
//! `e = x * 2^exposure`, then the curve: Reinhard `e / (1 + e)`, gamma `a (e + c)^gamma`, or none; then the
//! encoding. Reinhard and none end in linear light and are encoded with the sRGB transfer function (IEC
//! 61966-2-1). The gamma curve *is* a display encoding (its default is the plain `e^(1/2.2)`), so it is not
//! encoded a second time. [`display`] and [`display_srgb8`] do the whole way.
//!
//! Every function is total: NaN and negative light are black, infinite light is the largest finite number
//! before the curve (and so white after it).

use crate::math;

/// The curve from exposed linear light to display.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum ToneMap {
    /// `x / (1 + x)` per channel: 0 to 0, 1 to 1/2, white only at infinity (Reinhard et al. 2002, eq. 3).
    #[default]
    Reinhard,
    /// `a (x + c)^gamma` per channel, with the numbers of [`ToneSettings`]. Already a display encoding.
    Gamma,
    /// `x`: clipped at 1 by the encoding.
    None,
}

/// What the command's `--tone`, `--exposure`, `--gamma-a`, `--gamma-c` and `--gamma` set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToneSettings {
    /// The curve; default Reinhard.
    pub map: ToneMap,
    /// Stops: light is multiplied by `2^exposure` before the curve. Default 0. NaN counts as 0; clamped to
    /// \[-126, 127\].
    pub exposure: f32,
    /// Factor `a` of the gamma curve, no unit. Default 1.
    pub gamma_a: f32,
    /// Offset `c` of the gamma curve, in exposed units of light. Default 0.
    pub gamma_c: f32,
    /// Exponent of the gamma curve. Default 1/2.2 (the *encoding* exponent, not the display's 2.2).
    pub gamma: f32,
}

impl Default for ToneSettings {
    fn default() -> Self {
        Self { map: ToneMap::Reinhard, exposure: 0.0, gamma_a: 1.0, gamma_c: 0.0, gamma: 1.0 / 2.2 }
    }
}

/// Black for NaN and negative numbers, the largest finite number for infinity, else `x`.
#[expect(clippy::manual_clamp, reason = "clamp keeps a NaN, max drops it")]
fn light(x: f32) -> f32 {
    // f32::max returns the other operand for NaN; -0 becomes +0 by the addition.
    x.max(0.0).min(f32::MAX) + 0.0
}

/// The factor of an exposure in stops: `2^stops`, exact for whole stops, else within 2e-7 relative.
///
/// NaN counts as 0 stops; clamped to \[-126, 127\], so that the factor is a normal number.
pub fn exposure_factor(stops: f32) -> f32 {
    if stops.is_nan() {
        return 1.0;
    }
    let stops = stops.clamp(-126.0, 127.0);
    let whole = stops as i32;
    let rest = stops - whole as f32;
    let power = f32::from_bits(((127 + whole) as u32) << 23);
    if rest == 0.0 { power } else { power * math::exp(rest * core::f32::consts::LN_2) }
}

/// The curve of `settings` applied to a linear colour after exposure; not yet encoded.
///
/// Output: finite and >= 0; at most 1 for Reinhard, not bounded for gamma and none. Reinhard and none give
/// linear light (encode it with [`encode_srgb8`]); gamma gives a display value. A gamma curve that is not a
/// number (0 to a negative power is infinite) follows the module's rule: NaN is black, infinity is
/// `f32::MAX`. A negative `x + c` counts as 0.
pub fn apply(settings: ToneSettings, rgb: [f32; 3]) -> [f32; 3] {
    let factor = exposure_factor(settings.exposure);
    rgb.map(|x| {
        let e = light(light(x) * factor);
        match settings.map {
            ToneMap::Reinhard => e / (1.0 + e),
            ToneMap::Gamma => {
                light(settings.gamma_a * math::pow(light(e + settings.gamma_c), settings.gamma))
            }
            ToneMap::None => e,
        }
    })
}

/// The sRGB transfer function from linear light to a display value, both on \[0, 1\] (input clamped, NaN 0).
///
/// `12.92 x` up to 0.0031308, above `1.055 x^(1/2.4) - 0.055` (IEC 61966-2-1). Absolute error below 5e-7.
pub fn encode_srgb(linear: f32) -> f32 {
    let x = light(linear).min(1.0);
    if x <= 0.003_130_8 { 12.92 * x } else { (1.055 * math::pow(x, 1.0 / 2.4) - 0.055).clamp(0.0, 1.0) }
}

/// A display value on \[0, 1\] (clamped, NaN 0) as a byte: `255 v` rounded to nearest.
pub fn quantise8(value: f32) -> u8 {
    // In range after the clamp, so that the cast truncates a positive number: round half up.
    (light(value).min(1.0) * 255.0 + 0.5) as u8
}

/// Linear light on \[0, 1\] (clamped, NaN 0) as sRGB bytes, as a PNG holds them.
pub fn encode_srgb8(linear: [f32; 3]) -> [u8; 3] {
    linear.map(|x| quantise8(encode_srgb(x)))
}

/// The whole way from linear light to a display value on \[0, 1\]: exposure, curve, encoding.
pub fn display(settings: ToneSettings, rgb: [f32; 3]) -> [f32; 3] {
    let mapped = apply(settings, rgb);
    match settings.map {
        ToneMap::Gamma => mapped.map(|v| v.min(1.0)),
        ToneMap::Reinhard | ToneMap::None => mapped.map(encode_srgb),
    }
}

/// The whole way from linear light to the bytes of a PNG: [`display`], rounded.
pub fn display_srgb8(settings: ToneSettings, rgb: [f32; 3]) -> [u8; 3] {
    display(settings, rgb).map(quantise8)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::disallowed_methods, reason = "truth in f64")]
    use super::*;

    const MAPS: [ToneMap; 3] = [ToneMap::Reinhard, ToneMap::Gamma, ToneMap::None];

    fn with(map: ToneMap) -> ToneSettings {
        ToneSettings { map, ..ToneSettings::default() }
    }

    #[test]
    fn curves_match_their_formulas() {
        let gamma =
            ToneSettings { map: ToneMap::Gamma, exposure: 1.0, gamma_a: 0.8, gamma_c: 0.01, gamma: 0.45 };
        for i in 0..2000 {
            let x = 1e-6 * 1.015_f64.powi(i);
            let xf = x as f32;
            let x = f64::from(xf);
            let reinhard = f64::from(apply(with(ToneMap::Reinhard), [xf; 3])[0]);
            assert!((reinhard - x / (1.0 + x)).abs() <= 2e-7 * x / (1.0 + x), "reinhard at {x}");
            let truth = 0.8 * (2.0 * x + 0.01).powf(0.45);
            let got = f64::from(apply(gamma, [xf; 3])[1]);
            assert!((got - truth).abs() <= 2e-6 * truth, "gamma at {x}: {got} {truth}");
            assert_eq!(apply(with(ToneMap::None), [xf; 3])[2], xf);
        }
    }

    #[test]
    fn exposure_counts_stops() {
        assert_eq!(exposure_factor(0.0), 1.0);
        assert_eq!(exposure_factor(3.0), 8.0);
        assert_eq!(exposure_factor(-3.0), 0.125);
        assert_eq!(exposure_factor(f32::NAN), 1.0);
        assert_eq!(exposure_factor(f32::INFINITY), 2.0_f32.powi(127));
        assert_eq!(exposure_factor(f32::NEG_INFINITY), f32::MIN_POSITIVE);
        for i in -1260..=1270 {
            let stops = i as f32 * 0.1;
            let truth = f64::from(stops).exp2();
            let err = (f64::from(exposure_factor(stops)) - truth).abs() / truth;
            assert!(err <= 2e-7, "{stops}: {err}");
        }
    }

    #[test]
    fn encoding_matches_the_standard_and_inverts_every_byte() {
        for i in 0..=100_000 {
            let x = i as f32 / 100_000.0;
            let v = f64::from(x);
            let truth = if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
            assert!((f64::from(encode_srgb(x)) - truth).abs() <= 5e-7, "{x}");
        }
        for byte in 0..=255_u8 {
            let v = f64::from(byte) / 255.0;
            let linear = if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) };
            assert_eq!(encode_srgb8([linear as f32; 3]), [byte; 3]);
        }
    }

    #[test]
    fn gamma_is_not_encoded_twice() {
        let byte = (255.0 * 0.25_f64.powf(1.0 / 2.2)).round() as u8;
        assert_eq!(display_srgb8(with(ToneMap::Gamma), [0.25; 3]), [byte; 3]);
        assert_eq!(display_srgb8(with(ToneMap::None), [0.25; 3]), encode_srgb8([0.25; 3]));
        assert_eq!(display_srgb8(with(ToneMap::Reinhard), [1.0; 3]), encode_srgb8([0.5; 3]));
    }

    #[test]
    fn total_for_every_input() {
        let hard = [
            f32::NAN,
            -f32::NAN,
            f32::INFINITY,
            f32::NEG_INFINITY,
            -1.0,
            -0.0,
            0.0,
            1e-45,
            f32::MIN_POSITIVE,
            1.0,
            f32::MAX,
            f32::MIN,
        ];
        for map in MAPS {
            for exposure in hard {
                for parameter in hard {
                    for x in hard {
                        let s = ToneSettings {
                            map,
                            exposure,
                            gamma_a: parameter,
                            gamma_c: parameter,
                            gamma: parameter,
                        };
                        for v in apply(s, [x; 3]) {
                            assert!(v.is_finite() && v >= 0.0, "{s:?} {x}: {v}");
                        }
                        for v in display(s, [x; 3]) {
                            assert!((0.0..=1.0).contains(&v), "{s:?} {x}: {v}");
                        }
                    }
                }
            }
            assert_eq!(display_srgb8(with(map), [f32::NAN, -1.0, f32::NEG_INFINITY]), [0; 3]);
            assert_eq!(display_srgb8(with(map), [f32::INFINITY, f32::MAX, 1e30]), [255; 3]);
        }
    }

    #[test]
    fn more_light_is_never_darker() {
        for map in MAPS {
            let mut last = 0;
            for i in 0..4000 {
                let byte = display_srgb8(with(map), [1e-6 * 1.008_f32.powi(i); 3])[0];
                assert!(byte >= last);
                last = byte;
            }
            assert_eq!(last, 255);
        }
    }
}
