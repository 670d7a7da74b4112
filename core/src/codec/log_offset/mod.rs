//! Log/offset quantisation: numbers in (0, max] as 8-bit codes of their logarithm.
//!
//! The published map: x / max in (0, 1], its natural logarithm in \[-width, 0\], plus `width`, scaled to 0..=255 and
//! rounded, `code = round(255 (1 + ln(x / max) / width))`, with `width` = 25 in the source. Code 255 is exactly `max`;
//! code 0 is exactly zero and takes all below `max e^(-width + width/510)`. A step multiplies by `e^(width/255)`;
//! h = `width / 510` is half of it in the logarithm.
//!
//! # Exact codes
//!
//! Codes are found by comparison with 255 thresholds that are made once on the host: threshold i is the least f32 not
//! below the number at level i + 1/2. No f32 lies on such a boundary itself (e to a rational power other than 0 is
//! irrational), so that the codes are those of the formula in exact arithmetic, on every backend. Three forms give the
//! same codes: a count over all thresholds ([`count_in`], which defines them), a binary search of 8 steps ([`search_in`],
//! the reference) and one look into a table of buckets ([`Quantiser::encode`], which the loops over slices use).
//! The formula in f32 ([`ByFormula`]) gives another code for 5 of a million floats (1520 of the 302 million of width 25).
//!
//! # Decoding
//!
//! By a table of 256 numbers, each rounded once ([`Decoding`]). The plain decode is the middle m of the cell
//! \[m e^-h, m e^h\] in the logarithm: within h of x in the logarithm, e^h - 1 in relative terms, exact for x = `max`.
//! What it does to sums depends on how the numbers are spread over a cell:
//!
//! - Density proportional to 1/x (as many numbers in each part of the logarithm): the mean of the cell is m sinh(h)/h and
//!   the plain decode too low. The mean-preserving decode multiplies by sinh(h)/h. Of the cell of code 255 only the lower
//!   half exists; its mean is max (1 - e^-h)/h. Code 0 stays zero, the limit of the mean over \[a, b\] as a goes to 0.
//! - Density proportional to 1/x^2 (as much of the *sum* in each part of the logarithm): the mean is m h/sinh(h) and the
//!   plain decode too high. It is so where most of a sum comes from, for there its share per unit of the logarithm has
//!   its peak and changes little over a cell. And it is so for any fixed number on average over where the cells happen
//!   to lie: decoded over true is e^t, t even in \[-h, h\], with the mean sinh(h)/h. The energy-preserving decode
//!   divides by that. Code 255 stays `max`, which is itself one of the numbers.
//! - The measured decode gives each code the mean of the very numbers that have it: their sum is kept exactly (to
//!   rounding), and no other decode of these codes has a smaller sum of squared errors. It costs nothing more once its
//!   table is made. Use it where the matrix is at hand.
//!
//! Measured on the form factors of an empty box (384 patches, width 25, sinh(h)/h - 1 = 4.0e-4), the bias of the sum
//! averaged over where the cells lie: plain +3.9e-4, mean-preserving +7.9e-4, energy-preserving -0.06e-4. For one position
//! of the cells it is larger (plain 1e-3), as the large entries of a regular mesh take few values; then only the measured
//! decode is right (1e-8).
//!
//! # Which width
//!
//! The error of an entry is even in the logarithm: `width / (510 sqrt 3)` root mean square, 2.8 % for 25, 1.3 % for 11.5.
//! What lies more than the width below the largest number is lost. [`LogOffset::fitted`] takes the width from the numbers:
//! it loses nothing and is not coarser than that needs. [`LogOffset::fitted_losing`] gives up the least entries for finer
//! steps; what is lost is lost from every sum, so keep the share below the error that a sum may have.
//!
//! The box with 1536 patches, relative error of the irradiance over lit faces and single lit patches: published 2.1 %;
//! all entries kept (14.0) 1.2 %; 1e-4 of the sum lost (10.1) and decode measured 0.84 %; best at a width of 9, 0.73 %; at 8 it is
//! 1.7 %, all of it loss. Use the published width to compare with the source, and where matrices must share one table.
//!
//! Sources: the quantisation stage of a thesis on compressed radiosity matrices (25-wide natural logarithm, 8 bits per
//! channel); conditional means as decoded values: J. Max, "Quantizing for minimum distortion", 1960; S. P. Lloyd, "Least
//! squares quantization in PCM", 1982.

mod buckets;
mod double;
mod fit;
mod formula;

use buckets::Buckets;
use core::fmt;
use double::{Double, exp_negative, mean_exp_negative, mean_exp_symmetric};

pub use fit::Span;
pub use formula::{ByFormula, mean_at, value_at};

/// The width of the published map, in units of the natural logarithm.
pub const PUBLISHED_WIDTH: f32 = 25.0;
/// The narrowest width: steps of 2.5e-4, two thousand times the rounding of an f32.
pub const MIN_WIDTH: f32 = 0.0625;
/// The widest: nearly all that lies between the smallest normal f32 and the largest (254 ln 2 = 176.1), and the root of
/// its smallest ratio is still normal.
pub const MAX_WIDTH: f32 = 174.0;

/// Numbers that the loop over a slice takes at once: of 8, 16 and 32 the fastest, portable and with AVX2.
const LANES: usize = 16;

/// Why there is no map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LogOffsetError {
    /// The width is not in [`MIN_WIDTH`]..=[`MAX_WIDTH`].
    Width {
        /// The width.
        width: f32,
    },
    /// The largest number is negative, infinite or not a number.
    Max {
        /// The largest number.
        max: f32,
    },
    /// The lowest threshold would be subnormal, where devices disagree about comparisons.
    TooSmall {
        /// The width.
        width: f32,
        /// The largest number.
        max: f32,
    },
    /// A number that a map is fitted to is infinite or not a number.
    Value {
        /// Its index.
        index: usize,
        /// The number.
        value: f32,
    },
    /// Numbers and codes are not equally many.
    Lengths {
        /// How many numbers.
        values: usize,
        /// How many codes.
        codes: usize,
    },
}

impl fmt::Display for LogOffsetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Width { width } => write!(f, "width {width} is not in {MIN_WIDTH} to {MAX_WIDTH}"),
            Self::Max { max } => write!(f, "the largest number is {max}, not finite and >= 0"),
            Self::TooSmall { width, max } => {
                write!(f, "e^-{width} of the largest number {max} is below the normal floats")
            }
            Self::Value { index, value } => write!(f, "number {index} is {value}, not finite"),
            Self::Lengths { values, codes } => write!(f, "{values} numbers for {codes} codes"),
        }
    }
}

impl core::error::Error for LogOffsetError {}

/// A map between numbers and 8-bit codes. Both ways total: every float has a code, every code a finite number.
pub trait Quantiser {
    /// The code of `x`. Never falls as `x` grows. 0 for NaN and what is not positive; 255 for all above the range, infinity too.
    fn encode(&self, x: f32) -> u8;

    /// The number that a code stands for.
    fn decode(&self, code: u8) -> f32;

    /// [`Quantiser::encode`] of each number.
    ///
    /// # Errors
    /// [`LogOffsetError::Lengths`] unless the slices are equally long; nothing is written then.
    #[inline(always)]
    fn encode_slice(&self, values: &[f32], codes: &mut [u8]) -> Result<(), LogOffsetError> {
        equally_long(values, codes)?;
        for (code, value) in codes.iter_mut().zip(values) {
            *code = self.encode(*value);
        }
        Ok(())
    }

    /// [`Quantiser::decode`] of each code.
    ///
    /// # Errors
    /// As for [`Quantiser::encode_slice`].
    #[inline(always)]
    fn decode_slice(&self, codes: &[u8], values: &mut [f32]) -> Result<(), LogOffsetError> {
        equally_long(values, codes)?;
        for (value, code) in values.iter_mut().zip(codes) {
            *value = self.decode(*code);
        }
        Ok(())
    }
}

fn equally_long(values: &[f32], codes: &[u8]) -> Result<(), LogOffsetError> {
    let (values, codes) = (values.len(), codes.len());
    if values == codes { Ok(()) } else { Err(LogOffsetError::Lengths { values, codes }) }
}

/// What a code decodes to; the module says when each is right. Code 0 is always 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decoding {
    /// The middle of the cell in the logarithm, `max e^(-width (255 - code) / 255)`, correctly rounded; 255 is exactly `max`.
    Plain,
    /// The mean of the cell for an even spread of the logarithm (density 1/x), correctly rounded.
    MeanPreserving,
    /// The mean of the cell for an even spread of the sum over the logarithm (density 1/x^2), correctly rounded; 255 is
    /// exactly `max`.
    EnergyPreserving,
    /// The mean of given numbers.
    Measured,
}

/// The map of a width and a largest number: thresholds to encode by, a table to decode by.
#[derive(Clone, Debug, PartialEq)]
pub struct LogOffset {
    width: f32,
    max: f32,
    decoding: Decoding,
    thresholds: [f32; 255],
    values: [f32; 256],
    buckets: Buckets,
}

/// The conditions on a map's parameters.
fn check(width: f32, max: f32) -> Result<(), LogOffsetError> {
    if !(MIN_WIDTH..=MAX_WIDTH).contains(&width) {
        return Err(LogOffsetError::Width { width });
    }
    // The sign of -0 does not matter.
    if !(0.0..f32::INFINITY).contains(&max) {
        return Err(LogOffsetError::Max { max });
    }
    if max > 0.0 && lowest(width, max).ceiling() < f32::MIN_POSITIVE {
        return Err(LogOffsetError::TooSmall { width, max });
    }
    Ok(())
}

/// e^(-width/510), half a step down.
fn half_step(width: f32) -> Double {
    exp_negative(Double::new(f64::from(width)).over(510.0))
}

/// The boundary between codes 0 and 1, half_step^509 max.
fn lowest(width: f32, max: f32) -> Double {
    let (mut power, mut square) = (Double::new(f64::from(max)), half_step(width));
    for bit in 0..9 {
        if 509 >> bit & 1 == 1 {
            power = power.times(square);
        }
        square = square.times(square);
    }
    power
}

impl LogOffset {
    /// The published map: a width of 25.
    ///
    /// # Errors
    /// As for [`LogOffset::try_new`].
    pub fn published(max: f32) -> Result<Self, LogOffsetError> {
        Self::try_new(PUBLISHED_WIDTH, max)
    }

    /// The map of a width (in units of the natural logarithm) for numbers up to `max`, with the plain decode.
    ///
    /// `max` = 0 is the map of a matrix of zeros: each code decodes to 0 (all numbers below f32::MAX have code 0).
    ///
    /// # Errors
    /// [`LogOffsetError::Width`], [`LogOffsetError::Max`], or [`LogOffsetError::TooSmall`] where `max e^(-width + width/510)` is
    /// below the smallest normal float.
    pub fn try_new(width: f32, max: f32) -> Result<Self, LogOffsetError> {
        check(width, max)?;
        let (mut thresholds, mut values) = ([f32::MAX; 255], [0.0; 256]);
        if max > 0.0 {
            // Powers of half a step, from the top down: even ones are codes, odd ones the boundaries between them.
            let half = half_step(width);
            let mut power = Double::new(f64::from(max));
            for (value, threshold) in values[1..].iter_mut().zip(&mut thresholds).rev() {
                *value = power.nearest();
                power = power.times(half);
                *threshold = power.ceiling();
                power = power.times(half);
            }
        }
        let buckets = Buckets::new(&thresholds);
        Ok(Self { width, max, decoding: Decoding::Plain, thresholds, values, buckets })
    }

    /// The same codes with the mean-preserving decode.
    #[must_use]
    pub fn mean_preserving(self) -> Self {
        let half_width = Double::new(f64::from(self.width)).over(510.0);
        let top = mean_exp_negative(half_width);
        self.centred(Decoding::MeanPreserving, top, mean_exp_symmetric(half_width))
    }

    /// The same codes with the energy-preserving decode.
    #[must_use]
    pub fn energy_preserving(self) -> Self {
        let half_width = Double::new(f64::from(self.width)).over(510.0);
        let inverse = mean_exp_symmetric(half_width).inverse();
        self.centred(Decoding::EnergyPreserving, Double::ONE, inverse)
    }

    /// The middles of the cells times `factor`, and `max` times `top` for code 255.
    fn centred(mut self, decoding: Decoding, top: Double, factor: Double) -> Self {
        self.decoding = decoding;
        if self.max > 0.0 {
            let half = half_step(self.width);
            let mut power = Double::new(f64::from(self.max));
            self.values[255] = power.times(top).nearest();
            for value in self.values[1..255].iter_mut().rev() {
                power = power.times(half).times(half);
                *value = power.times(factor).nearest();
            }
        }
        self
    }

    /// The same codes with a decode that keeps the sum of these `values`, code by code (but for those of code 0).
    ///
    /// Sums in f64 in the order of the slice. Infinite ones and NaN do not count. A code that no value has keeps the number
    /// that it has.
    #[must_use]
    pub fn measured(mut self, values: &[f32]) -> Self {
        self.decoding = Decoding::Measured;
        let mut sums = [(0.0_f64, 0.0_f64); 256];
        for value in values.iter().filter(|v| v.is_finite()) {
            let (sum, count) = &mut sums[usize::from(self.encode(*value))];
            *sum += f64::from(*value);
            *count += 1.0;
        }
        for (value, (sum, count)) in self.values.iter_mut().zip(sums).skip(1) {
            if count > 0.0 && self.max > 0.0 {
                *value = (sum / count) as f32;
            }
        }
        self
    }

    /// The width, in units of the natural logarithm.
    pub const fn width(&self) -> f32 {
        self.width
    }

    /// The largest number.
    pub const fn max(&self) -> f32 {
        self.max
    }

    /// What the codes decode to.
    pub const fn decoding(&self) -> Decoding {
        self.decoding
    }

    /// Threshold i is the least f32 of code i + 1. Never decreasing, positive, normal.
    pub const fn thresholds(&self) -> &[f32; 255] {
        &self.thresholds
    }

    /// The number of each code.
    pub const fn values(&self) -> &[f32; 256] {
        &self.values
    }

    /// [`Quantiser::encode`] by [`search_in`]: the reference that the bucket table is held to.
    pub fn encode_by_search(&self, x: f32) -> u8 {
        search_in(&self.thresholds, x)
    }
}

impl Quantiser for LogOffset {
    #[inline(always)]
    fn encode(&self, x: f32) -> u8 {
        self.buckets.counts(&[x])[0]
    }

    #[inline(always)]
    fn decode(&self, code: u8) -> f32 {
        self.values[usize::from(code)]
    }

    #[inline(always)]
    fn encode_slice(&self, values: &[f32], codes: &mut [u8]) -> Result<(), LogOffsetError> {
        equally_long(values, codes)?;
        let (codes, codes_rest) = codes.as_chunks_mut::<LANES>();
        let (values, values_rest) = values.as_chunks::<LANES>();
        for (codes, values) in codes.iter_mut().zip(values) {
            *codes = self.buckets.counts(values);
        }
        for (code, value) in codes_rest.iter_mut().zip(values_rest) {
            *code = self.encode(*value);
        }
        Ok(())
    }
}

/// How many of the thresholds (never decreasing) are not above `x`, by a binary search of 8 steps without branches. NaN: 0.
#[inline]
#[must_use]
pub fn search_in(thresholds: &[f32; 255], x: f32) -> u8 {
    let mut count = 0;
    let mut step = 128;
    while step > 0 {
        // Not a branch: it would be mispredicted half of the time. The sum of the steps is 255: the index is at most 254.
        let above = x >= thresholds[count + step - 1];
        count = core::hint::select_unpredictable(above, count + step, count);
        step >>= 1;
    }
    count as u8
}

/// The same by looking at all of them, in any order: what a code is.
#[inline]
#[must_use]
pub fn count_in(thresholds: &[f32; 255], x: f32) -> u8 {
    thresholds.iter().map(|t| u8::from(x >= *t)).sum()
}
