//! How surfaces scatter: the bidirectional scattering distribution function f(wo, wi) \[1/sr\].
//!
//! `wo` and `wi` are unit vectors away from the surface; `n` is the unit normal on the side of `wo`. What a path
//! carries on is f cos(wi, n) / pdf. Densities are per solid angle. Each lobe is a trio in its own module; [`Lobes`]
//! is their sum at one surface point.

pub mod diffuse;
pub mod fresnel;
mod interface;
mod lobes;
pub mod phong;

pub use interface::{Interface, Passage};
pub use lobes::{BsdfSample, Lobes};
