//! Inputs of the kernels of `linear_triangle`: weights flat, nearly flat, alone, with zeros, and of far ratios.

use super::{Batch, HARD_UNITS, put, single};
use crate::statistics::Random;
use etendue_core::kernel::Kernel;

/// Hard weights, to be turned about.
const HARD_WEIGHTS: [[f32; 3]; 13] = [
    [1.0, 1.0, 1.0],
    [0.0, 0.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
    [0.0, 1.0, 3.0],
    [1.0, 1.0 + f32::EPSILON, 1.0],
    [1.0, 1.0 - 0.5 * f32::EPSILON, 1.0 + f32::EPSILON],
    [1e-30, 1e-30, 1.0],
    [1e-30, 1.0, 1.0],
    [3e38, 3e38, 3e38],
    [1e38, 3e38, 2e-30],
    [1e-10, 3e38, 5e-11],
    [-1.0, 2.0, 3.0],
];

pub(super) fn weights(r: &mut Random) -> [f32; 3] {
    let scale = f64::from(r.log_range(1e-20, 1e20));
    let mut w = match r.below(6) {
        0 => [0.0, r.range(0.0, 1.0), r.range(0.0, 1.0)],
        1 => [(); 3].map(|()| 1.0 + 1e-7 * r.range(0.0, 1.0)),
        2 => [1.0, f64::from(r.log_range(1e-15, 1.0)), f64::from(r.log_range(1e-15, 1.0))],
        3 => {
            let x = f64::from(r.log_range(1e-15, 1.0));
            [1.0, x, x]
        }
        _ => [r.range(0.0, 1.0), r.range(0.0, 1.0), r.range(0.0, 1.0)],
    };
    w.rotate_left(r.below(3) as usize);
    w.map(|x| (x * scale) as f32)
}

fn bary(r: &mut Random) -> [f32; 3] {
    match r.below(8) {
        0 => {
            let mut b = [1.0, 0.0, 0.0];
            b.rotate_left(r.below(3) as usize);
            b
        }
        1 => {
            let t = r.unit();
            let mut b = [t, 1.0 - t, 0.0];
            b.rotate_left(r.below(3) as usize);
            b
        }
        2 => {
            let (x, y) = (r.log_range(1e-12, 0.3), r.log_range(1e-12, 0.3));
            let mut b = [x, y, (1.0 - f64::from(x) - f64::from(y)) as f32];
            b.rotate_left(r.below(3) as usize);
            b
        }
        _ => {
            let (a, t) = (r.range(0.0, 1.0).sqrt(), r.range(0.0, 1.0));
            [(1.0 - a) as f32, (a * t) as f32, (a * (1.0 - t)) as f32]
        }
    }
}

pub(super) fn inputs(kernel: Kernel, count: usize, r: &mut Random) -> Vec<Batch> {
    let mut items = Vec::new();
    let tail = |items: &mut Vec<u32>, r: &mut Random, hard: Option<[f32; 2]>| match kernel {
        Kernel::SampleLinearTriangle => put(items, &hard.unwrap_or([r.unit(), r.unit()])),
        Kernel::LinearTriangleDistance => put(items, &[hard.map_or_else(|| r.unit(), |u| u[0])]),
        _ => put(items, &bary(r)),
    };
    for w in HARD_WEIGHTS {
        for turn in 0..3 {
            let mut w = w;
            w.rotate_left(turn);
            for u in HARD_UNITS.into_iter().chain([1.0]) {
                for v in HARD_UNITS {
                    put(&mut items, &w);
                    tail(&mut items, r, Some([u, v]));
                }
            }
        }
    }
    for i in 0..count {
        put(&mut items, &weights(r));
        // Some near the ends of the unit interval.
        let hard = match i % 8 {
            0 => Some([1.0 - r.log_range(6e-8, 0.1), r.log_range(6e-8, 1.0)]),
            1 => Some([r.log_range(1e-12, 1.0), 1.0 - r.log_range(6e-8, 0.1)]),
            _ => None,
        };
        tail(&mut items, r, hard);
    }
    single(items)
}
