//! What starts carry.
//!
//! Quantity: flux \[W\] per channel. At a place of irradiance E starts have two densities per area \[1/m^2\]: that of the pieces
//! ([`super::place::density`]), and that of photons straight from the light, which is in proportion to E. A start on a piece carries E over their
//! sum, a photon from the light its flux times its density's share of the sum (the balance heuristic, Veach 1997, section 9.2.2): wherever a
//! start comes from, the mean is E.

use crate::math::{self, Vec3};

/// Density per area \[1/m^2\] of photons straight from a light at a place of irradiance `e` \[W/m^2\]: `per_watt` \[1/W\], the chance of the light
/// over its flux, times the channels' mean. In \[0, `f32::MAX`\]; NaN counts as 0.
#[inline]
pub fn light_density(e: Vec3, per_watt: f32) -> f32 {
    math::clamp(per_watt * math::mean(e), 0.0, f32::MAX)
}

/// Flux \[W\] of a start on a piece: the irradiance `e` \[W/m^2\] over the density of the pieces and that of the light together.
///
/// 0 where no density is positive and where the irradiance is not finite; each channel in \[0, `f32::MAX`\]. A density that is NaN counts as 0.
#[inline]
pub fn start_flux(e: Vec3, density: f32, per_watt: f32) -> Vec3 {
    let all = math::max(density, 0.0) + light_density(e, per_watt);
    if all > 0.0 && e.is_finite() { (e / all).max(Vec3::ZERO).min(Vec3::MAX) } else { Vec3::ZERO }
}

/// Share of its flux that a photon straight from a light keeps where it lands: its density over that of the pieces and its own together.
///
/// In \[0, 1\]. 1 where no density is positive: then nothing else starts here. A density that is NaN counts as 0, an infinite one as `f32::MAX`.
#[inline]
pub fn light_share(e: Vec3, density: f32, per_watt: f32) -> f32 {
    let (from_light, density) = (light_density(e, per_watt), math::max(density, 0.0));
    let all = from_light + density;
    // Neither is NaN.
    if all <= 0.0 {
        return 1.0;
    }
    if all <= f32::MAX {
        return from_light / all;
    }
    // Only the sum has overflowed.
    let half = 0.5 * from_light;
    half / (half + 0.5 * math::min(density, f32::MAX))
}

/// What the flux of a start is multiplied by where it was asked, with this chance, whether the light is hidden: 1 where it is seen. Where it is
/// hidden, 1 - 1 / chance, which in the mean, with those that were not asked and count 1, is 0.
///
/// Chances outside (0, 1) count as 1; at least -`f32::MAX`.
#[inline]
pub fn look_factor(chance: f32, blocked: bool) -> f32 {
    if !blocked {
        return 1.0;
    }
    if chance > 0.0 && chance < 1.0 { math::max(1.0 - 1.0 / chance, -f32::MAX) } else { 0.0 }
}

/// Flux \[W\] of a start by the weights as published, alike over the whole piece: the light's `colour` (its channels' mean is 1) times the mean of
/// the irradiance at the corners \[W/m^2\] and the area \[m^2\], over the chance of the piece.
///
/// 0 for a chance of 0 or NaN; each channel in \[0, `f32::MAX`\], NaN counts as 0.
#[inline]
pub fn piece_flux(colour: Vec3, weights: [f32; 3], area: f32, pmf: f32) -> Vec3 {
    let mean = (weights[0] + weights[1] + weights[2]) / 3.0;
    let flux = mean * area / pmf;
    if !(pmf > 0.0 && flux >= 0.0) {
        return Vec3::ZERO;
    }
    // Not infinite: a channel of 0 must not become NaN.
    let flux = colour * math::min(flux, f32::MAX);
    Vec3::from_array(flux.to_array().map(|x| math::clamp(x, 0.0, f32::MAX)))
}
