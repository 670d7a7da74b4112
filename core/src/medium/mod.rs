//! Participating media: how far light flies, how it is scattered, and which medium a point lies in.
//!
//! Extinction sigma_t = sigma_a + sigma_s \[1/m\] per channel. A flight of length t is left by T = exp(-sigma_t t); at its end light is scattered by sigma_s p, p the phase
//! function ([`phase`]). Distances are drawn by one of the channels, and weighted so that all channels share them ([`flight`]). Which medium a point lies in is what the
//! boundaries crossed on the way say ([`Inside`]).

pub mod flight;
mod inside;
pub mod phase;

pub use inside::{INSIDE_MAX, Inside};

use crate::math::Vec3;
use crate::scene::MediumRecord;

/// What a homogeneous medium is to a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    /// Extinction \[1/m\] per channel.
    pub sigma_t: Vec3,
    /// Scattering \[1/m\] per channel.
    pub sigma_s: Vec3,
    /// Radiance emitted per metre \[W m^-3 sr^-1\] per channel.
    pub emission: Vec3,
    /// Henyey-Greenstein mean cosine.
    pub g: f32,
}

impl Medium {
    /// From the compiled scene.
    #[inline(always)]
    pub fn new(record: &MediumRecord) -> Self {
        let sigma_s = Vec3::from_array(record.sigma_s);
        Self {
            sigma_t: Vec3::from_array(record.sigma_a) + sigma_s,
            sigma_s,
            emission: Vec3::from_array(record.emission),
            g: record.g,
        }
    }
}
