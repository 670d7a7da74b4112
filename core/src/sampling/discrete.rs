//! Choice among weighted entries by an integer cumulative distribution.
//!
//! The probabilities are whole numbers of counts, `count_i / 2^32`, that sum to exactly 2^32, so that a random word *is* a position in the
//! distribution, every backend picks the same entry, and the probability that divides a sample's weight is the one it was picked with.
//!
//! Storage is a flat run of 32-bit words: word i is the number of counts before entry i (`cumulative[0] == 0`, never decreasing). The end of
//! the last entry, 2^32, is not stored, as it fits no word. So that it can stay implied, the run stops at the last entry with a nonzero
//! weight: trailing zero-weight entries have no word, no counts, and a `pmf` of 0 like any index beyond the run.

use alloc::vec::Vec;
use core::fmt;

/// Counts of a whole distribution: 2^32.
pub const TOTAL: u64 = 1 << 32;
/// One count as a probability.
const COUNT: f32 = 1.0 / 4_294_967_296.0;

/// Why weights make no distribution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WeightError {
    /// There are no weights.
    Empty,
    /// A weight is negative, infinite or not a number.
    Invalid {
        /// Its index.
        index: usize,
        /// The weight.
        weight: f64,
    },
    /// Every weight is zero.
    AllZero {
        /// How many there are.
        len: usize,
    },
    /// More entries than 2^32 counts, or than an index of 32 bits can name.
    TooMany {
        /// How many there are.
        len: usize,
    },
}

impl fmt::Display for WeightError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Empty => write!(f, "no weights"),
            Self::Invalid { index, weight } => write!(f, "weight {index} is {weight}, not finite and >= 0"),
            Self::AllZero { len } => write!(f, "all {len} weights are zero"),
            Self::TooMany { len } => {
                write!(f, "{len} weights are more than the 2^32 counts of a distribution")
            }
        }
    }
}

impl core::error::Error for WeightError {}

/// An entry picked from a distribution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pick {
    /// The entry.
    pub index: u32,
    /// Its probability, `count / 2^32` rounded to f32; in `[2^-32, 1]`.
    pub pmf: f32,
    /// The position within the entry's counts stretched over 32 bits, `floor((x - start) 2^32 / count)`: a random word again, of
    /// log2(count) bits of resolution, that may serve a further decision.
    pub remainder: u32,
}

/// The counts `[start, end)` of entry `index`; empty beyond the run.
#[inline]
const fn span(cumulative: &[u32], index: usize) -> (u64, u64) {
    let len = cumulative.len();
    if index >= len {
        return (TOTAL, TOTAL);
    }
    let end = if index + 1 < len { cumulative[index + 1] as u64 } else { TOTAL };
    (cumulative[index] as u64, end)
}

/// Picks the entry in whose counts the random word `x` lies: the last one with `cumulative[i] <= x`.
///
/// `cumulative` as the module describes; an empty one gives `index` 0 and `pmf` 0. Exact: over all 2^32 words entry i is picked `count_i`
/// times. Binary search; the position is the full 32-bit product `x * 2^32 >> 32`, that is `x` itself.
#[inline]
pub fn pick_in(cumulative: &[u32], x: u32) -> Pick {
    if cumulative.is_empty() {
        return Pick { index: 0, pmf: 0.0, remainder: x };
    }
    // The answer is in `low .. low + size`.
    let (mut low, mut size) = (0, cumulative.len());
    while size > 1 {
        let half = size / 2;
        // Not a branch: it would be mispredicted half of the time.
        low = core::hint::select_unpredictable(cumulative[low + half] <= x, low + half, low);
        size -= half;
    }
    let (start, end) = span(cumulative, low);
    // `end > start` for the picked entry of every well-formed run; the maximum keeps a malformed one from dividing by zero.
    let count = end.saturating_sub(start).max(1);
    let offset = (x as u64).saturating_sub(start);
    Pick {
        index: low as u32,
        pmf: count as f32 * COUNT,
        remainder: ((offset << 32) / count).min(u32::MAX as u64) as u32,
    }
}

/// The probability `count / 2^32` of entry `index`, rounded to f32; 0 for a zero weight and beyond the run.
#[inline]
pub const fn pmf_in(cumulative: &[u32], index: u32) -> f32 {
    let (start, end) = span(cumulative, index as usize);
    end.saturating_sub(start) as f32 * COUNT
}

/// The word of place `index` among 2^`bits` that walk along a distribution, one in each of equal parts: place by place, all shifted by the same
/// `shift` of a part, of which the leading bits count.
///
/// `index 2^(32 - bits) + floor(shift / 2^bits)`; of an index beyond 2^bits the low bits count. With 0 bits it is the shift, with 32 or more
/// the index.
#[inline(always)]
pub const fn even_word(index: u32, shift: u32, bits: u32) -> u32 {
    match bits {
        0 => shift,
        1..32 => index << (32 - bits) | shift >> bits,
        _ => index,
    }
}

/// A discrete distribution over weighted entries, with integer probabilities that sum to exactly one.
///
/// Each nonzero weight has at least one count, a zero weight has none. An entry whose fair share `w / sum(w) * 2^32` is less than one count
/// is raised to one; the others divide the rest in proportion to their weights by largest remainders (lower index first among equals), so
/// that each is within one count of its share of that rest.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IntegerCdf {
    cumulative: Vec<u32>,
    len: usize,
}

impl IntegerCdf {
    /// The distribution of `weights`, each finite and >= 0, of any scale and dynamic range.
    ///
    /// # Errors
    /// [`WeightError`] for an empty list, an invalid weight, all weights zero, or more than 2^32 entries.
    pub fn try_new(weights: &[f32]) -> Result<Self, WeightError> {
        Self::build(weights.len(), |i| f64::from(weights[i]))
    }

    /// The distribution of `weights` in double precision; see [`IntegerCdf::try_new`].
    ///
    /// # Errors
    /// As for [`IntegerCdf::try_new`].
    pub fn try_new_f64(weights: &[f64]) -> Result<Self, WeightError> {
        Self::build(weights.len(), |i| weights[i])
    }

    fn build(len: usize, weight: impl Fn(usize) -> f64) -> Result<Self, WeightError> {
        let counts = counts(len, weight)?;
        let mut before = 0_u64;
        let mut cumulative = Vec::with_capacity(counts.len());
        for count in counts {
            // The run ends with a nonzero entry, so what lies before any of its entries is less than 2^32.
            cumulative.push(before as u32);
            before += count;
        }
        debug_assert_eq!(before, TOTAL);
        Ok(Self { cumulative, len })
    }

    /// The stored run: counts before each entry, up to the last entry with a nonzero weight. Never empty.
    #[inline]
    pub fn cumulative(&self) -> &[u32] {
        &self.cumulative
    }

    /// The number of weights given, zeros included.
    #[inline]
    pub const fn len(&self) -> usize {
        self.len
    }

    /// Always false: an empty list of weights is an error.
    #[inline]
    pub const fn is_empty(&self) -> bool {
        false
    }

    /// The entry of the random word `x`; see [`pick_in`].
    #[inline]
    pub fn pick(&self, x: u32) -> Pick {
        pick_in(&self.cumulative, x)
    }

    /// The probability of entry `index`; see [`pmf_in`].
    #[inline]
    pub fn pmf(&self, index: u32) -> f32 {
        pmf_in(&self.cumulative, index)
    }

    /// The exact number of counts, out of 2^32, of entry `index`.
    #[inline]
    pub fn count(&self, index: u32) -> u64 {
        let (start, end) = span(&self.cumulative, index as usize);
        end - start
    }
}

/// A compensated sum (A. Neumaier, 1974): as if formed in twice the precision.
fn sum(values: impl Iterator<Item = f64>) -> f64 {
    let (mut total, mut lost) = (0.0_f64, 0.0_f64);
    for v in values {
        let next = total + v;
        lost += if total >= v { (total - next) + v } else { (v - next) + total };
        total = next;
    }
    total + lost
}

/// The counts of the entries up to the last nonzero one; they sum to 2^32.
fn counts(len: usize, weight: impl Fn(usize) -> f64) -> Result<Vec<u64>, WeightError> {
    if len == 0 {
        return Err(WeightError::Empty);
    }
    if len as u64 > TOTAL {
        return Err(WeightError::TooMany { len });
    }
    let (mut largest, mut positive, mut stored) = (0.0_f64, 0_u64, 0);
    for index in 0..len {
        let w = weight(index);
        if !(0.0..f64::INFINITY).contains(&w) {
            return Err(WeightError::Invalid { index, weight: w });
        }
        if w > 0.0 {
            (largest, positive, stored) = (largest.max(w), positive + 1, index + 1);
        }
    }
    if positive == 0 {
        return Err(WeightError::AllZero { len });
    }
    // Relative to the largest, so that neither a sum nor a ratio can overflow. A ratio may underflow to zero: such an entry is a light one.
    let relative = |i: usize| weight(i) / largest;
    let all = sum((0..stored).map(relative));

    // Light entries get one count. Taking the lightest first, an entry is light if its share of what is left is less than a count; each light
    // one taken lowers the counts per weight of the rest. Only entries below the least possible rate can be light: sort only those.
    let floor_rate = (TOTAL - positive) as f64 / all;
    let mut light: Vec<usize> =
        (0..stored).filter(|&i| weight(i) > 0.0 && relative(i) * floor_rate < 1.0).collect();
    light.sort_unstable_by(|&a, &b| weight(a).total_cmp(&weight(b)).then(a.cmp(&b)));
    let mut counts = alloc::vec![0_u64; stored];
    let (mut left_counts, mut left_weight, mut lost) = (TOTAL, all, 0.0_f64);
    for &i in &light {
        let w = relative(i);
        // At the end of the list the weight left can only be that of rounding errors when every entry is light.
        if w * left_counts as f64 >= left_weight - lost && left_weight > lost {
            break;
        }
        counts[i] = 1;
        left_counts -= 1;
        lost += w;
    }
    left_weight = sum((0..stored).filter(|&i| counts[i] == 0).map(relative)).max(f64::MIN_POSITIVE);

    // The rest by largest remainders.
    let rate = left_counts as f64 / left_weight;
    let mut remainders: Vec<(f64, usize)> = Vec::new();
    let mut given = 0_u64;
    for (i, count) in counts.iter_mut().enumerate() {
        if *count > 0 || weight(i) == 0.0 {
            continue;
        }
        let share = relative(i) * rate;
        // A share is at least a count but for rounding.
        let whole = (share as u64).max(1);
        *count = whole;
        given += whole;
        remainders.push((share - whole as f64, i));
    }
    settle(&mut counts, &mut remainders, left_counts, given);
    Ok(counts)
}

/// Makes the counts of the entries in `remainders` sum to `target` where they sum to `given`: one count each to the largest remainders, or
/// from the smallest where rounding gave too much. In rounds, for the case that the difference exceeds the number of entries.
fn settle(counts: &mut [u64], remainders: &mut [(f64, usize)], target: u64, mut given: u64) {
    while given != target && !remainders.is_empty() {
        let short = given < target;
        let missing = given.abs_diff(target).min(remainders.len() as u64) as usize;
        if missing < remainders.len() {
            remainders.select_nth_unstable_by(missing - 1, |a, b| {
                let order = if short { b.0.total_cmp(&a.0) } else { a.0.total_cmp(&b.0) };
                order.then(a.1.cmp(&b.1))
            });
        }
        let before = given;
        for (remainder, i) in &mut remainders[..missing] {
            if short {
                (counts[*i], *remainder, given) = (counts[*i] + 1, *remainder - 1.0, given + 1);
            } else if counts[*i] > 1 {
                (counts[*i], *remainder, given) = (counts[*i] - 1, *remainder + 1.0, given - 1);
            } else {
                // Nothing to take here: look at the others first.
                *remainder = f64::INFINITY;
            }
        }
        // Cannot last: some entry has more than one count while they sum to more than their number.
        if given == before && !short && remainders.iter().all(|r| counts[r.1] <= 1) {
            break;
        }
    }
}
