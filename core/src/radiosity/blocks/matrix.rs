//! The matrix that is to be stored, in f32, channel by channel.

use super::encode::Settings;
use super::parts::{BlockError, Matrix, PATCHES_MAX, check_len, check_values};
use crate::math;
use crate::radiosity::form_factors::FormFactors;
use crate::radiosity::operator::Dense;
use crate::radiosity::polynomial::{Horner, Multiply, PowerSum, gather, infinite};
use alloc::vec::Vec;

/// Entries of each channel, patch by patch, and the factors that symmetry asks for before and after it.
pub(super) struct Planes {
    pub(super) channels: Vec<Vec<f32>>,
    pub(super) scales: Vec<[f32; 2]>,
}

/// F, rounded once.
pub(super) fn dense(form_factors: &FormFactors) -> Result<Dense, BlockError> {
    let n = form_factors.len();
    let mut entries = Vec::with_capacity(n * n);
    for (i, area) in form_factors.areas.iter().enumerate() {
        let area = f64::from(*area);
        entries.extend((0..n).map(|j| (f64::from(form_factors.flux(i, j)) / area) as f32));
    }
    Ok(Dense::try_new(n, entries)?)
}

/// A^1/2 X A^-1/2 of an X for which A X is symmetric but for rounding, entries and their mirror images the same.
fn symmetric(n: usize, x: &mut [f32], roots: &[f64]) {
    for i in 0..n {
        for j in 0..=i {
            let ratio = roots[i] / roots[j];
            let both = ratio * f64::from(x[i * n + j]) + f64::from(x[j * n + i]) / ratio;
            let value = (0.5 * both) as f32;
            (x[i * n + j], x[j * n + i]) = (value, value);
        }
    }
}

impl Planes {
    /// The planes of a matrix, nothing below 0.
    pub(super) fn new<M: Multiply + ?Sized>(
        multiply: &M,
        form_factors: &FormFactors,
        albedo: &[[f32; 3]],
        settings: &Settings<'_>,
    ) -> Result<Self, BlockError> {
        let n = form_factors.len();
        if n > PATCHES_MAX {
            return Err(BlockError::TooLarge { patches: n });
        }
        check_len("albedo", albedo.len(), n)?;
        check_values("albedo", albedo.as_flattened(), 3, |x| (0.0..=1.0).contains(&x))?;
        check_values("area", &form_factors.areas, 1, |x| x > 0.0 && x.is_finite())?;
        let matrix = settings.matrix;
        if settings.half && !matrix.can_be_half() {
            return Err(BlockError::NotSymmetric { matrix });
        }
        let f = dense(form_factors)?;
        let of = |c: usize| -> Result<Vec<f32>, BlockError> {
            let rho: Vec<f32> = albedo.iter().map(|a| a[c]).collect();
            let made = match matrix {
                Matrix::FormFactors { bounces: 0 } | Matrix::Bounces(0) => return Err(BlockError::NoBounces),
                Matrix::FormFactors { .. } => f.clone(),
                Matrix::Bounces(k) => Horner.sum(multiply, &f.reflecting(&rho)?, k)?,
                // In f32: what 1 / (1 - albedo) makes of rounding is far below what few bits do.
                Matrix::AllBounces => infinite::<f32, M>(multiply, &f.reflecting(&rho)?)?,
                Matrix::Gather => gather::<f32, M>(multiply, &f, &rho)?,
            };
            // Elimination may leave less than nothing.
            Ok(made.entries().iter().map(|x| math::max(*x, 0.0)).collect())
        };
        let mut channels: Vec<Vec<f32>> = Vec::with_capacity(matrix.channels());
        for c in 0..matrix.channels() {
            // Grey scenes are common.
            match (0..c).find(|d| albedo.iter().all(|a| a[*d] == a[c])) {
                Some(same) => channels.push(channels[same].clone()),
                None => channels.push(of(c)?),
            }
        }
        let mut scales = Vec::new();
        if settings.half {
            let roots: Vec<f64> = form_factors.areas.iter().map(|a| math::sqrt64(f64::from(*a))).collect();
            channels.iter_mut().for_each(|x| symmetric(n, x, &roots));
            scales = roots.iter().map(|r| [*r as f32, (1.0 / r) as f32]).collect();
        }
        Ok(Self { channels, scales })
    }
}
