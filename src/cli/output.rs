//! From films to files.

use super::error::CliError;
use crate::driver::Outcome;
use crate::io::{RenderImage, write_exr, write_png, write_points};
use etendue_core::backend::Probe;
use etendue_core::scene::CompiledScene;
use etendue_core::tone::{ToneSettings, display_srgb8};
use std::path::Path;

/// A hash of everything that a compiled scene holds, as hexadecimal text.
pub(super) fn scene_hash(scene: &CompiledScene) -> String {
    let mut hash = blake3::Hasher::new();
    let mut part = |bytes: &[u8]| {
        hash.update(&(bytes.len() as u64).to_le_bytes());
        hash.update(bytes);
    };
    part(bytemuck::cast_slice(&scene.positions));
    part(bytemuck::cast_slice(&scene.triangles));
    part(bytemuck::cast_slice(&scene.shapes));
    part(bytemuck::cast_slice(&scene.surfaces));
    part(bytemuck::cast_slice(&scene.texcoords));
    part(bytemuck::cast_slice(&scene.normals));
    part(bytemuck::cast_slice(&scene.materials));
    part(bytemuck::cast_slice(&scene.checkers));
    part(bytemuck::cast_slice(&scene.textures));
    part(bytemuck::cast_slice(&scene.texels));
    part(bytemuck::cast_slice(&scene.lights));
    part(bytemuck::cast_slice(&scene.environment));
    if let Some(map) = &scene.environment_map {
        part(bytemuck::cast_slice(&[map.width, map.height]));
        part(bytemuck::cast_slice(&map.texels));
        part(bytemuck::cast_slice(&map.to_world));
    }
    part(bytemuck::cast_slice(&scene.media));
    part(bytemuck::cast_slice(&scene.grids));
    part(bytemuck::cast_slice(&scene.grid_values));
    part(scene.camera.as_ref().map_or(&[], |c| bytemuck::bytes_of(c)));
    hash.finalize().to_hex()[..32].to_owned()
}

/// Refuses an output whose folder is missing before any work is spent on it.
pub(super) fn check_folder(file: &Path) -> Result<(), CliError> {
    match file.parent() {
        Some(folder) if !folder.as_os_str().is_empty() && !folder.is_dir() => {
            Err(CliError::NoFolder { file: file.display().to_string() })
        }
        _ => Ok(()),
    }
}

/// Points as a backend asks for them.
pub(super) fn probes_of(points: &[crate::io::Probe]) -> Vec<Probe> {
    points.iter().map(|p| Probe { position: p.position, normal: p.normal }).collect()
}

/// Writes points with the irradiance that an outcome has for them.
pub(super) fn write_outcome(
    path: &Path,
    points: &mut [crate::io::Probe],
    outcome: &Outcome,
) -> Result<(), CliError> {
    for (i, p) in points.iter_mut().enumerate() {
        p.irradiance = Some(outcome.film.mean(i).map(|x| x as f32));
        p.stderr = outcome.film.standard_error(i).map(|v| v.map(|x| x as f32));
    }
    Ok(write_points(path, points)?)
}

/// Mean radiance, variance of the mean and sample count of an image job.
pub(super) fn image_of(outcome: &Outcome, metadata: String) -> RenderImage {
    let film = &outcome.film;
    let rgb = |v: [f64; 3]| v.map(|x| x as f32);
    let variance = (0..film.len()).map(|i| film.variance(i).map(rgb)).collect();
    RenderImage {
        width: film.settings().width,
        height: film.settings().height,
        radiance: (0..film.len()).map(|i| rgb(film.mean(i))).collect(),
        variance,
        sample_count: Some(vec![film.samples() as f32; film.len()]),
        metadata,
    }
}

/// Writes the EXR and, where asked for, the PNG.
pub(super) fn write_image(
    image: &RenderImage,
    exr: &Path,
    png: Option<&Path>,
    tone: ToneSettings,
) -> Result<(), CliError> {
    write_exr(exr, image)?;
    if let Some(png) = png {
        let pixels: Vec<[u8; 3]> = image.radiance.iter().map(|p| display_srgb8(tone, *p)).collect();
        write_png(png, image.width, image.height, &pixels)?;
    }
    Ok(())
}
