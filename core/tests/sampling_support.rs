//! Statistics in f64 for the sampling tests: the chi-square survival function and what decides with it.
//!
//! Every test that rejects at random states its alpha; with `m` such tests in one run each uses Sidak's 1 - (1 - alpha)^(1/m).
#![allow(dead_code, reason = "each test crate includes this file and uses a part of it")]
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

/// ln Gamma(x), x > 0: Stirling's series after shifting x above 15; 1e-14.
pub(crate) fn ln_gamma(x: f64) -> f64 {
    let (mut x, mut shift) = (x, 0.0);
    while x < 15.0 {
        shift -= x.ln();
        x += 1.0;
    }
    let r = 1.0 / (x * x);
    let series = (1.0 / 12.0 - r * (1.0 / 360.0 - r * (1.0 / 1260.0 - r * (1.0 / 1680.0 - r / 1188.0)))) / x;
    shift + (x - 0.5) * x.ln() - x + 0.5 * (2.0 * core::f64::consts::PI).ln() + series
}

/// The upper regularised incomplete gamma function Q(a, x): power series below a + 1, Lentz's continued fraction above.
pub(crate) fn gamma_q(a: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 1.0;
    }
    let front = (a * x.ln() - x - ln_gamma(a)).exp();
    if x < a + 1.0 {
        let (mut term, mut sum, mut n) = (1.0 / a, 1.0 / a, a);
        while term > sum * 1e-17 {
            n += 1.0;
            term *= x / n;
            sum += term;
        }
        1.0 - front * sum
    } else {
        let tiny = 1e-300;
        let mut b = x + 1.0 - a;
        let (mut c, mut d) = (1.0 / tiny, 1.0 / b);
        let mut h = d;
        for i in 1..100_000 {
            let an = -f64::from(i) * (f64::from(i) - a);
            b += 2.0;
            d = 1.0 / (an * d + b).abs().max(tiny).copysign(an * d + b);
            c = b + an / c;
            h *= d * c;
            if (d * c - 1.0).abs() < 1e-15 {
                break;
            }
        }
        front * h
    }
}

/// The probability that a chi-square variable of `dof` degrees of freedom exceeds `statistic`.
pub(crate) fn chi2_survival(statistic: f64, dof: usize) -> f64 {
    gamma_q(0.5 * dof as f64, 0.5 * statistic)
}

/// Sidak's level of each of `tests` tests for a joint level `alpha`.
pub(crate) fn sidak(alpha: f64, tests: usize) -> f64 {
    1.0 - (1.0 - alpha).powf(1.0 / tests as f64)
}

/// p-value of counts against expected counts; cells expecting fewer than 5 are pooled.
pub(crate) fn chi2_p(observed: &[u64], expected: &[f64]) -> f64 {
    assert_eq!(observed.len(), expected.len());
    let (mut statistic, mut cells, mut pooled) = (0.0, 0_usize, (0.0, 0.0));
    for (&o, &e) in observed.iter().zip(expected) {
        if e < 5.0 {
            pooled = (pooled.0 + o as f64, pooled.1 + e);
        } else {
            statistic += (o as f64 - e).powi(2) / e;
            cells += 1;
        }
    }
    if pooled.1 > 0.0 {
        statistic += (pooled.0 - pooled.1).powi(2) / pooled.1.max(1e-3);
        cells += 1;
    }
    assert!(cells > 1, "too few samples for the cells");
    chi2_survival(statistic, cells - 1)
}

/// p-value of counts against equal expectations.
pub(crate) fn chi2_uniform_p(observed: &[u64]) -> f64 {
    let n: u64 = observed.iter().sum();
    chi2_p(observed, &vec![n as f64 / observed.len() as f64; observed.len()])
}

/// Fails unless `p` is above `level` and not so near 1 that the counts are too even for chance.
pub(crate) fn assert_random(p: f64, level: f64, what: &str) {
    assert!(p >= level && 1.0 - p >= level, "{what}: p = {p:e}, level {level:e}");
}

#[test]
fn survival_function_meets_published_and_closed_values() {
    // Two degrees of freedom: exp(-x/2). One: tables, 3.841458820694124 is the 5 % point; ten: 18.307038053275146; hundred: 124.3421134.
    for x in [0.1, 1.0, 3.0, 10.0, 50.0] {
        assert!((chi2_survival(x, 2) / (-0.5 * x).exp() - 1.0).abs() <= 1e-12);
    }
    assert!((chi2_survival(3.841_458_820_694_124, 1) - 0.05).abs() <= 1e-12);
    assert!((chi2_survival(18.307_038_053_275_146, 10) - 0.05).abs() <= 1e-12);
    assert!((chi2_survival(124.342_113_4, 100) - 0.05).abs() <= 1e-8);
    assert!((sidak(0.001, 2) - 5.001_250_6e-4).abs() <= 1e-9);
}
