//! How much of an error more samples would not take away.
//!
//! With x_i the R replicates of an image, b its mean error and d_i = x_i - r, the sum over pixels of `(|sum d_i|^2 - sum |d_i|^2) / (R (R - 1))` has the mean `|b|^2 + var(r)`: products of different replicates, in
//! which noise has no part. Summed by blocks of pixels it also tells its own spread: where b is nothing, the blocks' sums scatter about 0.

use crate::metrics::BLOCK;
use crate::metrics::statistics::normal_survival;

/// Sums over the replicates of one rung.
#[derive(Clone, Debug)]
pub struct Structure {
    width: usize,
    /// Sum of the replicates' differences from the reference, and of their squares.
    sum: Vec<[f64; 3]>,
    squares: Vec<f64>,
    count: u32,
}

/// What the sums say of all pixels together, in relation to the reference's own square.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parts {
    /// `rel_error` that would be left after ever more replicates.
    pub lasting: f64,
    /// `rel_error` of noise in one replicate.
    pub noise: f64,
    /// Chance that blocks would say this of an image without lasting errors.
    pub chance: f64,
}

impl Structure {
    /// Of an image of so many pixels.
    pub fn new(width: usize, pixels: usize) -> Self {
        Self { width: width.max(1), sum: vec![[0.0; 3]; pixels], squares: vec![0.0; pixels], count: 0 }
    }

    /// Adds a replicate. Pixels that the mask leaves out, or that are not finite, count as right.
    pub fn add(&mut self, x: &[[f32; 3]], r: &[[f32; 3]], mask: Option<&[bool]>) {
        for (i, (x, r)) in x.iter().zip(r).enumerate() {
            let d = [0, 1, 2].map(|c| f64::from(x[c]) - f64::from(r[c]));
            if mask.is_some_and(|m| !m[i]) || d.iter().any(|v| !v.is_finite()) {
                continue;
            }
            self.sum[i] = [0, 1, 2].map(|c| self.sum[i][c] + d[c]);
            self.squares[i] += d.iter().map(|v| v * v).sum::<f64>();
        }
        self.count += 1;
    }

    /// The two parts of the error; `None` below two replicates or for a black reference.
    pub fn parts(&self, r: &[[f32; 3]], var_r: Option<&[[f32; 3]]>, mask: Option<&[bool]>) -> Option<Parts> {
        let n = f64::from(self.count);
        if self.count < 2 {
            return None;
        }
        let blocks_across = self.width.div_ceil(BLOCK);
        let blocks_down = (self.sum.len() / self.width).div_ceil(BLOCK);
        let mut blocks = vec![0.0; blocks_across * blocks_down];
        let (mut square, mut noise) = (0.0, 0.0);
        for i in 0..self.sum.len() {
            if mask.is_some_and(|m| !m[i]) {
                continue;
            }
            let together: f64 = self.sum[i].iter().map(|v| v * v).sum();
            let known = var_r.map_or(0.0, |v| v[i].iter().map(|x| f64::from(*x)).sum::<f64>());
            let product = (together - self.squares[i]) / (n * (n - 1.0)) - known;
            let (x, y) = (i % self.width, i / self.width);
            blocks[y / BLOCK * blocks_across + x / BLOCK] += product;
            noise += (self.squares[i] - together / n) / (n - 1.0);
            square += r[i].iter().map(|x| f64::from(*x).powi(2)).sum::<f64>();
        }
        if square <= 0.0 {
            return None;
        }
        let sum: f64 = blocks.iter().sum();
        let spread = blocks.iter().map(|b| b * b).sum::<f64>().sqrt();
        let chance = if spread > 0.0 { normal_survival(sum / spread) } else { 1.0 };
        Some(Parts { lasting: (sum.max(0.0) / square).sqrt(), noise: (noise / square).sqrt(), chance })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_core::sampling::numbers::Numbers;

    const SIDE: usize = 256;

    /// Five replicates of a grey image with noise of 10 % a pixel, and an error that all share.
    fn parts(shared: impl Fn(usize) -> f32, seed: u64) -> Parts {
        let reference = vec![[0.5; 3]; SIDE * SIDE];
        let mut structure = Structure::new(SIDE, SIDE * SIDE);
        for replicate in 0..5 {
            let numbers = Numbers::random(seed, replicate);
            let image: Vec<[f32; 3]> = (0..SIDE * SIDE)
                .map(|i| {
                    let u = numbers.with_index(i as u32).group4(0);
                    [0, 1, 2].map(|c| 0.5 + 0.05 * (12.0_f32).sqrt() * (u[c] - 0.5) + shared(i))
                })
                .collect();
            structure.add(&image, &reference, None);
        }
        structure.parts(&reference, None, None).unwrap()
    }

    #[test]
    fn noise_alone_is_noise_alone() {
        let mut small = 0;
        for seed in 0..20 {
            let found = parts(|_| 0.0, seed);
            assert!((found.noise - 0.1).abs() < 1e-3, "{found:?}");
            assert!(found.lasting < 0.005, "{found:?}");
            small += u32::from(found.chance < 0.05);
        }
        // 20 images at 5 %: five or more have a chance of 0.3 %.
        assert!(small < 5, "{small} of 20");
    }

    #[test]
    fn a_shared_error_far_below_the_noise_is_found() {
        let found = parts(|i| if i % SIDE < SIDE / 2 { 0.01 } else { 0.0 }, 1);
        let truth = 0.02 * 0.5_f64.sqrt();
        assert!((found.lasting - truth).abs() < 0.1 * truth, "{found:?}");
        assert!((found.noise - 0.1).abs() < 1e-3, "{found:?}");
        assert!(found.chance < 1e-4, "{found:?}");
    }

    #[test]
    fn little_says_nothing() {
        assert_eq!(Structure::new(4, 16).parts(&[[1.0; 3]; 16], None, None), None);
        let mut black = Structure::new(4, 16);
        black.add(&[[0.0; 3]; 16], &[[0.0; 3]; 16], None);
        black.add(&[[0.0; 3]; 16], &[[0.0; 3]; 16], None);
        assert_eq!(black.parts(&[[0.0; 3]; 16], None, None), None);
    }
}
