//! Sums over pixels and blocks, and what follows from them.

use super::{BLOCK, CONFIDENCE, MetricsError, MetricsInput, Selection, Z_ALPHA, statistics};

type Rgb = [f64; 3];

fn wide(p: [f32; 3]) -> Rgb {
    p.map(f64::from)
}

/// `a / b` where both are differences or sums of like things: 0/0 is `equal`, else division as it comes, and
/// what is still no number is infinite.
fn ratio(a: f64, b: f64, equal: f64) -> f64 {
    match a / b {
        _ if a == 0.0 && b == 0.0 => equal,
        q if q.is_nan() => f64::INFINITY,
        q => q,
    }
}

/// `sqrt(sum A |x - r|^2 / sum A |r|^2)` over elements, RGB norm; `areas` None counts each element once.
///
/// 0 where x equals r, infinite where only r is black or where anything is not finite.
///
/// # Errors
/// Arrays of different lengths.
pub fn rel_error(x: &[[f32; 3]], r: &[[f32; 3]], areas: Option<&[f32]>) -> Result<f64, MetricsError> {
    let expected = r.len();
    for (what, found) in [("x", x.len()), ("areas", areas.map_or(expected, <[_]>::len))] {
        if found != expected {
            return Err(MetricsError::SizeMismatch { what, found, expected });
        }
    }
    let (mut error, mut square) = (0.0, 0.0);
    for (i, (x, r)) in x.iter().zip(r).enumerate() {
        let area = areas.map_or(1.0, |a| f64::from(a[i]));
        for (x, r) in wide(*x).into_iter().zip(wide(*r)) {
            error += area * (x - r) * (x - r);
            square += area * r * r;
        }
    }
    Ok(ratio(error, square, 0.0).sqrt())
}

/// Sums over the pixels that count.
pub(super) struct Sums {
    n: f64,
    x: Rgb,
    r: Rgb,
    error: f64,
    square: f64,
    relative: f64,
}

impl Sums {
    pub(super) fn new(input: &MetricsInput<'_>, s: &Selection) -> Self {
        let mut sums =
            Self { n: s.usable as f64, x: [0.0; 3], r: [0.0; 3], error: 0.0, square: 0.0, relative: 0.0 };
        for i in (0..s.used.len()).filter(|i| s.used[*i]) {
            let (x, r) = (wide(input.x[i]), wide(input.r[i]));
            for c in 0..3 {
                let e = (x[c] - r[c]) * (x[c] - r[c]);
                sums.x[c] += x[c];
                sums.r[c] += r[c];
                sums.error += e;
                sums.square += r[c] * r[c];
                sums.relative += e / (r[c] * r[c] + 0.01);
            }
        }
        sums
    }

    pub(super) fn rel_error(&self) -> f64 {
        ratio(self.error, self.square, 0.0).sqrt()
    }

    pub(super) fn rel_mse(&self) -> f64 {
        self.relative / (3.0 * self.n)
    }

    pub(super) fn bias(&self) -> Rgb {
        [0, 1, 2].map(|c| ratio(self.x[c], self.r[c], 1.0) - 1.0)
    }

    pub(super) fn energy_error(&self) -> f64 {
        ratio(self.x.iter().sum(), self.r.iter().sum(), 1.0) - 1.0
    }

    /// Norm of the reference's mean.
    fn mean_norm(&self) -> f64 {
        norm(self.r) / self.n
    }
}

fn norm(v: Rgb) -> f64 {
    (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt()
}

/// The 99 % interval of the bias per channel, to first order in the noise of both means.
///
/// From replicates: mean of the replicates' own biases, Student's t with one degree less than replicates.
/// Else from `var_x`, pixels taken as independent, normal. The reference's own variance, where known, widens
/// both: `var(bias) = (var X + (X/R)^2 var R) / R^2` for means X and R.
pub(super) fn bias_interval(input: &MetricsInput<'_>, s: &Selection, sums: &Sums) -> Option<[[f64; 2]; 3]> {
    let used = || (0..s.used.len()).filter(|i| s.used[*i]);
    let total = |image: &[[f32; 3]], c: usize| -> f64 { used().map(|i| f64::from(image[i][c])).sum() };
    if input.replicates.is_empty() && input.var_x.is_none() {
        return None;
    }
    Some([0, 1, 2].map(|c| {
        let r = sums.r[c];
        let reference_variance = input.var_r.map_or(0.0, |v| total(v, c));
        let (x, x_variance, width) = if input.replicates.is_empty() {
            let variance = input.var_x.map_or(0.0, |v| total(v, c));
            (sums.x[c], variance, statistics::normal_two_sided(1.0 - CONFIDENCE))
        } else {
            let sums: Vec<f64> = input.replicates.iter().map(|image| total(image, c)).collect();
            let (mean, variance) = statistics::mean_and_variance_of_mean(&sums);
            (mean, variance, statistics::student_t_two_sided(1.0 - CONFIDENCE, sums.len() as f64 - 1.0))
        };
        let center = ratio(x, r, 1.0);
        if r == 0.0 {
            // A black channel: either nothing differs or no relative statement holds.
            let exact = x == 0.0 && x_variance == 0.0 && reference_variance == 0.0;
            return if exact { [0.0, 0.0] } else { [f64::NEG_INFINITY, f64::INFINITY] };
        }
        let half = width * (x_variance + center * center * reference_variance).sqrt() / r.abs();
        [center - 1.0 - half, center - 1.0 + half]
    }))
}

/// Sums of x and r over 32-pixel blocks.
pub(super) struct Blocks {
    /// Pixels that count, sum of x, sum of r; only blocks that take part.
    blocks: Vec<(f64, Rgb, Rgb)>,
}

impl Blocks {
    /// Blocks start at the top left; those at the right and bottom edge are cut. A block takes part when at
    /// least a quarter of its full 32 x 32 pixels counts, or, when no block has as many, when any does.
    pub(super) fn new(input: &MetricsInput<'_>, s: &Selection) -> Self {
        let across = input.width.div_ceil(BLOCK);
        let mut blocks = vec![(0.0, [0.0; 3], [0.0; 3]); across * input.height.div_ceil(BLOCK)];
        for i in (0..s.used.len()).filter(|i| s.used[*i]) {
            let (column, row) = (i % input.width, i / input.width);
            let (count, sum_x, sum_r) = &mut blocks[row / BLOCK * across + column / BLOCK];
            *count += 1.0;
            for c in 0..3 {
                sum_x[c] += f64::from(input.x[i][c]);
                sum_r[c] += f64::from(input.r[i][c]);
            }
        }
        let quarter = (BLOCK * BLOCK / 4) as f64;
        let most = blocks.iter().map(|b| b.0).fold(0.0, f64::max);
        let least = if most >= quarter { quarter } else { 1.0 };
        blocks.retain(|b| b.0 >= least);
        Self { blocks }
    }

    /// 5, 50 and 95 percentile of (mean of x) / (mean of r), channels summed. Two black blocks agree: 1.
    pub(super) fn ratio(&self) -> Rgb {
        let sum = |v: &Rgb| v.iter().sum::<f64>();
        let mut ratios: Vec<f64> = self.blocks.iter().map(|(_, x, r)| ratio(sum(x), sum(r), 1.0)).collect();
        ratios.sort_unstable_by(f64::total_cmp);
        [0.05, 0.5, 0.95].map(|q| statistics::percentile_of_sorted(&ratios, q))
    }

    /// Greatest `|mean x - mean r| / |mean r|` of a block, RGB norm; a block darker than 1 % of the whole
    /// reference is measured against that 1 %, so that a black corner does not decide.
    pub(super) fn worst(&self, sums: &Sums) -> f64 {
        let floor = 0.01 * sums.mean_norm();
        (self.blocks.iter())
            .map(|(n, x, r)| {
                let difference = [0, 1, 2].map(|c| (x[c] - r[c]) / n);
                ratio(norm(difference), (norm(*r) / n).max(floor), 0.0)
            })
            .fold(0.0, f64::max)
    }
}

/// Share of pixels that pass the z test, and the mean of z^2.
///
/// `z = (x - r) / sqrt(var_x + var_r)` per channel; a pixel passes when every channel has |z| at most the
/// two-sided normal quantile at Sidak's level for [`Z_ALPHA`] over the pixels of the mask. Without variance
/// equal values pass, different ones fail. The mean of z^2 is over the channels that have variance (0 if none
/// has). Pixels that are not finite fail.
///
/// A variance from B sample blocks is itself noisy: z is Student's with B - 1 degrees, so that the mean of z^2
/// is (B - 1) / (B - 3) and, at 65 536 pixels, 0.4 % of the pixels fail of themselves at B = 8, 0.03 % at 16.
/// From 16 blocks on the limit of 0.25 % is honest.
pub(super) fn z_test(input: &MetricsInput<'_>, s: &Selection) -> Option<(f64, f64)> {
    let var_x = input.var_x?;
    let limit = statistics::normal_two_sided(statistics::sidak(Z_ALPHA, s.pixels as u64));
    let (mut passed, mut squares, mut measured) = (0_usize, 0.0, 0_usize);
    for i in (0..s.used.len()).filter(|i| s.used[*i]) {
        let (x, r, vx) = (wide(input.x[i]), wide(input.r[i]), wide(var_x[i]));
        let vr = input.var_r.map_or([0.0; 3], |v| wide(v[i]));
        let mut pass = true;
        for c in 0..3 {
            let (difference, variance) = (x[c] - r[c], vx[c] + vr[c]);
            if variance == 0.0 {
                pass &= difference == 0.0;
                continue;
            }
            let z2 = difference * difference / variance;
            squares += z2;
            measured += 1;
            pass &= z2 <= limit * limit;
        }
        passed += usize::from(pass);
    }
    Some((passed as f64 / s.pixels as f64, squares / measured.max(1) as f64))
}
