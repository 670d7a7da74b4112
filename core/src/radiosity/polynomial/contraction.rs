//! Whether the bounces of light die out, and how fast.

use super::super::operator::{LinearOperator, OperatorError};
use alloc::vec;
use alloc::vec::Vec;

/// Bounds of the spectral radius of |A|, and the norm in which A is a contraction.
///
/// For any positive v the quotients (|A| v)_i / v_i enclose the spectral radius of |A| (L. Collatz 1942, H. Wielandt 1950);
/// the largest, `high`, is also the norm of A in max |x_i| / v_i. With `high` < 1 the series of bounces converges and
/// |x - x*| <= |residual| / (1 - high) in that norm.
#[derive(Clone, Debug, PartialEq)]
pub struct Contraction {
    /// The spectral radius of |A| is at least this.
    pub low: f64,
    /// And at most this.
    pub high: f64,
    /// The weights v, positive, at most 1.
    pub weights: Vec<f64>,
}

/// Steps after which [`contraction`] gives up.
const STEPS: u32 = 64;

impl Contraction {
    /// Whether the bounces are proved to die out.
    pub fn proved(&self) -> bool {
        self.high < 1.0
    }

    /// max_i v_i max_j |r_j| / v_j / (1 - high): how far, at most, an approximation with residual r is from the solution;
    /// infinite where nothing is proved.
    pub fn error_bound(&self, residual: impl Iterator<Item = f64>) -> f64 {
        if !self.proved() {
            return f64::INFINITY;
        }
        let worst = residual.zip(&self.weights).fold(0.0_f64, |m, (r, v)| {
            let q = r.abs() / v;
            // NaN counts as no bound at all.
            if q <= m {
                m
            } else if q.is_nan() {
                f64::INFINITY
            } else {
                q
            }
        });
        worst * self.weights.iter().fold(0.0_f64, |m, v| m.max(*v)) / (1.0 - self.high)
    }
}

/// Power iteration on |A| from v = 1, v <- (v + |A| v) / max, until `high` < 1 or `low` >= 1, at most 64 steps. The first
/// step settles every operator whose rows sum to less than 1. Sums in f64; their rounding is added to `high`.
///
/// # Errors
/// The operator's own (none: lengths agree).
pub fn contraction<O: LinearOperator + ?Sized>(operator: &O) -> Result<Contraction, OperatorError> {
    let n = operator.len();
    let mut weights = vec![1.0_f64; n];
    let mut next = vec![0.0_f64; n];
    let (mut low, mut high) = (0.0_f64, if n == 0 { 0.0 } else { f64::INFINITY });
    // Of a sum of n products in f64, with room to spare.
    let rounding = 1.0 + (n as f64 / 16.0 + 8.0) * 2.0 * f64::EPSILON;
    let mut best = weights.clone();
    for _ in 0..STEPS {
        operator.apply_magnitudes(&weights, &mut next)?;
        let quotients = || next.iter().zip(&weights).map(|(next, v)| next / v);
        let above = quotients().fold(0.0_f64, |m, q| if q > m || q.is_nan() { q } else { m }) * rounding;
        let below = quotients().fold(f64::INFINITY, |m, q| if q < m { q } else { m }) / rounding;
        if above < high {
            high = above;
            best.clone_from(&weights);
        }
        if below.is_finite() {
            low = low.max(below);
        }
        if high < 1.0 || low >= 1.0 || !above.is_finite() || n == 0 {
            break;
        }
        let largest = next.iter().zip(&weights).fold(0.0_f64, |m, (next, v)| m.max(next + v));
        for (v, next) in weights.iter_mut().zip(&next) {
            // Stays positive: v can at most halve, and 64 halvings are far from underflow.
            *v = ((*v + next) / largest).max(f64::MIN_POSITIVE);
        }
    }
    Ok(Contraction { low, high, weights: best })
}
