//! Form factors as the half that reciprocity leaves.

use super::super::lanes::{Magnitude, Real, dots_and_scatter};
use super::{
    Dense, LinearOperator, OperatorError, STRIPE, Striped, apply_stripes, check_areas, check_len, in_planes,
    striped_operator,
};
use alloc::vec;
use alloc::vec::Vec;

/// The lower half of S = A F, which is symmetric: 2 bytes per pair of patches, and F x = A^-1 (S x).
///
/// Row i of the half has i + 1 entries. Its dot product with x is in the order of [`lanes`](super::super::lanes); what the rows
/// below add to patch i comes in the order of rows, stripe by stripe ([`Striped`]). The bits are not those of [`Dense`].
#[derive(Clone, Debug, PartialEq)]
pub struct SymmetricHalf {
    n: usize,
    areas: Vec<f32>,
    half: Vec<f32>,
}

/// Where row i of a packed half starts; also its length up to there.
#[inline(always)]
fn start(i: usize) -> usize {
    i * (i + 1) / 2
}

impl SymmetricHalf {
    /// From areas \[m^2\] and the packed lower half of A F \[m^2\]: rows 0, 1, ... of 1, 2, ... entries.
    ///
    /// # Errors
    /// A wrong number of entries, one that is not finite, or an area that is not positive and finite.
    pub fn try_new(areas: Vec<f32>, half: Vec<f32>) -> Result<Self, OperatorError> {
        let n = areas.len();
        check_areas(&areas)?;
        n.checked_mul(n + 1).ok_or(OperatorError::TooLarge { patches: n })?;
        check_len("half", half.len(), start(n))?;
        for row in 0..n {
            if let Some(column) = half[start(row)..start(row + 1)].iter().position(|e| !e.is_finite()) {
                return Err(OperatorError::NotFinite { row, column, value: half[start(row) + column] });
            }
        }
        Ok(Self { n, areas, half })
    }

    /// The symmetric part of A F: S(i, j) = (A_i F(i, j) + A_j F(j, i)) / 2, formed in f64 and rounded once. Where the
    /// form factors are reciprocal that is A F itself; otherwise it spreads their disagreement.
    ///
    /// # Errors
    /// A wrong number of areas, a bad one, or an entry that overflows.
    pub fn from_dense(form_factors: &Dense, areas: &[f32]) -> Result<Self, OperatorError> {
        check_len("areas", areas.len(), form_factors.len())?;
        let n = areas.len();
        let one_way = |i: usize, j: usize| f64::from(areas[i]) * f64::from(form_factors.row(i)[j]);
        let mut half = Vec::with_capacity(start(n));
        for i in 0..n {
            half.extend((0..=i).map(|j| (0.5 * (one_way(i, j) + one_way(j, i))) as f32));
        }
        Self::try_new(areas.to_vec(), half)
    }

    /// Areas \[m^2\].
    pub fn areas(&self) -> &[f32] {
        &self.areas
    }

    /// Row i of the half, the diagonal last; empty beyond the last row.
    pub fn row(&self, i: usize) -> &[f32] {
        if i < self.n { &self.half[start(i)..start(i + 1)] } else { &[] }
    }
}

impl Striped for SymmetricHalf {
    const COLUMNS: bool = true;

    #[inline(always)]
    fn stripe<T: Real, const C: usize>(
        &self,
        stripe: usize,
        x: [&[T]; C],
        mut rows: [&mut [T]; C],
        mut columns: [&mut [T]; C],
    ) {
        let first = stripe.saturating_mul(STRIPE).min(self.n);
        let count = rows.iter().map(|r| r.len()).min().unwrap_or(0).min(self.n.saturating_sub(first));
        if x.iter().any(|x| x.len() < self.n) || columns.iter().any(|c| c.len() < first + count) {
            return;
        }
        let row = |i: usize| &self.half[start(first + i)..start(first + i + 1)];
        let factor = |i: usize| x.map(|x| x[first + i]);
        // Pairs read and write the columns half as often; a stripe starts at a multiple of 16.
        let pairs = if C == 1 { count / 2 } else { 0 };
        for i in 0..pairs {
            let i = 2 * i;
            let sums = dots_and_scatter([row(i), row(i + 1)], x, [factor(i), factor(i + 1)], &mut columns);
            for (c, rows) in rows.iter_mut().enumerate() {
                (rows[i], rows[i + 1]) = (sums[0][c], sums[1][c]);
            }
        }
        for i in 2 * pairs..count {
            let [sums] = dots_and_scatter([row(i)], x, [factor(i)], &mut columns);
            rows.iter_mut().zip(sums).for_each(|(rows, sum)| rows[i] = sum);
        }
    }

    #[inline(always)]
    fn finish<T: Real>(&self, row: usize, sum: T) -> T {
        // Beyond the last row there is nothing to divide by.
        self.areas.get(row).map_or(sum, |area| sum / T::from_f32(*area))
    }
}

striped_operator!(SymmetricHalf);
