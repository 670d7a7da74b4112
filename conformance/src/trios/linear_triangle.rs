//! The trio of the linear density over a triangle.

use super::{Finding, map, units};
use crate::inputs::HARD_UNITS;
use crate::statistics::chi2_p;
use etendue_core::backend::{Backend, BackendError};
use etendue_core::kernel::Kernel;

/// Flat, nearly flat, common, one zero, one alone, and of far ratios.
pub(super) const WEIGHTS: [[f32; 3]; 6] =
    [[1.0; 3], [1.0, 1.000_000_1, 1.0], [3.0, 1.0, 2.0], [5.0, 2.0, 0.0], [0.0, 7.0, 0.0], [1e-9, 1e9, 1.0]];
/// Round trip in units of 2^-24, as `invert`'s doc states.
const ROUND_TRIP: f64 = 8.0;
/// Rows and columns of cells.
const CELLS: usize = 16;

/// Rows of `width` numbers, each behind the weights.
fn behind(weights: [f32; 3], values: &[f32], width: usize) -> Vec<f32> {
    values.chunks(width).flat_map(|row| weights.iter().chain(row).copied()).collect()
}

/// Cells of equal area: strips in (1 - b0)^2, shares in b1 / (1 - b0). A linear density has its mean over a cell at the
/// cell's centre of mass, so that the expected counts are exact.
fn centres() -> Vec<f32> {
    let edge = |i: usize| (i as f64 / CELLS as f64).sqrt();
    let mut out = Vec::new();
    for i in 0..CELLS {
        let (r, q) = (edge(i), edge(i + 1));
        let mean = 2.0 / 3.0 * (q * q * q - r * r * r) / (q * q - r * r);
        for j in 0..CELLS {
            let share = (j as f64 + 0.5) / CELLS as f64;
            out.extend([1.0 - mean, mean * share, mean * (1.0 - share)].map(|x| x as f32));
        }
    }
    out
}

pub(super) fn check(
    backend: &dyn Backend,
    count: usize,
    level: f64,
    out: &mut Vec<Finding>,
) -> Result<(), BackendError> {
    for (i, weights) in WEIGHTS.into_iter().enumerate() {
        let label = |what: &str| format!("trio/linear_triangle({weights:?})/{what}");
        let u = units(count, 0x11ea + i as u64);
        let bary = map(backend, Kernel::SampleLinearTriangle, &behind(weights, &u, 2))?;
        let pdf = map(backend, Kernel::PdfLinearTriangle, &behind(weights, &bary, 3))?;
        let bad = bary.iter().filter(|x| !(0.0..=1.0).contains(*x)).count();
        // Density 0 only at the ends of the unit interval.
        let inner = |u: &[f32]| u.iter().all(|u| *u > 0.0);
        let zero =
            u.chunks(2).zip(&pdf).filter(|(u, p)| !(p.is_finite() && (**p > 0.0 || !inner(u)))).count();
        out.push((
            label("total"),
            bad == 0 && zero == 0,
            format!("{bad} coordinates outside, {zero} samples without a density, of {}", pdf.len()),
        ));
        let back = map(backend, Kernel::InvertLinearTriangle, &behind(weights, &bary, 3))?;
        let mut worst = 0.0_f64;
        for (u, b) in u.chunks(2).zip(back.chunks(2)) {
            let d = [0, 1].map(|i| (f64::from(u[i]) - f64::from(b[i])).abs() * 16_777_216.0);
            // At the apex there is no segment.
            let here = if u[0] == 0.0 { d[0] } else { d[0].max(d[1]) };
            worst = worst.max(if d[0].is_nan() || d[1].is_nan() { f64::INFINITY } else { here });
        }
        out.push((
            label("round_trip"),
            worst <= ROUND_TRIP,
            format!("worst {worst:.2} u, allowed {ROUND_TRIP}"),
        ));
        let expected = map(backend, Kernel::PdfLinearTriangle, &behind(weights, &centres(), 3))?;
        let sum = expected.iter().map(|p| f64::from(*p)).sum::<f64>() / (CELLS * CELLS) as f64;
        out.push((label("integral"), (sum - 1.0).abs() <= 1e-6, format!("integral {sum:.9}")));
        let mut observed = vec![0_u64; CELLS * CELLS];
        for b in bary.chunks(3).skip(HARD_UNITS.len() * HARD_UNITS.len()) {
            let r = f64::from(b[1]) + f64::from(b[2]);
            let share = if r > 0.0 { f64::from(b[1]) / r } else { 0.0 };
            let cell = |x: f64| ((x * CELLS as f64) as usize).min(CELLS - 1);
            observed[cell(r * r) * CELLS + cell(share)] += 1;
        }
        let n: u64 = observed.iter().sum();
        let expected: Vec<f64> =
            expected.iter().map(|p| f64::from(*p) * n as f64 / (CELLS * CELLS) as f64).collect();
        let p = chi2_p(&observed, &expected);
        out.push((label("chi_square"), p >= level, format!("p = {p:.3e}, level {level:.2e}, {n} samples")));
    }
    Ok(())
}
