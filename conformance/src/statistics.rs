//! Distribution functions in f64, and the corrections that many tests need.
//!
//! Every random test of the suite has a fixed seed, states its alpha, and divides it by Sidak's rule over all that it
//! tests. Error bars come from a few blocks, so that quotients are Student's t and not normal.

/// ln Gamma(x), x > 0: Stirling's series after shifting x above 12; 1e-13 relative.
pub fn ln_gamma(x: f64) -> f64 {
    let (mut x, mut shift) = (x, 0.0);
    while x < 12.0 {
        shift += x.ln();
        x += 1.0;
    }
    let r = 1.0 / (x * x);
    let series = (1.0 / 12.0 - r * (1.0 / 360.0 - r * (1.0 / 1260.0 - r / 1680.0))) / x;
    (x - 0.5) * x.ln() - x + 0.5 * (2.0 * std::f64::consts::PI).ln() + series - shift
}

/// Upper regularised incomplete gamma function Q(a, x).
fn gamma_q(a: f64, x: f64) -> f64 {
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
        return 1.0 - front * sum;
    }
    let mut b = x + 1.0 - a;
    let (mut c, mut d) = (1e300, 1.0 / b);
    let mut h = d;
    for i in 1..100_000 {
        let an = -f64::from(i) * (f64::from(i) - a);
        b += 2.0;
        d = 1.0 / (an * d + b);
        c = b + an / c;
        h *= d * c;
        if (d * c - 1.0).abs() < 1e-15 {
            break;
        }
    }
    front * h
}

/// Probability that a chi-square variable of `dof` degrees of freedom exceeds `statistic`.
pub fn chi2_survival(statistic: f64, dof: usize) -> f64 {
    gamma_q(0.5 * dof as f64, 0.5 * statistic)
}

/// Regularised incomplete beta function I_x(a, b) by Lentz's continued fraction.
fn beta_i(a: f64, b: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    if x >= 1.0 {
        return 1.0;
    }
    if x > (a + 1.0) / (a + b + 2.0) {
        return 1.0 - beta_i(b, a, 1.0 - x);
    }
    let front = (ln_gamma(a + b) - ln_gamma(a) - ln_gamma(b) + a * x.ln() + b * (1.0 - x).ln()).exp() / a;
    let guard = |v: f64| if v.abs() < 1e-300 { 1e-300 } else { v };
    let (mut c, mut d) = (1.0, 1.0 / guard(1.0 - (a + b) * x / (a + 1.0)));
    let mut h = d;
    for m in 1..10_000 {
        let m = f64::from(m);
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        d = 1.0 / guard(1.0 + even * d);
        c = guard(1.0 + even / c);
        h *= d * c;
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        d = 1.0 / guard(1.0 + odd * d);
        c = guard(1.0 + odd / c);
        h *= d * c;
        if (d * c - 1.0).abs() < 1e-15 {
            break;
        }
    }
    front * h
}

/// Two-sided tail of Student's t: P(|T| > t) for `dof` degrees of freedom.
pub fn t_two_sided(t: f64, dof: f64) -> f64 {
    beta_i(0.5 * dof, 0.5, dof / (dof + t * t))
}

/// The t at which [`t_two_sided`] is `p`, by bisection.
pub fn t_quantile(p: f64, dof: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1e6);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if t_two_sided(middle, dof) > p {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

/// Sidak's level of each of `tests` tests for a joint level `alpha`.
pub fn sidak(alpha: f64, tests: usize) -> f64 {
    // 1 - (1 - alpha)^(1/m) without cancellation.
    -((-alpha).ln_1p() / tests.max(1) as f64).exp_m1()
}

/// p-value of counts against expected counts; cells that expect fewer than 5 are pooled.
pub fn chi2_p(observed: &[u64], expected: &[f64]) -> f64 {
    let (mut statistic, mut cells, mut pooled) = (0.0, 0_usize, (0.0, 0.0));
    for (&o, &e) in observed.iter().zip(expected) {
        if e < 5.0 {
            pooled = (pooled.0 + o as f64, pooled.1 + e);
        } else {
            statistic += (o as f64 - e).powi(2) / e;
            cells += 1;
        }
    }
    if pooled.0 > 0.0 || pooled.1 > 0.0 {
        // Counts where nothing is expected weigh as much as they should: against a thousandth of a count.
        statistic += (pooled.0 - pooled.1).powi(2) / pooled.1.max(1e-3);
        cells += 1;
    }
    if cells < 2 { 0.0 } else { chi2_survival(statistic, cells - 1) }
}

/// A stream of 64-bit numbers (Steele, Lea and Flood 2014, SplitMix64): the suite's own, so that inputs do not come
/// from what is tested.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// The stream of a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next number.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// The next word.
    pub fn word(&mut self) -> u32 {
        (self.bits() >> 32) as u32
    }

    /// Below `n`.
    pub fn below(&mut self, n: u32) -> u32 {
        ((u64::from(self.word()) * u64::from(n)) >> 32) as u32
    }

    /// A multiple of 2^-24 in \[0, 1).
    pub fn unit(&mut self) -> f32 {
        (self.word() >> 8) as f32 / 16_777_216.0
    }

    /// In \[low, high), to 53 bits.
    pub fn range(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.bits() >> 11) as f64 / 9_007_199_254_740_992.0)
    }

    /// Uniform in the logarithm, between two positive numbers.
    pub fn log_range(&mut self, low: f64, high: f64) -> f32 {
        self.range(low.ln(), high.ln()).exp() as f32
    }

    /// A unit vector, rounded to f32.
    pub fn direction(&mut self) -> [f32; 3] {
        let z = self.range(-1.0, 1.0);
        let phi = self.range(0.0, 2.0 * std::f64::consts::PI);
        let r = (1.0 - z * z).sqrt();
        [(r * phi.cos()) as f32, (r * phi.sin()) as f32, z as f32]
    }

    /// Three numbers in \[low, high).
    pub fn vector(&mut self, low: f64, high: f64) -> [f32; 3] {
        [0; 3].map(|_| self.range(low, high) as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_meet_published_values() {
        // Tables: chi-square 5 % points 3.841458821 (1) and 18.307038053 (10); t two-sided 5 %: 12.7062 (1), 2.2281 (10),
        // 1.9600 (normal); 0.1 %: 4.5869 (10).
        assert!((chi2_survival(3.841_458_820_694_124, 1) - 0.05).abs() <= 1e-10);
        assert!((chi2_survival(18.307_038_053_275_146, 10) - 0.05).abs() <= 1e-10);
        assert!((t_quantile(0.05, 1.0) - 12.706_204_736).abs() <= 1e-6);
        assert!((t_quantile(0.05, 10.0) - 2.228_138_852).abs() <= 1e-7);
        assert!((t_quantile(0.001, 10.0) - 4.586_893_859).abs() <= 1e-6);
        assert!((t_quantile(0.05, 1e7) - 1.959_964).abs() <= 1e-5);
        assert!((sidak(0.001, 2) - 5.001_250_6e-4).abs() <= 1e-9);
        assert!((ln_gamma(0.5) - 0.572_364_942_924_700_1).abs() <= 1e-12);
    }

    #[test]
    fn counts_where_none_are_expected_are_refused() {
        assert!(chi2_p(&[500, 500, 40], &[500.0, 500.0, 0.0]) < 1e-9);
        assert!(chi2_p(&[505, 495], &[500.0, 500.0]) > 0.5);
    }
}
