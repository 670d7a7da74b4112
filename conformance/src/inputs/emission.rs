//! Inputs of the kernels of `emission`.

use super::{Batch, put, single};
use crate::statistics::Random;
use etendue_core::kernel::Kernel;

pub(super) fn inputs(kernel: Kernel, count: usize, r: &mut Random) -> Vec<Batch> {
    match kernel {
        Kernel::EmissionCoefficient => single(coefficients(count, r)),
        Kernel::EmissionOverlap => single(overlaps(count / 4 + 50, r)),
        Kernel::EmissionScan | Kernel::EmissionScanTexels | Kernel::EmissionBrightest => {
            bitmaps(kernel, count, r)
        }
        _ => Vec::new(),
    }
}

fn coefficients(count: usize, r: &mut Random) -> Vec<u32> {
    let mut items = Vec::new();
    // No area, no light, no albedo.
    for (corner, light, albedo) in
        [([0.0; 3], 1.0, 1.0), ([0.0, 1.0, 0.0], 0.0, 1.0), ([0.0, 1.0, 0.0], 1.0, 0.0_f32)]
    {
        put(&mut items, &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
        put(&mut items, &corner);
        put(&mut items, &[albedo; 3]);
        put(&mut items, &[light; 9]);
    }
    for _ in 0..count {
        let scale = f64::from(r.log_range(1e-9, 1e9));
        let far = r.vector(-4.0, 4.0);
        let mut vertices = [0; 3].map(|_| r.vector(-1.0, 1.0));
        if r.below(3) == 0 {
            // A sliver, down to a height of 2^-16 of its length.
            let (t, h) = (r.range(0.0, 1.0), f64::from(r.log_range(1.6e-5, 1.0)));
            let off = r.direction();
            vertices[2] = [0, 1, 2].map(|k| {
                let (a, b) = (f64::from(vertices[0][k]), f64::from(vertices[1][k]));
                (a + t * (b - a) + h * f64::from(off[k])) as f32
            });
        }
        for v in vertices {
            let v = [0, 1, 2].map(|k| ((f64::from(v[k]) + f64::from(far[k])) * scale) as f32);
            put(&mut items, &v);
        }
        put(&mut items, &[r.unit(), r.unit(), r.unit()]);
        let light = r.log_range(1e-9, 1e9);
        for _ in 0..9 {
            put(&mut items, &[light * r.log_range(1e-3, 1.0)]);
        }
    }
    items
}

fn overlaps(count: usize, r: &mut Random) -> Vec<u32> {
    let mut items = Vec::new();
    for p in [
        // The cell's halves, a triangle around it, one outside, one touching, needles and points.
        [0.0, 0.0, 1.0, 0.0, 0.0, 1.0],
        [1.0, 1.0, 0.0, 1.0, 1.0, 0.0],
        [-3.0, -3.0, 6.0, -3.0, -3.0, 6.0],
        [2.0, 2.0, 3.0, 2.0, 2.0, 3.0],
        [1.0, 0.0, 2.0, 0.0, 1.0, 1.0],
        [-1.0, 0.5, 2.0, 0.5, 0.25, 0.5],
        [0.25, -1.0, 0.25, 3.0, 0.25, 0.5],
        [0.5, 0.5, 0.5, 0.5, 0.5, 0.5],
        [-1.0, -1.0, 2.0, 2.0, 0.5, 0.5],
        [0.0, 0.0, 1.0, 1.0, 0.0, 1.0_f32],
    ] {
        put(&mut items, &p);
    }
    for _ in 0..count {
        let size = if r.below(4) == 0 { r.log_range(1e-3, 8.0) } else { 2.0 };
        let at = [r.range(-0.5, 1.5) as f32, r.range(-0.5, 1.5) as f32];
        for _ in 0..3 {
            let grid = |x: f32| if size == 2.0 { (x * 4.0).round() / 4.0 } else { x };
            let [dx, dy] = [0; 2].map(|_| size * (r.unit() - 0.5));
            if r.below(3) == 0 {
                put(&mut items, &[grid(at[0] + dx), grid(at[1] + dy)]);
            } else {
                put(&mut items, &[at[0] + dx, at[1] + dy]);
            }
        }
    }
    items
}

fn bitmaps(kernel: Kernel, count: usize, r: &mut Random) -> Vec<Batch> {
    let mut out = Vec::new();
    for [width, height] in [[1_u32, 1], [2, 2], [7, 3], [64, 32]] {
        let mut constants = vec![width, height];
        constants.extend((0..width * height).map(|_| r.word() >> 8));
        let side = [width as f32, height as f32];
        let mut items = Vec::new();
        for p in [
            // A point, lines along both axes, corners of texels, a flipped one, and one over too many texels.
            [0.3, 0.4, 0.3, 0.4, 0.3, 0.4],
            [0.1, 0.3, 0.6, 0.3, 0.2, 0.3],
            [0.3, 0.1, 0.3, 0.6, 0.3, 0.2],
            [0.0, 0.0, 2.0 / side[0], 0.0, 0.0, 2.0 / side[1]],
            [0.0, 0.0, 0.0, 2.0 / side[1], 2.0 / side[0], 0.0],
            [0.5 / side[0], 0.5 / side[1], 1.5 / side[0], 0.5 / side[1], 0.5 / side[0], 1.5 / side[1]],
            [-5000.0, 0.0, 5000.0, 0.0, 0.0, 5000.0],
        ] {
            put(&mut items, &p);
        }
        for i in 0..count / 64 + 20 {
            // Few over many cells: the truth goes through all pairs of lines.
            let size = if i % 20 == 0 { 12.0 } else { r.log_range(0.02, 4.0) };
            let at = [0; 2].map(|_| r.range(-2.0, 2.0) as f32);
            let narrow = if kernel == Kernel::EmissionScan && r.below(4) == 0 { 1e-3 } else { 1.0 };
            for _ in 0..3 {
                let p = [0, 1].map(|k| {
                    let along = if k == 0 { size } else { size * narrow };
                    at[k] + (r.unit() - 0.5) * along / side[k]
                });
                put(&mut items, &p);
            }
        }
        out.push(Batch { constants, items });
    }
    out
}
