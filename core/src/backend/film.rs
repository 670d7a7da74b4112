//! Settings of the films that jobs fill.

use super::{BackendError, PathJob, PhotonJob};
use crate::film::{FilmSettings, scale_exponent};
use crate::illumination::{self, Elements};
use crate::scene::CompiledScene;
use crate::transport::photon::LightPlan;

/// Settings of the film of a job of direct irradiance on this scene: one row of its elements.
pub fn direct_film_settings(scene: &CompiledScene, elements: &Elements, job: &PathJob) -> FilmSettings {
    film_settings(scene, job, elements.count().min(u32::MAX as usize) as u32, 1)
}

/// Settings of the film of an illumination map of this scene: one row of its elements.
///
/// # Errors
/// When nothing emits.
pub fn illumination_film_settings(
    scene: &CompiledScene,
    elements: &Elements,
    job: &PhotonJob,
) -> Result<FilmSettings, BackendError> {
    let plan = LightPlan::new(scene).map_err(|_| BackendError::Dark)?;
    Ok(illumination::film_settings(elements.count(), plan.total(), scene.area(), job.seed, job.photons))
}

/// The largest radiance, intensity or irradiance that a scene's lights state.
fn brightest(scene: &CompiledScene) -> f32 {
    scene.lights.iter().flat_map(|l| l.radiance).chain(scene.environment).fold(0.0_f32, |m, x| m.max(x))
}

/// Settings of the film of an image job on this scene.
///
/// # Errors
/// When the scene has no camera.
pub fn image_film_settings(scene: &CompiledScene, job: &PathJob) -> Result<FilmSettings, BackendError> {
    let camera = scene.camera.as_ref().ok_or(BackendError::NoCamera)?;
    Ok(film_settings(scene, job, camera.width, camera.height))
}

/// Settings of the film of a probe job on this scene: one row of probes.
pub fn probe_film_settings(scene: &CompiledScene, job: &PathJob, probes: usize) -> FilmSettings {
    film_settings(scene, job, probes.min(u32::MAX as usize) as u32, 1)
}

fn film_settings(scene: &CompiledScene, job: &PathJob, width: u32, height: u32) -> FilmSettings {
    FilmSettings {
        width,
        height,
        seed: job.seed,
        block_length: job.block_length,
        scale_exponent: scale_exponent(brightest(scene)),
    }
}
