//! All bounces of light: (I - R F) B = B0 without a matrix but F.
//!
//! An outer loop forms the residual B0 + R F B - B in f64 (same f32 form factors, B in f64), which proves a bound of the
//! error ([`Contraction`]), and stops when the bound is small enough. Until then an [`Inner`] solver finds, in f32, a
//! correction that leaves about a thousandth of the residual. So the accuracy does not depend on the albedo, on the inner
//! solver or on its rounding; only the number of passes does. That is iterative refinement (J. H. Wilkinson 1963).

use super::super::operator::{LinearOperator, OperatorError, Scaled, check_areas, check_len};
use super::contraction::{Contraction, contraction};
use super::inner::{Inner, Residual};
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
/// The error is against the exact solution for these f32 numbers; a radiosity beyond f32::MAX is given as infinite. E_indirect = F B, or (B - B0) / rho where rho > 0.
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
            if q <= m {
                m
            } else if q.is_nan() {
                f64::INFINITY
            } else {
                q
            }
        });
        if relative <= settings.tolerance {
            let radiosity = x.iter().map(|x| x.map(|x| x as f32)).collect();
            return Ok(Solution { radiosity, bound, passes, wide_passes });
        }
        if passes + wide_passes >= settings.max_passes {
            return Err(SolveError::PassLimit { passes: passes + wide_passes, bound: relative });
        }
        // A bound of infinity twice is no progress either.
        if relative > 0.5 * before || (relative == f64::INFINITY && wide_passes > 1) {
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
