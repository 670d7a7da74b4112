//! Form factors as a linear operator: y = F x, where x is radiosity \[W m^-2\] per patch and y irradiance \[W m^-2\].
//!
//! F(i, j) is the form factor from patch i to patch j (no unit), so that row i gathers at patch i. Rows of a closed scene
//! sum to 1, and A_i F(i, j) = A_j F(j, i) for areas A. Albedo stays outside (R F, with R = diag(rho)): it can be edited
//! after F is made, and F is one channel where R F is three.
//!
//! [`Dense`] stores F, [`SymmetricHalf`] the lower half of A F. Both work in stripes of [`STRIPE`] rows with sums in the
//! order of [`lanes`](super::lanes), so that threads may share the stripes and still give the same bits. The three
//! channels of a colour go through the operator together: it is read once.

mod dense;
mod half;
mod scaled;

use super::lanes::{Real, value_or_zero};
use alloc::vec;
use alloc::vec::Vec;
use core::fmt;

pub use dense::Dense;
pub use half::SymmetricHalf;
pub use scaled::Scaled;

/// Rows of a stripe, the unit of work.
pub const STRIPE: usize = 256;

/// Why something is no operator, or cannot be applied to this.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum OperatorError {
    /// A slice has the wrong length.
    WrongLength {
        /// Which one.
        slice: &'static str,
        /// Its length.
        found: usize,
        /// What it should be.
        expected: usize,
    },
    /// More entries than memory can address.
    TooLarge {
        /// Number of patches.
        patches: usize,
    },
    /// An entry is infinite or not a number.
    NotFinite {
        /// Its row.
        row: usize,
        /// Its column.
        column: usize,
        /// The entry.
        value: f32,
    },
    /// An area is not positive and finite.
    BadArea {
        /// The patch.
        patch: usize,
        /// Its area \[m^2\].
        area: f32,
    },
}

impl fmt::Display for OperatorError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::WrongLength { slice, found, expected } => {
                write!(f, "{slice} has {found} entries, not {expected}")
            }
            Self::TooLarge { patches } => write!(f, "{patches} patches have too many form factors"),
            Self::NotFinite { row, column, value } => write!(f, "entry ({row}, {column}) is {value}"),
            Self::BadArea { patch, area } => {
                write!(f, "patch {patch} has area {area}, not positive and finite")
            }
        }
    }
}

impl core::error::Error for OperatorError {}

pub(in crate::radiosity) fn check_len(
    slice: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), OperatorError> {
    if found == expected { Ok(()) } else { Err(OperatorError::WrongLength { slice, found, expected }) }
}

/// A square matrix that is known by what it does to vectors.
///
/// Every `apply` fails only when `x` or `y` is not as long as the operator. Finite `x` never gives NaN
/// ([`lanes`](super::lanes), overflow).
pub trait LinearOperator {
    /// Number of patches n.
    fn len(&self) -> usize;

    /// Whether there are no patches.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// y = F x.
    ///
    /// # Errors
    /// A length that is not [`len`](Self::len).
    fn apply(&self, x: &[f32], y: &mut [f32]) -> Result<(), OperatorError>;

    /// y = F x for three channels at once; the bits are those of three calls of [`apply`](Self::apply).
    ///
    /// # Errors
    /// As [`apply`](Self::apply).
    fn apply_rgb(&self, x: &[[f32; 3]], y: &mut [[f32; 3]]) -> Result<(), OperatorError>;

    /// y = F x with the same f32 entries and sums in f64: residuals need it. For the host only.
    ///
    /// # Errors
    /// As [`apply`](Self::apply).
    fn apply_wide(&self, x: &[f64], y: &mut [f64]) -> Result<(), OperatorError>;

    /// [`apply_wide`](Self::apply_wide) for three channels.
    ///
    /// # Errors
    /// As [`apply`](Self::apply).
    fn apply_wide_rgb(&self, x: &[[f64; 3]], y: &mut [[f64; 3]]) -> Result<(), OperatorError>;

    /// y = |F| x with sums in f64, where |F| has the entries' magnitudes: it bounds what F can do
    /// ([`contraction`](super::polynomial::contraction)).
    ///
    /// # Errors
    /// As [`apply`](Self::apply).
    fn apply_magnitudes(&self, x: &[f64], y: &mut [f64]) -> Result<(), OperatorError>;
}

/// An operator that is applied a stripe of rows at a time: the door for a backend's threads.
///
/// A stripe reads all of `x` and gives the sums of its own rows; where only half of a symmetric matrix is stored, it
/// also gives what its rows add to the columns before them. The result of row i is
/// `finish(i, row sum + columns of stripe i / STRIPE + columns of the next stripe + ...)`, added in this order.
pub trait Striped: LinearOperator + Sync {
    /// Whether stripes add to columns.
    const COLUMNS: bool;

    /// Row sums of a stripe and, if [`COLUMNS`](Self::COLUMNS), its column sums, *added* to `columns`, which reach from
    /// patch 0 to at least the last row of the stripe. `rows` has one entry per row of the stripe. Does nothing where `x`
    /// or `columns` is too short; rows beyond the last one keep their values.
    fn stripe<T: Real, const C: usize>(
        &self,
        stripe: usize,
        x: [&[T]; C],
        rows: [&mut [T]; C],
        columns: [&mut [T]; C],
    );

    /// What a row's whole sum still needs.
    fn finish<T: Real>(&self, row: usize, sum: T) -> T;
}

/// Splits vectors of C channels into C planes.
pub fn to_planes<T: Real, const C: usize>(x: &[[T; C]]) -> [Vec<T>; C] {
    core::array::from_fn(|c| x.iter().map(|x| x[c]).collect())
}

/// y = F x over planes, a stripe after the other: what every schedule of the stripes must equal.
pub(in crate::radiosity) fn apply_stripes<O: Striped + ?Sized, T: Real, const C: usize>(
    operator: &O,
    x: [&[T]; C],
    mut y: [&mut [T]; C],
) {
    let n = operator.len();
    let mut columns: [Vec<T>; C] = core::array::from_fn(|_| vec![T::ZERO; if O::COLUMNS { n } else { 0 }]);
    for first in (0..n).step_by(STRIPE) {
        let end = (first + STRIPE).min(n);
        columns.iter_mut().for_each(|c| c.fill(T::ZERO));
        let rows = y.each_mut().map(|y| &mut y[first..end]);
        operator.stripe(first / STRIPE, x, rows, columns.each_mut().map(|c| &mut c[..]));
        if O::COLUMNS {
            for (y, columns) in y.iter_mut().zip(&columns) {
                add_columns(&mut y[..end], columns);
            }
        }
    }
    for y in &mut y {
        for (row, sum) in y.iter_mut().enumerate() {
            *sum = value_or_zero(operator.finish(row, *sum));
        }
    }
}

/// Adds a stripe's column sums to the rows' sums so far.
#[inline(always)]
pub fn add_columns<T: Real>(rows: &mut [T], columns: &[T]) {
    for (row, column) in rows.iter_mut().zip(columns) {
        *row = *row + *column;
    }
}

/// [`LinearOperator`] of what has `n` and is [`Striped`].
macro_rules! striped_operator {
    ($name:ty) => {
        impl LinearOperator for $name {
            fn len(&self) -> usize {
                self.n
            }

            fn apply(&self, x: &[f32], y: &mut [f32]) -> Result<(), OperatorError> {
                check_len("x", x.len(), self.n)?;
                check_len("y", y.len(), self.n)?;
                apply_stripes(self, [x], [y]);
                Ok(())
            }

            fn apply_rgb(&self, x: &[[f32; 3]], y: &mut [[f32; 3]]) -> Result<(), OperatorError> {
                in_planes(self, x, y)
            }

            fn apply_wide(&self, x: &[f64], y: &mut [f64]) -> Result<(), OperatorError> {
                check_len("x", x.len(), self.n)?;
                check_len("y", y.len(), self.n)?;
                apply_stripes(self, [x], [y]);
                Ok(())
            }

            fn apply_wide_rgb(&self, x: &[[f64; 3]], y: &mut [[f64; 3]]) -> Result<(), OperatorError> {
                in_planes(self, x, y)
            }

            fn apply_magnitudes(&self, x: &[f64], y: &mut [f64]) -> Result<(), OperatorError> {
                check_len("x", x.len(), self.n)?;
                check_len("y", y.len(), self.n)?;
                let x: Vec<Magnitude> = x.iter().copied().map(Magnitude).collect();
                let mut out = vec![Magnitude(0.0); self.n];
                apply_stripes(self, [&x], [&mut out]);
                for (y, out) in y.iter_mut().zip(out) {
                    *y = out.0;
                }
                Ok(())
            }
        }
    };
}

pub(in crate::radiosity) fn in_planes<O: Striped, T: Real>(
    operator: &O,
    x: &[[T; 3]],
    y: &mut [[T; 3]],
) -> Result<(), OperatorError> {
    let n = operator.len();
    check_len("x", x.len(), n)?;
    check_len("y", y.len(), n)?;
    let x = to_planes(x);
    let mut out: [Vec<T>; 3] = core::array::from_fn(|_| vec![T::ZERO; n]);
    apply_stripes(operator, x.each_ref().map(|x| &x[..]), out.each_mut().map(|y| &mut y[..]));
    for (i, y) in y.iter_mut().enumerate() {
        *y = out.each_ref().map(|out| out[i]);
    }
    Ok(())
}

pub(in crate::radiosity) fn check_areas(areas: &[f32]) -> Result<(), OperatorError> {
    match areas.iter().position(|a| !(*a > 0.0 && a.is_finite())) {
        Some(patch) => Err(OperatorError::BadArea { patch, area: areas[patch] }),
        None => Ok(()),
    }
}

use striped_operator;
