//! What lands in pixels from elsewhere, as integers: any order of adding gives the same bits.

use crate::film::power_of_two;
use crate::math::Vec3;

/// Bits of the unit below the film's scale: what lands in a pixel in one block may be 2^29 times that.
const FRACTION_BITS: i32 = 34;
/// Largest single splat in units; what is larger is clipped.
const UNITS_MAX: f32 = (1_u64 << 58) as f32;

/// The unit in which splats are counted: 2^(scale exponent of the film - 34).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SplatUnit {
    unit: f64,
    per_unit: f32,
}

impl SplatUnit {
    /// Of a film with this scale (see [`crate::film::FilmSettings::scale_exponent`]).
    pub fn new(scale_exponent: i32) -> Self {
        let exponent = scale_exponent - FRACTION_BITS;
        Self { unit: power_of_two(exponent), per_unit: power_of_two(-exponent) as f32 }
    }

    /// Units in one of radiance: a power of two.
    pub fn per_unit(&self) -> f32 {
        self.per_unit
    }

    /// Adds a splat to a pixel's sums, to the nearest unit. What is no number counts as 0.
    #[inline]
    pub fn add(&self, sums: &mut [i64; 3], value: Vec3) {
        for (sum, x) in sums.iter_mut().zip(value.to_array()) {
            let units = (x * self.per_unit).clamp(-UNITS_MAX, UNITS_MAX);
            *sum = sum.saturating_add((units + if units < 0.0 { -0.5 } else { 0.5 }) as i64);
        }
    }

    /// What sums of a block of so many samples add to the mean.
    #[inline]
    pub fn mean(&self, sums: &[i64; 3], block_length: u32) -> [f64; 3] {
        sums.map(|s| s as f64 * self.unit / f64::from(block_length.max(1)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn splats_add_up_and_nothing_breaks_them() {
        let unit = SplatUnit::new(3);
        let mut sums = [0; 3];
        for _ in 0..1000 {
            unit.add(&mut sums, Vec3::new(1.5, 1e-3, -2.0));
        }
        let mean = unit.mean(&sums, 16);
        for (found, expected) in mean.iter().zip([93.75, 0.0625, -125.0]) {
            assert!((found - expected).abs() < 1e-5 * expected.abs(), "{found} {expected}");
        }
        unit.add(&mut sums, Vec3::new(f32::INFINITY, f32::NAN, f32::NEG_INFINITY));
        assert!(unit.mean(&sums, 16).iter().all(|m| m.is_finite()));
    }
}
