//! The image that all others are measured against, and how good it is.

use super::{Picture, ReportError};
use crate::driver::{Outcome, estimate_error};
use crate::io::{RenderImage, SaveError, read_exr, write_exr};
use etendue_core::film::Film;
use serde_json::json;
use std::path::Path;

/// Its file in the folder of a report.
const FILE: &str = "reference.exr";

/// A reference image.
#[derive(Clone, Debug)]
pub struct Reference {
    /// Pixels across and down.
    pub size: (u32, u32),
    /// Radiance per pixel.
    pub radiance: Vec<[f32; 3]>,
    /// Variance of the mean per pixel; `None`: taken as exact.
    pub variance: Option<Vec<[f32; 3]>>,
    /// Where it comes from, in words.
    pub made_by: String,
    /// Seconds that it took, if it was made now.
    pub seconds: f64,
}

fn narrow(v: [f64; 3]) -> [f32; 3] {
    v.map(|x| x as f32)
}

/// Means of a film.
pub(super) fn radiance_of(film: &Film) -> Vec<[f32; 3]> {
    (0..film.len()).map(|i| narrow(film.mean(i))).collect()
}

/// Variances of its means; `None` below two blocks.
pub(super) fn variance_of(film: &Film) -> Option<Vec<[f32; 3]>> {
    (0..film.len()).map(|i| film.variance(i).map(narrow)).collect()
}

impl Reference {
    /// From an image file.
    pub fn of_image(image: RenderImage, made_by: String) -> Self {
        let RenderImage { width, height, radiance, variance, .. } = image;
        Self { size: (width, height), radiance, variance, made_by, seconds: 0.0 }
    }

    /// From a job that has ended. `None` below two blocks: nothing would be known of its error.
    pub fn of_outcome(outcome: &Outcome, made_by: String) -> Option<Self> {
        estimate_error(&outcome.film)?;
        let settings = outcome.film.settings();
        Some(Self {
            size: (settings.width, settings.height),
            radiance: radiance_of(&outcome.film),
            variance: variance_of(&outcome.film),
            made_by: format!("{made_by}, {} samples", outcome.film.samples()),
            seconds: outcome.seconds,
        })
    }

    /// Keeps it in a folder, for later reports of the scene of this hash.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub(super) fn keep(&self, folder: &Path, scene_hash: &str) -> Result<(), SaveError> {
        let image = RenderImage {
            width: self.size.0,
            height: self.size.1,
            radiance: self.radiance.clone(),
            variance: self.variance.clone(),
            sample_count: None,
            metadata: json!({ "scene_hash": scene_hash, "made_by": self.made_by }).to_string(),
        };
        write_exr(&folder.join(FILE), &image)
    }

    /// That which an earlier report has kept in a folder, if it is of this scene and size.
    pub fn kept(folder: &Path, scene_hash: &str, size: (u32, u32)) -> Option<Self> {
        let image = read_exr(&folder.join(FILE)).ok()?;
        let about: serde_json::Value = serde_json::from_str(&image.metadata).ok()?;
        let made_by = format!("{} (of an earlier report)", about["made_by"].as_str()?);
        let same = about["scene_hash"] == scene_hash && (image.width, image.height) == size;
        same.then(|| Self::of_image(image, made_by))
    }

    /// Its own standard error: `[rel_error, root of rel_mse]`. Zeros where it is taken as exact.
    pub fn error(&self, mask: Option<&[bool]>) -> [f64; 2] {
        let Some(variance) = &self.variance else { return [0.0; 2] };
        let (mut sum, mut square, mut relative, mut count) = (0.0, 0.0, 0.0, 0_u64);
        for (i, (v, r)) in variance.iter().zip(&self.radiance).enumerate() {
            if mask.is_some_and(|m| !m[i]) {
                continue;
            }
            for (v, r) in v.iter().zip(r) {
                let (v, r2) = (f64::from(*v), f64::from(*r).powi(2));
                sum += v;
                square += r2;
                relative += v / (r2 + 0.01);
                count += 1;
            }
        }
        if square <= 0.0 {
            return [0.0; 2];
        }
        [(sum / square).sqrt(), (relative / count.max(1) as f64).sqrt()]
    }

    /// Standard error of the mean of all pixels, relative, per channel; pixels err independently.
    pub fn energy_error(&self, mask: Option<&[bool]>) -> [f64; 3] {
        let Some(variance) = &self.variance else { return [0.0; 3] };
        [0, 1, 2].map(|c| {
            let counts = |i: &usize| mask.is_none_or(|m| m[*i]);
            let pixels = || (0..self.radiance.len()).filter(counts);
            let v: f64 = pixels().map(|i| f64::from(variance[i][c])).sum();
            let sum: f64 = pixels().map(|i| f64::from(self.radiance[i][c])).sum();
            if sum > 0.0 { v.sqrt() / sum } else { 0.0 }
        })
    }

    /// Whether it has the size of a picture of that size.
    ///
    /// # Errors
    /// [`ReportError::OtherSize`].
    pub fn check(&self, size: (u32, u32)) -> Result<(), ReportError> {
        if self.size == size {
            return Ok(());
        }
        Err(ReportError::OtherSize { found: self.size, expected: size })
    }
}

/// How good an unbiased picture is for its time: one over its variance (relative) and its seconds. `None` where it does not tell its variance, or is black.
pub(super) fn efficiency(picture: &Picture) -> Option<f64> {
    let variance = picture.variance.as_ref()?;
    let sum = |list: &[[f32; 3]], power: i32| -> f64 {
        list.iter().flatten().map(|x| f64::from(*x).powi(power)).sum()
    };
    let relative = sum(variance, 1) / sum(&picture.radiance, 2);
    (relative.is_finite() && relative > 0.0).then(|| 1.0 / (relative * picture.seconds().max(1e-9)))
}
