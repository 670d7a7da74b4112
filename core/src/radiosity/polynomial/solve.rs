//! All bounces of light: (I - R F) B = B0 without a matrix but F.
//!
//! An outer loop forms the residual B0 + R F B - B in f64 (same f32 form factors, B in f64), which proves a bound of the
//! error ([`Contraction`]), and stops when the bound is small enough. Until then an [`Inner`] solver finds, in f32, a
//! correction that leaves about a thousandth of the residual. So the accuracy does not depend on the albedo, on the inner
//! solver or on its rounding; only the number of passes does. That is iterative refinement (J. H. Wilkinson 1963).

use super::super::operator::{Dense, LinearOperator, OperatorError, Scaled, check_areas, check_len};
use super::contraction::{Contraction, contraction};
use super::sums::apply_channels;
use crate::math;
use alloc::vec;
use alloc::vec::Vec;
use core::fmt;

/// Why there is no solution.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum SolveError {
    /// The operator or a length.
    Operator(OperatorError),
    /// Albedo or radiosity that is not finite, or an albedo that is negative.
    BadValue {
        /// Which slice.
        slice: &'static str,
        /// The patch.
        patch: usize,
        /// The value.
        value: f32,
    },
    /// The bounces are not proved to die out: the spectral radius of |R F|, with the largest channel of each albedo, is
    /// between these bounds. From `low` = 1 on there is no solution.
    NotContracting {
        /// Lower bound.
        low: f64,
        /// Upper bound.
        high: f64,
    },
    /// The limit of passes was reached first.
    PassLimit {
        /// Passes over F.
        passes: u32,
        /// The error is proved to be at most this, relative to the largest radiosity.
        bound: f64,
    },
    /// Corrections no longer make the residual smaller.
    Stalled {
        /// Passes over F.
        passes: u32,
        /// The error is proved to be at most this, relative to the largest radiosity.
        bound: f64,
    },
    /// A pivot is zero or not finite.
    Singular {
        /// Its column.
        column: usize,
    },
}

impl From<OperatorError> for SolveError {
    fn from(e: OperatorError) -> Self {
        Self::Operator(e)
    }
}

impl fmt::Display for SolveError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Operator(e) => e.fmt(f),
            Self::BadValue { slice, patch, value } => {
                write!(f, "{slice} of patch {patch} is {value}, not finite and >= 0")
            }
            Self::NotContracting { low, high } => {
                write!(f, "light is not proved to die out: spectral radius between {low} and {high}")
            }
            Self::PassLimit { passes, bound } => {
                write!(f, "error still up to {bound:e} after {passes} passes, the limit")
            }
            Self::Stalled { passes, bound } => {
                write!(f, "no progress after {passes} passes, error up to {bound:e}")
            }
            Self::Singular { column } => write!(f, "no pivot in column {column}"),
        }
    }
}

impl core::error::Error for SolveError {}

/// When [`solve`] stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// The proved bound of the error, relative to the largest radiosity of the channel.
    pub tolerance: f64,
    /// Passes over F at most, of both kinds together.
    pub max_passes: u32,
}

impl Default for Settings {
    /// Half an ulp of f32 at 1, and 10 000 passes.
    fn default() -> Self {
        Self { tolerance: 1.0 / 16_777_216.0, max_passes: 10_000 }
    }
}

/// What [`solve`] found.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution<const C: usize> {
    /// Radiosity \[W m^-2\], all bounces and B0 itself, rounded to f32 at the end.
    pub radiosity: Vec<[f32; C]>,
    /// Its error before that rounding is proved to be at most this \[W m^-2\], per channel.
    pub bound: [f64; C],
    /// Passes over F in f32, all channels together.
    pub passes: u32,
    /// Passes over F in f64, all channels together.
    pub wide_passes: u32,
}

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
        use super::super::lanes::dots;
        use super::super::operator::to_planes;
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

fn apply_wide<O: LinearOperator + ?Sized, const C: usize>(
    operator: &O,
    x: &[[f64; C]],
    y: &mut [[f64; C]],
) -> Result<(), OperatorError> {
    match C {
        1 => operator.apply_wide(x.as_flattened(), y.as_flattened_mut()),
        3 => operator
            .apply_wide_rgb(x.as_flattened().as_chunks::<3>().0, y.as_flattened_mut().as_chunks_mut::<3>().0),
        _ => {
            let mut out = vec![0.0; y.len()];
            for c in 0..C {
                let plane: Vec<f64> = x.iter().map(|x| x[c]).collect();
                operator.apply_wide(&plane, &mut out)?;
                y.iter_mut().zip(&out).for_each(|(y, out)| y[c] = *out);
            }
            Ok(())
        }
    }
}

fn check_values<const C: usize>(
    slice: &'static str,
    x: &[[f32; C]],
    good: impl Fn(f32) -> bool,
) -> Result<(), SolveError> {
    match x.as_flattened().iter().position(|x| !good(*x)) {
        Some(at) => Err(SolveError::BadValue { slice, patch: at / C, value: x.as_flattened()[at] }),
        None => Ok(()),
    }
}

/// B = B0 + R F B0 + (R F)^2 B0 + ...: radiosity \[W m^-2\] of all bounces, with a proved error.
///
/// `areas` \[m^2\] are those of A F being symmetric (form factors that are only nearly reciprocal cost passes, not
/// accuracy). `albedo` >= 0 per channel; it need not be below 1 as long as light dies out. `radiosity` is B0, of any sign.
/// The error is against the exact solution for these f32 numbers. E_indirect = F B, or (B - B0) / rho where rho > 0.
///
/// # Errors
/// [`SolveError`]; a bound that cannot be reached is an error with the bound that was.
pub fn solve<O: LinearOperator + ?Sized, I: Inner<O>, const C: usize>(
    inner: &I,
    form_factors: &O,
    areas: &[f32],
    albedo: &[[f32; C]],
    radiosity: &[[f32; C]],
    settings: Settings,
) -> Result<Solution<C>, SolveError> {
    let n = form_factors.len();
    check_len("areas", areas.len(), n)?;
    check_len("albedo", albedo.len(), n)?;
    check_len("radiosity", radiosity.len(), n)?;
    check_areas(areas)?;
    check_values("albedo", albedo, |x| x >= 0.0 && x.is_finite())?;
    check_values("radiosity", radiosity, f32::is_finite)?;
    let brightest: Vec<f32> =
        albedo.iter().map(|rho| rho.iter().fold(0.0, |m, x| math::max(m, *x))).collect();
    let contraction = contraction(&Scaled::try_new(form_factors, &brightest)?)?;
    if !contraction.proved() {
        return Err(SolveError::NotContracting { low: contraction.low, high: contraction.high });
    }
    let mut x: Vec<[f64; C]> = radiosity.iter().map(|b| b.map(f64::from)).collect();
    let mut residual = vec![[0.0_f64; C]; n];
    let mut scaled = vec![[0.0_f32; C]; n];
    let mut e = vec![[0.0_f32; C]; n];
    let (mut passes, mut wide_passes, mut before) = (0, 0, f64::INFINITY);
    loop {
        apply_wide(form_factors, &x, &mut residual)?;
        wide_passes += 1;
        for i in 0..n {
            for c in 0..C {
                let reflected = f64::from(albedo[i][c]) * residual[i][c];
                residual[i][c] = (f64::from(radiosity[i][c]) - x[i][c]) + reflected;
            }
        }
        let size: [f64; C] = core::array::from_fn(|c| x.iter().fold(0.0_f64, |m, x| m.max(x[c].abs())));
        let bound: [f64; C] = core::array::from_fn(|c| bound_of(&contraction, &residual, &x, c));
        let relative = (0..C).fold(0.0_f64, |m, c| {
            let q = if bound[c] == 0.0 { 0.0 } else { bound[c] / size[c] };
            if q <= m { m } else { q }
        });
        if relative <= settings.tolerance {
            let radiosity = x.iter().map(|x| x.map(|x| x as f32)).collect();
            return Ok(Solution { radiosity, bound, passes, wide_passes });
        }
        if passes + wide_passes >= settings.max_passes {
            return Err(SolveError::PassLimit { passes: passes + wide_passes, bound: relative });
        }
        if !(relative <= 0.5 * before) {
            return Err(SolveError::Stalled { passes: passes + wide_passes, bound: relative });
        }
        before = relative;
        let scale: [f64; C] =
            core::array::from_fn(|c| residual.iter().fold(0.0_f64, |m, r| m.max(r[c].abs())));
        for (to, r) in scaled.iter_mut().zip(&residual) {
            *to = core::array::from_fn(|c| if scale[c] > 0.0 { (r[c] / scale[c]) as f32 } else { 0.0 });
        }
        e.fill([0.0; C]);
        let equation = Residual {
            form_factors,
            areas,
            albedo,
            residual: &scaled,
            max_passes: settings.max_passes - passes - wide_passes,
        };
        passes += inner.correct(&equation, &mut e)?;
        for (x, e) in x.iter_mut().zip(&e) {
            for c in 0..C {
                x[c] += scale[c] * f64::from(e[c]);
            }
        }
    }
}

/// The proved error of one channel: residual, and what its own rounding in f64 may hide.
fn bound_of<const C: usize>(
    contraction: &Contraction,
    residual: &[[f64; C]],
    x: &[[f64; C]],
    c: usize,
) -> f64 {
    let weighted = x.iter().zip(&contraction.weights).fold(0.0_f64, |m, (x, v)| m.max(x[c].abs() / v));
    let u = (x.len() as f64 / 16.0 + 270.0) * f64::EPSILON;
    contraction.error_bound(residual.iter().zip(x).zip(&contraction.weights).map(|((r, x), v)| {
        r[c].abs() + u * (2.0 * x[c].abs() + r[c].abs() + contraction.high * weighted * v)
    }))
}
