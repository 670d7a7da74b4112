//! How far an image x is from a reference r: one definition of each number, cited everywhere.
//!
//! | name | meaning |
//! |---|---|
//! | `rel_error` | `sqrt(sum A \|x - r\|^2 / sum A \|r\|^2)` over elements (A area) or pixels (A = 1), RGB norm |
//! | `rel_mse` | mean over pixels and channels of `(x - r)^2 / (r^2 + 0.01)`, as others print it |
//! | `bias`, `bias_interval` | `mean(x) / mean(r) - 1` per channel and its 99 % interval |
//! | `block_ratio` | 5, 50 and 95 percentile of 32-pixel block means, x over r |
//! | `worst_block` | greatest relative difference of a block mean |
//! | `energy_error` | `sum(x) / sum(r) - 1` over all pixels and channels |
//! | `z_pass`, `z_fail`, `mean_z2` | share of pixels that pass (fail) the z test; mean of z^2 (1 when only noise differs) |
//! | `flip` | mean FLIP difference of the tone-mapped images |
//!
//! A black pixel of the mask is left out of every number. A pixel that is not finite in x or in r is left out
//! of the means as well, but counted, fails the z test, and makes [`Metrics::exceeds`] true for every limit:
//! an image with a NaN never passes. All numbers except `rel_mse` (whose 0.01 is in the units of the image)
//! stay the same when both images are multiplied by one factor.
//!
//! Sums run in f64 in the order of the pixels: the same input gives the same bits on one platform.
#![allow(
    clippy::disallowed_methods,
    reason = "measuring is f64 on the host; nothing here feeds a kernel or a backend"
)]

mod error;
mod estimate;
pub mod flip;
pub mod replicates;
mod report;
pub mod statistics;

pub use error::MetricsError;
pub use estimate::rel_error;
pub use report::{MetricValue, Metrics};

use etendue_core::tone::{self, ToneMap, ToneSettings};

/// Side of the square blocks of `block_ratio` and `worst_block`, in pixels.
pub const BLOCK: usize = 32;
/// Level of the z test over the whole image.
pub const Z_ALPHA: f64 = 0.01;
/// The share of pixels from which on two renders agree.
pub const Z_AGREE: f64 = 0.9975;
/// Confidence of `bias_interval`.
pub const CONFIDENCE: f64 = 0.99;

/// Two linear images of one size, row by row from the top, and what is known of their noise.
#[derive(Clone, Copy, Debug)]
pub struct MetricsInput<'a> {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// The image under test: linear RGB, any unit.
    pub x: &'a [[f32; 3]],
    /// The reference, in the unit of `x`.
    pub r: &'a [[f32; 3]],
    /// Variance of the mean of each pixel of `x` (unit squared), from its own sample blocks. The z test and,
    /// without replicates, `bias_interval` need it; zeros say that x is exact.
    pub var_x: Option<&'a [[f32; 3]]>,
    /// Variance of the mean of each pixel of `r`; None takes the reference as exact.
    pub var_r: Option<&'a [[f32; 3]]>,
    /// True where a pixel counts; None counts all.
    pub mask: Option<&'a [bool]>,
    /// Independent renders whose mean is `x`, at least two; or empty. They give `bias_interval` without the
    /// assumption that pixels err independently, which one scramble shared by all pixels breaks.
    pub replicates: &'a [&'a [[f32; 3]]],
    /// How both images are mapped for FLIP; None is Reinhard with the exposure of [`auto_exposure`].
    pub tone: Option<ToneSettings>,
    /// Viewing distance of FLIP, 1 to 1000 pixels per degree.
    pub pixels_per_degree: f64,
}

impl<'a> MetricsInput<'a> {
    /// Two images, all pixels, nothing known of their noise, FLIP with its defaults.
    pub fn new(width: usize, height: usize, x: &'a [[f32; 3]], r: &'a [[f32; 3]]) -> Self {
        Self {
            width,
            height,
            x,
            r,
            var_x: None,
            var_r: None,
            mask: None,
            replicates: &[],
            tone: None,
            pixels_per_degree: flip::DEFAULT_PIXELS_PER_DEGREE,
        }
    }
}

fn pixel_count(width: usize, height: usize) -> Result<usize, MetricsError> {
    match width.checked_mul(height) {
        Some(n) if n > 0 && n <= isize::MAX as usize / 64 => Ok(n),
        _ => Err(MetricsError::BadDimensions { width, height }),
    }
}

fn finite(p: &[f32; 3]) -> bool {
    p.iter().all(|v| v.is_finite())
}

/// The pixels that enter the means, and those that had to be left out.
struct Selection {
    used: Vec<bool>,
    /// Pixels the mask leaves.
    pixels: usize,
    /// Of these finite in both images.
    usable: usize,
    non_finite_x: usize,
    non_finite_r: usize,
}

fn select(input: &MetricsInput<'_>) -> Result<Selection, MetricsError> {
    let n = pixel_count(input.width, input.height)?;
    let check = |what, found| match found {
        found if found == n => Ok(()),
        found => Err(MetricsError::SizeMismatch { what, found, expected: n }),
    };
    check("x", input.x.len())?;
    check("r", input.r.len())?;
    check("var_x", input.var_x.map_or(n, <[_]>::len))?;
    check("var_r", input.var_r.map_or(n, <[_]>::len))?;
    check("mask", input.mask.map_or(n, <[_]>::len))?;
    for replicate in input.replicates {
        check("replicates", replicate.len())?;
    }
    if input.replicates.len() == 1 {
        return Err(MetricsError::SingleReplicate);
    }

    let mut s = Selection { used: vec![false; n], pixels: 0, usable: 0, non_finite_x: 0, non_finite_r: 0 };
    for i in 0..n {
        if !input.mask.is_none_or(|m| m[i]) {
            continue;
        }
        let (x, r) = (finite(&input.x[i]), finite(&input.r[i]));
        s.pixels += 1;
        s.non_finite_x += usize::from(!x);
        s.non_finite_r += usize::from(!r);
        s.usable += usize::from(x && r);
        s.used[i] = x && r;
    }
    if s.pixels == 0 {
        return Err(MetricsError::EmptyMask { pixels: n });
    }
    if s.usable == 0 {
        return Err(MetricsError::NothingFinite {
            pixels: s.pixels,
            non_finite_x: s.non_finite_x,
            non_finite_r: s.non_finite_r,
        });
    }

    let require = |what, expected, image: &[[f32; 3]], good: fn(&[f32; 3]) -> bool| {
        let mut bad = (0..n).filter(|&i| s.used[i] && !good(&image[i]));
        match bad.next() {
            None => Ok(()),
            Some(first) => Err(MetricsError::BadValues {
                what,
                expected,
                count: 1 + bad.count(),
                x: first % input.width,
                y: first / input.width,
            }),
        }
    };
    for (what, variance) in [("var_x", input.var_x), ("var_r", input.var_r)] {
        if let Some(v) = variance {
            require(what, "finite and at least 0", v, |p| finite(p) && p.iter().all(|v| *v >= 0.0))?;
        }
    }
    for replicate in input.replicates {
        require("replicates", "finite", replicate, finite)?;
    }
    Ok(s)
}

/// The exposure in stops that maps the reference's median luminance (of the pixels that have any) to 0.18
/// after Reinhard's curve: `log2(0.18 / (1 - 0.18) / median)`. 0 for a black image.
///
/// A median rather than a mean: a light in view does not darken the room. `mask` as in [`MetricsInput`].
pub fn auto_exposure(r: &[[f32; 3]], mask: Option<&[bool]>) -> f32 {
    let counts = |i: usize| mask.is_none_or(|m| m.get(i).copied().unwrap_or(false));
    let mut luminance: Vec<f64> = (r.iter().enumerate())
        .filter(|(i, p)| counts(*i) && finite(p))
        .map(|(_, p)| 0.2126 * f64::from(p[0]) + 0.7152 * f64::from(p[1]) + 0.0722 * f64::from(p[2]))
        .filter(|l| *l > 0.0)
        .collect();
    if luminance.is_empty() {
        return 0.0;
    }
    let middle = luminance.len() / 2;
    let (_, median, _) = luminance.select_nth_unstable_by(middle, f64::total_cmp);
    (0.18 / 0.82 / *median).log2() as f32
}

/// All metrics of x against r.
///
/// `bias_interval`, `z_pass` and `mean_z2` are None where the input knows too little of the noise (see the
/// fields of [`MetricsInput`]).
///
/// # Errors
/// Sizes that do not fit, a mask that leaves nothing, no pixel finite in both images, variances that are
/// negative or not finite, a single replicate, a viewing distance out of range.
pub fn compare(input: &MetricsInput<'_>) -> Result<Metrics, MetricsError> {
    let s = select(input)?;
    let tone = input.tone.unwrap_or_else(|| ToneSettings {
        map: ToneMap::Reinhard,
        exposure: auto_exposure(input.r, Some(&s.used)),
        ..ToneSettings::default()
    });
    // FLIP starts from the light of the display: only the gamma curve has to be shown and decoded for that.
    let shown = |image: &[[f32; 3]]| -> Vec<[f32; 3]> {
        // Where a pixel does not count, both images show the reference: no difference leaks out of the mask.
        let pixel = |i: usize| if s.used[i] { image[i] } else { input.r[i] };
        (0..image.len())
            .map(|i| match tone.map {
                ToneMap::Gamma => tone::display(tone, pixel(i)),
                ToneMap::Reinhard | ToneMap::None => tone::apply(tone, pixel(i)),
            })
            .collect()
    };
    let measure = if tone.map == ToneMap::Gamma { flip::flip_map } else { flip::flip_map_linear };
    let (r, x) = (shown(input.r), shown(input.x));
    let map = measure(input.width, input.height, &r, &x, input.pixels_per_degree)?;
    let flip_sum: f64 = map.iter().zip(&s.used).filter(|(_, u)| **u).map(|(v, _)| f64::from(*v)).sum();

    let sums = estimate::Sums::new(input, &s);
    let blocks = estimate::Blocks::new(input, &s);
    let z = estimate::z_test(input, &s);
    Ok(Metrics {
        rel_error: sums.rel_error(),
        rel_mse: sums.rel_mse(),
        bias: sums.bias(),
        bias_interval: estimate::bias_interval(input, &s, &sums),
        block_ratio: blocks.ratio(),
        worst_block: blocks.worst(&sums),
        energy_error: sums.energy_error(),
        z_pass: z.map(|z| z.0),
        mean_z2: z.map(|z| z.1),
        flip: flip_sum / s.usable as f64,
        flip_exposure: tone.exposure,
        pixels: s.pixels as u64,
        non_finite_x: s.non_finite_x as u64,
        non_finite_r: s.non_finite_r as u64,
    })
}
