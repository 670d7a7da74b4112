//! Form factors between patches, by rays.
//!
//! F(i, j) is the share of what patch i sends out evenly that arrives at patch j: F(i, j) = 1 / A_i times the integral over both of cos cos' V / (pi r^2).
//! A row's rays start evenly on its patch by the cosine law, so that F(i, j) is the share of them that meets j ([`rays`]). Rows see each pair twice:
//! A_i F(i, j) = A_j F(j, i), and both counts go into one number ([`assemble`]); [`balance`] sets the sums of rows right. Where a few pairs are wanted to more digits than
//! rays give, [`near`] has them in closed form, and [`assemble_with`] puts these in the place of counts.

mod assemble;
mod balance;
pub mod near;
pub mod rays;
pub mod reach;
#[cfg(test)]
mod tests;

pub use assemble::{FormFactors, RowError, assemble, assemble_with};
pub use balance::{Balance, balance};
pub use rays::Row;

/// Where row i of a packed half begins, which is also its length up to there.
#[inline(always)]
pub(in crate::radiosity) const fn start(i: usize) -> usize {
    i * (i + 1) / 2
}
