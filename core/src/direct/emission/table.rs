//! The emission coefficients of all pairs, their total flux, and the density over them.

use super::importance;
use crate::math::{self, Compensated, Vec3};
use crate::sampling::discrete::{IntegerCdf, WeightError};
use alloc::vec::Vec;
use core::fmt;

/// What an entry of the density stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Entry {
    /// A piece of a lit surface and the light that lights it.
    Pair {
        /// Index of the piece.
        piece: u32,
        /// Index of the light.
        light: u32,
    },
    /// A light that emits for itself (area, emissive, environment).
    Light {
        /// Index of the light.
        light: u32,
    },
}

/// Why an entry is refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TableError {
    /// A flux is negative, infinite or not a number.
    Invalid {
        /// For what.
        entry: Entry,
        /// The flux \[W\].
        flux: [f32; 3],
    },
    /// More entries than an index of 32 bits can name.
    Full,
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Invalid { entry, flux } => write!(f, "{entry:?} has flux {flux:?}, not finite and >= 0"),
            Self::Full => write!(f, "more than 2^32 - 1 entries"),
        }
    }
}

impl core::error::Error for TableError {}

/// A compensated sum of fluxes \[W\]: per channel, and of the scalar importances.
///
/// In f64: where terms span decades, what f32 loses needs more digits than f32 has (10^6 terms over 12 decades: 2e-7).
/// Within 2^-24 of the exact sum of the same numbers, that is one rounding (same terms, `tests/emission_table.rs`).
/// The order of terms is that of the calls; a host-side sum, no kernel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FluxSum {
    channels: [Compensated<f64>; 3],
    importance: Compensated<f64>,
}

impl FluxSum {
    /// Adds one entry.
    #[inline]
    pub fn add(&mut self, flux: Vec3, importance: f32) {
        for (sum, x) in self.channels.iter_mut().zip(flux.to_array()) {
            sum.add(f64::from(x));
        }
        self.importance.add(f64::from(importance));
    }

    /// Adds another sum with what it lost.
    #[inline]
    pub fn merge(&mut self, other: &Self) {
        for (sum, x) in self.channels.iter_mut().zip(other.channels) {
            sum.merge(x);
        }
        self.importance.merge(other.importance);
    }

    /// Total per channel \[W\]; at most f32::MAX.
    #[inline]
    pub fn flux(&self) -> Vec3 {
        Vec3::from_array(self.flux_f64().map(|c| math::min(c as f32, f32::MAX)))
    }

    /// Total per channel \[W\] before it is rounded to f32.
    #[inline]
    pub fn flux_f64(&self) -> [f64; 3] {
        self.channels.map(Compensated::<f64>::value)
    }

    /// Total of the importances \[W\]; at most f32::MAX.
    #[inline]
    pub fn importance(&self) -> f32 {
        math::min(self.importance.value() as f32, f32::MAX)
    }
}

/// Emission coefficients \[W\] of many entries, in the order in which they came.
///
/// Entries of no importance are left out: nothing can start there. The density over the rest is an [`IntegerCdf`],
/// whose entry i is entry i here. A start on entry i carries `emission / pmf`, with the pmf that it was picked with, so
/// that the counts' rounding is no error: over all 2^32 random words the mean is the total flux (to the rounding of
/// the pmf, 2^-24).
///
/// What 2^32 counts cost: entries below a count (2^-32 of the whole) are picked more often than they deserve, each
/// with a weight below the mean; others by half a count at most. For n entries the variance of the scalar weight
/// grows by less than n / 2^32 of its square mean (2.4e-4 for 10^6; measured in `tests/emission_table.rs`), so that
/// wider counts would gain nothing before some 10^8 entries.
#[derive(Clone, Debug, Default)]
pub struct EmissionTable {
    entries: Vec<Entry>,
    emission: Vec<[f32; 3]>,
    importance: Vec<f32>,
    sum: FluxSum,
}

impl EmissionTable {
    /// An empty table.
    pub const fn new() -> Self {
        const ZERO: Compensated<f64> = Compensated::<f64>::new(0.0);
        Self {
            entries: Vec::new(),
            emission: Vec::new(),
            importance: Vec::new(),
            sum: FluxSum { channels: [ZERO; 3], importance: ZERO },
        }
    }

    /// Adds a pair of emission coefficient `emission`; `bound` is the emission that the piece's brightest texel would
    /// give (`emission` itself for a plain albedo), see [`importance`]. Whether it was kept.
    ///
    /// # Errors
    /// [`TableError`] for a flux that is none, or a full table.
    pub fn push_pair(
        &mut self,
        piece: u32,
        light: u32,
        emission: Vec3,
        bound: Vec3,
    ) -> Result<bool, TableError> {
        let entry = Entry::Pair { piece, light };
        valid(entry, bound)?;
        self.push(entry, emission, bound)
    }

    /// Adds a light that emits `flux` \[W\] for itself. Whether it was kept.
    ///
    /// # Errors
    /// [`TableError`] for a flux that is none, or a full table.
    pub fn push_light(&mut self, light: u32, flux: Vec3) -> Result<bool, TableError> {
        self.push(Entry::Light { light }, flux, flux)
    }

    fn push(&mut self, entry: Entry, emission: Vec3, bound: Vec3) -> Result<bool, TableError> {
        valid(entry, emission)?;
        let importance = importance(emission, bound);
        if importance <= 0.0 {
            return Ok(false);
        }
        if self.entries.len() >= u32::MAX as usize {
            return Err(TableError::Full);
        }
        self.entries.push(entry);
        self.emission.push(emission.to_array());
        self.importance.push(importance);
        self.sum.add(emission, importance);
        Ok(true)
    }

    /// Appends the entries of `other`. Tables of fixed blocks, appended in order, give the same bits whoever made them.
    ///
    /// # Errors
    /// [`TableError::Full`]; nothing is appended then.
    pub fn append(&mut self, other: &Self) -> Result<(), TableError> {
        if other.len() > u32::MAX as usize - self.len() {
            return Err(TableError::Full);
        }
        self.entries.extend_from_slice(&other.entries);
        self.emission.extend_from_slice(&other.emission);
        self.importance.extend_from_slice(&other.importance);
        self.sum.merge(&other.sum);
        Ok(())
    }

    /// Number of entries.
    #[inline]
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Whether nothing sends any light.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// The total flux \[W\] per channel, and the total importance.
    #[inline]
    pub const fn sum(&self) -> &FluxSum {
        &self.sum
    }

    /// What the entries stand for.
    #[inline]
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// Emission coefficient \[W\] of entry `index`; 0 beyond the last.
    #[inline]
    pub fn emission(&self, index: u32) -> Vec3 {
        self.emission.get(index as usize).copied().map_or(Vec3::ZERO, Vec3::from_array)
    }

    /// The weights of the density, per entry \[W\].
    #[inline]
    pub fn importances(&self) -> &[f32] {
        &self.importance
    }

    /// The density over the entries: counts of 2^32, at least one each.
    ///
    /// # Errors
    /// [`WeightError::Empty`] for an empty table.
    pub fn density(&self) -> Result<IntegerCdf, WeightError> {
        IntegerCdf::try_new(&self.importance)
    }

    /// Flux \[W\] that one start on entry `index` stands for: `emission / pmf`, the pmf that of [`Self::density`].
    /// Divided by the number of starts it is a photon's. 0 for a pmf of 0.
    #[inline]
    pub fn start_flux(&self, index: u32, pmf: f32) -> Vec3 {
        if pmf > 0.0 { (self.emission(index) / pmf).min(Vec3::splat(f32::MAX)) } else { Vec3::ZERO }
    }
}

fn valid(entry: Entry, flux: Vec3) -> Result<(), TableError> {
    if flux.to_array().iter().all(|x| (0.0..=f32::MAX).contains(x)) {
        Ok(())
    } else {
        Err(TableError::Invalid { entry, flux: flux.to_array() })
    }
}
