//! Solvers of the correction, in f32.

use super::super::lanes::dots;
use super::super::operator::{Dense, LinearOperator, OperatorError, to_planes};
use super::sums::apply_channels;
use crate::math;
use alloc::vec;
use alloc::vec::Vec;

/// The equation of a correction: (I - R F) e = r.
#[derive(Clone, Copy, Debug)]
pub struct Residual<'a, O: ?Sized, const C: usize> {
    /// F.
    pub form_factors: &'a O,
    /// Areas \[m^2\] of the patches.
    pub areas: &'a [f32],
    /// R, per channel.
    pub albedo: &'a [[f32; C]],
    /// r, scaled so that the largest of each channel is about 1.
    pub residual: &'a [[f32; C]],
    /// Passes over F at most.
    pub max_passes: u32,
}

/// Solves for a correction in f32.
pub trait Inner<O: ?Sized> {
    /// e such that r - (I - R F) e is at most about a thousandth of r, and the passes over F that it took. `e` is 0 at
    /// first. A poor e costs time, not accuracy.
    ///
    /// # Errors
    /// The operator's own.
    fn correct<const C: usize>(
        &self,
        equation: &Residual<'_, O, C>,
        e: &mut [[f32; C]],
    ) -> Result<u32, OperatorError>;
}

/// What an inner solver leaves of a residual.
const LEFT: f32 = 1.0e-3;

fn largest<const C: usize>(x: &[[f32; C]]) -> f32 {
    x.as_flattened().iter().fold(0.0, |m, x| math::max(m, math::abs(*x)))
}

/// e <- r + R F e, a bounce each (the classical method): passes grow as 1 / (1 - albedo).
#[derive(Clone, Copy, Debug, Default)]
pub struct Jacobi;

impl<O: LinearOperator + ?Sized> Inner<O> for Jacobi {
    fn correct<const C: usize>(
        &self,
        q: &Residual<'_, O, C>,
        e: &mut [[f32; C]],
    ) -> Result<u32, OperatorError> {
        e.copy_from_slice(q.residual);
        let enough = LEFT * largest(e);
        let mut next = vec![[0.0; C]; e.len()];
        for pass in 1..=q.max_passes {
            apply_channels(q.form_factors, e, &mut next)?;
            let mut change = 0.0_f32;
            for (i, e) in e.iter_mut().enumerate() {
                for (c, e) in e.iter_mut().enumerate() {
                    let to = q.residual[i][c] + q.albedo[i][c] * next[i][c];
                    change = math::max(change, math::abs(to - *e));
                    *e = to;
                }
            }
            if change <= enough {
                return Ok(pass);
            }
        }
        Ok(q.max_passes)
    }
}

/// Jacobi's method that uses each new value at once, patch after patch: about half the passes, but rows must be at hand
/// and one follows the other.
#[derive(Clone, Copy, Debug, Default)]
pub struct GaussSeidel;

impl Inner<Dense> for GaussSeidel {
    fn correct<const C: usize>(
        &self,
        q: &Residual<'_, Dense, C>,
        e: &mut [[f32; C]],
    ) -> Result<u32, OperatorError> {
        let mut planes = to_planes(q.residual);
        let enough = LEFT * largest(q.residual);
        let mut passes = 0;
        while passes < q.max_passes {
            passes += 1;
            let mut change = 0.0_f32;
            for i in 0..e.len() {
                let row = q.form_factors.row(i);
                let [sums] = dots([row], planes.each_ref().map(|p| &p[..]));
                for c in 0..C {
                    let own = q.albedo[i][c] * row[i];
                    let old = planes[c][i];
                    // e_i (1 - rho F_ii) = r_i + rho sum over the others.
                    let new = (q.residual[i][c] + (q.albedo[i][c] * sums[c] - own * old)) / (1.0 - own);
                    change = math::max(change, math::abs(new - old));
                    planes[c][i] = new;
                }
            }
            if change <= enough {
                break;
            }
        }
        for (i, e) in e.iter_mut().enumerate() {
            *e = core::array::from_fn(|c| planes[c][i]);
        }
        Ok(passes)
    }
}

/// Conjugate gradients (M. R. Hestenes and E. Stiefel 1952) on the symmetric form of the equation: with d = sqrt(R / A),
/// m = sqrt(R A) and T = m F d, e = r + d y where (I - T) y = m F r. T is symmetric because A F is; it has the spectrum of
/// R F, so that I - T is positive definite. Albedo 0 is allowed. Passes grow with the number of eigenvalues near 1, which
/// for form factors is small (a closed room of one albedo has one), not with 1 / (1 - albedo).
///
/// Scalar products are sums in f64 in the order of patches.
#[derive(Clone, Copy, Debug, Default)]
pub struct ConjugateGradients;

fn products<const C: usize>(x: &[[f32; C]], y: &[[f32; C]]) -> [f64; C] {
    let mut sums = [0.0; C];
    for (x, y) in x.iter().zip(y) {
        for c in 0..C {
            sums[c] += f64::from(x[c]) * f64::from(y[c]);
        }
    }
    sums
}

impl<O: LinearOperator + ?Sized> Inner<O> for ConjugateGradients {
    fn correct<const C: usize>(
        &self,
        q: &Residual<'_, O, C>,
        e: &mut [[f32; C]],
    ) -> Result<u32, OperatorError> {
        let n = e.len();
        let weights = |f: &dyn Fn(f32, f32) -> f32| -> Vec<[f32; C]> {
            q.albedo.iter().zip(q.areas).map(|(rho, a)| rho.map(|rho| math::sqrt(f(rho, *a)))).collect()
        };
        let (before, after) = (weights(&|rho, a| rho / a), weights(&|rho, a| rho * a));
        let times = |x: &[[f32; C]], w: &[[f32; C]], to: &mut [[f32; C]]| {
            for (to, (x, w)) in to.iter_mut().zip(x.iter().zip(w)) {
                *to = core::array::from_fn(|c| x[c] * w[c]);
            }
        };
        let mut scratch = vec![[0.0_f32; C]; n];
        let mut image = vec![[0.0_f32; C]; n];
        // g = m F r is the residual of y = 0, and the first direction.
        apply_channels(q.form_factors, q.residual, &mut image)?;
        let mut passes = 1;
        let mut left = vec![[0.0_f32; C]; n];
        times(&image, &after, &mut left);
        let mut direction = left.clone();
        let mut y = vec![[0.0_f32; C]; n];
        let mut square = products(&left, &left);
        let enough = square.map(|s| s * f64::from(LEFT) * f64::from(LEFT));
        while passes < q.max_passes && (0..C).any(|c| square[c] > enough[c]) {
            times(&direction, &before, &mut scratch);
            apply_channels(q.form_factors, &scratch, &mut image)?;
            passes += 1;
            times(&image, &after, &mut scratch);
            for (t, p) in scratch.iter_mut().zip(&direction) {
                *t = core::array::from_fn(|c| p[c] - t[c]);
            }
            let curvature = products(&direction, &scratch);
            // A channel that is done, or in which rounding has left no descent, stands still.
            let step: [f32; C] = core::array::from_fn(|c| {
                let live = square[c] > enough[c] && curvature[c] > 0.0;
                if live { (square[c] / curvature[c]) as f32 } else { 0.0 }
            });
            if step.iter().all(|s| !(*s > 0.0 && s.is_finite())) {
                break;
            }
            for i in 0..n {
                for c in 0..C {
                    y[i][c] += step[c] * direction[i][c];
                    left[i][c] -= step[c] * scratch[i][c];
                }
            }
            let now = products(&left, &left);
            for c in 0..C {
                let ratio = if step[c] > 0.0 { (now[c] / square[c]) as f32 } else { 0.0 };
                for i in 0..n {
                    direction[i][c] = left[i][c] + ratio * direction[i][c];
                }
                square[c] = if step[c] > 0.0 { now[c] } else { 0.0 };
            }
        }
        for (i, e) in e.iter_mut().enumerate() {
            *e = core::array::from_fn(|c| q.residual[i][c] + before[i][c] * y[i][c]);
        }
        Ok(passes)
    }
}
