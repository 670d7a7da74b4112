//! Noise and bias of maps of irradiance from independent replicates of them.
//!
//! A map is a list of values per element or per cluster with what each counts for (its area). Errors are relative L2 norms weighted so, `rel_error` of the
//! table of metrics, all channels together.

use etendue_core::illumination::{Clusters, Elements};

/// Numbers of one replicate with what each counts for.
pub type Values = Vec<([f64; 3], f64)>;

/// The replicates of a map on clusters, or on its elements.
pub fn on(clusters: Option<&Clusters>, elements: &Elements, maps: &[Vec<[f64; 3]>]) -> Vec<Values> {
    maps.iter()
        .map(|m| match clusters {
            Some(c) => c.means(|i| elements.weight(i), |i| m[i]),
            None => m.iter().enumerate().map(|(i, x)| (*x, elements.weight(i))).collect(),
        })
        .collect()
}

/// Mean of the replicates at a place, and the variance of one of them.
fn moments(maps: &[Values], i: usize, c: usize) -> (f64, f64) {
    let n = maps.len() as f64;
    let mean = maps.iter().map(|m| m[i].0[c]).sum::<f64>() / n;
    (mean, maps.iter().map(|m| (m[i].0[c] - mean).powi(2)).sum::<f64>() / (n - 1.0))
}

/// Relative error of one replicate by the spread of all: sqrt(sum A var / sum A |mean|^2).
pub fn noise(maps: &[Values]) -> f64 {
    let (mut variance, mut square) = (0.0, 0.0);
    for i in 0..maps[0].len() {
        for c in 0..3 {
            let (mean, v) = moments(maps, i, c);
            variance += maps[0][i].1 * v;
            square += maps[0][i].1 * (mean * mean - v / maps.len() as f64);
        }
    }
    (variance / square).sqrt()
}

/// Relative distance of the means of two runs beyond the noise of both, as a root with the sign of its square: below 0 nothing is to be seen.
pub fn bias(a: &[Values], b: &[Values]) -> f64 {
    let (mut distance, mut square) = (0.0, 0.0);
    for i in 0..a[0].len() {
        for c in 0..3 {
            let ((ma, va), (mb, vb)) = (moments(a, i, c), moments(b, i, c));
            distance += a[0][i].1 * ((ma - mb).powi(2) - va / a.len() as f64 - vb / b.len() as f64);
            square += a[0][i].1 * mb * mb;
        }
    }
    let relative = distance / square;
    relative.abs().sqrt().copysign(relative)
}

/// Mean over everything of `a` over that of `b`, less 1.
pub fn energy(a: &[Values], b: &[Values]) -> f64 {
    let total = |maps: &[Values]| {
        maps.iter().flatten().map(|(v, w)| w * (v[0] + v[1] + v[2])).sum::<f64>() / maps.len() as f64
    };
    total(a) / total(b) - 1.0
}
