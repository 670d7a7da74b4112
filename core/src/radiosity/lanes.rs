//! Sums of products in one fixed order, the same for scalar code, every width of register and every number of threads.
//!
//! **The order.** Lane l of [`LANES`] = 16 starts at 0 and adds the products of the terms j = l, l + 16, l + 32, ... in
//! this order; each product is rounded before it is added (no fma). Then lanes are folded: l takes l + 8, then l + 4,
//! l + 2, l + 1. [`dot_reference`] says the same in scalar code and is what [`dot`] is tested against, bit for bit.
//!
//! **Error.** A term passes n/16 additions in its lane and 4 in the fold, so with u = 2^-24 the error is at most
//! (ceil(n/16) + 4) u sum |a_j x_j| to first order, against n u of a plain loop. Measured over form factors of n = 4096:
//! about 1 u, as errors of both signs cancel: no compensation is needed.
//!
//! **Overflow.** A sum in which infinities of both signs meet (or a term is NaN) has no value and gives 0, so that finite
//! input never gives NaN. A sum that overflows one way is infinite.

use core::ops::{Add, Div, Mul, Sub};

/// Partial sums of a dot product.
pub const LANES: usize = 16;

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
    impl Sealed for super::Magnitude {}
}

/// What sums are formed in: f32, f64 for residuals (the operator's entries stay f32), or the magnitudes of either.
pub trait Real:
    sealed::Sealed
    + Copy
    + Default
    + PartialOrd
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
{
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// An entry of an operator.
    fn from_f32(x: f32) -> Self;
    /// Without its sign.
    fn magnitude(self) -> Self;
    /// Neither infinite nor NaN.
    fn is_finite(self) -> bool;
}

macro_rules! real {
    ($float:ty) => {
        impl Real for $float {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            #[inline(always)]
            fn from_f32(x: f32) -> Self {
                x as $float
            }
            #[inline(always)]
            fn magnitude(self) -> Self {
                self.abs()
            }
            #[inline(always)]
            fn is_finite(self) -> bool {
                <$float>::is_finite(self)
            }
        }
    };
}

real!(f32);
real!(f64);

/// A number in f64 that takes an operator's entries without their sign: applying an operator to such numbers applies
/// |F|, which bounds what F can do.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Magnitude(pub f64);

macro_rules! magnitude_op {
    ($trait:ident, $method:ident) => {
        impl $trait for Magnitude {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0.$method(other.0))
            }
        }
    };
}

magnitude_op!(Add, add);
magnitude_op!(Sub, sub);
magnitude_op!(Mul, mul);
magnitude_op!(Div, div);

impl Real for Magnitude {
    const ZERO: Self = Self(0.0);
    const ONE: Self = Self(1.0);
    #[inline(always)]
    fn from_f32(x: f32) -> Self {
        Self(f64::from(x.abs()))
    }
    #[inline(always)]
    fn magnitude(self) -> Self {
        Self(self.0.abs())
    }
    #[inline(always)]
    fn is_finite(self) -> bool {
        self.0.is_finite()
    }
}

/// The value of a sum: 0 where it has none (NaN).
#[inline(always)]
pub fn value_or_zero<T: Real>(sum: T) -> T {
    // Only NaN does not equal itself.
    #[allow(clippy::eq_op, reason = "the test for NaN that every float type has")]
    if sum == sum { sum } else { T::ZERO }
}

/// Folds the lanes: l takes l + 8, then l + 4, l + 2, l + 1.
///
/// Never inlined: seen through, its narrowing tree makes the compiler keep the lanes of the loop before it in registers
/// of four floats instead of eight.
#[inline(never)]
pub fn fold<T: Real>(s: &[T; LANES]) -> T {
    let s: [T; 8] = core::array::from_fn(|l| s[l] + s[l + 8]);
    let s: [T; 4] = core::array::from_fn(|l| s[l] + s[l + 4]);
    value_or_zero((s[0] + s[2]) + (s[1] + s[3]))
}

/// One more term in every lane.
#[inline(always)]
fn advance<T: Real>(lanes: &mut [T; LANES], a: &[f32; LANES], x: &[T; LANES]) {
    for l in 0..LANES {
        lanes[l] = lanes[l] + T::from_f32(a[l]) * x[l];
    }
}

/// The last few entries, filled up with zeros. The zeros change no bit: a lane starts at +0, so it is never -0, and adding
/// +0 to anything else leaves it.
#[inline(always)]
fn padded<T: Real>(rest: &[T]) -> [T; LANES] {
    let mut full = [T::ZERO; LANES];
    for (to, from) in full.iter_mut().zip(rest) {
        *to = *from;
    }
    full
}

/// sum_j a_j x_j in the module's order, over the shorter of both lengths.
#[inline(always)]
#[must_use]
pub fn dot<T: Real>(a: &[f32], x: &[T]) -> T {
    dots([a], [x])[0][0]
}

/// [`dot`] as its definition says it, a term at a time.
#[must_use]
pub fn dot_reference<T: Real>(a: &[f32], x: &[T]) -> T {
    let mut lanes = [T::ZERO; LANES];
    for (j, (a, x)) in a.iter().zip(x).enumerate() {
        lanes[j % LANES] = lanes[j % LANES] + T::from_f32(*a) * *x;
    }
    fold(&lanes)
}

/// The dot products of R rows with C vectors, each in the module's order, over the shortest of all lengths. Rows and
/// vectors are read once: the lanes of all R C sums are in registers.
#[inline(always)]
#[must_use]
pub fn dots<T: Real, const R: usize, const C: usize>(rows: [&[f32]; R], x: [&[T]; C]) -> [[T; C]; R] {
    let n = rows.iter().map(|r| r.len()).chain(x.iter().map(|x| x.len())).min().unwrap_or(0);
    let blocks = n / LANES;
    let rows = rows.map(|r| &r[..n]);
    let x = x.map(|x| &x[..n]);
    let row_blocks = rows.map(|r| &r.as_chunks::<LANES>().0[..blocks]);
    let x_blocks = x.map(|x| &x.as_chunks::<LANES>().0[..blocks]);
    let mut lanes = [[[T::ZERO; LANES]; C]; R];
    for b in 0..blocks {
        for r in 0..R {
            for c in 0..C {
                advance(&mut lanes[r][c], &row_blocks[r][b], &x_blocks[c][b]);
            }
        }
    }
    if blocks * LANES < n {
        // Indices into lanes stay constants, or the compiler would keep the lanes in memory.
        let x = x.map(|x| padded(&x[blocks * LANES..]));
        for r in 0..R {
            let a = padded(&rows[r][blocks * LANES..]);
            for c in 0..C {
                advance(&mut lanes[r][c], &a, &x[c]);
            }
        }
    }
    core::array::from_fn(|r| core::array::from_fn(|c| fold(&lanes[r][c])))
}

/// R rows of the lower half of a symmetric matrix, one below the other, each with its diagonal last: gives their dot
/// products with `x` (which reach to the diagonal) and adds row_j * factor to `columns` for every j before the diagonal,
/// row after row. `x` and `columns` must reach as far as the last row.
///
/// The first row has at most 16 - R entries beyond a multiple of 16, or one more if R is 1: pairs start at even rows.
#[inline(always)]
pub(crate) fn dots_and_scatter<T: Real, const R: usize, const C: usize>(
    rows: [&[f32]; R],
    x: [&[T]; C],
    factors: [[T; C]; R],
    columns: &mut [&mut [T]; C],
) -> [[T; C]; R] {
    let blocks = rows[0].len().saturating_sub(1) / LANES;
    let done = blocks * LANES;
    let row_blocks = rows.map(|r| &r.as_chunks::<LANES>().0[..blocks]);
    let x_blocks = x.map(|x| &x.as_chunks::<LANES>().0[..blocks]);
    let mut lanes = [[[T::ZERO; LANES]; C]; R];
    {
        let column_blocks = columns.each_mut().map(|c| &mut c.as_chunks_mut::<LANES>().0[..blocks]);
        for b in 0..blocks {
            for c in 0..C {
                // All is read before anything is written: the compiler cannot know that columns are apart.
                let mut sums = column_blocks[c][b];
                for r in 0..R {
                    let a: [T; LANES] = row_blocks[r][b].map(T::from_f32);
                    advance(&mut lanes[r][c], &row_blocks[r][b], &x_blocks[c][b]);
                    for l in 0..LANES {
                        sums[l] = sums[l] + a[l] * factors[r][c];
                    }
                }
                column_blocks[c][b] = sums;
            }
        }
    }
    for r in 0..R {
        let n = rows[r].len();
        let a = padded(&rows[r][done..]);
        for c in 0..C {
            advance(&mut lanes[r][c], &a, &padded(&x[c][done..n]));
            for (column, a) in columns[c][done..n.saturating_sub(1)].iter_mut().zip(&a) {
                *column = *column + T::from_f32(*a) * factors[r][c];
            }
        }
    }
    core::array::from_fn(|r| core::array::from_fn(|c| fold(&lanes[r][c])))
}
