//! Inputs of media on grids: boxes of many sizes, turned or not, with empty cells; points and rays about them.

use super::{Batch, put};
use crate::statistics::Random;
use etendue_core::kernel::Kernel;

/// Cells along the axes, and channels: one cell, a rod, a plate, more than a block of pieces.
const GRIDS: [([u32; 3], u32); 6] =
    [([1, 1, 1], 1), ([2, 1, 1], 3), ([3, 2, 4], 1), ([9, 2, 3], 3), ([17, 9, 1], 1), ([5, 6, 7], 1)];

pub(super) fn inputs(kernel: Kernel, count: usize, r: &mut Random) -> Vec<Batch> {
    let mut out = Vec::new();
    for (i, (size, channels)) in GRIDS.into_iter().enumerate() {
        // Edges of half a metre to two, every other box about turned axes.
        let edges = [(); 3].map(|()| r.range(0.5, 2.0) as f32);
        let corner = r.vector(-1.0, 1.0);
        let angle = if i % 2 == 1 { r.range(0.1, 1.0) } else { 0.0 };
        let (s, c) = (angle.sin() as f32, angle.cos() as f32);
        let axes = [[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]];
        let mut constants = size.to_vec();
        constants.push(channels);
        for k in 0..3 {
            let scale = size[k] as f32 / edges[k];
            put(&mut constants, &axes[k].map(|x| x * scale));
            put(&mut constants, &[corner[k]]);
        }
        for _ in 0..size.iter().product::<u32>() * channels {
            put(&mut constants, &[if r.below(3) == 0 { 0.0 } else { r.unit() }]);
        }
        let mut items = Vec::new();
        for _ in 0..count / GRIDS.len() {
            // In the box or about it.
            let local = edges.map(|e| r.range(-0.3, 1.3) as f32 * e);
            let world = |local: [f32; 3]| {
                [0, 1, 2].map(|j| corner[j] + (0..3).map(|k| axes[k][j] * local[k]).sum::<f32>())
            };
            if kernel == Kernel::GridAt {
                put(&mut items, &world(local));
                continue;
            }
            let direction = match r.below(4) {
                0 => axes[r.below(3) as usize],
                _ => r.direction(),
            };
            // From within, or from before it.
            let back = if r.below(2) == 0 { 0.0 } else { r.range(0.5, 4.0) as f32 };
            let from = world(local);
            let origin: [f32; 3] = std::array::from_fn(|k| from[k] - direction[k] * back);
            put(&mut items, &origin);
            put(&mut items, &direction);
            put(&mut items, &[if r.below(4) == 0 { 1e4 } else { r.range(0.01, 6.0) as f32 }]);
        }
        out.push(Batch { constants, items });
    }
    out
}
