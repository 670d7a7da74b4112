//! How the photons of one replicate are numbered, and how many of them live on: what every backend must do alike.
//!
//! Where they walk together ([`Sequence::Sorted`]) chances are whole numbers in units of 2^-32, so that their sums over parts of the order are exact: a photon survives
//! where the sum passes a whole number of photons.

use super::{PICK_GROUP, Sequence};
use crate::sampling::discrete::even_word;
use crate::sampling::numbers::Numbers;

/// Most photons that walk together: about 140 bytes each, and what is gained by more of them is little.
pub const WAVE: u32 = 1 << 20;
/// One as a count of chances.
const ONE: f64 = 4_294_967_296.0;

/// A chance in units of 2^-32. 2^32 is one too many for the integer: a sure survivor is lost once in 2^32.
#[inline]
pub fn chance_count(chance: f32) -> u32 {
    (f64::from(chance) * ONE) as u32
}

/// What the flux of a survivor of a chance is multiplied by: its inverse, rounded to 53 bits and then to 24. 1 for a chance of 0, by which nothing survives.
#[inline]
pub fn survivor_factor(count: u32) -> f32 {
    if count == 0 { 1.0 } else { (ONE / f64::from(count)) as f32 }
}

/// How the numbers of a replicate's photons are made.
#[derive(Clone, Copy, Debug)]
pub struct Replicate {
    /// Of starts and of scattering.
    pub numbers: Numbers,
    /// Independent ones, for what is drawn once for many photons, and for what happens between hits.
    pub random: Numbers,
    /// Whether photons walk along the distribution of starts, one in each of equal parts; from where on, and how many bits name a photon.
    even: bool,
    shift: u32,
    bits: u32,
}

impl Replicate {
    /// Replicate `number` of `photons` photons, a power of two.
    pub fn new(seed: u64, sequence: Sequence, photons: u32, number: u32) -> Self {
        let random = Numbers::random(seed, number);
        let [shift, ..] = random.with_index(u32::MAX).bits4(PICK_GROUP);
        let numbers = match sequence {
            Sequence::Random => random,
            Sequence::Sobol | Sequence::Sorted => Numbers::sobol(seed, number),
        };
        Self { numbers, random, even: sequence != Sequence::Random, shift, bits: photons.trailing_zeros() }
    }

    /// Shift and bits of [`even_word`], where photons walk along the distribution of starts.
    pub fn even(&self) -> Option<(u32, u32)> {
        self.even.then_some((self.shift, self.bits))
    }

    /// Where systematic roulette of a bounce begins, for the wave of photons from `first` on: a fraction of a photon in units of 2^-32.
    pub fn roulette_offset(&self, first: u32, bounce: u32) -> u32 {
        self.random.with_index(first ^ (u32::MAX - 1)).bits4(bounce)[0]
    }

    /// The word that chooses where photon `index` starts, `numbers` being its own.
    #[inline(always)]
    pub fn pick(&self, index: u32, numbers: &Numbers) -> u32 {
        if !self.even {
            return numbers.bits4(PICK_GROUP)[0];
        }
        even_word(index, self.shift, self.bits)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chances_and_their_inverses_agree() {
        for (chance, count, factor) in [
            (0.0, 0, 1.0),
            (0.5, 1 << 31, 2.0),
            (0.25, 1 << 30, 4.0),
            (1.0, u32::MAX, 1.0),
            (f32::NAN, 0, 1.0),
        ] {
            assert_eq!(chance_count(chance), count);
            assert_eq!(survivor_factor(count), factor);
        }
        for count in (0..1000_u32).map(|i| i.wrapping_mul(0x9E37_79B9) | 1) {
            let both = f64::from(survivor_factor(count)) * (f64::from(count) / ONE);
            assert!((both - 1.0).abs() <= 6e-8, "{count}: {both}");
        }
    }
}
