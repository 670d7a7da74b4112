//! Golden images: small scenes without an exact answer, rendered once by the scalar reference and kept as text.
//!
//! The reference is the only producer; every backend is compared to it, pixel by pixel with both variances and as a
//! mean. `cargo run --release -p etendue-conformance --example bless` writes the files anew; no test does.

use crate::analytic::{BLOCKS, Estimator, compiled, estimates, render};
use crate::reference::ReferenceBackend;
use crate::statistics::{sidak, t_quantile};
use crate::suite::Level;
use crate::trios::Finding;
use etendue_core::backend::{Backend, BackendError, PathJob};

mod make;

pub use make::scenes;

/// Joint level of the comparison of all pixels of an image, as the project's metric `z_pass` has it.
const PIXEL_ALPHA: f64 = 0.01;
/// Level of the comparison of an image's means.
const MEAN_ALPHA: f64 = 1e-4;
/// Least share of pixels that must agree.
const PIXEL_SHARE: f64 = 0.9975;
/// The same where samples are spared.
const THRIFTY_SHARE: f64 = 0.99;
/// Relative error that f32 may have beyond the noise.
const ROUNDING: f64 = 2e-5;
/// The mean must be known this well, or the comparison has no power.
const MEAN_POWER: f64 = 0.01;
/// Samples per pixel of a golden.
const GOLDEN_SAMPLES: u32 = 16_384;
/// Samples per pixel of a quick comparison: blocks of 32, so that their means are nearly normal even where one light
/// is picked seldom; the tails of t presume that.
const QUICK_SAMPLES: u32 = 1024;

/// A scene and its stored image.
#[derive(Clone, Debug)]
pub struct GoldenScene {
    /// Name of the scene and of its file.
    pub name: &'static str,
    /// The scene.
    pub scene: etendue_core::scene::SceneDesc,
    /// The stored text.
    pub text: &'static str,
}

/// Mean and standard error of a pixel, per channel.
type Pixel = [(f64, f64); 3];

fn golden_job(seed: u64, samples: u32) -> PathJob {
    PathJob { seed, block_length: samples / BLOCKS, blocks: 0..BLOCKS, max_depth: u32::MAX }
}

/// The text of a golden, by the scalar reference.
///
/// # Errors
/// When the scene cannot be rendered.
pub fn produce(scene: &GoldenScene) -> Result<String, BackendError> {
    let compiled = compiled(&scene.scene)?;
    let film =
        render(&ReferenceBackend, Estimator::Path, &compiled, None, &golden_job(0x601d, GOLDEN_SAMPLES))?;
    let settings = film.settings();
    let mut text = format!(
        "# {}: {} x {}, {} samples; per pixel: mean r g b, standard error r g b\n",
        scene.name,
        settings.width,
        settings.height,
        film.samples()
    );
    for pixel in estimates(&film, false) {
        let means = pixel.map(|(m, _)| format!("{:e}", m as f32)).join(" ");
        let errors = pixel.map(|(_, s)| format!("{:e}", s as f32)).join(" ");
        text.push_str(&format!("{means} {errors}\n"));
    }
    Ok(text)
}

fn parse(text: &str) -> Option<Vec<Pixel>> {
    text.lines()
        .skip(1)
        .map(|line| {
            let x: Vec<f64> = line.split(' ').map(str::parse).collect::<Result<_, _>>().ok()?;
            (x.len() == 6).then(|| [0, 1, 2].map(|c| (x[c], x[3 + c])))
        })
        .collect()
}

/// Compares a backend's image with the golden.
///
/// # Errors
/// The backend's own.
pub fn check(
    backend: &dyn Backend,
    estimator: Estimator,
    scene: &GoldenScene,
    level: Level,
) -> Result<Vec<Finding>, BackendError> {
    let name = |what: &str| format!("{}golden/{}/{what}", estimator.prefix(), scene.name);
    let Some(stored) = parse(scene.text) else {
        return Ok(vec![(name("pixels"), false, "the stored golden is not readable: bless it".into())]);
    };
    let compiled = compiled(&scene.scene)?;
    let samples = if level == Level::Quick { QUICK_SAMPLES } else { QUICK_SAMPLES * 8 } / estimator.thrift();
    let film = render(backend, estimator, &compiled, None, &golden_job(0xbeef, samples))?;
    let found = estimates(&film, false);
    if found.len() != stored.len() || stored.is_empty() {
        let detail = format!("{} pixels against {} stored: bless it", found.len(), stored.len());
        return Ok(vec![(name("pixels"), false, detail)]);
    }
    let t = t_quantile(sidak(PIXEL_ALPHA, 3 * found.len()), f64::from(BLOCKS) - 1.0);
    let mut agree = 0;
    let (mut worst, mut at) = (0.0_f64, String::new());
    for (i, (a, b)) in found.iter().zip(&stored).enumerate() {
        let mut good = true;
        for c in 0..3 {
            let ((x, sx), (r, sr)) = (a[c], b[c]);
            let allowed = t * (sx * sx + sr * sr).sqrt() + ROUNDING * r.abs();
            let off = (x - r).abs();
            good &= off <= allowed;
            let share = if off == 0.0 { 0.0 } else { off / allowed };
            if share > worst || share.is_nan() {
                worst = share;
                at = format!("pixel {i}: {x:.5} +- {sx:.1e} against {r:.5} +- {sr:.1e}");
            }
        }
        agree += usize::from(good);
    }
    let share = agree as f64 / found.len() as f64;
    // With fewer samples more pixels at edges and of rare light have seen too little to know their noise.
    let enough = if estimator.thrift() > 1 { THRIFTY_SHARE } else { PIXEL_SHARE };
    let mut out = vec![(
        name("pixels"),
        share >= enough && film.invalid() == 0 && film.saturated() == 0,
        format!(
            "{:.2} % of {} pixels agree (at least {:.2} %); {worst:.2} of what is allowed at {at}",
            100.0 * share,
            found.len(),
            100.0 * enough
        ),
    )];
    let power = MEAN_POWER * f64::from(estimator.thrift()).sqrt();
    let t = t_quantile(sidak(MEAN_ALPHA, 3), 1000.0);
    let n = found.len() as f64;
    let (mut passed, mut detail) = (true, String::new());
    for c in 0..3 {
        let mean = |list: &[Pixel]| list.iter().map(|p| p[c].0).sum::<f64>() / n;
        let variance = |list: &[Pixel]| list.iter().map(|p| p[c].1 * p[c].1).sum::<f64>() / (n * n);
        let (x, r) = (mean(&found), mean(&stored));
        let stderr = (variance(&found) + variance(&stored)).sqrt();
        passed &= (x - r).abs() <= t * stderr + ROUNDING * r && stderr <= power * r;
        detail.push_str(&format!("{x:.6} against {r:.6} +- {stderr:.1e}; "));
    }
    out.push((name("mean"), passed, detail));
    Ok(out)
}
