//! Pictures for the page: what each method makes of the same time, and where it is off.

use super::figures::times;
use super::measure::Measured;
use super::runs::Curve;
use super::summary::Summary;
use crate::metrics::auto_exposure;
use base64::Engine as _;
use etendue_core::tone::{ToneMap, ToneSettings, display_srgb8};
use image::{ExtendedColorType, ImageEncoder as _};

/// Differences of this part of the reference show in full colour.
const FULL: f32 = 0.2;
/// The reference counts as at least this part of its mean: black is not infinitely wrong.
const LEAST: f32 = 0.05;

/// One picture with its error beside it.
#[derive(Clone, Debug)]
pub(super) struct Shown {
    pub name: String,
    pub words: String,
    /// As `data:` addresses.
    pub picture: String,
    pub error: String,
}

/// The pictures of a report.
#[derive(Clone, Debug)]
pub(super) struct Pictures {
    /// Seconds that all had, about.
    pub seconds: f64,
    pub reference: String,
    pub list: Vec<Shown>,
}

fn address(size: (u32, u32), pixels: &[[u8; 3]]) -> Option<String> {
    let mut png = Vec::new();
    let bytes: Vec<u8> = pixels.iter().flatten().copied().collect();
    image::codecs::png::PngEncoder::new(&mut png)
        .write_image(&bytes, size.0, size.1, ExtendedColorType::Rgb8)
        .ok()?;
    Some(format!("data:image/png;base64,{}", base64::engine::general_purpose::STANDARD.encode(png)))
}

/// Red where too bright, blue where too dark, white where right.
fn difference(x: [f32; 3], r: [f32; 3], least: f32) -> [u8; 3] {
    let luminance = |p: [f32; 3]| 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2];
    let (x, r) = (luminance(x), luminance(r));
    let d = ((x - r) / (FULL * r.max(least))).clamp(-1.0, 1.0);
    if !d.is_finite() {
        return [255, 0, 255];
    }
    let fade = |k: f32| (255.0 * (1.0 - k * d.abs())) as u8;
    if d > 0.0 { [fade(0.25), fade(0.9), fade(0.85)] } else { [fade(0.9), fade(0.7), fade(0.2)] }
}

impl Pictures {
    /// Of each curve the rung whose seconds are nearest to those that all can have; `None` where images are not at hand.
    pub(super) fn new(measured: &Measured, summary: &Summary) -> Option<Self> {
        let size = measured.reference.size;
        let reference = &measured.reference.radiance;
        let settings = ToneSettings {
            map: ToneMap::Reinhard,
            exposure: auto_exposure(reference, None),
            ..ToneSettings::default()
        };
        let show = |image: &[[f32; 3]]| {
            address(size, &image.iter().map(|p| display_srgb8(settings, *p)).collect::<Vec<_>>())
        };
        // The time of path tracing's highest rung, or of the first curve there is.
        let path = Curve::new("path", "", "cpu");
        let base = summary.curve(&path).or(summary.curves.first())?;
        let seconds = base.cells.last()?.seconds.median;
        let mean = reference.iter().flatten().sum::<f32>() / (3 * reference.len().max(1)) as f32;
        let mut list = Vec::new();
        for curve in &summary.curves {
            let far = |s: f64| (s / seconds).ln().abs();
            let nearest =
                curve.cells.iter().min_by(|a, b| far(a.seconds.median).total_cmp(&far(b.seconds.median)))?;
            let Some(sums) = measured.sums.get(&(curve.curve.clone(), nearest.rung)) else { continue };
            let wrong: Vec<[u8; 3]> =
                sums.radiance.iter().zip(reference).map(|(x, r)| difference(*x, *r, LEAST * mean)).collect();
            list.push(Shown {
                name: curve.name.clone(),
                words: format!(
                    "{} in {:.2} s ({} the time), error {:.2} %",
                    nearest.effort,
                    nearest.seconds.median,
                    times(nearest.seconds.median / seconds),
                    100.0 * nearest.rel_error.median
                ),
                picture: show(&sums.radiance)?,
                error: address(size, &wrong)?,
            });
        }
        Some(Self { seconds, reference: show(reference)?, list })
    }
}
