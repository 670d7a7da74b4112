//! Meshes to shoot at, and rays to shoot.

use etendue::core::geometry::{Intersector, Primitives, Ray};
use etendue::core::math::Vec3;

/// Weyl sequence with the finaliser of splitmix64.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// In [0, 1).
    pub(crate) fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 40) as f32 / 16_777_216.0
    }
}

/// Triangles with a view, and a lamp for shadow rays.
#[derive(Default)]
pub(crate) struct Mesh {
    pub(crate) name: String,
    pub(crate) positions: Vec<[f32; 3]>,
    pub(crate) triangles: Vec<[u32; 3]>,
    pub(crate) eye: Vec3,
    pub(crate) target: Vec3,
    /// Corner and edges of the lamp.
    pub(crate) lamp: [Vec3; 3],
    /// Length of short occlusion rays.
    pub(crate) short: f32,
}

impl Mesh {
    pub(crate) fn primitives(&self) -> Primitives<'_> {
        Primitives { positions: &self.positions, triangles: &self.triangles, shapes: &[] }
    }

    /// A grid of `rows` x `columns` cells over `at(u, v)`.
    fn grid(&mut self, rows: u32, columns: u32, at: impl Fn(f32, f32) -> Vec3) {
        let base = self.positions.len() as u32;
        for i in 0..=rows {
            for j in 0..=columns {
                self.positions.push(at(i as f32 / rows as f32, j as f32 / columns as f32).to_array());
            }
        }
        for i in 0..rows {
            for j in 0..columns {
                let a = base + i * (columns + 1) + j;
                let b = a + columns + 1;
                self.triangles.extend([[a, b, a + 1], [a + 1, b, b + 1]]);
            }
        }
    }

    /// A room with 24 bumpy balls of 2 rows^2 triangles each.
    pub(crate) fn room(rows: u32) -> Self {
        let mut m = Self {
            name: String::new(),
            eye: Vec3::new(-7.0, 3.0, -4.5),
            target: Vec3::new(6.0, 1.0, 3.0),
            lamp: [Vec3::new(-1.0, 5.9, -1.0), Vec3::new(2.0, 0.0, 0.0), Vec3::new(0.0, 0.0, 2.0)],
            short: 1.5,
            ..Self::default()
        };
        // Six walls around x in [-8, 8], y in [0, 6], z in [-5, 5].
        let (lo, hi) = (Vec3::new(-8.0, 0.0, -5.0), Vec3::new(8.0, 6.0, 5.0));
        let d = hi - lo;
        for axis in 0..3 {
            let [a, b] = [(axis + 1) % 3, (axis + 2) % 3];
            for end in [0.0, 1.0] {
                m.grid(1, 1, |u, v| {
                    let mut p = lo;
                    p[axis] += end * d[axis];
                    p[a] += u * d[a];
                    p[b] += v * d[b];
                    p
                });
            }
        }
        let mut r = Random(1);
        for _ in 0..24 {
            let radius = 0.35 + 0.5 * r.unit();
            let c = Vec3::new(13.0 * r.unit() - 6.5, 0.6 + 4.0 * r.unit(), 8.0 * r.unit() - 4.0);
            let phase = 6.0 * r.unit();
            m.grid(rows, rows, |u, v| {
                use std::f32::consts::PI;
                let ((st, ct), (sp, cp)) = ((PI * u).sin_cos(), (2.0 * PI * v).sin_cos());
                let bump = 1.0 + 0.06 * (9.0 * PI * u + phase).sin() * (14.0 * PI * v).sin();
                c + radius * bump * Vec3::new(st * cp, ct, st * sp)
            });
        }
        m.name = format!("room, {} triangles", m.triangles.len());
        m
    }
}

/// Rays of one kind.
pub(crate) struct Set {
    pub(crate) name: &'static str,
    /// Whether the first hit is asked for, or only whether there is one.
    pub(crate) closest: bool,
    pub(crate) rays: Vec<Ray>,
}

/// 2^18 primary rays; from each of their hits a diffuse bounce, a shadow ray and a short occlusion ray.
pub(crate) fn sets(mesh: &Mesh, tree: &impl Intersector) -> Vec<Set> {
    const SIDE: u32 = 512;
    let mut r = Random(2);
    let forward = (mesh.target - mesh.eye).normalize();
    let right = forward.cross(Vec3::Y).normalize();
    let up = right.cross(forward);
    let mut out = [("primary", true), ("bounce", true), ("shadow", false), ("short", false)]
        .map(|(name, closest)| Set { name, closest, rays: Vec::new() });
    for i in 0..SIDE * SIDE {
        let (x, y) = (i % SIDE, i / SIDE);
        let (x, y) = ((x as f32 + r.unit()) / SIDE as f32 - 0.5, 0.5 - (y as f32 + r.unit()) / SIDE as f32);
        let primary = Ray {
            origin: mesh.eye,
            direction: forward + right * (1.5 * x) + up * (1.1 * y),
            t_max: f32::INFINITY,
        };
        out[0].rays.push(primary);
        let Some(hit) = tree.closest_hit(&primary) else { continue };
        let [a, b, c] =
            mesh.triangles[hit.primitive as usize].map(|v| Vec3::from_array(mesh.positions[v as usize]));
        let n = (b - a).cross(c - a).normalize_or(Vec3::Y);
        let n = if n.dot(primary.direction) > 0.0 { -n } else { n };
        let p = primary.origin + primary.direction * hit.t + n * 1e-3;
        let mut cosine = || {
            let (z, phi) = ((1.0 - r.unit()).sqrt(), 2.0 * std::f32::consts::PI * r.unit());
            let (t, b) = etendue::core::math::orthonormal_basis(n);
            let s = (1.0 - z * z).max(0.0).sqrt();
            t * (s * phi.cos()) + b * (s * phi.sin()) + n * z
        };
        let bounce = cosine();
        let short = cosine();
        out[1].rays.push(Ray { origin: p, direction: bounce, t_max: f32::INFINITY });
        let lamp = mesh.lamp[0] + mesh.lamp[1] * r.unit() + mesh.lamp[2] * r.unit();
        out[2].rays.push(Ray { origin: p, direction: lamp - p, t_max: 0.999 });
        out[3].rays.push(Ray { origin: p, direction: short, t_max: mesh.short });
    }
    out.into()
}
