//! Finite sums of powers.

use super::super::lanes::{dot, value_or_zero};
use super::super::operator::{Dense, LinearOperator, OperatorError, check_len};
use super::product::{Multiply, Target, View};
use alloc::vec;
use alloc::vec::Vec;

/// A way to form M_k = A + A^2 + ... + A^k as a matrix. M_0 is zero.
pub trait PowerSum {
    /// M_k.
    ///
    /// # Errors
    /// [`OperatorError::NotFinite`] where the powers overflow.
    fn sum<M: Multiply + ?Sized>(&self, multiply: &M, a: &Dense, k: u32) -> Result<Dense, OperatorError>;

    /// How many matrix products it forms.
    fn products(&self, k: u32) -> u32;
}

/// M_1 = A, M_(h+1) = A + A M_h: the published form. Its error grows no faster than the sum itself: each step adds the
/// rounding of one product and passes the old error through A.
#[derive(Clone, Copy, Debug, Default)]
pub struct Horner;

/// S_2m = S_m + P_m S_m and P_2m = P_m P_m, where P_m = A^m; an odd count takes P_(m+1) = A P_m and
/// S_(m+1) = S_m + P_(m+1) on the way, and S_(m+1) = A + A S_m at the end.
#[derive(Clone, Copy, Debug, Default)]
pub struct Doubling;

fn square(n: usize, entries: &[f32]) -> View<'_, f32> {
    View { entries, stride: n, rows: n, columns: n }
}

/// `start` + A B.
fn step<M: Multiply + ?Sized>(m: &M, n: usize, start: Vec<f32>, a: &[f32], b: &[f32]) -> Vec<f32> {
    let mut c = start;
    if n > 0 {
        m.multiply_add(Target { entries: &mut c, stride: n, column: 0 }, square(n, a), square(n, b));
    }
    c
}

impl PowerSum for Horner {
    fn sum<M: Multiply + ?Sized>(&self, multiply: &M, a: &Dense, k: u32) -> Result<Dense, OperatorError> {
        let n = a.len();
        if k == 0 {
            return Dense::try_new(n, vec![0.0; n * n]);
        }
        let mut sum = a.entries().to_vec();
        for _ in 1..k {
            sum = step(multiply, n, a.entries().to_vec(), a.entries(), &sum);
            // Once an entry has overflowed there is nothing more to learn, however large k is.
            if sum.iter().any(|x| !x.is_finite()) {
                break;
            }
        }
        Dense::try_new(n, sum)
    }

    fn products(&self, k: u32) -> u32 {
        k.saturating_sub(1)
    }
}

impl PowerSum for Doubling {
    fn sum<M: Multiply + ?Sized>(&self, multiply: &M, a: &Dense, k: u32) -> Result<Dense, OperatorError> {
        let n = a.len();
        if k == 0 {
            return Dense::try_new(n, vec![0.0; n * n]);
        }
        let a = a.entries();
        let zero = || vec![0.0_f32; n * n];
        let mut sum = a.to_vec();
        let mut power = a.to_vec();
        // The bits of k below the leading one, from above.
        for bit in (0..k.ilog2()).rev() {
            let last = bit == 0;
            if bit + 1 == k.ilog2() {
                // S_1 and P_1 are both A: one product serves both.
                power = step(multiply, n, zero(), a, a);
                sum = a.iter().zip(&power).map(|(s, p)| s + p).collect();
            } else {
                sum = step(multiply, n, sum.clone(), &power, &sum);
                if !last {
                    power = step(multiply, n, zero(), &power, &power);
                }
            }
            if k >> bit & 1 == 1 {
                if last {
                    sum = step(multiply, n, a.to_vec(), a, &sum);
                } else {
                    power = step(multiply, n, zero(), a, &power);
                    sum.iter_mut().zip(&power).for_each(|(s, p)| *s += p);
                }
            }
            if sum.iter().any(|x| !x.is_finite()) {
                break;
            }
        }
        Dense::try_new(n, sum)
    }

    fn products(&self, k: u32) -> u32 {
        if k < 2 {
            return 0;
        }
        // One for the first doubling, two for each later one but the last, one for the last and for each odd step.
        let doublings = k.ilog2();
        let odd = k.count_ones() - 1;
        if doublings == 1 { 1 + odd } else { 2 * doublings - 2 + odd }
    }
}

/// Channels of an interleaved vector through an operator's matching method: one, three, or one after the other.
pub(super) fn apply_channels<O: LinearOperator + ?Sized, const C: usize>(
    operator: &O,
    x: &[[f32; C]],
    y: &mut [[f32; C]],
) -> Result<(), OperatorError> {
    match C {
        1 => operator.apply(x.as_flattened(), y.as_flattened_mut()),
        3 => operator
            .apply_rgb(x.as_flattened().as_chunks::<3>().0, y.as_flattened_mut().as_chunks_mut::<3>().0),
        _ => {
            let mut out = vec![0.0; y.len()];
            for c in 0..C {
                let plane: Vec<f32> = x.iter().map(|x| x[c]).collect();
                operator.apply(&plane, &mut out)?;
                y.iter_mut().zip(&out).for_each(|(y, out)| y[c] = *out);
            }
            Ok(())
        }
    }
}

/// M_k B0 = (A + ... + A^k) B0 with A = R F, matrix-free: x_1 = A B0, x_(h+1) = A (B0 + x_h). C is the number of channels,
/// each with its own albedo; one pass over F serves them all.
///
/// `radiosity` B0 \[W m^-2\] after the first reflection; the result is indirect radiosity \[W m^-2\]. Each step rounds the
/// sum B0 + x, the sum over F in the order of [`lanes`](super::super::lanes), and the product with the albedo. k = 0 gives
/// zeros.
///
/// # Errors
/// A wrong length.
pub fn series<O: LinearOperator + ?Sized, const C: usize>(
    form_factors: &O,
    albedo: &[[f32; C]],
    radiosity: &[[f32; C]],
    k: u32,
) -> Result<Vec<[f32; C]>, OperatorError> {
    let n = form_factors.len();
    check_len("albedo", albedo.len(), n)?;
    check_len("radiosity", radiosity.len(), n)?;
    let mut x = vec![[0.0_f32; C]; n];
    let mut sent = radiosity.to_vec();
    for h in 0..k {
        if h > 0 {
            for (sent, (b, x)) in sent.iter_mut().zip(radiosity.iter().zip(&x)) {
                *sent = core::array::from_fn(|c| b[c] + x[c]);
            }
        }
        apply_channels(form_factors, &sent, &mut x)?;
        for (x, rho) in x.iter_mut().zip(albedo) {
            *x = core::array::from_fn(|c| value_or_zero(rho[c] * x[c]));
        }
    }
    Ok(x)
}

/// Patches of the small operators, whose whole work fits a shader's registers.
pub const SMALL: usize = 8;

/// y = A x for at most [`SMALL`] patches: row i of A is `a[i * n ..]`; missing entries are 0, n beyond [`SMALL`] counts as
/// [`SMALL`], results beyond n are 0. Sums in the order of [`lanes`](super::super::lanes).
pub fn small_apply(n: usize, a: &[f32], x: [f32; SMALL]) -> [f32; SMALL] {
    let n = n.min(SMALL);
    let mut y = [0.0; SMALL];
    for (i, y) in y.iter_mut().enumerate().take(n) {
        let from = (i * n).min(a.len());
        *y = dot(&a[from..(from + n).min(a.len())], &x);
    }
    y
}

/// y = A^-1 S x for at most [`SMALL`] patches, as [`SymmetricHalf`](super::super::operator::SymmetricHalf) has it in its
/// first stripe: row i of the lower half of S starts at `half[i (i + 1) / 2]`; missing entries are 0, and so is the result
/// of a patch whose area is not positive.
pub fn small_apply_half(n: usize, areas: &[f32], half: &[f32], x: [f32; SMALL]) -> [f32; SMALL] {
    let n = n.min(SMALL);
    let (mut rows, mut columns) = ([0.0; SMALL], [0.0_f32; SMALL]);
    for i in 0..n {
        let from = (i * (i + 1) / 2).min(half.len());
        let row = &half[from..(from + i + 1).min(half.len())];
        rows[i] = dot(row, &x);
        for (column, s) in columns.iter_mut().zip(row).take(i) {
            *column += s * x[i];
        }
    }
    core::array::from_fn(|i| {
        let area = if i < n { areas.get(i).copied().unwrap_or(0.0) } else { 0.0 };
        if area > 0.0 { value_or_zero((rows[i] + columns[i]) / area) } else { 0.0 }
    })
}

/// (A + ... + A^k) b for at most [`SMALL`] patches, as [`series`] with A instead of R F; k counts up to 64.
pub fn small_series(n: usize, a: &[f32], b: [f32; SMALL], k: u32) -> [f32; SMALL] {
    let mut x = [0.0; SMALL];
    for _ in 0..k.min(64) {
        let sent = core::array::from_fn(|i| value_or_zero(b[i] + x[i]));
        x = small_apply(n, a, sent);
    }
    x
}
