//! A closed box whose form factors are about right.

use crate::radiosity::form_factors::{FormFactors, balance};
use crate::radiosity::order;
use crate::radiosity::patches::Patch;
use alloc::vec;
use alloc::vec::Vec;

/// The inside of a cube, m x m patches a side, rows that sum to 1; and an order for it.
pub(super) fn cube(m: usize) -> (FormFactors, Vec<u32>) {
    let mut patches = Vec::new();
    for side in 0..6 {
        for k in 0..m * m {
            let step = 1.0 / m as f32;
            let (a, b) = ((0.5 + (k % m) as f32) * step, (0.5 + (k / m) as f32) * step);
            let (mut position, mut normal) = ([0.0; 3], [0.0; 3]);
            (position[side % 3], normal[side % 3]) = if side < 3 { (0.0, 1.0) } else { (1.0, -1.0) };
            (position[(side + 1) % 3], position[(side + 2) % 3]) = (a, b);
            // Areas that differ.
            let area = step * step * (0.7 + 0.6 * ((k * 7 + side) % 10) as f32 / 10.0);
            patches.push(Patch { area, position, normal, ..Patch::default() });
        }
    }
    let mut half = Vec::new();
    for (i, p) in patches.iter().enumerate() {
        for q in &patches[..=i] {
            let d: [f32; 3] = [0, 1, 2].map(|k| q.position[k] - p.position[k]);
            let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            let (r2, out, into) = (dot(d, d), dot(p.normal, d).max(0.0), dot(q.normal, d).min(0.0).abs());
            let kernel = if r2 > 0.0 { out * into / (core::f32::consts::PI * r2 * r2) } else { 0.0 };
            half.push(p.area * q.area * kernel);
        }
    }
    let n = patches.len();
    let zeros = vec![0.0; n];
    let areas = patches.iter().map(|p| p.area).collect();
    let mut made = FormFactors { areas, half, escaped: zeros.clone(), lost: zeros.clone(), stderr: zeros };
    balance(&mut made, &vec![1.0; n], 200);
    (made, order::kd(&patches, 8))
}

/// Some patches of a cube, from all sides; not closed.
pub(super) fn part(n: usize) -> FormFactors {
    let (f, _) = cube(4);
    let order: Vec<u32> = (0..n as u32).map(|i| i * 37 % f.len() as u32).collect();
    f.reordered(&order)
}

/// Albedos around `rho`.
pub(super) fn albedo(n: usize, rho: f32) -> Vec<[f32; 3]> {
    (0..n).map(|i| [rho, rho * (0.5 + 0.5 * ((i * 7 % 10) as f32) / 10.0), 0.4 * rho]).collect()
}

/// A few lit patches, one of them bright.
pub(super) fn lit(n: usize) -> Vec<[f32; 3]> {
    let mut direct: Vec<[f32; 3]> =
        (0..n).map(|i| if i % 5 == 0 { [1.0, 0.75, 0.5] } else { [0.0; 3] }).collect();
    direct[n / 3] = [30.0, 20.0, 10.0];
    direct
}
