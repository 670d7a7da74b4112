//! Noise and bias of maps of irradiance from independent replicates of them.
//!
//! A map is a list of values per element or per cluster with what each counts for (its area). Errors are relative L2 norms weighted so, `rel_error` of the
//! table of metrics, all channels together.

use super::statistics::mean_and_variance_of_mean;
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

/// Mean of the replicates at a place, and the variance of that mean.
pub fn moments(maps: &[Values], i: usize, c: usize) -> (f64, f64) {
    let each: Vec<f64> = maps.iter().map(|m| m[i].0[c]).collect();
    mean_and_variance_of_mean(&each)
}

/// Mean over everything and all channels together, each place by what it counts for, and the variance of that mean.
pub fn total(maps: &[Values]) -> (f64, f64) {
    let sum = |m: &Values| m.iter().map(|(v, w)| w * v.iter().sum::<f64>()).sum::<f64>();
    let each: Vec<f64> = maps.iter().map(sum).collect();
    mean_and_variance_of_mean(&each)
}

/// Relative error of one replicate by the spread of all: sqrt(sum A var / sum A |mean|^2).
pub fn noise(maps: &[Values]) -> f64 {
    let (mut variance, mut square) = (0.0, 0.0);
    for i in 0..maps[0].len() {
        for c in 0..3 {
            let (mean, v) = moments(maps, i, c);
            variance += maps[0][i].1 * v * maps.len() as f64;
            square += maps[0][i].1 * (mean * mean - v);
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
            distance += a[0][i].1 * ((ma - mb).powi(2) - va - vb);
            square += a[0][i].1 * mb * mb;
        }
    }
    let relative = distance / square;
    relative.abs().sqrt().copysign(relative)
}

/// Mean over everything of `a` over that of `b`, less 1.
pub fn energy(a: &[Values], b: &[Values]) -> f64 {
    total(a).0 / total(b).0 - 1.0
}
