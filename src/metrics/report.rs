//! The numbers by name, for JSON and for limits.

use super::{MetricsError, Z_AGREE};

/// All metrics of an image against a reference; defined in the [module](super).
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Metrics {
    /// Root of the summed squared difference over the summed square of the reference.
    pub rel_error: f64,
    /// Mean of `(x - r)^2 / (r^2 + 0.01)`: the one number that depends on the unit of the image.
    pub rel_mse: f64,
    /// `mean(x) / mean(r) - 1` per channel; 0 where both are black, infinite where only r is.
    pub bias: [f64; 3],
    /// Low and high end of the 99 % interval of the bias per channel. None without variance or replicates.
    pub bias_interval: Option<[[f64; 2]; 3]>,
    /// 5, 50 and 95 percentile of block means of x over those of r, channels summed.
    pub block_ratio: [f64; 3],
    /// Greatest relative difference of a block mean, RGB norm, against at least 1 % of the mean of r.
    pub worst_block: f64,
    /// `sum(x) / sum(r) - 1` over all pixels and channels.
    pub energy_error: f64,
    /// Share of pixels that pass the z test in all channels. None without `var_x`.
    pub z_pass: Option<f64>,
    /// Mean of z^2 over pixels and channels with variance. None without `var_x`.
    pub mean_z2: Option<f64>,
    /// Mean FLIP difference, on \[0, 1\].
    pub flip: f64,
    /// Exposure in stops under which FLIP saw both images.
    pub flip_exposure: f32,
    /// Pixels the mask leaves.
    pub pixels: u64,
    /// Of these not finite in x.
    pub non_finite_x: u64,
    /// Of these not finite in r.
    pub non_finite_r: u64,
}

/// A metric's value as JSON shows it.
#[derive(Clone, Debug, PartialEq)]
pub enum MetricValue {
    /// One number.
    Number(f64),
    /// A list: red, green, blue; or the 5, 50 and 95 percentile.
    List(Vec<f64>),
    /// Low and high end for red, green and blue.
    Intervals(Vec<[f64; 2]>),
    /// A count.
    Count(u64),
}

/// Names that a limit can apply to, in the order of [`Metrics::fields`].
const LIMITS: [&str; 10] = [
    "rel_error",
    "rel_mse",
    "bias",
    "bias_interval",
    "block_ratio",
    "worst_block",
    "energy_error",
    "z_fail",
    "mean_z2",
    "flip",
];

fn greatest(values: impl IntoIterator<Item = f64>) -> f64 {
    // f64::max would drop a NaN.
    values.into_iter().fold(0.0, |a: f64, b| if b.is_nan() || b > a { b } else { a })
}

impl Metrics {
    /// Whether a render agrees with its reference: at least 0.9975 of the pixels pass the z test. None
    /// without variance.
    pub fn agrees(&self) -> Option<bool> {
        self.z_pass.map(|share| share >= Z_AGREE)
    }

    /// Every metric that was measured, by name and in fixed order, for JSON.
    pub fn fields(&self) -> Vec<(&'static str, MetricValue)> {
        use MetricValue::{Count, Intervals, List, Number};
        let mut fields = vec![
            ("rel_error", Number(self.rel_error)),
            ("rel_mse", Number(self.rel_mse)),
            ("bias", List(self.bias.to_vec())),
        ];
        fields.extend(self.bias_interval.map(|v| ("bias_interval", Intervals(v.to_vec()))));
        fields.extend([
            ("block_ratio", List(self.block_ratio.to_vec())),
            ("worst_block", Number(self.worst_block)),
            ("energy_error", Number(self.energy_error)),
        ]);
        if let (Some(pass), Some(z2)) = (self.z_pass, self.mean_z2) {
            fields.extend([
                ("z_pass", Number(pass)),
                ("z_fail", Number(1.0 - pass)),
                ("mean_z2", Number(z2)),
            ]);
        }
        fields.extend([
            ("flip", Number(self.flip)),
            ("flip_exposure", Number(f64::from(self.flip_exposure))),
            ("pixels", Count(self.pixels)),
            ("non_finite_x", Count(self.non_finite_x)),
            ("non_finite_r", Count(self.non_finite_r)),
        ]);
        fields
    }

    /// The one number of a metric that a limit applies to; 0 is perfect (`mean_z2`: 1), larger is worse.
    ///
    /// `bias`: greatest absolute value of a channel. `bias_interval`: greatest distance of an interval from
    /// 0, so 0 while all contain 0. `block_ratio`: greatest absolute value of a percentile less 1.
    /// `energy_error`: absolute. `z_fail`: 1 - `z_pass`. The others: as they are.
    ///
    /// # Errors
    /// A name without an upper limit (among them `z_pass`), or a metric that was not measured.
    pub fn limit_value(&self, name: &str) -> Result<f64, MetricsError> {
        let missing = |needs| MetricsError::NotMeasured { name: name.to_owned(), needs };
        let no_variance = || missing("the variance of x");
        Ok(match name {
            "rel_error" => self.rel_error,
            "rel_mse" => self.rel_mse,
            "bias" => greatest(self.bias.map(f64::abs)),
            "bias_interval" => {
                let interval =
                    self.bias_interval.ok_or_else(|| missing("the variance of x, or replicates"))?;
                greatest(interval.map(|[low, high]| low.max(-high).max(0.0)))
            }
            "block_ratio" => greatest(self.block_ratio.map(|q| (q - 1.0).abs())),
            "worst_block" => self.worst_block,
            "energy_error" => self.energy_error.abs(),
            "z_fail" => 1.0 - self.z_pass.ok_or_else(no_variance)?,
            "mean_z2" => self.mean_z2.ok_or_else(no_variance)?,
            "flip" => self.flip,
            _ => {
                return Err(MetricsError::UnknownMetric { name: name.to_owned(), known: LIMITS.join(", ") });
            }
        })
    }

    /// Whether [`Metrics::limit_value`] lies above `limit` (`--fail-above NAME=LIMIT`).
    ///
    /// Also true when the value is NaN, the limit is NaN, or any pixel under the mask is not finite in x or
    /// in r: what could not be measured does not pass.
    ///
    /// # Errors
    /// As [`Metrics::limit_value`].
    pub fn exceeds(&self, name: &str, limit: f64) -> Result<bool, MetricsError> {
        let value = self.limit_value(name)?;
        let measured = self.non_finite_x == 0 && self.non_finite_r == 0;
        Ok(!(measured && value <= limit))
    }
}
