//! Distribution functions and corrections that the statistical comparisons share.
//!
//! All are total: a probability outside \[0, 1\] is clamped, NaN counts as "nothing known" and takes the
//! value that rejects nothing (a quantile of infinity, a survival of 1). Distribution functions come from the
//! crate `statrs`; its panics and its domain are fenced off here.

use statrs::distribution::{ChiSquared, ContinuousCDF, StudentsT};
use statrs::function::erf;
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

/// Share of a standard normal below `z`. Relative error below 1e-9 for z > -30, tails included (found: 6e-11).
/// NaN gives 1/2.
pub fn normal_cdf(z: f64) -> f64 {
    if z.is_nan() { 0.5 } else { 0.5 * erf::erfc(-z * FRAC_1_SQRT_2) }
}

/// Share of a standard normal above `z`, without the cancellation of `1 - cdf`. NaN gives 1/2.
pub fn normal_survival(z: f64) -> f64 {
    normal_cdf(-z)
}

/// The `z` with [`normal_cdf`]`(z) = p`; relative error below 1e-9 for p down to 1e-300.
///
/// p <= 0 gives minus infinity, p >= 1 plus infinity, NaN plus infinity.
pub fn normal_quantile(p: f64) -> f64 {
    if p.is_nan() || p >= 1.0 {
        f64::INFINITY
    } else if p <= 0.0 {
        f64::NEG_INFINITY
    } else {
        -SQRT_2 * erf::erfc_inv(2.0 * p)
    }
}

/// The `z` that a standard normal exceeds in absolute value with probability `alpha`.
pub fn normal_two_sided(alpha: f64) -> f64 {
    if alpha.is_nan() { f64::INFINITY } else { -normal_quantile(0.5 * alpha.clamp(0.0, 1.0)) }
}

/// Sidak's correction: the level of each of `n` independent tests whose family errs with probability `alpha`,
/// `1 - (1 - alpha)^(1/n)` (Sidak 1967), without cancellation. `n` = 0 counts as 1.
pub fn sidak(alpha: f64, n: u64) -> f64 {
    if alpha.is_nan() {
        return 0.0;
    }
    -((-alpha.clamp(0.0, 1.0)).ln_1p() / n.max(1) as f64).exp_m1()
}

/// Probability that a chi-square variable with `df` degrees of freedom exceeds `statistic`.
///
/// Relative error below 1e-9 for df up to 1e4 where the value is above 1e-200; above 1e8 degrees absolute error
/// below 1e-6 (a normal stands in). `df` <= 0 is the constant 0.
/// A NaN statistic gives 0: what could not be computed does not pass.
pub fn chi_square_survival(statistic: f64, df: f64) -> f64 {
    if statistic.is_nan() || df.is_nan() {
        return 0.0;
    }
    if statistic <= 0.0 {
        return 1.0;
    }
    if df.is_infinite() {
        return if df > 0.0 { 1.0 } else { 0.0 };
    }
    if statistic.is_infinite() || df <= 0.0 {
        return 0.0;
    }
    if df > 1e8 {
        // Wilson and Hilferty (1931): the cube root of chi-square / df is nearly normal. The series below
        // takes about sqrt(df) terms and would seem to hang.
        let spread = 2.0 / (9.0 * df);
        return normal_survival(((statistic / df).cbrt() - (1.0 - spread)) / spread.sqrt());
    }
    // The constructor refuses only what was handled above.
    ChiSquared::new(df).map_or(1.0, |d| d.sf(statistic)).clamp(0.0, 1.0)
}

/// The `t` below which a Student variable with `df` degrees of freedom falls with probability `p`.
///
/// p <= 0 gives minus infinity, p >= 1 or NaN plus infinity. `df` <= 0 or NaN knows nothing: infinite with
/// the sign of p - 1/2. Above 1e8 degrees the normal quantile stands in (they differ by 1e-8 relative).
pub fn student_t_quantile(p: f64, df: f64) -> f64 {
    if p.is_nan() || p >= 1.0 {
        return f64::INFINITY;
    }
    if p <= 0.0 {
        return f64::NEG_INFINITY;
    }
    if p == 0.5 {
        return 0.0;
    }
    let unknown = if p > 0.5 { f64::INFINITY } else { f64::NEG_INFINITY };
    if df.is_nan() || df <= 0.0 {
        return unknown;
    }
    if df > 1e8 {
        return normal_quantile(p);
    }
    StudentsT::new(0.0, 1.0, df).map_or(unknown, |d| d.inverse_cdf(p))
}

/// The `t` that a Student variable with `df` degrees of freedom exceeds in absolute value with probability
/// `alpha`.
pub fn student_t_two_sided(alpha: f64, df: f64) -> f64 {
    if alpha.is_nan() { f64::INFINITY } else { -student_t_quantile(0.5 * alpha.clamp(0.0, 1.0), df) }
}

/// Mean of independent values and the variance of that mean, `s^2 / n` with `s^2` over `n - 1`.
///
/// The variance of fewer than two values is unknown: infinite. No values have mean 0.
pub fn mean_and_variance_of_mean(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    if values.is_empty() {
        return (0.0, f64::INFINITY);
    }
    let mean = values.iter().sum::<f64>() / n;
    if values.len() < 2 {
        return (mean, f64::INFINITY);
    }
    let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
    (mean, squares / (n - 1.0) / n)
}

/// The percentile `q` in \[0, 1\] of ascending values, linear between order statistics (Hyndman and Fan 1996,
/// type 7). No values give 0.
pub fn percentile_of_sorted(sorted: &[f64], q: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return 0.0 };
    let position = if q.is_nan() { 0.0 } else { q.clamp(0.0, 1.0) * last as f64 };
    // Truncation of a number in 0..=last.
    let below = position as usize;
    let t = position - below as f64;
    let low = sorted[below];
    // Without the branch an infinite neighbour would give 0 * infinity.
    if t == 0.0 || below == last || low == sorted[below + 1] {
        low
    } else {
        low + t * (sorted[below + 1] - low)
    }
}
