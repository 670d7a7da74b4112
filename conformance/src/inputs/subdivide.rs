//! Inputs of the kernels of `subdivide`.

use super::{Batch, put};
use crate::statistics::Random;
use etendue_core::kernel::Kernel;

/// Tolerances: the text's none, a common one, an absolute one, a part of the parent's error.
const TOLERANCES: [[f32; 3]; 4] = [[0.0; 3], [0.05, 0.0, 0.0], [0.01, 0.02, 0.0], [0.0, 0.0, 0.03]];

/// Corners: any, needles, obtuse, right angles on the axes, huge, tiny, without area.
fn corners(r: &mut Random) -> [f32; 9] {
    let mut c: [f32; 9] = core::array::from_fn(|_| r.range(-1.0, 1.0) as f32);
    match r.below(8) {
        0 => {
            // A needle: the third corner near the second.
            let thin = r.log_range(1e-6, 1e-1);
            for i in 0..3 {
                c[6 + i] = c[3 + i] + thin * c[6 + i];
            }
        }
        1 => {
            // Near the middle of the opposite edge: obtuse.
            for i in 0..3 {
                c[i] = 0.5 * (c[3 + i] + c[6 + i]) + 0.2 * c[i];
            }
        }
        2 => {
            let (p, q) = (r.range(0.2, 1.0) as f32, r.range(0.2, 1.0) as f32);
            c = [0.0, 0.0, 0.0, p, 0.0, 0.0, 0.0, 0.0, q];
        }
        3 => c = c.map(|x| x * 1e30),
        4 => c = c.map(|x| x * 1e-30),
        _ => {}
    }
    c
}

/// Irradiance at the seven points: linear, quadratic, a step, dark, one lit, anything.
fn samples(r: &mut Random) -> [f32; 7] {
    const BARY: [[f64; 3]; 7] = [
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.5, 0.5],
        [0.5, 0.0, 0.5],
        [0.5, 0.5, 0.0],
        [1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0],
    ];
    let scale = f64::from(r.log_range(1e-6, 1e6));
    let l: [f64; 3] = core::array::from_fn(|_| r.range(0.2, 1.0));
    let kind = r.below(8);
    // Curvature along the edges opposite the corners; for kind 1 only along one.
    let mut q: [f64; 3] = core::array::from_fn(|_| r.range(-0.6, 0.6));
    if kind == 1 {
        let one = r.below(3) as usize;
        q = core::array::from_fn(|i| if i == one { q[i] } else { 0.02 * q[i] });
    }
    let noise = if kind == 2 { 0.1 } else { 0.002 };
    let cut: [f64; 4] = core::array::from_fn(|_| r.range(-1.0, 1.0));
    BARY.map(|b| {
        let linear = b[0] * l[0] + b[1] * l[1] + b[2] * l[2];
        let square = q[0] * b[1] * b[2] + q[1] * b[2] * b[0] + q[2] * b[0] * b[1];
        let lit = cut[0] * b[0] + cut[1] * b[1] + cut[2] * b[2] + 0.3 * cut[3] > 0.0;
        let value = match kind {
            0 => linear + 0.01 * square,
            1..=3 => linear + square + noise * r.range(-1.0, 1.0),
            4 | 5 => f64::from(u8::from(lit)) * (linear + 0.2 * square),
            6 => f64::from(u8::from(r.below(4) == 0)) * linear,
            _ => r.range(0.0, 1.0),
        };
        (value.max(0.0) * scale) as f32
    })
}

/// Corners and samples whose answer is exact, or whose samples are no irradiance.
fn hard() -> Vec<([f32; 9], [f32; 7])> {
    let right = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 2.0, 0.0];
    let obtuse = [0.0, 0.0, 0.0, 4.0, 1.0, 0.0, -4.0, 2.0, 0.0];
    let acute = [0.0, 0.0, 0.0, 8.0, 0.0, 0.0, 3.0, 7.0, 0.0];
    let flat = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 3.0, 3.0, 3.0];
    let (huge, inf, nan) = (f32::MAX, f32::INFINITY, f32::NAN);
    let mut list = Vec::new();
    for c in [right, obtuse, acute, flat, [huge, 0.0, 0.0, -huge, 0.0, 0.0, 0.0, huge, 0.0], [inf; 9]] {
        for s in [
            [0.0; 7],
            [0.7; 7],
            [11_184_814.0; 7],
            [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
            [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0],
            [1.0, 1.0, 1.0, 4.0, 1.0, 1.0, 1.5],
            [1.0, 1.0, 1.0, 1.2, 1.0, 1.0, 1.1],
            [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0],
            [huge; 7],
            [huge, 0.0, inf, huge, 0.0, nan, huge],
            [nan; 7],
            [-1.0, -2.0, -3.0, -inf, -0.0, -1.0, 5.0],
        ] {
            list.push((c, s));
        }
    }
    list
}

pub(super) fn inputs(kernel: Kernel, count: usize, r: &mut Random) -> Vec<Batch> {
    let share = kernel == Kernel::SubdivideRobust;
    let constants = kernel.shape().constants;
    TOLERANCES
        .iter()
        .map(|t| {
            let mut batch = Batch::default();
            put(&mut batch.constants, &t[..constants]);
            let random: Vec<_> = (0..count / TOLERANCES.len()).map(|_| (corners(r), samples(r))).collect();
            for (c, s) in hard().into_iter().chain(random) {
                put(&mut batch.items, &c);
                put(&mut batch.items, &s);
                if share {
                    let fraction = 2.0_f64.powi(-(r.below(12) as i32)) as f32;
                    // Nothing expected, about as much as there is, anything.
                    let brightest = s.iter().fold(0.0_f32, |m, x| m.max(*x)).min(1e37);
                    let rest = [0.0, 0.0, 0.4 * brightest, 1e30][r.below(4) as usize];
                    put(&mut batch.items, &[fraction, rest]);
                }
            }
            batch
        })
        .collect()
}
