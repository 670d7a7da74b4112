//! Weights of passes: what is known of the passes not made.
//!
//! Passes change the irradiance by less and less, E_0, E_1 = E_0 + d_1, ...; a sum E_0 + w_1 d_1 + ... + w_k d_k with the right weights is several times
//! nearer to the end than E_k itself, because the last changes tell what would follow. One set of weights does for all lights of an operator: they
//! depend on how its light decays, not on where it starts. They are found by least squares over lights whose end is known, and the
//! operator stays one fixed linear map.

use super::RelightError;
use alloc::vec::Vec;

/// What the square of the relative error of the total counts beside that of irradiance.
const TOTAL: f64 = 25.0;
/// Share of the mean diagonal that draws weights to 1 where the changes do not tell.
const DRAW: f64 = 1e-9;

/// Weights for so many passes, from lights (direct irradiance per patch) and their exact indirect irradiance. `relight` gives the indirect irradiance of a light after
/// a number of passes, none of them weighted.
///
/// What they make least is the mean over lights of squares of the relative error, by area, and of the relative error of the total, the latter twenty-five times.
///
/// # Errors
/// Of `relight`; a light that has another number of patches than there are areas.
pub fn fit<E: From<RelightError>>(
    areas: &[f32],
    lights: &[Vec<[f32; 3]>],
    exact: &[Vec<[f32; 3]>],
    passes: u32,
    mut relight: impl FnMut(&[[f32; 3]], u32, &mut [[f32; 3]]) -> Result<(), E>,
) -> Result<Vec<f32>, E> {
    let k = passes as usize;
    // Least squares of T - E_k over the changes: matrix, and right side.
    let (mut matrix, mut right) = (alloc::vec![0.0_f64; k * k], alloc::vec![0.0_f64; k]);
    for (direct, exact) in lights.iter().zip(exact) {
        let mut iterates = Vec::with_capacity(k + 1);
        for pass in 0..=passes {
            let mut found = alloc::vec![[0.0; 3]; areas.len()];
            relight(direct, pass, &mut found)?;
            iterates.push(found);
        }
        super::check_len("exact irradiance", exact.len(), areas.len())?;
        let (mut squares, mut total) = (0.0, 0.0);
        let mut sums = alloc::vec![0.0_f64; k + 1];
        let (mut m, mut r) = (alloc::vec![0.0_f64; k * k], alloc::vec![0.0_f64; k]);
        let mut changes = alloc::vec![0.0_f64; k];
        for (i, area) in areas.iter().enumerate() {
            let area = f64::from(*area);
            for c in 0..3 {
                let truth = f64::from(exact[i][c]);
                let rest = truth - f64::from(iterates[k][i][c]);
                for (d, pair) in changes.iter_mut().zip(iterates.windows(2)) {
                    *d = f64::from(pair[1][i][c]) - f64::from(pair[0][i][c]);
                }
                squares += area * truth * truth;
                total += area * truth;
                sums[k] += area * rest;
                for a in 0..k {
                    sums[a] += area * changes[a];
                    r[a] += area * changes[a] * rest;
                    for b in 0..k {
                        m[a * k + b] += area * changes[a] * changes[b];
                    }
                }
            }
        }
        if squares > 0.0 && total > 0.0 {
            for a in 0..k {
                right[a] += r[a] / squares + TOTAL * sums[a] * sums[k] / (total * total);
                for b in 0..k {
                    matrix[a * k + b] += m[a * k + b] / squares + TOTAL * sums[a] * sums[b] / (total * total);
                }
            }
        }
    }
    let more = solve(&mut matrix, &mut right);
    Ok(more.iter().map(|x| (1.0 + x) as f32).collect())
}

/// Solution of a symmetric system that is positive but for rounding; 0 where nothing determines it.
fn solve(matrix: &mut [f64], right: &mut [f64]) -> Vec<f64> {
    let k = right.len();
    let mean = (0..k).map(|a| matrix[a * k + a]).sum::<f64>() / k.max(1) as f64;
    if !(mean > 0.0 && mean.is_finite()) {
        return alloc::vec![0.0; k];
    }
    for a in 0..k {
        matrix[a * k + a] += DRAW * mean;
    }
    // Elimination needs no exchange of rows: what is added keeps all pivots above 0.
    for a in 0..k {
        for b in a + 1..k {
            let factor = matrix[b * k + a] / matrix[a * k + a];
            for c in a..k {
                matrix[b * k + c] -= factor * matrix[a * k + c];
            }
            right[b] -= factor * right[a];
        }
    }
    let mut x = alloc::vec![0.0; k];
    for a in (0..k).rev() {
        let known: f64 = (a + 1..k).map(|b| matrix[a * k + b] * x[b]).sum();
        x[a] = (right[a] - known) / matrix[a * k + a];
    }
    if x.iter().all(|x| x.is_finite()) { x } else { alloc::vec![0.0; k] }
}
