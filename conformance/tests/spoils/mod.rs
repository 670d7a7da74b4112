//! Kernel mutants, by the module that they spoil.

mod bc1;
mod discrete;
mod emission;
mod emit;
mod first_shot;
mod linear_triangle;
mod log_offset;
mod polynomial;
mod subdivide;

use etendue_core::kernel::Kernel;

/// Spoils one item of one kernel: (constants, item, out).
pub(crate) type Spoil = fn(&[u32], &[u32], &mut [u32]);

/// Name, kernel, and what is done to its answers.
pub(crate) type Mutant = (&'static str, Kernel, Spoil);

pub(crate) fn float(w: u32) -> f32 {
    f32::from_bits(w)
}

pub(crate) fn scale(out: &mut [u32], factor: f32) {
    for w in out {
        *w = (float(*w) * factor).to_bits();
    }
}

/// The mutants of all modules here.
pub(crate) const MUTANTS: &[&[Mutant]] = &[
    linear_triangle::MUTANTS,
    emission::MUTANTS,
    subdivide::MUTANTS,
    log_offset::MUTANTS,
    bc1::MUTANTS,
    polynomial::MUTANTS,
    discrete::MUTANTS,
    first_shot::MUTANTS,
    emit::MUTANTS,
];
