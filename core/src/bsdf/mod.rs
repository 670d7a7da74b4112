//! How surfaces scatter: the bidirectional scattering distribution function f(wo, wi) \[1/sr\].
//!
//! `wo` and `wi` are unit vectors away from the surface; `n` is the unit normal on the side of `wo` (where light passes the surface, on either). What a path
//! carries on is f |cos(wi, n)| / pdf. Densities are per solid angle. Each lobe is a trio in its own module; [`Lobes`]
//! is their sum at one surface point.

mod boundary;
pub mod diffuse;
mod erf;
mod facets;
mod film;
pub mod fresnel;
mod interface;
mod lobes;
pub mod phong;
pub mod plastic;
mod rough;

pub use boundary::Boundary;
pub use facets::{ALPHA_MIN, Facets};
pub use interface::{Interface, Passage};
pub use lobes::{BsdfSample, Finish, Lobes};
pub use rough::{Metal, Rough};
