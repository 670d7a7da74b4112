//! Sums of powers of a transport operator: M_k = A + A^2 + ... + A^k, where A = R F reflects at each bounce (form factors
//! F, albedo R). M_k B0 is the indirect radiosity \[W m^-2\] of k bounces, where B0 is the radiosity after the first
//! reflection of direct light and of emission.
//!
//! | wanted | form | cost |
//! |---|---|---|
//! | M_k as a matrix | [`Horner`] (published): M <- A + A M | k - 1 products |
//! | | [`Doubling`]: S_2m = S_m + A^m S_m | about 2 log2 k products |
//! | M_k B0 | [`series`]: k passes over F, three channels in each | k passes |
//! | all bounces of B0 | [`solve`]: correction by an [`Inner`] solver until an error bound holds | about 10 passes |
//! | all bounces as a matrix | [`infinite`], [`gather`]: blocked LU | 4/3 products |
//!
//! A product of n x n matrices is n^3 multiplications and as many additions. Truncation after k bounces leaves a share of
//! about rho^k of the indirect light; the last two rows have none.
//!
//! **Error**, relative L2 against f64, in a closed box of 150 patches, after k = 3, 16 and 64 bounces (measured; the tests
//! hold each entry to a bound of (min(n, 256) + n / 256 + 3) u per bounce with u = 2^-24):
//!
//! | form | albedo 0.2 to 0.9 | albedo 0.999 |
//! |---|---|---|
//! | [`Horner`] | 6e-8, 7e-8, 7e-8 | 9e-8, 1.5e-7, 1.8e-7 |
//! | [`Doubling`] | 6e-8, 6e-8, 7e-8 | 9e-8, 1.1e-7, 1.1e-7 |
//! | [`series`] | 5e-8, 5e-8, 5e-8 | 6e-8, 1.2e-7, 3.8e-7 |
//! | [`solve`], all bounces | rounded once | rounded once |
//! | [`infinite`] in f32, all bounces | 1.9e-7 | 2.6e-5 |
//! | [`infinite`] in f64, all bounces | 3e-8 | 3e-8 |
//!
//! What no solver can mend: form factors rounded to f32 make the rows of a closed scene sum to 1 within about n^(1/2) u, and
//! 1 / (1 - rho) amplifies that (to 1e-6 of the radiosity at rho = 0.999 in that box).

mod contraction;
mod dense;
mod inner;
mod product;
mod solve;
mod sums;

pub use contraction::{Contraction, contraction};
pub use dense::{Lu, gather, infinite};
pub use inner::{ConjugateGradients, GaussSeidel, Inner, Jacobi, Residual};
pub use product::{
    BLOCK, Element, Multiply, Packed, Portable, ROWS, Target, View, multiply_add_reference, multiply_rows,
};
pub use solve::{Settings, Solution, SolveError, solve};
pub use sums::{Doubling, Horner, PowerSum, SMALL, series, small_apply, small_apply_half, small_series};
