//! Form factors as a full matrix.

use super::super::lanes::{Magnitude, Real, dots};
use super::{
    LinearOperator, OperatorError, STRIPE, Striped, apply_stripes, check_len, in_planes, striped_operator,
};
use alloc::vec;
use alloc::vec::Vec;

/// A full matrix, row after row: 4 bytes per pair of patches.
#[derive(Clone, Debug, PartialEq)]
pub struct Dense {
    n: usize,
    entries: Vec<f32>,
}

impl Dense {
    /// An operator of n patches from its n^2 entries, row after row.
    ///
    /// # Errors
    /// A wrong number of entries, or one that is not finite.
    pub fn try_new(n: usize, entries: Vec<f32>) -> Result<Self, OperatorError> {
        let expected = n.checked_mul(n).ok_or(OperatorError::TooLarge { patches: n })?;
        check_len("entries", entries.len(), expected)?;
        match entries.iter().position(|e| !e.is_finite()) {
            Some(at) => Err(OperatorError::NotFinite { row: at / n, column: at % n, value: entries[at] }),
            None => Ok(Self { n, entries }),
        }
    }

    /// The entries, row after row.
    pub fn entries(&self) -> &[f32] {
        &self.entries
    }

    /// Row i; empty beyond the last one.
    pub fn row(&self, i: usize) -> &[f32] {
        if i < self.n { &self.entries[i * self.n..][..self.n] } else { &[] }
    }

    /// R F: each row times the albedo of its patch, rounded once. This is the published F^C(i, j) = F(i, j) colour_i of
    /// one channel.
    ///
    /// # Errors
    /// A wrong length, or a product that overflows.
    pub fn reflecting(&self, albedo: &[f32]) -> Result<Self, OperatorError> {
        check_len("albedo", albedo.len(), self.n)?;
        let entries = (0..self.n).flat_map(|i| self.row(i).iter().map(move |f| f * albedo[i])).collect();
        Self::try_new(self.n, entries)
    }

    /// F R: each column times the albedo of its patch, rounded once.
    ///
    /// # Errors
    /// A wrong length, or a product that overflows.
    pub fn reflected(&self, albedo: &[f32]) -> Result<Self, OperatorError> {
        check_len("albedo", albedo.len(), self.n)?;
        let entries =
            (0..self.n).flat_map(|i| self.row(i).iter().zip(albedo).map(|(f, rho)| f * rho)).collect();
        Self::try_new(self.n, entries)
    }
}

impl Striped for Dense {
    const COLUMNS: bool = false;

    #[inline(always)]
    fn stripe<T: Real, const C: usize>(
        &self,
        stripe: usize,
        x: [&[T]; C],
        mut rows: [&mut [T]; C],
        _columns: [&mut [T]; C],
    ) {
        let first = stripe.saturating_mul(STRIPE);
        let count = rows.iter().map(|r| r.len()).min().unwrap_or(0).min(self.n.saturating_sub(first));
        if x.iter().any(|x| x.len() < self.n) {
            return;
        }
        let row = |i: usize| &self.entries[(first + i) * self.n..][..self.n];
        // Two rows of one vector keep as many registers busy as one row of three.
        let pairs = if C == 1 { count / 2 } else { 0 };
        for i in 0..pairs {
            let sums = dots([row(2 * i), row(2 * i + 1)], x);
            for (c, rows) in rows.iter_mut().enumerate() {
                (rows[2 * i], rows[2 * i + 1]) = (sums[0][c], sums[1][c]);
            }
        }
        for i in 2 * pairs..count {
            let [sums] = dots([row(i)], x);
            rows.iter_mut().zip(sums).for_each(|(rows, sum)| rows[i] = sum);
        }
    }

    #[inline(always)]
    fn finish<T: Real>(&self, _row: usize, sum: T) -> T {
        sum
    }
}

striped_operator!(Dense);
