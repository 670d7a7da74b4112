//! Operators for the tests of `polynomial`, and the truth in f64.
#![allow(dead_code, reason = "each test crate includes this file and uses a part of it")]
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use etendue_core::radiosity::operator::Dense;

/// SplitMix64 (Steele et al. 2014).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
    pub(crate) fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / 9_007_199_254_740_992.0
    }
    pub(crate) fn vector(&mut self, n: usize) -> Vec<f32> {
        (0..n).map(|_| self.unit() as f32).collect()
    }
    pub(crate) fn signed(&mut self, n: usize) -> Vec<f32> {
        (0..n).map(|_| (2.0 * self.unit() - 1.0) as f32).collect()
    }
}

/// A closed scene: S symmetric, nothing on the diagonal, A its row sums, F = S / A. Areas differ by a factor of 100, most
/// form factors are small and a few are large.
pub(crate) fn closed(n: usize, seed: u64) -> (Dense, Vec<f32>) {
    let mut random = Random(seed);
    let size: Vec<f64> = (0..n).map(|_| 0.1 + random.unit().powi(3) * 10.0).collect();
    let mut s = vec![0.0_f64; n * n];
    for i in 0..n {
        for j in 0..i {
            let x = size[i] * size[j] * random.unit().powi(4);
            (s[i * n + j], s[j * n + i]) = (x, x);
        }
    }
    let areas: Vec<f64> = (0..n).map(|i| s[i * n..][..n].iter().sum()).collect();
    let entries = (0..n * n).map(|k| (s[k] / areas[k / n]) as f32).collect();
    (Dense::try_new(n, entries).unwrap(), areas.iter().map(|a| *a as f32).collect())
}

/// The entries in f64.
pub(crate) fn wide(a: &Dense) -> Vec<f64> {
    a.entries().iter().map(|x| f64::from(*x)).collect()
}

/// A B for n x n matrices, the plain triple loop.
pub(crate) fn product(n: usize, a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut c = vec![0.0; n * n];
    for i in 0..n {
        for k in 0..n {
            for j in 0..n {
                c[i * n + j] += a[i * n + k] * b[k * n + j];
            }
        }
    }
    c
}

/// A + A^2 + ... + A^k, power by power: neither of the forms under test.
pub(crate) fn powers(n: usize, a: &[f64], k: u32) -> Vec<f64> {
    let mut sum = vec![0.0; n * n];
    let mut power: Vec<f64> = (0..n * n).map(|i| f64::from(i / n == i % n)).collect();
    for _ in 0..k {
        power = product(n, &power, a);
        sum.iter_mut().zip(&power).for_each(|(s, p)| *s += p);
    }
    sum
}

/// M^-1 X by Gaussian elimination with partial pivoting in f64.
pub(crate) fn eliminate(n: usize, mut m: Vec<f64>, mut x: Vec<f64>, columns: usize) -> Vec<f64> {
    for c in 0..n {
        let pivot = (c..n).max_by(|i, j| m[i * n + c].abs().total_cmp(&m[j * n + c].abs())).unwrap();
        for j in 0..n {
            m.swap(c * n + j, pivot * n + j);
        }
        for j in 0..columns {
            x.swap(c * columns + j, pivot * columns + j);
        }
        for i in (0..n).filter(|i| *i != c) {
            let f = m[i * n + c] / m[c * n + c];
            for j in c..n {
                m[i * n + j] -= f * m[c * n + j];
            }
            for j in 0..columns {
                x[i * columns + j] -= f * x[c * columns + j];
            }
        }
    }
    for i in 0..n {
        for j in 0..columns {
            x[i * columns + j] /= m[i * n + i];
        }
    }
    x
}

/// I - diag(rho) F.
pub(crate) fn system(n: usize, f: &[f64], rho: &[f32]) -> Vec<f64> {
    (0..n * n).map(|k| f64::from(k / n == k % n) - f64::from(rho[k / n]) * f[k]).collect()
}

/// |got - truth| / |truth|, Euclidean.
pub(crate) fn relative(got: &[f32], truth: &[f64]) -> f64 {
    assert_eq!(got.len(), truth.len());
    let error: f64 = got.iter().zip(truth).map(|(g, t)| (f64::from(*g) - t).powi(2)).sum();
    let size: f64 = truth.iter().map(|t| t * t).sum();
    if error == 0.0 { 0.0 } else { (error / size).sqrt() }
}

/// Largest |got - truth| over the largest |truth|.
pub(crate) fn worst(got: &[f32], truth: &[f64]) -> f64 {
    assert_eq!(got.len(), truth.len());
    let error = got.iter().zip(truth).fold(0.0_f64, |m, (g, t)| {
        let e = (f64::from(*g) - t).abs();
        if e <= m { m } else { e }
    });
    error / truth.iter().fold(0.0_f64, |m, t| m.max(t.abs()))
}
