//! First shot against photons from the lights.

pub mod measure;
pub mod needs;
pub mod precompute;
pub mod reconstruct;
pub mod scenes;
