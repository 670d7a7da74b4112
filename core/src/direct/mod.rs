//! Direct light as the start of everything else: which parts of a surface are lit, and how much they send on.
//!
//! - [`irradiance`]: what lights without size bring to a point, and to an element on average.
//! - [`subdivide`]: pieces of a triangle over which direct irradiance is nearly linear.
//! - [`emission`]: the flux that a piece sends on after its first reflection.

pub mod emission;
pub mod irradiance;
pub mod subdivide;
