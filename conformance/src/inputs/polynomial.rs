//! Inputs of the kernels of `polynomial`: form factors of closed scenes of up to 8 patches, and what is no form factor.

use super::{Batch, any_finite, put};
use crate::statistics::Random;
use etendue_core::kernel::Kernel;

/// Numbers between which a sum depends on its order: alike, of mixed sign, of many scales.
fn number(kind: u32, r: &mut Random) -> f32 {
    match kind {
        0 => r.unit(),
        1 => r.range(-1.0, 1.0) as f32,
        2 => r.log_range(1e-12, 1e6) * if r.below(2) == 0 { 1.0 } else { -1.0 },
        3 => (r.below(5) as f32 - 2.0) * 0.5,
        // Far from where products of two, times eight to the 64th, could overflow.
        _ => any_finite(r).clamp(-1e9, 1e9),
    }
}

fn vector(len: usize, kind: u32, r: &mut Random) -> Vec<f32> {
    (0..len).map(|_| number(kind, r)).collect()
}

fn dots(count: usize, r: &mut Random) -> Vec<u32> {
    let mut items = Vec::new();
    // One term at each place, so that a lane that is left out shows.
    for place in 0..32 {
        let (mut a, mut x) = ([0.0_f32; 32], [0.0_f32; 32]);
        (a[place], x[place]) = (3.0, 0.7);
        put(&mut items, &a);
        put(&mut items, &x);
    }
    // Cancellation between lanes, and sums that only an order decides.
    for big in [1e8_f32, 1e20] {
        for place in 1..32 {
            let (mut a, x) = ([1.0_f32; 32], [1.0_f32; 32]);
            (a[0], a[place]) = (big, -big);
            put(&mut items, &a);
            put(&mut items, &x);
        }
    }
    for _ in 0..count {
        let kind = r.below(5);
        put(&mut items, &vector(64, kind, r));
    }
    items
}

/// A symmetric S with nothing on the diagonal, its row sums A, and F = S / A: a closed scene.
fn closed(n: usize, r: &mut Random) -> (Vec<f32>, Vec<f32>, Vec<f32>) {
    let mut s = vec![0.0_f64; n * n];
    for i in 0..n {
        for j in 0..i {
            let x = f64::from(r.log_range(1e-3, 1.0));
            (s[i * n + j], s[j * n + i]) = (x, x);
        }
    }
    let areas: Vec<f64> =
        (0..n).map(|i| s[i * n..][..n].iter().sum::<f64>().max(f64::from(n == 1))).collect();
    let factors = (0..n * n).map(|k| (s[k] / areas[k / n]) as f32).collect();
    let half = (0..n).flat_map(|i| s[i * n..][..=i].to_vec()).map(|x| x as f32).collect();
    (factors, areas.iter().map(|a| *a as f32).collect(), half)
}

pub(super) fn inputs(kernel: Kernel, count: usize, r: &mut Random) -> Vec<Batch> {
    if kernel == Kernel::PolynomialDot {
        return vec![Batch { constants: Vec::new(), items: dots(count, r) }];
    }
    let mut out = Vec::new();
    // Every size, closed scenes of an albedo up to 0.999 and matrices of any sign.
    let scenes: Vec<(usize, u32)> = (0..=8).flat_map(|n| (0..4).map(move |kind| (n, kind))).collect();
    for (place, (n, kind)) in scenes.iter().copied().enumerate() {
        let (mut factors, mut areas, mut half) = closed(n, r);
        if kind == 3 {
            factors = vector(n * n, 1, r);
            factors.iter_mut().for_each(|f| *f /= n as f32);
            half = vector(n * (n + 1) / 2, 1, r);
            areas = (0..n).map(|_| r.log_range(1e-3, 1e3)).collect();
        } else if kernel == Kernel::PolynomialSeries {
            let rho = [0.5, 0.9, 0.999][kind as usize];
            factors.iter_mut().for_each(|f| *f *= rho);
        }
        let mut constants = vec![n as u32];
        match kernel {
            Kernel::PolynomialApply => put(&mut constants, &factors),
            Kernel::PolynomialApplyHalf => {
                put(&mut constants, &areas);
                put(&mut constants, &half);
            }
            _ => {
                constants.push([0, 1, 2, 3, 5, 8, 17, 64][place % 8]);
                put(&mut constants, &factors);
            }
        }
        let mut items = Vec::new();
        // A single lit patch at each place: the columns of the operator.
        for lit in 0..8 {
            let mut x = [0.0_f32; 8];
            x[lit] = 1.0;
            put(&mut items, &x);
        }
        for _ in 0..count.div_ceil(scenes.len()) {
            let kind = r.below(4);
            put(&mut items, &vector(8, kind, r));
        }
        out.push(Batch { constants, items });
    }
    out
}
