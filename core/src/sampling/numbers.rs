//! The numbers of one photon: random, or a point of a scrambled Sobol' block, behind one door.

use super::counter::Counter;
use super::sobol::BlockSampler;
use super::u32_to_unit;

/// Groups of four numbers for the decisions of one photon, named by its place in a replicate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Numbers {
    /// Independent random numbers.
    Random {
        /// The generator of the seed.
        counter: Counter,
        /// The replicate.
        replicate: u32,
        /// The photon.
        index: u32,
    },
    /// The replicate is a block, the photon an index.
    Sobol(BlockSampler),
}

/// Keeps the words of photons apart from those of a film's samples of the same seed, random and Sobol' alike: replicate b's photons and block b's samples of
/// the first pixel would otherwise be one set.
const DOMAIN: u64 = 0x9E6D_62D0_6F6A_9A9B;

impl Numbers {
    /// Random numbers of a replicate's first photon.
    pub const fn random(seed: u64, replicate: u32) -> Self {
        Self::Random { counter: Counter::new(seed ^ DOMAIN), replicate, index: 0 }
    }

    /// Sobol' points of a replicate's first photon.
    pub const fn sobol(seed: u64, replicate: u32) -> Self {
        Self::Sobol(BlockSampler::new(seed ^ DOMAIN, 0, replicate, 0))
    }

    /// Those of another photon of the replicate.
    #[inline(always)]
    pub const fn with_index(self, index: u32) -> Self {
        match self {
            Self::Random { counter, replicate, .. } => Self::Random { counter, replicate, index },
            Self::Sobol(sampler) => Self::Sobol(sampler.with_index(index)),
        }
    }

    /// Four 32-bit words of a group.
    #[inline(always)]
    pub fn bits4(&self, group: u32) -> [u32; 4] {
        match self {
            Self::Random { counter, replicate, index } => counter.bits4(*replicate, *index, group),
            Self::Sobol(sampler) => sampler.bits4(group),
        }
    }

    /// Four numbers of a group, each in `[0, 1 - 2^-24]`.
    #[inline(always)]
    pub fn group4(&self, group: u32) -> [f32; 4] {
        self.bits4(group).map(u32_to_unit)
    }
}
