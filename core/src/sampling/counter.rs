//! Counter-based random bits: a pure function of (seed, stream, sample, dimension), so that any number can be made at any time, in any order,
//! on any backend.
//!
//! The generator is Philox4x32-10 (J. K. Salmon, M. A. Moraes, R. O. Dror, D. E. Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC 2011):
//! a keyed bijection of 128-bit counters that passes TestU01's BigCrush, with known answers published in the authors' Random123.
//! One call makes four words. The seed is its key, (dimension / 4, sample, stream, domain) its counter; the domain is 0 here, and other values
//! keep the keys of [`super::sobol`] apart.
//! Its only operation beyond 32-bit `+`, `*` and `^` is the high word of a 32 x 32 bit product, which a shader without 64-bit integers
//! forms from 16-bit halves.

use super::u32_to_unit;

/// Multipliers of Philox4x32 (Salmon et al. 2011, table 2).
const PHILOX_MULTIPLIER: [u32; 2] = [0xD251_1F53, 0xCD9E_8D57];
/// Key increments of Philox4x32: the golden ratio and sqrt(3) - 1, in units of 2^-32.
const PHILOX_WEYL: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];

/// Philox4x32 with ten rounds: four random words of a 128-bit `counter` under a 64-bit `key`.
///
/// For a fixed key it is a bijection of the counter. Source: Salmon et al. 2011, section 3.3.
#[inline]
pub const fn philox4x32_10(counter: [u32; 4], key: [u32; 2]) -> [u32; 4] {
    let [mut c0, mut c1, mut c2, mut c3] = counter;
    let [mut k0, mut k1] = key;
    let mut round = 0;
    while round < 10 {
        let p0 = PHILOX_MULTIPLIER[0] as u64 * c0 as u64;
        let p1 = PHILOX_MULTIPLIER[1] as u64 * c2 as u64;
        (c0, c1, c2, c3) = ((p1 >> 32) as u32 ^ c1 ^ k0, p1 as u32, (p0 >> 32) as u32 ^ c3 ^ k1, p0 as u32);
        k0 = k0.wrapping_add(PHILOX_WEYL[0]);
        k1 = k1.wrapping_add(PHILOX_WEYL[1]);
        round += 1;
    }
    [c0, c1, c2, c3]
}

/// Random words addressed by (stream, sample, dimension) under one seed.
///
/// A stream is a pixel or a photon batch, a sample its running number, a dimension the number of the decision within the sample.
/// Distinct addresses give words of distinct counters: no two overlap under one seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counter {
    key: [u32; 2],
}

impl Counter {
    /// The generator of `seed`.
    #[inline]
    pub const fn new(seed: u64) -> Self {
        Self { key: [seed as u32, (seed >> 32) as u32] }
    }

    /// Four random words: dimensions `4 group .. 4 group + 4` of `sample` in `stream`. One call of Philox.
    #[inline]
    pub const fn bits4(&self, stream: u32, sample: u32, group: u32) -> [u32; 4] {
        philox4x32_10([group, sample, stream, 0], self.key)
    }

    /// The random word of one dimension. Four times the price of [`Counter::bits4`] per word.
    #[inline]
    pub const fn bits(&self, stream: u32, sample: u32, dimension: u32) -> u32 {
        self.bits4(stream, sample, dimension >> 2)[(dimension & 3) as usize]
    }

    /// The unit number of one dimension, in `[0, 1 - 2^-24]`.
    #[inline]
    pub const fn unit(&self, stream: u32, sample: u32, dimension: u32) -> f32 {
        u32_to_unit(self.bits(stream, sample, dimension))
    }
}

/// The random word of (seed, stream, sample, dimension): [`Counter::bits`] in one call.
#[inline]
pub const fn counter_u32(seed: u64, stream: u32, sample: u32, dimension: u32) -> u32 {
    Counter::new(seed).bits(stream, sample, dimension)
}

/// A 32-bit integer hash: a bijection with low avalanche bias; `hash_u32(0) == 0`.
///
/// Two rounds of xorshift-multiply with searched constants (C. Wellons, "hash prospector", `lowbias32`, 2018; bias 0.17 in his measure).
/// A hash, not a random generator: for long sequences use [`Counter`].
#[inline(always)]
pub const fn hash_u32(x: u32) -> u32 {
    let x = (x ^ (x >> 16)).wrapping_mul(0x7FEB_352D);
    let x = (x ^ (x >> 15)).wrapping_mul(0x846C_A68B);
    x ^ (x >> 16)
}

/// The hash of `value` under the running hash `seed`: for a fixed one of the two a bijection of the other; not symmetric.
#[inline(always)]
pub const fn hash_combine(seed: u32, value: u32) -> u32 {
    hash_u32(hash_u32(seed.wrapping_add(0x9E37_79B9)).wrapping_add(value))
}
