//! The mixture of estimates whose estimated error is least.

use alloc::vec::Vec;

/// Rounds over all pairs.
const ROUNDS: usize = 200;

/// Shares a, none below 0, their sum 1, with the least a Q a + 2 b a: `products` is Q, symmetric and positive semidefinite, `linear` is b.
///
/// Moves share between two at a time, which ends at the one minimum of this convex function.
pub(super) fn shares(products: &[Vec<f64>], linear: &[f64]) -> Vec<f64> {
    let n = linear.len();
    let mut shares = alloc::vec![0.0_f64; n];
    if n == 0 {
        return shares;
    }
    shares[n - 1] = 1.0;
    for _ in 0..ROUNDS {
        for i in 0..n {
            for j in 0..i {
                let slope =
                    |k: usize| linear[k] + products[k].iter().zip(&shares).map(|(q, a)| q * a).sum::<f64>();
                let (down, curve) =
                    (slope(j) - slope(i), products[i][i] + products[j][j] - 2.0 * products[i][j]);
                let step = if curve > 0.0 { down / curve } else { 0.0 };
                let step = step.max(-shares[i]).min(shares[j]);
                shares[i] += step;
                shares[j] -= step;
            }
        }
    }
    shares
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_of_a_convex_function_is_found() {
        // Independent estimates of variance 1 and 3, at the ends of a base: a^2 + 3 (1 - a)^2 is least at 3/4.
        let found = shares(&[alloc::vec![1.0, 0.0], alloc::vec![0.0, 3.0]], &[0.0; 2]);
        assert!((found[0] - 0.75).abs() < 1e-12 && (found[1] - 0.25).abs() < 1e-12, "{found:?}");
        let found = shares(&[alloc::vec![1.0, 0.0], alloc::vec![0.0, 3.0]], &[4.0, 0.0]);
        assert_eq!(found, [0.0, 1.0]);
        assert_eq!(shares(&[alloc::vec![0.0; 2], alloc::vec![0.0; 2]], &[0.0; 2]), [0.0, 1.0]);
        assert_eq!(shares(&[alloc::vec![5.0]], &[1.0]), [1.0]);
        assert!(shares(&[], &[]).is_empty());
    }
}
