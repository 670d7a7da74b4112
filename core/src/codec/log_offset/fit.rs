//! The range of a set of numbers, and the width that fits it.

use super::{LogOffset, LogOffsetError, MAX_WIDTH, MIN_WIDTH};
use alloc::vec;

/// Where the positive numbers of a matrix lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// The least positive number; infinity if there is none.
    pub min: f32,
    /// The largest number; 0 if none is positive.
    pub max: f32,
}

impl Span {
    /// The span of no numbers.
    pub const EMPTY: Self = Self { min: f32::INFINITY, max: 0.0 };

    /// The span of `values`. Zeros and negative numbers do not count.
    ///
    /// # Errors
    /// [`LogOffsetError::Value`] for NaN and infinity.
    pub fn of(values: &[f32]) -> Result<Self, LogOffsetError> {
        let mut span = Self::EMPTY;
        for (index, &value) in values.iter().enumerate() {
            if !value.is_finite() {
                return Err(LogOffsetError::Value { index, value });
            }
            if value > 0.0 {
                span = span.merged(Self { min: value, max: value });
            }
        }
        Ok(span)
    }

    /// The span of both.
    #[must_use]
    pub fn merged(self, other: Self) -> Self {
        Self {
            min: if other.min < self.min { other.min } else { self.min },
            max: if other.max > self.max { other.max } else { self.max },
        }
    }
}

/// The part of `values` that matters: without the least ones, whose sum is at most `share` of the sum of all positive
/// ones. `min` is then the least float of a run of 2^16 that share their upper bits (128 to the octave), or the least value.
///
/// # Errors
/// [`LogOffsetError::Value`] for NaN and infinity.
fn span_losing(values: &[f32], share: f32) -> Result<Span, LogOffsetError> {
    let span = Span::of(values)?;
    // One sum per run, each in the order of the values; f64 loses nothing that matters to the choice of a run.
    let mut sums = vec![0.0_f64; 1 << 15];
    for value in values.iter().filter(|v| **v > 0.0) {
        sums[(value.to_bits() >> 16) as usize] += f64::from(*value);
    }
    let budget = f64::from(share) * sums.iter().sum::<f64>();
    let mut lost = 0.0_f64;
    let mut min = span.min;
    for (run, sum) in sums.iter().enumerate() {
        lost += sum;
        if lost > budget {
            let start = f32::from_bits((run as u32) << 16);
            min = if start > span.min { start } else { span.min };
            break;
        }
    }
    Ok(Span { min, max: span.max })
}

impl LogOffset {
    /// The narrowest map that loses nothing: the least positive one of `values` still has a code of its own cell.
    ///
    /// Zeros and negative numbers do not count. Numbers below 2^-125 and below `max` e^-[`MAX_WIDTH`] are not kept. Where
    /// nothing is positive, `max` is 0.
    ///
    /// # Errors
    /// [`LogOffsetError::Value`] for NaN and infinity; [`LogOffsetError::TooSmall`] where all is below about 2^-125.
    pub fn fitted(values: &[f32]) -> Result<Self, LogOffsetError> {
        Self::fitted_to(Span::of(values)?)
    }

    /// The narrowest map that loses at most `share` of the sum of the positive `values` to code 0.
    ///
    /// A few very small entries widen the steps of all others; what they add to a row is often less than the steps' own
    /// error. `share` <= 0 (and NaN) loses nothing, as [`LogOffset::fitted`].
    ///
    /// # Errors
    /// As for [`LogOffset::fitted`].
    pub fn fitted_losing(values: &[f32], share: f32) -> Result<Self, LogOffsetError> {
        Self::fitted_to(if share > 0.0 { span_losing(values, share)? } else { Span::of(values)? })
    }

    /// The narrowest map (of a width from [`MIN_WIDTH`] to [`MAX_WIDTH`]) for which `span.min` is not code 0: `ln(max / min) 510 / 509`.
    ///
    /// A `min` below 2^-125 counts as 2^-125, one above `max` as `max`; a NaN `min` too.
    ///
    /// # Errors
    /// As for [`LogOffset::try_new`].
    pub fn fitted_to(span: Span) -> Result<Self, LogOffsetError> {
        let Span { min, max } = span;
        let min = if min < max { min } else { max };
        let min = if min < 2.0 * f32::MIN_POSITIVE { 2.0 * f32::MIN_POSITIVE } else { min };
        let exact = libm::log(f64::from(max) / f64::from(min)) * (510.0 / 509.0);
        let mut width = if exact > f64::from(MIN_WIDTH) { exact as f32 } else { MIN_WIDTH };
        if width > MAX_WIDTH {
            width = MAX_WIDTH;
        }
        // The rounded width may be a few floats short.
        loop {
            let this = Self::try_new(width, max)?;
            if this.thresholds[0] <= min || max < min || width >= MAX_WIDTH {
                return Ok(this);
            }
            width = width.next_up();
        }
    }
}
