//! Radiosity's linear algebra on many threads and in wide registers.
//!
//! Core states the order of every sum; here only tiles, registers and threads differ, and the bits are those of core's
//! own forms (`tests/linear.rs`). A thread takes whole stripes of rows, never a part of a sum.

use crate::ThreadError;
use crate::simd::widest;
use etendue_core::radiosity::lanes::{Magnitude, Real, value_or_zero};
use etendue_core::radiosity::operator::{
    Dense, LinearOperator, OperatorError, STRIPE, Striped, SymmetricHalf, add_columns, to_planes,
};
use etendue_core::radiosity::polynomial::{Multiply, Packed, ROWS, Target, View, multiply_rows};
use rayon::prelude::*;
use std::sync::Arc;

/// Threads for matrix products and operators. By default rayon's own, those of whatever pool the caller is in.
#[derive(Clone, Debug, Default)]
pub struct Linear {
    pool: Option<Arc<rayon::ThreadPool>>,
}

impl Linear {
    /// With this many threads; `None` for one per core.
    ///
    /// # Errors
    /// When the system refuses the threads.
    pub fn new(threads: Option<usize>) -> Result<Self, ThreadError> {
        Ok(crate::CpuBackend::new(threads)?.linear())
    }

    /// Whether there is nothing to share: then the caller's own thread works, and nobody is woken.
    fn alone(&self) -> bool {
        self.threads() <= 1
    }

    pub(crate) fn threads(&self) -> usize {
        self.pool.as_ref().map_or_else(rayon::current_num_threads, |pool| pool.current_num_threads())
    }

    /// Runs on these threads.
    pub(crate) fn install<T: Send>(&self, run: impl FnOnce() -> T + Send) -> T {
        match &self.pool {
            Some(pool) => pool.install(run),
            None => run(),
        }
    }

    pub(crate) fn on(pool: Arc<rayon::ThreadPool>) -> Self {
        Self { pool: Some(pool) }
    }

    /// The same operator, applied by these threads.
    pub fn operator<'a, O: Striped>(&'a self, operator: &'a O) -> ParallelOperator<'a, O> {
        ParallelOperator { linear: self, operator }
    }
}

// The portable build has 16 registers of 4 floats, AVX2 16 of 8: tiles that leave room for both factors.
widest! {
    fn rows_f32(c: Target<'_, f32>, a: &View<'_, f32>, first: usize, b: &Packed<f32, 16>) {
        multiply_rows::<f32, 6, 16>(c, a, first, b);
    }
}

widest! {
    fn rows_f64(c: Target<'_, f64>, a: &View<'_, f64>, first: usize, b: &Packed<f64, 8>) {
        multiply_rows::<f64, 6, 8>(c, a, first, b);
    }
}

fn has_avx2() -> bool {
    #[cfg(target_arch = "x86_64")]
    {
        crate::simd::has_avx2()
    }
    #[cfg(not(target_arch = "x86_64"))]
    {
        false
    }
}

impl Linear {
    fn product<T: Real, const N: usize>(
        &self,
        c: Target<'_, T>,
        a: View<'_, T>,
        b: View<'_, T>,
        rows: impl Fn(Target<'_, T>, &View<'_, T>, usize, &Packed<T, N>) + Sync,
    ) {
        let (stride, column) = (c.stride.max(1), c.column);
        let packed = Packed::<T, N>::new(&b);
        if self.alone() {
            for (chunk, entries) in c.entries.chunks_mut(ROWS * stride).enumerate() {
                rows(Target { entries, stride, column }, &a, chunk * ROWS, &packed);
            }
            return;
        }
        self.install(|| {
            c.entries.par_chunks_mut(ROWS * stride).enumerate().for_each(|(chunk, entries)| {
                rows(Target { entries, stride, column }, &a, chunk * ROWS, &packed);
            });
        });
    }
}

impl Multiply for Linear {
    fn multiply_add(&self, c: Target<'_, f32>, a: View<'_, f32>, b: View<'_, f32>) {
        if has_avx2() {
            self.product(c, a, b, rows_f32);
        } else {
            self.product(c, a, b, multiply_rows::<f32, 4, 8>);
        }
    }

    fn multiply_add_wide(&self, c: Target<'_, f64>, a: View<'_, f64>, b: View<'_, f64>) {
        if has_avx2() {
            self.product(c, a, b, rows_f64);
        } else {
            self.product(c, a, b, multiply_rows::<f64, 4, 4>);
        }
    }
}

/// An operator whose stripes are compiled for wide registers too.
pub trait WideStripe<T: Real, const C: usize>: Striped {
    /// [`Striped::stripe`] in the widest registers of the machine.
    fn wide_stripe(&self, stripe: usize, x: [&[T]; C], rows: [&mut [T]; C], columns: [&mut [T]; C]);
}

macro_rules! wide_stripes {
    ($($name:ident: $operator:ty, $float:ty, $channels:literal;)*) => {$(
        widest! {
            fn $name(
                operator: &$operator,
                stripe: usize,
                x: [&[$float]; $channels],
                rows: [&mut [$float]; $channels],
                columns: [&mut [$float]; $channels],
            ) {
                operator.stripe(stripe, x, rows, columns);
            }
        }

        impl WideStripe<$float, $channels> for $operator {
            fn wide_stripe(
                &self,
                stripe: usize,
                x: [&[$float]; $channels],
                rows: [&mut [$float]; $channels],
                columns: [&mut [$float]; $channels],
            ) {
                $name(self, stripe, x, rows, columns);
            }
        }
    )*};
}

wide_stripes! {
    dense_f32: Dense, f32, 1;
    dense_f32_rgb: Dense, f32, 3;
    dense_f64: Dense, f64, 1;
    dense_f64_rgb: Dense, f64, 3;
    dense_magnitudes: Dense, Magnitude, 1;
    half_f32: SymmetricHalf, f32, 1;
    half_f32_rgb: SymmetricHalf, f32, 3;
    half_f64: SymmetricHalf, f64, 1;
    half_f64_rgb: SymmetricHalf, f64, 3;
    half_magnitudes: SymmetricHalf, Magnitude, 1;
}

/// [`WideStripe`] for all that a [`LinearOperator`] does.
pub trait WideOperator:
    WideStripe<f32, 1> + WideStripe<f32, 3> + WideStripe<f64, 1> + WideStripe<f64, 3> + WideStripe<Magnitude, 1>
{
}

impl<O> WideOperator for O where
    O: WideStripe<f32, 1>
        + WideStripe<f32, 3>
        + WideStripe<f64, 1>
        + WideStripe<f64, 3>
        + WideStripe<Magnitude, 1>
{
}

/// An operator on the threads of a [`Linear`]; the bits are those of the operator itself.
#[derive(Clone, Copy, Debug)]
pub struct ParallelOperator<'a, O> {
    linear: &'a Linear,
    operator: &'a O,
}

/// The rows of a stripe and what it adds to columns, in planes.
type Job<'a, T, const C: usize> = ([&'a mut [T]; C], [Vec<T>; C]);

impl<O> ParallelOperator<'_, O> {
    fn check(&self, x: usize, y: usize) -> Result<(), OperatorError>
    where
        O: Striped,
    {
        let expected = self.operator.len();
        for (slice, found) in [("x", x), ("y", y)] {
            if found != expected {
                return Err(OperatorError::WrongLength { slice, found, expected });
            }
        }
        Ok(())
    }

    fn run<T: Real, const C: usize>(&self, x: [&[T]; C], y: [&mut [T]; C])
    where
        O: WideStripe<T, C>,
    {
        let n = self.operator.len();
        let mut rest = y.map(|y| y.chunks_mut(STRIPE));
        let stripes = n.div_ceil(STRIPE);
        let mut jobs: Vec<Job<'_, T, C>> = (0..stripes)
            .map(|s| {
                let rows: [&mut [T]; C] = std::array::from_fn(|c| rest[c].next().unwrap_or_default());
                // Column sums reach to the stripe's own last row.
                let reach = if O::COLUMNS { ((s + 1) * STRIPE).min(n) } else { 0 };
                let columns: [Vec<T>; C] = std::array::from_fn(|_| vec![T::ZERO; reach]);
                (rows, columns)
            })
            .collect();
        let work = |(s, (rows, columns)): (usize, &mut Job<'_, T, C>)| {
            let rows = rows.each_mut().map(|r| &mut r[..]);
            self.operator.wide_stripe(s, x, rows, columns.each_mut().map(|c| &mut c[..]));
        };
        if self.linear.alone() {
            jobs.iter_mut().enumerate().for_each(work);
        } else {
            self.linear.install(|| jobs.par_iter_mut().with_max_len(1).enumerate().for_each(work));
        }
        for s in 0..stripes {
            let (earlier, later) = jobs.split_at_mut(s + 1);
            for c in 0..C {
                let own = earlier.last_mut().map(|(rows, columns)| (&mut *rows[c], &columns[c][..]));
                let Some((rows, columns)) = own else { continue };
                add_columns(rows, columns.get(s * STRIPE..).unwrap_or(&[]));
                for (_, columns) in &mut *later {
                    add_columns(rows, columns[c].get(s * STRIPE..).unwrap_or(&[]));
                }
                for (i, sum) in rows.iter_mut().enumerate() {
                    *sum = value_or_zero(self.operator.finish(s * STRIPE + i, *sum));
                }
            }
        }
    }

    fn run_rgb<T: Real>(&self, x: &[[T; 3]], y: &mut [[T; 3]]) -> Result<(), OperatorError>
    where
        O: WideStripe<T, 3>,
    {
        self.check(x.len(), y.len())?;
        let planes = to_planes(x);
        let mut out: [Vec<T>; 3] = std::array::from_fn(|_| vec![T::ZERO; y.len()]);
        self.run(planes.each_ref().map(|p| &p[..]), out.each_mut().map(|p| &mut p[..]));
        for (i, y) in y.iter_mut().enumerate() {
            *y = out.each_ref().map(|out| out[i]);
        }
        Ok(())
    }
}

impl<O: WideOperator> LinearOperator for ParallelOperator<'_, O> {
    fn len(&self) -> usize {
        self.operator.len()
    }

    fn apply(&self, x: &[f32], y: &mut [f32]) -> Result<(), OperatorError> {
        self.check(x.len(), y.len())?;
        self.run([x], [y]);
        Ok(())
    }

    fn apply_rgb(&self, x: &[[f32; 3]], y: &mut [[f32; 3]]) -> Result<(), OperatorError> {
        self.run_rgb(x, y)
    }

    fn apply_wide(&self, x: &[f64], y: &mut [f64]) -> Result<(), OperatorError> {
        self.check(x.len(), y.len())?;
        self.run([x], [y]);
        Ok(())
    }

    fn apply_wide_rgb(&self, x: &[[f64; 3]], y: &mut [[f64; 3]]) -> Result<(), OperatorError> {
        self.run_rgb(x, y)
    }

    fn apply_magnitudes(&self, x: &[f64], y: &mut [f64]) -> Result<(), OperatorError> {
        self.check(x.len(), y.len())?;
        let x: Vec<Magnitude> = x.iter().copied().map(Magnitude).collect();
        let mut out = vec![Magnitude(0.0); y.len()];
        self.run([&x], [&mut out]);
        y.iter_mut().zip(out).for_each(|(y, out)| *y = out.0);
        Ok(())
    }
}
