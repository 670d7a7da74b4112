//! One number for each pair of patches from what both rows counted.

use super::near::NearPair;
use super::{Row, start};
use crate::radiosity::patches::NO_PATCH;
use alloc::vec::Vec;
use core::fmt;

/// Rows that do not fit their patches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RowError {
    /// Another number of rows than of areas.
    WrongLength {
        /// Rows found.
        found: usize,
        /// Rows expected.
        expected: usize,
    },
    /// A row met a patch that is not there.
    UnknownPatch {
        /// The row.
        row: usize,
        /// What it met.
        patch: u32,
    },
    /// A row without rays.
    NoRays {
        /// The row.
        row: usize,
    },
}

impl fmt::Display for RowError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::WrongLength { found, expected } => {
                write!(f, "{found} rows of form factors, expected {expected}")
            }
            Self::UnknownPatch { row, patch } => {
                write!(f, "row {row} of form factors met patch {patch}, which is not there")
            }
            Self::NoRays { row } => write!(f, "row {row} of form factors has no rays"),
        }
    }
}

impl core::error::Error for RowError {}

/// Least share of a patch that counts as seen.
const SEEN_LEAST: f32 = 1e-3;

/// Form factors between n patches.
#[derive(Clone, Debug, PartialEq)]
pub struct FormFactors {
    /// Areas \[m^2\].
    pub areas: Vec<f32>,
    /// The lower half of A F \[m^2\], which is symmetric, packed: rows 0, 1, ... of 1, 2, ... entries.
    pub half: Vec<f32>,
    /// Share of each row's rays that met nothing.
    pub escaped: Vec<f32>,
    /// Share of each row's rays that met what is no patch.
    pub lost: Vec<f32>,
    /// Standard error of each row: root of the sum of the variances of its form factors, as if rays were independent (which they are better than).
    pub stderr: Vec<f32>,
}

/// Puts the two counts of each pair together.
///
/// With n_i rays a row has q_i = n_i / A_i of them a square metre, and A F(i, j) = (c_ij + c_ji) / (q_i + q_j): both counts have the mean q A F, and this
/// is their mean of least variance where counts are Poisson's. Reciprocity is exact.
///
/// # Errors
/// [`RowError`].
pub fn assemble(areas: &[f32], rows: &[Row]) -> Result<FormFactors, RowError> {
    assemble_with(areas, rows, &[])
}

/// The same, but for the pairs of `near`, which are as they are given; of a pair that is given twice the last counts.
///
/// # Errors
/// [`RowError`], pairs of patches that are not there among them.
pub fn assemble_with(areas: &[f32], rows: &[Row], near: &[NearPair]) -> Result<FormFactors, RowError> {
    let n = areas.len();
    if rows.len() != n {
        return Err(RowError::WrongLength { found: rows.len(), expected: n });
    }
    let mut half = alloc::vec![0.0_f32; start(n)];
    for (i, row) in rows.iter().enumerate() {
        if row.rays == 0 {
            return Err(RowError::NoRays { row: i });
        }
        for (j, count) in &row.met {
            if *j as usize >= n || *j == NO_PATCH {
                return Err(RowError::UnknownPatch { row: i, patch: *j });
            }
            let (high, low) = (i.max(*j as usize), i.min(*j as usize));
            // A pair of a patch with itself has one row.
            let count = if high == low { 2 * count } else { *count };
            half[start(high) + low] += count as f32;
        }
    }
    let place = |pair: &NearPair| {
        let [i, j] = pair.patches.map(|p| p as usize);
        start(i.max(j)) + i.min(j)
    };
    for pair in near {
        let [i, j] = pair.patches;
        if let Some(patch) = [i, j].into_iter().find(|p| *p as usize >= n) {
            return Err(RowError::UnknownPatch { row: i.min(j) as usize, patch });
        }
        half[place(pair)] = 0.0;
    }
    let density: Vec<f64> =
        rows.iter().zip(areas).map(|(row, area)| f64::from(row.rays) / f64::from(*area)).collect();
    let mut variance = alloc::vec![0.0_f64; n];
    for i in 0..n {
        for (j, entry) in half[start(i)..start(i + 1)].iter_mut().enumerate() {
            if *entry == 0.0 {
                continue;
            }
            let flux = f64::from(*entry) / (density[i] + density[j]);
            *entry = flux as f32;
            let spread = flux / (density[i] + density[j]);
            variance[i] += spread;
            if i != j {
                variance[j] += spread;
            }
        }
    }
    // Pairs that are given twice must not count twice.
    let mut given: Vec<(usize, usize)> = near.iter().enumerate().map(|(k, p)| (place(p), k)).collect();
    given.sort_unstable();
    for (k, (at, which)) in given.iter().enumerate() {
        if given.get(k + 1).is_some_and(|next| next.0 == *at) {
            continue;
        }
        let pair = &near[*which];
        half[*at] = pair.flux as f32;
        let [i, j] = pair.patches.map(|p| p as usize);
        variance[i] += pair.stderr * pair.stderr;
        if i != j {
            variance[j] += pair.stderr * pair.stderr;
        }
    }
    let share = |count: u32, row: &Row| (f64::from(count) / f64::from(row.rays)) as f32;
    let stderr = variance.iter().zip(areas).map(|(v, a)| crate::math::sqrt(*v as f32) / *a).collect();
    Ok(FormFactors {
        areas: areas.to_vec(),
        half,
        escaped: rows.iter().map(|r| share(r.escaped, r)).collect(),
        lost: rows.iter().map(|r| share(r.lost, r)).collect(),
        stderr,
    })
}

impl FormFactors {
    /// How many patches there are.
    pub fn len(&self) -> usize {
        self.areas.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.areas.is_empty()
    }

    /// A_i F(i, j) \[m^2\].
    pub fn flux(&self, i: usize, j: usize) -> f32 {
        self.half.get(start(i.max(j)) + i.min(j)).copied().unwrap_or(0.0)
    }

    /// Sums of rows of F.
    pub fn row_sums(&self) -> Vec<f64> {
        let n = self.len();
        let mut sums = alloc::vec![0.0_f64; n];
        for i in 0..n {
            for (j, flux) in self.half[start(i)..start(i + 1)].iter().enumerate() {
                sums[i] += f64::from(*flux);
                if i != j {
                    sums[j] += f64::from(*flux);
                }
            }
        }
        for (sum, area) in sums.iter_mut().zip(&self.areas) {
            *sum /= f64::from(*area);
        }
        sums
    }

    /// What the sums of rows should be: all but what escapes or is lost.
    pub fn targets(&self) -> Vec<f64> {
        self.escaped
            .iter()
            .zip(&self.lost)
            .map(|(e, l)| (1.0 - f64::from(*e) - f64::from(*l)).max(0.0))
            .collect()
    }

    /// The same without what is covered, and the share of each patch that is left: points whose rays meet what is no patch lie under something, as the floor under a box does, and are no part of what light falls on.
    /// What patches send each other is what it was; only areas are smaller, so that no light is lost. At least as much is left as others see of a patch, and a thousandth.
    #[must_use]
    pub fn seen(mut self) -> (Self, Vec<f32>) {
        let sums = self.row_sums();
        let share = |(lost, sum): (&f32, f64)| (1.0 - lost).max(sum as f32).clamp(SEEN_LEAST, 1.0);
        let seen: Vec<f32> = self.lost.iter().zip(sums).map(share).collect();
        for (i, seen) in seen.iter().enumerate() {
            self.areas[i] *= seen;
            self.stderr[i] /= seen;
            self.escaped[i] = (self.escaped[i] / seen).clamp(0.0, 1.0);
            self.lost[i] = 0.0;
        }
        (self, seen)
    }

    /// The same with patches in another order: patch i of the result is patch `order[i]` of this one, a permutation.
    #[must_use]
    pub fn reordered(&self, order: &[u32]) -> Self {
        let pick =
            |values: &[f32]| order.iter().map(|o| values.get(*o as usize).copied().unwrap_or(0.0)).collect();
        let mut half = Vec::with_capacity(self.half.len());
        for (i, a) in order.iter().enumerate() {
            half.extend(order[..=i].iter().map(|b| self.flux(*a as usize, *b as usize)));
        }
        Self {
            areas: pick(&self.areas),
            half,
            escaped: pick(&self.escaped),
            lost: pick(&self.lost),
            stderr: pick(&self.stderr),
        }
    }
}
