//! Meshes, random numbers and rays shared by the geometry tests (`#[path]`-included; no tests of its own).
#![allow(dead_code, reason = "each test file uses its part")]
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use etendue_core::geometry::{Primitives, Ray, RoundShape};
use etendue_core::math::Vec3;

/// SplitMix64: a fixed, portable stream per seed.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
    pub(crate) fn below(&mut self, n: usize) -> usize {
        ((u128::from(self.next()) * n as u128) >> 64) as usize
    }
    /// In [0, 1).
    pub(crate) fn unit(&mut self) -> f32 {
        (self.next() >> 40) as f32 * (1.0 / 16_777_216.0)
    }
    pub(crate) fn range(&mut self, lo: f32, hi: f32) -> f32 {
        lo + (hi - lo) * self.unit()
    }
    pub(crate) fn vector(&mut self, scale: f32) -> Vec3 {
        Vec3::new(self.range(-scale, scale), self.range(-scale, scale), self.range(-scale, scale))
    }
    pub(crate) fn direction(&mut self) -> Vec3 {
        loop {
            let v = self.vector(1.0);
            let l = v.length_squared();
            if l > 1e-4 && l < 1.0 {
                return v / l.sqrt();
            }
        }
    }
}

/// Owned primitives.
#[derive(Clone, Default)]
pub(crate) struct Mesh {
    pub(crate) positions: Vec<[f32; 3]>,
    pub(crate) triangles: Vec<[u32; 3]>,
    pub(crate) shapes: Vec<RoundShape>,
}

impl Mesh {
    pub(crate) fn primitives(&self) -> Primitives<'_> {
        Primitives { positions: &self.positions, triangles: &self.triangles, shapes: &self.shapes }
    }
    pub(crate) fn moved(mut self, by: [f32; 3]) -> Self {
        for p in &mut self.positions {
            for k in 0..3 {
                p[k] += by[k];
            }
        }
        self
    }
    /// Rotates about an oblique axis by 0.7 rad (Rodrigues, in f64).
    pub(crate) fn oblique(mut self) -> Self {
        let (s, c) = 0.7f64.sin_cos();
        let k = [2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0f64];
        for p in &mut self.positions {
            let v = p.map(f64::from);
            let dot = k[0] * v[0] + k[1] * v[1] + k[2] * v[2];
            let cross = [k[1] * v[2] - k[2] * v[1], k[2] * v[0] - k[0] * v[2], k[0] * v[1] - k[1] * v[0]];
            for i in 0..3 {
                p[i] = (v[i] * c + cross[i] * s + k[i] * dot * (1.0 - c)) as f32;
            }
        }
        self
    }
    pub(crate) fn triangle(&mut self, v: [[f32; 3]; 3]) {
        let n = self.positions.len() as u32;
        self.positions.extend(v);
        self.triangles.push([n, n + 1, n + 2]);
    }
}

/// A closed bumpy ball of radius about 1 around the origin: an icosahedron whose faces are cut in four `levels`
/// times (20 * 4^levels triangles; 5 gives 20 480).
pub(crate) fn ball(levels: u32) -> Mesh {
    let g = (1.0 + 5f64.sqrt()) / 2.0;
    let mut p: Vec<[f64; 3]> = Vec::new();
    for a in [-1.0, 1.0] {
        for b in [-g, g] {
            p.extend([[a, b, 0.0], [0.0, a, b], [b, 0.0, a]]);
        }
    }
    let distance = |a: [f64; 3], b: [f64; 3]| -> f64 { (0..3).map(|k| (a[k] - b[k]).powi(2)).sum() };
    let mut faces: Vec<[u32; 3]> = Vec::new();
    for i in 0..12u32 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                let near = |a: u32, b: u32| distance(p[a as usize], p[b as usize]) < 4.1;
                if near(i, j) && near(j, k) && near(i, k) {
                    faces.push([i, j, k]);
                }
            }
        }
    }
    assert_eq!(faces.len(), 20);
    let unit = |v: [f64; 3]| {
        let l = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
        v.map(|x| x / l)
    };
    p.iter_mut().for_each(|v| *v = unit(*v));
    for _ in 0..levels {
        let mut middle = std::collections::HashMap::new();
        let mut next = Vec::with_capacity(faces.len() * 4);
        for [a, b, c] in faces {
            let mut mid = |i: u32, j: u32| {
                *middle.entry((i.min(j), i.max(j))).or_insert_with(|| {
                    let (u, v) = (p[i as usize], p[j as usize]);
                    p.push(unit([u[0] + v[0], u[1] + v[1], u[2] + v[2]]));
                    p.len() as u32 - 1
                })
            };
            let (ab, bc, ca) = (mid(a, b), mid(b, c), mid(c, a));
            next.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        faces = next;
    }
    let bump = |v: [f64; 3]| {
        let r = 1.0 + 0.05 * (7.0 * v[0]).sin() * (9.0 * v[1]).cos() * (8.0 * v[2] + 1.0).sin();
        v.map(|x| (x * r) as f32)
    };
    Mesh { positions: p.into_iter().map(bump).collect(), triangles: faces, shapes: Vec::new() }
}

/// The closed surface of the cube [-1, 1]^3 with `n` by `n` quads (two triangles each) on every face; vertices on
/// cube edges are shared, coordinates are exact multiples of 2/n.
pub(crate) fn box_grid(n: i32) -> Mesh {
    let mut index = std::collections::HashMap::new();
    let mut mesh = Mesh::default();
    for axis in 0..3usize {
        for side in [0, n] {
            for i in 0..n {
                for j in 0..n {
                    let mut at = |i: i32, j: i32| {
                        let mut key = [0; 3];
                        key[axis] = side;
                        key[(axis + 1) % 3] = i;
                        key[(axis + 2) % 3] = j;
                        *index.entry(key).or_insert_with(|| {
                            mesh.positions.push(key.map(|k| -1.0 + 2.0 * k as f32 / n as f32));
                            mesh.positions.len() as u32 - 1
                        })
                    };
                    let q = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                    if (i + j) % 2 == 0 {
                        mesh.triangles.extend([[q[0], q[1], q[2]], [q[0], q[2], q[3]]]);
                    } else {
                        mesh.triangles.extend([[q[0], q[1], q[3]], [q[1], q[2], q[3]]]);
                    }
                }
            }
        }
    }
    mesh
}

/// An unbounded ray.
pub(crate) fn ray(origin: Vec3, direction: Vec3) -> Ray {
    Ray { origin, direction, t_max: f32::INFINITY }
}
