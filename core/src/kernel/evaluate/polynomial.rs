//! Kernels of `polynomial`.

use super::{Reader, Shared, Writer};
use crate::kernel::Kernel;
use crate::radiosity::lanes::{LANES, dot};
use crate::radiosity::polynomial::{SMALL, small_apply, small_apply_half, small_series};

/// Up to N floats of a table; those that are missing are 0.
fn floats<const N: usize>(words: &[u32]) -> [f32; N] {
    core::array::from_fn(|i| f32::from_bits(words.get(i).copied().unwrap_or(0)))
}

fn vector<const N: usize>(r: &mut Reader<'_>) -> [f32; N] {
    core::array::from_fn(|_| r.float())
}

pub(super) fn one(kernel: Kernel, shared: &Shared<'_>, mut r: Reader<'_>, w: &mut Writer<'_>) {
    let word = |i: usize| shared.constants.get(i).copied().unwrap_or(0);
    let n = (word(0) as usize).min(SMALL);
    let from = |i: usize| shared.constants.get(i..).unwrap_or(&[]);
    match kernel {
        Kernel::PolynomialDot => {
            let (a, x): ([f32; 2 * LANES], [f32; 2 * LANES]) = (vector(&mut r), vector(&mut r));
            w.float(dot(&a, &x));
        }
        Kernel::PolynomialApply => {
            w.floats(small_apply(n, &floats::<{ SMALL * SMALL }>(from(1)), vector(&mut r)));
        }
        Kernel::PolynomialApplyHalf => {
            let areas: [f32; SMALL] = floats(from(1));
            let half: [f32; SMALL * (SMALL + 1) / 2] = floats(from(1 + n));
            w.floats(small_apply_half(n, &areas, &half, vector(&mut r)));
        }
        Kernel::PolynomialSeries => {
            w.floats(small_series(n, &floats::<{ SMALL * SMALL }>(from(2)), vector(&mut r), word(1)));
        }
        _ => {}
    }
}
