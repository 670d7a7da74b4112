//! Inputs of the kernels of `first_shot`: pieces whole, cut, tiny, thin and without area; weights to the ends of their range.

use super::{Batch, HARD_UNITS, linear_triangle, put, single};
use crate::statistics::Random;
use etendue_core::kernel::Kernel;

const GRID: u32 = 1 << 24;
const WHOLE: Corners = [[0, 0], [GRID, 0], [0, GRID]];

/// Second and third barycentric of each corner, in steps.
type Corners = [[u32; 2]; 3];

fn midpoint(a: [u32; 2], b: [u32; 2]) -> [u32; 2] {
    [0, 1].map(|k| (a[k] + b[k]) / 2)
}

/// Halves a triangle across an edge, or takes one of its four quarters, a few times.
fn cut(mut c: Corners, times: u32, r: &mut Random) -> Corners {
    for _ in 0..times {
        let k = r.below(3) as usize;
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        match r.below(4) {
            0 => c[i] = midpoint(c[i], c[j]),
            1 => c[j] = midpoint(c[i], c[j]),
            2 => c = [midpoint(c[0], c[1]), midpoint(c[1], c[2]), midpoint(c[2], c[0])],
            _ => (c[i], c[j]) = (midpoint(c[i], c[k]), midpoint(c[j], c[k])),
        }
    }
    c
}

fn point(r: &mut Random) -> [u32; 2] {
    let b = r.below(GRID + 1);
    [b, r.below(GRID - b + 1)]
}

fn corners(i: usize, r: &mut Random) -> Corners {
    match i % 16 {
        0 => WHOLE,
        1 => {
            // Any three points; turned over one time in two.
            [point(r), point(r), point(r)]
        }
        2 => {
            // Without area: two corners alike, or one halfway.
            let (a, b) = (point(r), point(r));
            let even = b.map(|x| x & !1);
            [[a, a, b], [a, b, b], [a.map(|x| x & !1), midpoint(a.map(|x| x & !1), even), even]]
                [r.below(3) as usize]
        }
        3 => {
            // A few steps.
            let a = [r.below(GRID / 2), r.below(GRID / 4)];
            [a, [a[0] + 1 + r.below(8), a[1] + r.below(2)], [a[0] + r.below(2), a[1] + 1 + r.below(8)]]
        }
        4 => {
            // A needle along the triangle.
            let a = point(r);
            let thin = 1 + r.below(1 << 12);
            [[0, 0], a, [a[0].saturating_sub(thin), a[1]]]
        }
        5 => {
            let mut c = WHOLE;
            // One corner outside.
            c[r.below(3) as usize] = [GRID, 1 + r.below(100)];
            c
        }
        n => {
            let times = if n < 12 { r.below(8) } else { r.below(30) };
            cut(WHOLE, times, r)
        }
    }
}

/// A point of the triangle: in the piece, on its corners and edges, a little outside, anywhere.
fn place(i: usize, c: Corners, r: &mut Random) -> [f32; 2] {
    let inside = {
        let (a, t) = (r.range(0.0, 1.0).sqrt(), r.range(0.0, 1.0));
        [1.0 - a, a * t, a * (1.0 - t)]
    };
    let mix = |l: [f64; 3]| {
        [0, 1].map(|k| ((0..3).map(|j| l[j] * f64::from(c[j][k])).sum::<f64>() / f64::from(GRID)) as f32)
    };
    match i / 16 % 8 {
        0 => c[r.below(3) as usize].map(|x| x as f32 / GRID as f32),
        1 => midpoint(c[0], c[1]).map(|x| x as f32 / GRID as f32),
        2 => {
            let out = f64::from(r.log_range(1e-6, 1e-3));
            let mut l = inside;
            let (k, lost) = (r.below(3) as usize, inside[0] + out);
            l[0] = -out;
            l[1] += 0.5 * lost;
            l[2] += 0.5 * lost;
            l.rotate_left(k);
            mix(l)
        }
        3 => point(r).map(|x| x as f32 / GRID as f32),
        _ => mix(inside),
    }
}

/// Irradiances: one channel, all alike, of far ratios, dark.
fn irradiance(i: usize, r: &mut Random) -> [f32; 3] {
    let e = r.log_range(1e-9, 1e9);
    match i % 8 {
        0 => [e, 0.0, 0.0],
        1 => [0.0, 0.0, e],
        2 => [e; 3],
        3 => [0.0; 3],
        _ => [0; 3].map(|_| e * r.log_range(1e-3, 1e3)),
    }
}

/// What has a documented value and no sense: (irradiance, density, chance per watt).
const SENSELESS: [[f32; 5]; 13] = [
    [-1.0, 2.0, 3.0, 1.0, 1.0],
    [0.0, 0.0, 0.0, 0.0, 0.0],
    [1.0, 2.0, 3.0, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 1.0],
    [1.0, 1.0, 1.0, f32::NAN, 1.0],
    [1.0, 1.0, 1.0, 1.0, f32::NAN],
    [1.0, f32::NAN, 1.0, 1.0, 1.0],
    [1.0, f32::NAN, 1.0, f32::NAN, f32::NAN],
    [f32::INFINITY, 1.0, 1.0, 1.0, 1.0],
    [1.0, 1.0, 1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0, 1.0, -1.0],
    [3e38, 3e38, 3e38, 1e-30, 0.0],
    [3e38, 3e38, 3e38, 1.0, 0.5],
];

/// (colour, weights, area, chance).
const SENSELESS_PIECES: [[f32; 8]; 8] = [
    [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.0],
    [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, f32::NAN],
    [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.5],
    [1.0, 1.0, 1.0, f32::NAN, 1.0, 1.0, 1.0, 0.5],
    [1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.5],
    [1.0, 1.0, 1.0, 0.0, 0.0, 0.0, f32::INFINITY, 0.5],
    [0.0, 3.0, 0.0, 1e30, 1e30, 1e30, 1e30, 0.5],
    [0.0, f32::NAN, -1.0, 1.0, 1.0, 1.0, 1.0, 0.5],
];

/// Chances of pieces: of many counts and of one.
fn chance(r: &mut Random) -> f32 {
    if r.below(16) == 0 { 1.0 / 4_294_967_296.0 } else { r.log_range(1e-9, 1.0) }
}

pub(super) fn inputs(kernel: Kernel, count: usize, r: &mut Random) -> Vec<Batch> {
    let mut items = Vec::new();
    match kernel {
        Kernel::StartFlux | Kernel::LightShare => put(&mut items, SENSELESS.as_flattened()),
        Kernel::PieceFlux => put(&mut items, SENSELESS_PIECES.as_flattened()),
        Kernel::LookFactor => {
            for chance in [1.0, 1.0 - 0.5 * f32::EPSILON, 0.25, 1e-30, 1e-45, 0.0, -1.0, 2.0, f32::NAN] {
                for blocked in [0, 1, 2] {
                    put(&mut items, &[chance]);
                    items.push(blocked);
                }
            }
        }
        _ => {}
    }
    for i in 0..count {
        match kernel {
            Kernel::StartFlux | Kernel::LightShare => {
                let e = irradiance(i, r);
                put(&mut items, &e);
                // Both densities within a few powers of ten, and one of them alone.
                let per_watt = if i % 11 == 0 { 0.0 } else { r.log_range(1e-6, 1.0) };
                let light = per_watt * (e[0] / 3.0 + e[1] / 3.0 + e[2] / 3.0);
                let density = match i % 7 {
                    0 => 0.0,
                    1 => r.log_range(1e-9, 1e9),
                    _ => light.max(1e-12) * r.log_range(1e-4, 1e4),
                };
                put(&mut items, &[density, per_watt]);
            }
            Kernel::LookFactor => {
                put(&mut items, &[r.log_range(1e-6, 1.0)]);
                items.push(r.below(2));
            }
            Kernel::PieceFlux => {
                put(&mut items, &irradiance(i / 2, r));
                put(&mut items, &irradiance(i, r));
                put(&mut items, &[r.log_range(1e-6, 1e6), chance(r)]);
            }
            _ => {
                let c = corners(i, r);
                items.extend(c.as_flattened());
                if kernel != Kernel::StartWithin {
                    put(&mut items, &linear_triangle::weights(r));
                }
                if kernel == Kernel::StartPlace {
                    let n = HARD_UNITS.len();
                    let k = i / 16;
                    let hard = [HARD_UNITS.get(k / n), HARD_UNITS.get(k % n)];
                    put(&mut items, &hard.map(|u| u.copied().unwrap_or_else(|| r.unit())));
                    continue;
                }
                if kernel == Kernel::StartDensity {
                    let area = if i % 67 == 0 {
                        [0.0, f32::NAN, 1e-45][r.below(3) as usize]
                    } else {
                        r.log_range(1e-9, 1e6)
                    };
                    put(&mut items, &[area, chance(r)]);
                }
                put(&mut items, &place(i, c, r));
            }
        }
    }
    single(items)
}

/// Places among powers of two, each with a shift: the first, the last, and beyond.
pub(super) fn words(count: usize, r: &mut Random) -> Vec<Batch> {
    let mut items = Vec::new();
    for bits in 0..40 {
        for index in [0, 1, 5, u32::MAX >> (bits + 1).min(31), u32::MAX] {
            for shift in [0, 1, 1 << 31, u32::MAX, r.word()] {
                items.extend([index, shift, bits]);
            }
        }
    }
    for _ in 0..count {
        let bits = r.below(33);
        items.extend([(u64::from(r.word()) >> (32 - bits)) as u32, r.word(), bits]);
    }
    single(items)
}
