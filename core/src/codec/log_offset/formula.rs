//! The published map, evaluated as it is written.

use super::{LogOffsetError, Quantiser, check};
use crate::math;

/// The published formula in f32, with this library's own logarithm and exponential.
///
/// Kept to compare with: near the ends of a cell its rounded logarithm picks the neighbouring code, another one on each
/// machine whose logarithm rounds differently. [`super::LogOffset`] does not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ByFormula {
    width: f32,
    max: f32,
}

impl ByFormula {
    /// The map of `width` for numbers up to `max`; arguments as for [`super::LogOffset::try_new`].
    ///
    /// # Errors
    /// As for [`super::LogOffset::try_new`].
    pub fn try_new(width: f32, max: f32) -> Result<Self, LogOffsetError> {
        check(width, max)?;
        Ok(Self { width, max })
    }

    /// The level of `x` before rounding, `(ln(x / max) + width) 255 / width`, cut to [0, 255]; 0 for NaN and what is not
    /// positive.
    #[inline]
    pub fn level(&self, x: f32) -> f32 {
        if x > 0.0 && self.max > 0.0 {
            let ratio = x / self.max;
            // A quotient that loses digits, or all of them, is taken in the logarithm.
            let log =
                if ratio >= f32::MIN_POSITIVE { math::ln(ratio) } else { math::ln(x) - math::ln(self.max) };
            math::clamp((log + self.width) * (255.0 / self.width), 0.0, 255.0)
        } else {
            0.0
        }
    }
}

impl Quantiser for ByFormula {
    #[inline]
    fn encode(&self, x: f32) -> u8 {
        math::round(self.level(x)) as u8
    }

    #[inline]
    fn decode(&self, code: u8) -> f32 {
        value_at(self.width, self.max, f32::from(code))
    }
}

/// The number at a level between two codes too, as an interpolating decoder meets it: `max e^(-width (255 - level) / 255)`.
///
/// A level below 1/2 (and NaN) is exactly 0, as code 0 is; one above 255 counts as 255, which is exactly `max`.
/// Precondition: `width` and `max` as [`super::LogOffset::try_new`] takes them; others give a number that means nothing
/// (finite for finite arguments).
///
/// Relative error below (3 |a| + 3) 2^-24, a the exponent ((3 |a| + 5) 2^-24 where a < -86). The table of
/// [`super::LogOffset`] has the numbers of whole levels correctly rounded.
#[inline]
#[must_use]
pub fn value_at(width: f32, max: f32, level: f32) -> f32 {
    if level >= 0.5 { decayed(max, width, level) } else { 0.0 }
}

/// The mean of the numbers that round to a level, if their logarithms are spread evenly: over the cell from `level - 1/2`
/// to `level + 1/2`, which ends at 255.
///
/// With u the upper end of the cell as a fraction of `max` and d its width in the logarithm: `max u (1 - e^-d) / d`. In
/// mid-range this is [`value_at`] times sinh(h)/h, h = d/2; at level 255 it is `max (1 - e^-h) / h`. A level below 1/2 (and
/// NaN) is exactly 0. Precondition as for [`value_at`], relative error below (3 |a| + 6) 2^-24.
#[inline]
#[must_use]
pub fn mean_at(width: f32, max: f32, level: f32) -> f32 {
    if level >= 0.5 {
        let level = math::min(level, 255.0);
        let upper = math::min(level + 0.5, 255.0);
        // A cell of no valid width is wider than 0.7.
        let d = math::clamp((upper - (level - 0.5)) * (width / 255.0), 0.0, 0.7);
        decayed(max, width, upper) * mean_exp_negative(d)
    } else {
        0.0
    }
}

/// `max e^a`, a = -width (255 - level) / 255.
#[inline(always)]
fn decayed(max: f32, width: f32, level: f32) -> f32 {
    // In this order: the product is exact for widths of few bits, such as 25.
    let a = math::min((level - 255.0) * width / 255.0, 0.0);
    // Below, e^a alone may be subnormal where the product is not: its root is taken twice. No branch, one exponential.
    let twice = a < -86.0;
    let e = math::exp(if twice { 0.5 * a } else { a });
    max * e * if twice { e } else { 1.0 }
}

/// (1 - e^-d) / d on [0, 0.7] by Taylor's series, its rest below 2^-28 (no difference of near numbers is taken).
#[inline(always)]
fn mean_exp_negative(d: f32) -> f32 {
    const INVERSE_FACTORIALS: [f32; 9] = [
        1.0 / 362_880.0,
        1.0 / 40_320.0,
        1.0 / 5_040.0,
        1.0 / 720.0,
        1.0 / 120.0,
        1.0 / 24.0,
        1.0 / 6.0,
        0.5,
        1.0,
    ];
    let mut sum = INVERSE_FACTORIALS[0];
    let mut i = 1;
    while i < 9 {
        sum = INVERSE_FACTORIALS[i] - d * sum;
        i += 1;
    }
    sum
}
