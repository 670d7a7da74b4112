//! Form factors as a linear operator: y = F x, where x is radiosity \[W m^-2\] per patch and y irradiance \[W m^-2\].
//!
//! F(i, j) is the form factor from patch i to patch j (no unit), so that row i gathers at patch i. Rows of a closed scene
//! sum to 1, and A_i F(i, j) = A_j F(j, i) for areas A. Albedo stays outside (R F, with R = diag(rho)): it can be edited
//! after F is made, and F is one channel where R F is three.
//!
//! [`Dense`] stores F, [`SymmetricHalf`] the lower half of A F. Both work in stripes of [`STRIPE`] rows with sums in the
//! order of [`lanes`](super::lanes), so that threads may share the stripes and still give the same bits. The three
//! channels of a colour go through the operator together: it is read once.

use super::lanes::{Magnitude, Real, dot_and_scatter, dots, value_or_zero};
use crate::math;
use alloc::vec;
use alloc::vec::Vec;
use core::fmt;

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

pub(super) fn check_len(slice: &'static str, found: usize, expected: usize) -> Result<(), OperatorError> {
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
    /// patch 0 to at least the last row of the stripe. `rows` has one entry per row of the stripe.
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
pub fn apply_stripes<O: Striped + ?Sized, T: Real, const C: usize>(
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

fn in_planes<O: Striped, T: Real>(operator: &O, x: &[[T; 3]], y: &mut [[T; 3]]) -> Result<(), OperatorError> {
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
        rows: [&mut [T]; C],
        _columns: [&mut [T]; C],
    ) {
        let first = stripe * STRIPE;
        let count = rows.iter().map(|r| r.len()).min().unwrap_or(0);
        let row = |i: usize| &self.entries[(first + i) * self.n..][..self.n];
        // Two rows of one vector keep as many registers busy as one row of three.
        let pairs = if C == 1 { count / 2 } else { 0 };
        for i in 0..pairs {
            let sums = dots([row(2 * i), row(2 * i + 1)], x);
            for c in 0..C {
                (rows[c][2 * i], rows[c][2 * i + 1]) = (sums[0][c], sums[1][c]);
            }
        }
        for i in 2 * pairs..count {
            let sums = dots([row(i)], x);
            for c in 0..C {
                rows[c][i] = sums[0][c];
            }
        }
    }

    #[inline(always)]
    fn finish<T: Real>(&self, _row: usize, sum: T) -> T {
        sum
    }
}

striped_operator!(Dense);

/// The lower half of S = A F, which is symmetric: 2 bytes per pair of patches, and F x = A^-1 (S x).
///
/// Row i of the half has i + 1 entries. Its dot product with x is in the order of [`lanes`](super::lanes); what the rows
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
        check_len("areas", areas.len(), form_factors.n)?;
        let n = areas.len();
        let one_way = |i: usize, j: usize| f64::from(areas[i]) * f64::from(form_factors.entries[i * n + j]);
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

pub(super) fn check_areas(areas: &[f32]) -> Result<(), OperatorError> {
    match areas.iter().position(|a| !(*a > 0.0 && a.is_finite())) {
        Some(patch) => Err(OperatorError::BadArea { patch, area: areas[patch] }),
        None => Ok(()),
    }
}

impl Striped for SymmetricHalf {
    const COLUMNS: bool = true;

    #[inline(always)]
    fn stripe<T: Real, const C: usize>(
        &self,
        stripe: usize,
        x: [&[T]; C],
        rows: [&mut [T]; C],
        mut columns: [&mut [T]; C],
    ) {
        let first = stripe * STRIPE;
        let count = rows.iter().map(|r| r.len()).min().unwrap_or(0);
        for i in 0..count {
            let row = &self.half[start(first + i)..start(first + i + 1)];
            let factor = x.map(|x| x[first + i]);
            let sums = dot_and_scatter(row, x, factor, columns.each_mut().map(|c| &mut c[..]));
            for c in 0..C {
                rows[c][i] = sums[c];
            }
        }
    }

    #[inline(always)]
    fn finish<T: Real>(&self, row: usize, sum: T) -> T {
        sum / T::from_f32(self.areas[row])
    }
}

striped_operator!(SymmetricHalf);

/// D F: an operator whose result is scaled row by row, such as R F with one albedo per patch for all channels. Tiled
/// operators compose the same way.
#[derive(Clone, Copy, Debug)]
pub struct Scaled<'a, O: ?Sized> {
    operator: &'a O,
    scale: &'a [f32],
}

impl<'a, O: LinearOperator + ?Sized> Scaled<'a, O> {
    /// diag(`scale`) `operator`.
    ///
    /// # Errors
    /// A wrong length, or a factor that is not finite (the error names it as row and column).
    pub fn try_new(operator: &'a O, scale: &'a [f32]) -> Result<Self, OperatorError> {
        check_len("scale", scale.len(), operator.len())?;
        match scale.iter().position(|s| !s.is_finite()) {
            Some(i) => Err(OperatorError::NotFinite { row: i, column: i, value: scale[i] }),
            None => Ok(Self { operator, scale }),
        }
    }
}

impl<O: LinearOperator + ?Sized> LinearOperator for Scaled<'_, O> {
    fn len(&self) -> usize {
        self.operator.len()
    }

    fn apply(&self, x: &[f32], y: &mut [f32]) -> Result<(), OperatorError> {
        self.operator.apply(x, y)?;
        y.iter_mut().zip(self.scale).for_each(|(y, s)| *y = value_or_zero(*y * s));
        Ok(())
    }

    fn apply_rgb(&self, x: &[[f32; 3]], y: &mut [[f32; 3]]) -> Result<(), OperatorError> {
        self.operator.apply_rgb(x, y)?;
        y.iter_mut().zip(self.scale).for_each(|(y, s)| *y = y.map(|y| value_or_zero(y * s)));
        Ok(())
    }

    fn apply_wide(&self, x: &[f64], y: &mut [f64]) -> Result<(), OperatorError> {
        self.operator.apply_wide(x, y)?;
        y.iter_mut().zip(self.scale).for_each(|(y, s)| *y = value_or_zero(*y * f64::from(*s)));
        Ok(())
    }

    fn apply_wide_rgb(&self, x: &[[f64; 3]], y: &mut [[f64; 3]]) -> Result<(), OperatorError> {
        self.operator.apply_wide_rgb(x, y)?;
        y.iter_mut().zip(self.scale).for_each(|(y, s)| *y = y.map(|y| value_or_zero(y * f64::from(*s))));
        Ok(())
    }

    fn apply_magnitudes(&self, x: &[f64], y: &mut [f64]) -> Result<(), OperatorError> {
        self.operator.apply_magnitudes(x, y)?;
        y.iter_mut().zip(self.scale).for_each(|(y, s)| *y = value_or_zero(*y * f64::from(math::abs(*s))));
        Ok(())
    }
}
