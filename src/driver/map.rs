//! What an illumination map says: photons' means, or what is reconstructed from them, with errors.

use etendue_core::film::Film;
use etendue_core::illumination::{Clustering, Elements, reconstruct};
use etendue_core::scene::CompiledScene;

/// Irradiance per element with its standard error \[W/m^2\].
#[derive(Clone, Debug, PartialEq)]
pub struct MapValues {
    /// Irradiance \[W/m^2\].
    pub values: Vec<[f64; 3]>,
    /// Its standard error; 0 below two replicates.
    pub stderr: Vec<[f64; 3]>,
    /// Its estimated relative error where it was reconstructed (`None` of a black one).
    pub reconstructed: Option<Option<f64>>,
}

impl MapValues {
    /// As the samples say.
    pub fn of(film: &Film) -> Self {
        let stderr = (0..film.len()).map(|i| film.standard_error(i).unwrap_or([0.0; 3])).collect();
        Self { values: (0..film.len()).map(|i| film.mean(i)).collect(), stderr, reconstructed: None }
    }

    /// Drawn towards their surroundings; see [`reconstruct`]. `None` below two replicates.
    pub fn reconstructed(scene: &CompiledScene, elements: &Elements, film: &Film) -> Option<Self> {
        let found = reconstruct(&Clustering::new(scene, elements), elements, film)?;
        let reconstructed = Some(found.rel_error(|i| elements.weight(i)));
        Some(Self { values: found.values, stderr: found.stderr, reconstructed })
    }

    /// Standard error of the sum with an independent map, at an element and a channel.
    pub fn stderr_with(&self, other: &Self, element: usize, channel: usize) -> f64 {
        self.stderr[element][channel].hypot(other.stderr[element][channel])
    }
}
