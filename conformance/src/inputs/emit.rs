//! Inputs of the kernels of `emit`: every light of `lights`, and spots hard, narrow and wide, in spheres near and far.

use super::lights::{Record, records};
use super::{Batch, HARD_UNITS, put};
use crate::statistics::Random;
use etendue_core::kernel::Kernel;

/// Cosines of spots' cones and of their full part.
const SPOTS: [[f32; 2]; 6] =
    [[0.8, 0.8], [0.5, 0.5000001], [0.9998, 0.9999], [-0.98, 1.0], [-1.0, -1.0], [0.0, 0.017_452_4]];

/// Four numbers: the ends of the unit interval against each other, then random ones.
fn four(i: usize, r: &mut Random) -> [f32; 4] {
    let n = HARD_UNITS.len();
    let pair = |k: usize| [HARD_UNITS[k / n % n], HARD_UNITS[k % n]];
    if i < n * n {
        let ([a, b], [c, d]) = (pair(i), pair((i * 32 + 7) % (n * n)));
        [a, b, c, d]
    } else {
        [r.unit(), r.unit(), r.unit(), r.unit()]
    }
}

fn items(count: usize, r: &mut Random) -> Vec<u32> {
    let mut out = Vec::new();
    for i in 0..count {
        put(&mut out, &four(i, r));
    }
    out
}

fn sphere(i: usize, r: &mut Random) -> [f32; 4] {
    if i == 0 {
        return [0.0, 0.0, 0.0, 1.0];
    }
    let [x, y, z] = r.vector(-10.0, 10.0);
    [x, y, z, r.log_range(1e-2, 1e4)]
}

pub(super) fn inputs(kernel: Kernel, count: usize, r: &mut Random) -> Vec<Batch> {
    let mut out = Vec::new();
    if kernel == Kernel::EmitEnvironment {
        for i in 0..8 {
            let mut constants = Vec::new();
            put(&mut constants, &r.vector(0.0, 5.0));
            put(&mut constants, &sphere(i, r));
            out.push(Batch { constants, items: items(count / 8 + 100, r) });
        }
        return out;
    }
    let mut lights: Vec<Vec<u32>> = records(r).iter().map(Record::words).collect();
    for params in SPOTS {
        lights.push(Record { edge1: r.direction(), params, ..Record::dark(1, r.vector(0.1, 9.0)) }.words());
    }
    for (i, mut constants) in lights.into_iter().enumerate() {
        put(&mut constants, &sphere(i % 4, r));
        out.push(Batch { constants, items: items(count / 24 + 100, r) });
    }
    out
}
