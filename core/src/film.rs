//! The film: exact, order-free sums of block means, per element (pixel or probe) and channel.
//!
//! Samples come in blocks; what is kept is the sum and the sum of squares of the block means, as 128-bit integers
//! against a recorded power-of-two unit. Integer addition is associative: any order of blocks, any split over
//! threads or machines and any merge gives the same bits. Saturated sums and non-finite block means are counted,
//! never silent.
//!
//! Quantity: whatever the job measures per element, radiance \[W m^-2 sr^-1\] or irradiance \[W/m^2\].

use alloc::vec::Vec;
use core::fmt;
use core::ops::Range;

/// Fractional bits of the fixed-point sums below the film's scale.
const FRACTION_BITS: i32 = 80;

/// What must agree for two films to be parts of one result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FilmSettings {
    /// Elements per row: the image's width, or the number of probes.
    pub width: u32,
    /// Rows; 1 for probes.
    pub height: u32,
    /// Seed of all samples.
    pub seed: u64,
    /// Samples per block: a power of two.
    pub block_length: u32,
    /// The unit of the sums is 2^(scale_exponent - 80), of the squares 2^(2 scale_exponent - 80).
    pub scale_exponent: i32,
}

/// Why films do not fit together.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FilmError {
    /// The two films were made with different settings.
    DifferentSettings {
        /// Of the film that was to grow.
        ours: FilmSettings,
        /// Of the film that was to be added.
        theirs: FilmSettings,
    },
    /// The blocks are in the film already.
    Overlap {
        /// First block of the overlapping range.
        start: u32,
        /// One past its last block.
        end: u32,
    },
    /// A block mean was given for an element that does not exist.
    NoSuchElement {
        /// The element.
        element: usize,
        /// The number of elements.
        count: usize,
    },
}

impl fmt::Display for FilmError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::DifferentSettings { ours, theirs } => {
                write!(f, "films of different settings cannot be merged: {ours:?} and {theirs:?}")
            }
            Self::Overlap { start, end } => write!(f, "blocks {start}..{end} are in the film already"),
            Self::NoSuchElement { element, count } => write!(f, "element {element} of a film of {count}"),
        }
    }
}

impl core::error::Error for FilmError {}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Sums {
    sum: [i128; 3],
    squares: [i128; 3],
}

/// Exact sums over blocks of samples.
///
/// Resolution: block means below 2^-80 of the scale count as 0, their squares below 2^-80 of its square; so variances
/// fade out for values 2^-40 times the scale and less.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Film {
    settings: FilmSettings,
    blocks: Vec<Range<u32>>,
    elements: Vec<Sums>,
    saturated: u64,
    invalid: u64,
}

impl Film {
    /// An empty film.
    pub fn new(settings: FilmSettings) -> Self {
        let count = settings.width as usize * settings.height as usize;
        Self {
            settings,
            blocks: Vec::new(),
            elements: alloc::vec![Sums::default(); count],
            saturated: 0,
            invalid: 0,
        }
    }

    /// What this film was made for.
    pub fn settings(&self) -> &FilmSettings {
        &self.settings
    }

    /// Whether it was made for these.
    ///
    /// # Errors
    /// [`FilmError::DifferentSettings`].
    pub fn check(&self, expected: &FilmSettings) -> Result<(), FilmError> {
        if self.settings == *expected {
            return Ok(());
        }
        Err(FilmError::DifferentSettings { ours: self.settings, theirs: *expected })
    }

    /// Number of elements.
    pub fn len(&self) -> usize {
        self.elements.len()
    }

    /// The film has no elements.
    pub fn is_empty(&self) -> bool {
        self.elements.is_empty()
    }

    /// Number of blocks in the film.
    pub fn block_count(&self) -> u64 {
        self.blocks.iter().map(|r| u64::from(r.end - r.start)).sum()
    }

    /// The blocks in the film, in order, neighbours joined.
    pub fn blocks(&self) -> &[Range<u32>] {
        &self.blocks
    }

    /// Samples per element.
    pub fn samples(&self) -> u64 {
        self.block_count() * u64::from(self.settings.block_length)
    }

    /// How many additions were clipped at the ends of the 128-bit range.
    pub fn saturated(&self) -> u64 {
        self.saturated
    }

    /// How many block means were NaN or infinite and entered as 0.
    pub fn invalid(&self) -> u64 {
        self.invalid
    }

    /// Adds a range of blocks at once: `means[b * len + i]` is the mean of block `blocks.start + b` at element i.
    ///
    /// # Errors
    /// When a block is in the film already, or the number of means is not blocks x elements.
    pub fn add_blocks(&mut self, blocks: Range<u32>, means: &[[f64; 3]]) -> Result<(), FilmError> {
        let n = self.elements.len();
        let expected = n * (blocks.end.saturating_sub(blocks.start)) as usize;
        if means.len() != expected {
            return Err(FilmError::NoSuchElement { element: means.len(), count: expected });
        }
        self.check_range(&blocks)?;
        for row in means.chunks_exact(n.max(1)) {
            for (element, mean) in self.elements.iter_mut().zip(row) {
                let [s, i] = element.add(mean, self.settings.scale_exponent);
                self.saturated += s;
                self.invalid += i;
            }
        }
        self.insert_range(blocks);
        Ok(())
    }

    /// Adds another film's blocks.
    ///
    /// # Errors
    /// When the settings differ or a block is in both.
    pub fn merge(&mut self, other: &Self) -> Result<(), FilmError> {
        self.check(&other.settings)?;
        for r in &other.blocks {
            self.check_range(r)?;
        }
        for (a, b) in self.elements.iter_mut().zip(&other.elements) {
            for c in 0..3 {
                self.saturated += add_saturating(&mut a.sum[c], b.sum[c]);
                self.saturated += add_saturating(&mut a.squares[c], b.squares[c]);
            }
        }
        self.saturated += other.saturated;
        self.invalid += other.invalid;
        for r in &other.blocks {
            self.insert_range(r.clone());
        }
        Ok(())
    }

    fn check_range(&self, r: &Range<u32>) -> Result<(), FilmError> {
        match self.blocks.iter().find(|b| b.start < r.end && r.start < b.end) {
            Some(b) => Err(FilmError::Overlap { start: b.start.max(r.start), end: b.end.min(r.end) }),
            None => Ok(()),
        }
    }

    fn insert_range(&mut self, r: Range<u32>) {
        if r.is_empty() {
            return;
        }
        let at = self.blocks.partition_point(|b| b.start < r.start);
        self.blocks.insert(at, r);
        let mut joined: Vec<Range<u32>> = Vec::with_capacity(self.blocks.len());
        for b in self.blocks.drain(..) {
            match joined.last_mut() {
                Some(last) if last.end == b.start => last.end = b.end,
                _ => joined.push(b),
            }
        }
        self.blocks = joined;
    }

    /// Mean over all blocks at one element; zero for an empty film.
    pub fn mean(&self, element: usize) -> [f64; 3] {
        let n = self.block_count() as f64;
        let unit = power_of_two(self.settings.scale_exponent - FRACTION_BITS);
        match self.elements.get(element) {
            Some(e) if n > 0.0 => e.sum.map(|s| s as f64 * unit / n),
            _ => [0.0; 3],
        }
    }

    /// Variance of the mean at one element, from its own blocks (unbiased); `None` below two blocks.
    pub fn variance(&self, element: usize) -> Option<[f64; 3]> {
        let n = self.block_count() as f64;
        if n < 2.0 {
            return None;
        }
        let e = self.elements.get(element)?;
        let mean = self.mean(element);
        let unit = power_of_two(2 * self.settings.scale_exponent - FRACTION_BITS);
        let mut out = [0.0; 3];
        for c in 0..3 {
            let square = e.squares[c] as f64 * unit / n;
            out[c] = ((square - mean[c] * mean[c]) / (n - 1.0)).max(0.0);
        }
        Some(out)
    }

    /// Standard error of the mean at one element; `None` below two blocks.
    pub fn standard_error(&self, element: usize) -> Option<[f64; 3]> {
        Some(self.variance(element)?.map(libm::sqrt))
    }
}

impl Sums {
    /// Adds one block mean; returns how many sums saturated and how many channels were not finite.
    #[inline]
    fn add(&mut self, mean: &[f64; 3], exponent: i32) -> [u64; 2] {
        let (mut saturated, mut invalid) = (0, 0);
        let to_sum = power_of_two(FRACTION_BITS - exponent);
        let to_square = power_of_two(FRACTION_BITS - 2 * exponent);
        for ((&m, sum), squares) in mean.iter().zip(&mut self.sum).zip(&mut self.squares) {
            if !m.is_finite() {
                invalid += 1;
                continue;
            }
            saturated += add_saturating(sum, to_fixed(m * to_sum, &mut saturated));
            saturated += add_saturating(squares, to_fixed(m * m * to_square, &mut saturated));
        }
        [saturated, invalid]
    }
}

/// Truncates to an integer; what does not fit is clipped and counted.
#[inline]
fn to_fixed(x: f64, saturated: &mut u64) -> i128 {
    // 2^126 leaves room for one addition of two clipped values.
    const LIMIT: f64 = 8.507_059_173_023_462e37;
    if x.abs() < LIMIT {
        x as i128
    } else {
        *saturated += 1;
        if x > 0.0 { LIMIT as i128 } else { -(LIMIT as i128) }
    }
}

#[inline]
fn add_saturating(to: &mut i128, x: i128) -> u64 {
    let (sum, overflow) = to.overflowing_add(x);
    *to = if overflow { to.saturating_add(x) } else { sum };
    u64::from(overflow)
}

/// 2^n as f64, exactly, for |n| <= 1022; clamped beyond.
#[inline]
pub(crate) fn power_of_two(n: i32) -> f64 {
    f64::from_bits(((n.clamp(-1022, 1023) + 1023) as u64) << 52)
}

/// The scale of a film for quantities of the size of `largest` (> 0): the exponent of the next power of two.
/// Zero, NaN and infinity give 0.
pub fn scale_exponent(largest: f32) -> i32 {
    if !(largest > 0.0 && largest.is_finite()) {
        return 0;
    }
    let bits = f64::from(largest).to_bits();
    ((bits >> 52) as i32 & 0x7ff) - 1022
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings() -> FilmSettings {
        FilmSettings { width: 3, height: 2, seed: 7, block_length: 16, scale_exponent: 4 }
    }

    fn mean(block: u32, element: usize) -> [f64; 3] {
        let x = f64::from(block * 37 % 11) + element as f64;
        [x, x * 1e-9, x * 1e5]
    }

    fn film(blocks: Range<u32>) -> Film {
        let mut film = Film::new(settings());
        let means: Vec<_> = blocks.clone().flat_map(|b| (0..6).map(move |i| mean(b, i))).collect();
        film.add_blocks(blocks, &means).unwrap();
        film
    }

    #[test]
    fn parts_merge_to_the_whole_in_either_order() {
        let whole = film(0..8);
        let (a, b) = (film(0..4), film(4..8));
        let mut ab = a.clone();
        ab.merge(&b).unwrap();
        let mut ba = b.clone();
        ba.merge(&a).unwrap();
        assert_eq!(ab, whole);
        assert_eq!(ba, whole);
        assert_eq!(whole.blocks(), core::slice::from_ref(&(0..8)));
    }

    #[test]
    fn overlapping_and_foreign_films_are_refused() {
        let mut a = film(0..4);
        assert_eq!(a.merge(&film(3..5)), Err(FilmError::Overlap { start: 3, end: 4 }));
        let other = Film::new(FilmSettings { seed: 8, ..settings() });
        assert!(matches!(a.merge(&other), Err(FilmError::DifferentSettings { .. })));
        assert!(a.add_blocks(9..10, &[[0.0; 3]; 5]).is_err());
        assert_eq!(a, film(0..4), "a refused merge changes nothing");
    }

    #[test]
    fn mean_and_variance_match_their_definitions() {
        let f = film(0..8);
        for element in 0..6 {
            for c in 0..3 {
                let x: Vec<f64> = (0..8).map(|b| mean(b, element)[c]).collect();
                let m = x.iter().sum::<f64>() / 8.0;
                let v = x.iter().map(|x| (x - m) * (x - m)).sum::<f64>() / (8.0 * 7.0);
                assert!((f.mean(element)[c] - m).abs() <= 1e-12 * m.abs() + 1e-19);
                let got = f.variance(element).unwrap()[c];
                // Squares are cut to the unit 2^(2 * 4 - 80), once per block; the mean of squares then has up to one.
                let unit = power_of_two(2 * 4 - 80) / 7.0;
                assert!((got - v).abs() <= 1e-9 * v + 1e-15 * m * m + unit, "{got} against {v}");
            }
        }
        assert!(film(0..1).variance(0).is_none());
        assert_eq!(film(0..0).mean(0), [0.0; 3]);
    }

    #[test]
    fn saturation_and_bad_numbers_are_counted() {
        let mut f = Film::new(FilmSettings { width: 1, height: 1, ..settings() });
        f.add_blocks(0..1, &[[f64::NAN, 1e300, -1e300]]).unwrap();
        assert_eq!(f.invalid(), 1);
        assert_eq!(f.saturated(), 4);
        assert!(f.mean(0).iter().all(|x| x.is_finite()));
    }

    #[test]
    fn scales_are_powers_of_two_above_the_value() {
        for (x, e) in [(1.0, 1), (0.99, 0), (17.0, 5), (1e-3, -9), (0.0, 0), (f32::INFINITY, 0)] {
            assert_eq!(scale_exponent(x), e, "{x}");
        }
    }
}
