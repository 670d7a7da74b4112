//! Sums of rows set right, symmetry kept.

use super::{FormFactors, start};
use alloc::vec::Vec;

/// No patch's factor leaves these: where sums cannot be reached, a pair should not go far off for it.
const FACTORS: [f64; 2] = [0.5, 2.0];

/// What balancing did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Balance {
    /// Root mean square, over area, of the sums' distance to their targets before.
    pub before: f64,
    /// The same after.
    pub after: f64,
}

/// Scales A F(i, j) by d_i d_j for the sums of rows to be `targets` (per patch, in \[0, 1\]): in a closed room 1. Symmetric form of R. Sinkhorn (1964), each step the
/// root of the plain one, by P. Knight, D. Ruiz and B. Ucar (2014).
pub fn balance(form_factors: &mut FormFactors, targets: &[f64], steps: u32) -> Balance {
    let factors = factors(form_factors, targets, steps);
    let before = distance(form_factors, targets);
    for i in 0..form_factors.len() {
        for (j, flux) in form_factors.half[start(i)..start(i + 1)].iter_mut().enumerate() {
            *flux = (f64::from(*flux) * factors[i] * factors[j]) as f32;
        }
    }
    Balance { before, after: distance(form_factors, targets) }
}

/// The factors of [`balance`].
pub(in crate::radiosity) fn factors(form_factors: &FormFactors, targets: &[f64], steps: u32) -> Vec<f64> {
    let n = form_factors.len();
    let mut factors = alloc::vec![1.0_f64; n];
    let mut sums = alloc::vec![0.0_f64; n];
    for _ in 0..steps {
        sums.fill(0.0);
        for i in 0..n {
            let mut own = 0.0;
            let row = &form_factors.half[start(i)..start(i + 1)];
            let (last, others) =
                row.split_last().map_or((0.0, row), |(last, others)| (f64::from(*last), others));
            for (j, flux) in others.iter().enumerate() {
                own += f64::from(*flux) * factors[j];
                sums[j] += f64::from(*flux) * factors[i];
            }
            sums[i] += own + last * factors[i];
        }
        for i in 0..n {
            let sum = factors[i] * sums[i] / f64::from(form_factors.areas[i]);
            let target = targets.get(i).copied().unwrap_or(0.0);
            if sum > 0.0 && target > 0.0 {
                factors[i] = (factors[i] * crate::math::sqrt64(target / sum)).clamp(FACTORS[0], FACTORS[1]);
            }
        }
    }
    factors
}

fn distance(form_factors: &FormFactors, targets: &[f64]) -> f64 {
    let (mut squares, mut all) = (0.0, 0.0);
    for ((sum, target), area) in form_factors.row_sums().iter().zip(targets).zip(&form_factors.areas) {
        squares += f64::from(*area) * (sum - target) * (sum - target);
        all += f64::from(*area);
    }
    if all > 0.0 { crate::math::sqrt64(squares / all) } else { 0.0 }
}
