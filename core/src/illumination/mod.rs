//! Illumination maps: the irradiance \[W/m^2\] that arrives at each element of a scene's surfaces, by photons.
//!
//! Photons come in replicates, each an independent run of the whole walk. Within a replicate the flux of arrivals is summed per element in 64-bit
//! fixed point ([`FluxUnit`]): integers may be added in any order, by any threads. A replicate's irradiance then enters a
//! [`Film`](crate::film::Film) as one block, which keeps the mean, the standard error and the right to be merged.
//!
//! Which elements there are, and what an arrival counts for, is [`Elements`].

mod clusters;
mod elements;
mod lattice;
mod reconstruct;

use crate::film::{FilmSettings, power_of_two, scale_exponent};
use crate::math::Vec3;

pub use clusters::{Clustering, Clusters, NO_CLUSTER};
pub use elements::{Basis, ElementMesh, ElementPlace, ElementSettings, Elements, Place, Sides};
pub use reconstruct::{Reconstruction, reconstruct};

/// Fractional bits: all of the scene's flux is 2^48 units, or up to twice as much.
const FRACTION_BITS: i32 = 48;

/// The unit of fixed-point sums of flux: a power of two \[W\].
///
/// A sum may reach 2^14 times the scene's flux before it overflows. Photons survive with a chance of at most 0.95, so that all arrivals together
/// are expected to bring 20 times that flux.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FluxUnit {
    /// Units a watt.
    scale: f64,
    /// Photons of a replicate.
    photons: f64,
}

impl FluxUnit {
    /// For replicates of `photons` photons that carry `total` \[W\] (the largest channel) between them.
    pub fn new(total: f64, photons: u32) -> Self {
        let exponent = scale_exponent(total as f32);
        Self { scale: power_of_two(FRACTION_BITS - exponent), photons: f64::from(photons.max(1)) }
    }

    /// The power of two by which [`Self::units`] multiplies, where it is one: for a number of photons that is.
    pub fn power(self) -> Option<i32> {
        let bits = (self.scale / self.photons).to_bits();
        let is_power = bits << 12 == 0 && (1..0x7ff).contains(&(bits >> 52));
        is_power.then(|| (bits >> 52) as i32 - 1023)
    }

    /// The share of one photon that carries `flux` as if it were the only one, in units, to nearest. NaN and what is below -2^51 count as 0,
    /// what is above 2^51 is clipped.
    #[inline]
    pub fn units(self, flux: f32) -> i64 {
        // The nearest integer by a sum whose last place is 1.
        const LIMIT: f64 = 2_251_799_813_685_248.0;
        const MAGIC: f64 = 6_755_399_441_055_744.0;
        let x = f64::from(flux) * (self.scale / self.photons);
        let x = if x > LIMIT {
            LIMIT
        } else if x > -LIMIT {
            x
        } else {
            0.0
        };
        ((x + MAGIC) - MAGIC) as i64
    }

    /// Flux \[W\] of a sum of shares.
    #[inline]
    pub fn flux(self, sum: i64) -> f64 {
        sum as f64 / self.scale
    }
}

/// Settings of an illumination map's film: one row of elements, one block a replicate.
pub fn film_settings(elements: usize, total: [f64; 3], area: f64, seed: u64, photons: u32) -> FilmSettings {
    let mean =
        Vec3::new(total[0] as f32, total[1] as f32, total[2] as f32).max_element() / area.max(1e-30) as f32;
    FilmSettings {
        width: elements.min(u32::MAX as usize) as u32,
        height: 1,
        seed,
        block_length: photons,
        scale_exponent: scale_exponent(mean),
    }
}
