//! Reconstruction of illumination maps: elements lean on their surroundings, by as much as they are noisy.
//!
//! Quantity: irradiance \[W/m^2\] per element, and the standard error of its distance to the truth, which has noise and bias in it.
//!
//! At each of a few scales, cells of near elements that face alike get a plane over places and normals, and each element is drawn to it ([`fit`]). No
//! scale is best for all numbers of photons, so that the result mixes the scales and the map as it is. The shares are those of the least estimated
//! squared error over the surfaces, which needs no truth (Stein 1981): sum w ((x - y)^2 - v + 2 v dx/dy) for values x, seen means y and their variances v.
//!
//! Nodes of the linear basis count as independent, which they are not: what is stated for them is too much.
//!
//! The mixture's squared error is exactly the mean of its parts' less their spread around it, which is how its standard error follows from theirs.

mod fit;
mod mix;
#[cfg(test)]
mod tests;

use super::{Basis, Clustering, Elements};
use crate::film::Film;
use crate::math::Vec3;
use alloc::vec::Vec;
use fit::{Fit, Scale, Seen, Sizes};

/// Most scales.
const SCALES: usize = 5;
/// From one scale to the next voxels shrink by this: cells of surfaces get three times as many.
const STEP: f32 = 1.732;
/// Fewest elements of a cell, on average.
const FEWEST: usize = 8;
/// Each scale's grid is shifted against the last by these parts of a voxel (powers of the root of x^4 = x + 1), so that no edges meet.
const SHIFT: [f32; 3] = [0.819_172_5, 0.671_043_6, 0.549_700_5];
/// Share of the variance of its parts that a mixture's never falls below.
const VARIANCE_MIN: f64 = 0.1;
/// Photons that are added to both fluxes of a cell before it is set right, so that cells of few photons hardly change.
const PHOTONS_TO_RESTORE: f64 = 10.0;

/// A map after reconstruction.
#[derive(Clone, Debug, PartialEq)]
pub struct Reconstruction {
    /// Irradiance per element \[W/m^2\]; not below 0 where elements are faces.
    pub values: Vec<[f64; 3]>,
    /// Root mean square of its expected distance to the truth, bias included \[W/m^2\].
    pub stderr: Vec<[f64; 3]>,
}

/// Reconstructs a map from its replicates; `None` below two of them, and for a film of other elements.
///
/// The flux of large cells stays what the photons say. Sums are in a fixed order: the same film gives the same bits.
pub fn reconstruct(clustering: &Clustering, elements: &Elements, film: &Film) -> Option<Reconstruction> {
    let n = elements.count();
    if film.block_count() < 2 || film.len() != n || clustering.places().len() != n {
        return None;
    }
    let sizes = Sizes {
        area: (0..n).map(|i| f64::from(elements.area(i))).collect(),
        weight: (0..n).map(|i| elements.weight(i)).collect(),
    };
    let channels = [0, 1, 2].map(|c| Seen {
        mean: (0..n).map(|i| film.mean(i)[c]).collect(),
        variance: (0..n).map(|i| film.variance(i).map_or(0.0, |v| v[c])).collect(),
    });
    let scales = scales(clustering, &sizes);
    let fits = channels.each_ref().map(|seen| fits(&scales, &sizes, seen));
    let shares = shares(&sizes, &channels, &fits);
    // Means are not negative; nodes beside an edge of light may be.
    let least = if elements.settings().basis == Basis::Constant { 0.0 } else { f64::NEG_INFINITY };
    let mut out = Reconstruction { values: alloc::vec![[0.0; 3]; n], stderr: alloc::vec![[0.0; 3]; n] };
    for (c, fits) in fits.iter().enumerate() {
        for i in 0..n {
            let [value, variance] = mixture(&shares, fits, i);
            out.values[i][c] = value.max(least);
            out.stderr[i][c] = libm::sqrt(variance);
        }
    }
    if let Some(coarse) = scales.first() {
        for (c, seen) in channels.iter().enumerate() {
            restore(coarse, &sizes, seen, c, &mut out);
        }
    }
    Some(out)
}

impl Reconstruction {
    /// Estimated relative error, `sqrt(sum w stderr^2 / sum w value^2)` over elements and channels; `None` for a black map.
    pub fn rel_error(&self, weight: impl Fn(usize) -> f64) -> Option<f64> {
        let sum = |of: &[[f64; 3]]| {
            of.iter().enumerate().map(|(i, x)| weight(i) * x.iter().map(|x| x * x).sum::<f64>()).sum::<f64>()
        };
        let (error, size) = (sum(&self.stderr), sum(&self.values));
        (size > 0.0).then(|| libm::sqrt(error / size))
    }
}

/// Scales from coarse to fine: those next to the finest whose cells have enough elements, or a single one.
fn scales(clustering: &Clustering, sizes: &Sizes) -> Vec<Scale> {
    let mut found: Vec<Scale> = Vec::new();
    let (mut size, mut shift) = (clustering.extent(), Vec3::ZERO);
    for _ in 0..40 {
        let scale = Scale::new(clustering, sizes, size, shift);
        let fine = scale.cells() * FEWEST > scale.members().map(<[u32]>::len).sum();
        if scale.cells() == 0 || (fine && !found.is_empty()) {
            break;
        }
        if found.len() == SCALES {
            found.remove(0);
        }
        found.push(scale);
        if fine {
            break;
        }
        size /= STEP;
        shift = (shift + Vec3::from_array(SHIFT)).fract();
    }
    found
}

/// What each scale makes of a channel, and last the channel as it is.
fn fits(scales: &[Scale], sizes: &Sizes, seen: &Seen) -> Vec<Fit> {
    let (mut flux, mut square) = (0.0, 0.0);
    for i in 0..seen.mean.len() {
        flux += sizes.weight[i] * seen.mean[i];
        square += sizes.weight[i] * sizes.area[i] * seen.variance[i];
    }
    let own = |noise: Vec<f64>| Fit {
        value: seen.mean.clone(),
        variance: noise.clone(),
        leverage: alloc::vec![1.0; noise.len()],
        noise,
    };
    // The flux of a usual photon. A channel without light or without noise stays as it is.
    let photon = square / flux;
    let noisy = flux > 0.0 && photon > 0.0 && photon.is_finite();
    if !noisy {
        return alloc::vec![own(seen.variance.clone()); scales.len() + 1];
    }
    let mut fits: Vec<Fit> = scales.iter().map(|scale| scale.fit(sizes, seen, photon)).collect();
    // Elements that no photon met have no variance of their own; the model's is that of the finest scale.
    let noise = fits.last().map_or_else(|| seen.variance.clone(), |fit| fit.noise.clone());
    fits.push(own(noise));
    fits
}

/// Shares of the fits for the least estimated error over all elements and channels.
fn shares(sizes: &Sizes, channels: &[Seen; 3], fits: &[Vec<Fit>; 3]) -> Vec<f64> {
    let n = fits[0].len();
    let mut products = alloc::vec![alloc::vec![0.0; n]; n];
    let mut linear = alloc::vec![0.0; n];
    for (seen, fits) in channels.iter().zip(fits) {
        for (e, w) in sizes.weight.iter().enumerate() {
            for i in 0..n {
                let of = fits[i].value[e] - seen.mean[e];
                linear[i] += w * fits[i].noise[e] * fits[i].leverage[e];
                for (j, product) in products[i].iter_mut().enumerate() {
                    *product += w * of * (fits[j].value[e] - seen.mean[e]);
                }
            }
        }
    }
    mix::shares(&products, &linear)
}

/// Value and variance of the mixture at an element.
fn mixture(shares: &[f64], fits: &[Fit], element: usize) -> [f64; 2] {
    let (mut value, mut variance, mut spread) = (0.0, 0.0, 0.0);
    for (a, fit) in shares.iter().zip(fits) {
        value += a * fit.value[element];
        variance += a * fit.variance[element];
    }
    for (a, fit) in shares.iter().zip(fits) {
        let d = fit.value[element] - value;
        spread += a * d * d;
    }
    [value, (variance - spread).max(VARIANCE_MIN * variance)]
}

/// Scales the values of each cell of the coarsest scale to the flux that its photons brought: planes by least squares, weighted by variances that go with
/// the values, come out low by a share of a photon.
fn restore(scale: &Scale, sizes: &Sizes, seen: &Seen, channel: usize, out: &mut Reconstruction) {
    for members in scale.members() {
        let (mut flux, mut square, mut now) = (0.0, 0.0, 0.0);
        for i in members.iter().map(|e| *e as usize) {
            flux += sizes.weight[i] * seen.mean[i];
            square += sizes.weight[i] * sizes.area[i] * seen.variance[i];
            now += sizes.weight[i] * out.values[i][channel];
        }
        let few = PHOTONS_TO_RESTORE * square / flux;
        let factor = if flux > 0.0 && now > 0.0 { (flux + few) / (now + few) } else { 1.0 };
        for i in members.iter().map(|e| *e as usize) {
            out.values[i][channel] *= factor;
            out.stderr[i][channel] *= factor;
        }
    }
}
