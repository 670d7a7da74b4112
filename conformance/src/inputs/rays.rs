//! Rays against triangles, boxes and round shapes: on exact edges and vertices, from planes, tiny, huge, degenerate.

use super::put;
use crate::statistics::Random;
use etendue_core::kernel::Kernel;

pub(super) fn items(kernel: Kernel, count: usize, r: &mut Random) -> Vec<u32> {
    let mut items = Vec::new();
    match kernel {
        Kernel::Triangle => {
            exact_triangles(&mut items);
            for _ in 0..count {
                random_triangle(&mut items, r);
            }
        }
        Kernel::Slab => {
            exact_slabs(&mut items);
            for _ in 0..count {
                let scale = f64::from(r.log_range(1e-3, 1e3));
                let (a, b) = (r.vector(-scale, scale), r.vector(-scale, scale));
                put(&mut items, &r.vector(-2.0 * scale, 2.0 * scale));
                put(&mut items, &r.direction());
                put(&mut items, &[if r.below(4) == 0 { scale as f32 } else { f32::MAX }]);
                put(&mut items, &[0, 1, 2].map(|i| a[i].min(b[i])));
                put(&mut items, &[0, 1, 2].map(|i| a[i].max(b[i])));
            }
        }
        Kernel::RoundShape => {
            exact_shapes(&mut items);
            for _ in 0..count {
                random_shape(&mut items, r);
            }
        }
        _ => {
            for _ in 0..count {
                let scale = f64::from(r.log_range(1e-3, 1e5));
                put(&mut items, &r.vector(-scale, scale));
                put(&mut items, &[r.log_range(1e-3, 1e3)]);
                put(&mut items, &r.direction());
                put(&mut items, &r.direction());
            }
        }
    }
    items
}

/// Dyadic coordinates, so that every edge function is exact: rays through vertices, edges, the inside, and just beside.
fn exact_triangles(items: &mut Vec<u32>) {
    let triangle = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0_f32]];
    for flip in [false, true] {
        for axis in 0..3 {
            for (x, y) in [
                (0.0, 0.0),
                (4.0, 0.0),
                (0.0, 4.0),
                (2.0, 0.0),
                (0.0, 2.0),
                (2.0, 2.0),
                (1.0, 3.0),
                (1.0, 1.0),
                (-0.125, 1.0),
                (1.0, -0.125),
                (2.125, 2.0),
                (5.0, 0.0),
            ] {
                for (z, t_max) in [(1.0, f32::MAX), (1.0, 1.0), (1.0, 0.5), (0.0, 1.0), (-1.0, 8.0)] {
                    for slope in [0.0_f32, 0.5] {
                        // The ray passes (x, y, 0) at t = z.
                        let turn = |v: [f32; 3]| [v[(3 - axis) % 3], v[(4 - axis) % 3], v[(5 - axis) % 3]];
                        put(items, &turn([x - slope * z, y, z]));
                        put(items, &turn([slope, 0.0, -1.0]));
                        put(items, &[t_max]);
                        let order = if flip { [0, 2, 1] } else { [0, 1, 2] };
                        for i in order {
                            put(items, &turn(triangle[i]));
                        }
                    }
                }
            }
        }
    }
    // No area; no direction; a negative interval; edge-on.
    for (direction, t_max, vertices) in [
        ([0.0, 0.0, -1.0], 9.0, [[1.0, 1.0, 0.0]; 3]),
        ([0.0, 0.0, -1.0], 9.0, [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [2.0, 2.0, 0.0]]),
        ([0.0, 0.0, 0.0], 9.0, triangle),
        ([0.0, 0.0, -1.0], -1.0, triangle),
        ([1.0, 0.0, 0.0], 9.0, [[0.0, 0.0, 1.0], [4.0, 0.0, 1.0], [0.0, 4.0, 1.0]]),
    ] {
        put(items, &[1.0, 1.0, 1.0]);
        put(items, &direction);
        put(items, &[t_max]);
        put(items, vertices.as_flattened());
    }
}

fn random_triangle(items: &mut Vec<u32>, r: &mut Random) {
    let scale = f64::from(r.log_range(1e-3, 1e3));
    let shift = if r.below(4) == 0 { r.vector(-30.0 * scale, 30.0 * scale) } else { [0.0; 3] };
    let moved = |v: [f32; 3]| [0, 1, 2].map(|i| v[i] + shift[i]);
    let v = [0; 3].map(|_| moved(r.vector(-scale, scale)));
    let origin = moved(r.vector(-2.0 * scale, 2.0 * scale));
    // Aimed at the triangle's plane within and around it.
    let (a, b) = (r.range(-0.3, 1.1), r.range(-0.3, 1.1));
    let target = [0, 1, 2].map(|i| {
        let [x, y, z] = [v[0][i], v[1][i], v[2][i]].map(f64::from);
        x + a * (y - x) + b * (z - x)
    });
    let length = f64::from(r.log_range(0.1, 10.0));
    put(items, &origin);
    put(items, &[0, 1, 2].map(|i| ((target[i] - f64::from(origin[i])) * length) as f32));
    put(items, &[if r.below(4) == 0 { r.log_range(0.05, 20.0) } else { f32::MAX }]);
    put(items, v.as_flattened());
}

fn exact_slabs(items: &mut Vec<u32>) {
    let (low, high) = ([-1.0; 3], [1.0_f32; 3]);
    for origin in [[-3.0, 0.0, 0.0], [0.0; 3], [-3.0, 1.5, 0.0], [3.0, 0.0, 0.0], [-1.0, 0.5, 0.5_f32]] {
        for direction in [[1.0, 0.0, 0.0], [1.0, 0.25, 0.125], [-1.0, 0.0, 0.0_f32]] {
            for t_max in [f32::MAX, 1.0, 2.5, 0.0] {
                put(items, &origin);
                put(items, &direction);
                put(items, &[t_max]);
                put(items, &low);
                put(items, &high);
            }
        }
    }
    // The empty box and a flat one.
    for (low, high) in [([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]), ([-1.0, -1.0, 0.0], [1.0, 1.0, 0.0])] {
        put(items, &[0.25, 0.25, 2.0, 0.0, 0.0, -1.0, f32::MAX]);
        put(items, &low);
        put(items, &high);
    }
}

fn exact_shapes(items: &mut Vec<u32>) {
    for kind in [0_u32, 1] {
        for origin in
            [[0.0, 0.0, 4.0], [0.0, 0.0, 0.0], [3.0, 0.0, 4.0], [0.5, 0.0, -4.0], [0.0, 0.0, 2.0_f32]]
        {
            for direction in [[0.0, 0.0, -1.0], [0.0, 0.0, 1.0], [0.0, 0.0, -2.0], [0.0, 0.0, 0.0_f32]] {
                for (radius, t_max) in [(2.0, f32::MAX), (2.0, 1.0), (0.0, 9.0), (-1.0, 9.0_f32)] {
                    put(items, &origin);
                    put(items, &direction);
                    put(items, &[t_max]);
                    items.push(kind);
                    put(items, &[radius, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
                }
            }
        }
    }
}

fn random_shape(items: &mut Vec<u32>, r: &mut Random) {
    let radius = r.log_range(1e-3, 1e3);
    let far = f64::from(radius) * f64::from(r.log_range(0.3, 100.0));
    let center = r.vector(-10.0 * f64::from(radius), 10.0 * f64::from(radius));
    let out = r.direction();
    let origin = [0, 1, 2].map(|i| (f64::from(center[i]) + far * f64::from(out[i])) as f32);
    // Aimed at a point within 1.3 radii of the centre.
    let aim = r.vector(-0.8, 0.8);
    let length = f64::from(r.log_range(0.1, 10.0));
    let direction = [0, 1, 2].map(|i| {
        ((f64::from(center[i]) + f64::from(radius) * f64::from(aim[i]) - f64::from(origin[i])) / far * length)
            as f32
    });
    put(items, &origin);
    put(items, &direction);
    put(items, &[if r.below(4) == 0 { (far * r.range(0.2, 2.0)) as f32 } else { f32::MAX }]);
    items.push(r.below(2));
    put(items, &[radius]);
    put(items, &center);
    put(items, &r.direction());
}
