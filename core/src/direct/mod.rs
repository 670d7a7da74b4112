//! Direct light as the start of everything else: which parts of a surface are lit, and how much they send on.
//!
//! - [`subdivide`]: pieces of a triangle over which direct irradiance is nearly linear.
//! - [`emission`]: the flux that a piece sends on after its first reflection.

pub mod emission;
pub mod subdivide;
