//! The truth of the kernels of `polynomial`: plain sums in f64, powers of a matrix one by one.

use super::{Answer, Expect, Words};
use etendue_core::kernel::Kernel;

/// What is summed, and the sum of what its terms weigh.
#[derive(Clone, Copy, Default)]
struct Sum {
    value: f64,
    weight: f64,
}

impl Sum {
    fn add(&mut self, term: f64, weight: f64) {
        self.value += term;
        self.weight += weight;
    }
    /// Subnormal products round to a grid of their own.
    fn expect(self) -> Expect {
        Expect::Scaled(self.value, self.weight + 1e-37)
    }
}

/// A x; `weight` of x is carried along, so that a result knows what rounding of all that went into it amounts to.
fn times(n: usize, a: impl Fn(usize, usize) -> f64, x: &[Sum]) -> Vec<Sum> {
    (0..n)
        .map(|i| {
            let mut sum = Sum::default();
            for (j, x) in x.iter().enumerate().take(n) {
                sum.add(a(i, j) * x.value, a(i, j).abs() * x.weight);
            }
            sum
        })
        .collect()
}

fn results(sums: &[Sum]) -> Answer {
    let mut list: Vec<Expect> = sums.iter().map(|s| s.expect()).collect();
    list.resize(8, Expect::Word(0));
    Answer::Is(list)
}

pub(super) fn truth(kernel: Kernel, constants: &[u32], r: &mut Words<'_>) -> Answer {
    if kernel == Kernel::PolynomialDot {
        let a: Vec<f64> = (0..32).map(|_| r.real()).collect();
        let mut sum = Sum::default();
        for a in a {
            let x = r.real();
            sum.add(a * x, (a * x).abs());
        }
        return Answer::Is(vec![sum.expect()]);
    }
    let mut c = Words::new(constants);
    let n = c.word().min(8) as usize;
    let x: Vec<Sum> = (0..8)
        .map(|_| {
            let value = r.real();
            Sum { value, weight: value.abs() }
        })
        .collect();
    match kernel {
        Kernel::PolynomialApply => {
            let a: Vec<f64> = (0..n * n).map(|_| c.real()).collect();
            results(&times(n, |i, j| a[i * n + j], &x))
        }
        Kernel::PolynomialApplyHalf => {
            let areas: Vec<f64> = (0..n).map(|_| c.real()).collect();
            let half: Vec<f64> = (0..n * (n + 1) / 2).map(|_| c.real()).collect();
            let at = |i: usize, j: usize| half[i.max(j) * (i.max(j) + 1) / 2 + i.min(j)] / areas[i];
            results(&times(n, at, &x))
        }
        Kernel::PolynomialSeries => {
            let k = c.word().min(64);
            let a: Vec<f64> = (0..n * n).map(|_| c.real()).collect();
            // A^h b for each h, added up: not the form of the kernel, which nests.
            let mut power = x[..n].to_vec();
            let mut sum = vec![Sum::default(); n];
            for h in 1..=k {
                power = times(n, |i, j| a[i * n + j], &power);
                // Each bounce adds its roundings to those of the bounces before it.
                for (sum, p) in sum.iter_mut().zip(&power) {
                    sum.add(p.value, p.weight * f64::from(h));
                }
            }
            results(&sum)
        }
        _ => Answer::Undecided,
    }
}
