//! First shot against photons from the lights.

pub mod measure;
pub mod precompute;
pub mod reconstruct;
pub mod scenes;
