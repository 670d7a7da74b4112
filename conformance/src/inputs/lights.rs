//! Surfaces, lights, cameras and images.

use super::{Batch, HARD_UNITS, exponent, normalized, pairs, put};
use crate::statistics::Random;
use etendue_core::kernel::Kernel;

fn albedo(r: &mut Random) -> [f32; 3] {
    match r.below(5) {
        0 => [0.0; 3],
        1 => [1.0; 3],
        _ => [0; 3].map(|_| r.unit()),
    }
}

/// A direction on the side of n.
fn above(n: [f32; 3], r: &mut Random) -> [f32; 3] {
    let w = r.direction();
    let cos: f32 = (0..3).map(|i| n[i] * w[i]).sum();
    if cos < 0.0 { w.map(|x| -x) } else { w }
}

/// A direction near the mirror direction, so that narrow lobes are met.
fn near_mirror(n: [f32; 3], wo: [f32; 3], r: &mut Random) -> [f32; 3] {
    let cos: f64 = (0..3).map(|i| f64::from(n[i]) * f64::from(wo[i])).sum();
    let spread = f64::from(r.log_range(1e-3, 1.0));
    let jitter = r.direction();
    normalized(
        [0, 1, 2]
            .map(|i| (2.0 * cos * f64::from(n[i]) - f64::from(wo[i]) + spread * f64::from(jitter[i])) as f32),
    )
}

fn normal(r: &mut Random) -> [f32; 3] {
    match r.below(8) {
        0 => [0.0, 0.0, 1.0],
        1 => [0.0, 0.0, -1.0],
        2 => [0.0, 1.0, 0.0],
        _ => r.direction(),
    }
}

fn unit_pair(i: usize, r: &mut Random) -> [f32; 2] {
    let n = HARD_UNITS.len();
    if i < n * n { [HARD_UNITS[i / n], HARD_UNITS[i % n]] } else { [r.unit(), r.unit()] }
}

pub(super) fn scattering(kernel: Kernel, count: usize, r: &mut Random) -> Vec<u32> {
    use Kernel as K;
    let mut items = Vec::new();
    for i in 0..count {
        let n = normal(r);
        let wo = if r.below(8) == 0 { n } else { above(n, r) };
        let wi = if r.below(2) == 0 { r.direction() } else { near_mirror(n, wo, r) };
        let u = unit_pair(i, r);
        match kernel {
            K::EvalDiffuse => put(&mut items, [albedo(r), n, wi].as_flattened()),
            K::PdfDiffuse => put(&mut items, [n, wi].as_flattened()),
            K::SampleDiffuse => put(&mut items, &[n[0], n[1], n[2], u[0], u[1]]),
            K::EvalPhong => {
                put(&mut items, &albedo(r));
                put(&mut items, &[exponent(r)]);
                put(&mut items, [n, wo, wi].as_flattened());
            }
            K::PdfPhong => {
                put(&mut items, &[exponent(r)]);
                put(&mut items, [n, wo, wi].as_flattened());
            }
            K::FacetsDensity | K::FacetsMasking | K::PdfVisible | K::SampleVisible => {
                items.push(u32::from(r.below(2) == 0));
                put(&mut items, &[r.log_range(1e-3, 2.0)]);
                put(&mut items, &n);
                match kernel {
                    K::FacetsDensity => put(&mut items, &near_mirror(n, n, r)),
                    K::FacetsMasking => put(&mut items, &wo),
                    K::PdfVisible => put(&mut items, [wo, near_mirror(n, n, r)].as_flattened()),
                    _ => put(&mut items, &[wo[0], wo[1], wo[2], u[0], u[1]]),
                }
            }
            K::SamplePhong => {
                put(&mut items, &[exponent(r)]);
                put(&mut items, [n, wo].as_flattened());
                put(&mut items, &u);
            }
            _ => {
                let specular = if r.below(3) == 0 { [0.0; 3] } else { albedo(r) };
                put(&mut items, [albedo(r), specular].as_flattened());
                put(&mut items, &[exponent(r)]);
                items.push(u32::from(r.below(8) == 0));
                put(&mut items, [n, wo].as_flattened());
                if kernel == K::SampleLobes {
                    put(&mut items, &[u[0], u[1], HARD_UNITS.get(i).copied().unwrap_or_else(|| r.unit())]);
                } else {
                    put(&mut items, &wi);
                }
            }
        }
    }
    items
}

/// Words of a `LightRecord`, by hand: the layout is part of what is tested.
pub(super) struct Record {
    pub(super) kind: u32,
    pub(super) pmf: f32,
    pub(super) area: f32,
    pub(super) point: [f32; 3],
    pub(super) params: [f32; 2],
    pub(super) radiance: [f32; 3],
    pub(super) edge1: [f32; 3],
    pub(super) edge2: [f32; 3],
    pub(super) normal: [f32; 3],
}

impl Record {
    /// A light of no extent or direction.
    pub(super) fn dark(kind: u32, radiance: [f32; 3]) -> Self {
        let zero = [0.0; 3];
        Self {
            kind,
            pmf: 1.0,
            area: 0.0,
            point: zero,
            params: [0.0; 2],
            radiance,
            edge1: zero,
            edge2: zero,
            normal: zero,
        }
    }

    pub(super) fn words(&self) -> Vec<u32> {
        let mut w = vec![self.kind, 0];
        put(&mut w, &[self.pmf, self.area]);
        put(&mut w, &self.point);
        put(&mut w, &self.params);
        put(&mut w, &[0.0; 3]);
        put(&mut w, [self.radiance, self.edge1, self.edge2, self.normal].as_flattened());
        w
    }
}

pub(super) fn records(r: &mut Random) -> Vec<Record> {
    let zero = [0.0; 3];
    let mut list = Vec::new();
    for kind in 0..7_u32 {
        for round in 0..3 {
            let radiance = [r.log_range(0.1, 100.0), r.log_range(0.1, 100.0), r.log_range(0.1, 100.0)];
            let point = if round == 0 { zero } else { r.vector(-3.0, 3.0) };
            let pmf = if round == 0 { 1.0 } else { r.range(0.01, 1.0) as f32 };
            let n = normal(r);
            let base = Record { pmf, point, ..Record::dark(kind, radiance) };
            let radius = r.log_range(0.05, 2.0);
            let pi = std::f64::consts::PI;
            let disk = (pi * f64::from(radius) * f64::from(radius)) as f32;
            list.push(match kind {
                0 => base,
                1 => Record {
                    edge1: n,
                    params: [r.range(-0.5, 0.5) as f32, r.range(0.6, 0.99) as f32],
                    ..base
                },
                2 => Record { normal: n, ..base },
                3 | 4 => {
                    let (a, b) = (r.direction(), r.direction());
                    let size = f64::from(radius);
                    let (a, b) = (a.map(|x| f64::from(x) * size), b.map(|x| f64::from(x) * size));
                    let c = crate::truth::vec::cross(a, b);
                    let twice = crate::truth::vec::length(c);
                    let area = if kind == 3 { 0.5 * twice } else { twice };
                    Record {
                        area: area as f32,
                        edge1: a.map(|x| x as f32),
                        edge2: b.map(|x| x as f32),
                        normal: c.map(|x| (x / twice) as f32),
                        ..base
                    }
                }
                5 => Record { area: 4.0 * disk, params: [radius, 0.0], ..base },
                _ => Record { area: disk, params: [radius, 0.0], normal: n, ..base },
            });
        }
    }
    list
}

pub(super) fn lights(kernel: Kernel, count: usize, r: &mut Random) -> Vec<Batch> {
    let mut out = Vec::new();
    for record in records(r) {
        let mut items = Vec::new();
        for i in 0..count / 16 + 100 {
            let mut p = r.vector(-5.0, 5.0);
            if i < 4 {
                // On the light and next to it.
                p = [0, 1, 2].map(|k| record.point[k] + record.params[0] * [0.0, 1.0, 2.0, 1.001][i]);
            }
            put(&mut items, &p);
            if kernel == Kernel::SampleLight {
                put(&mut items, &unit_pair(i, r));
            } else {
                put(&mut items, &r.direction());
                put(&mut items, &[r.log_range(0.01, 10.0)]);
                put(&mut items, &r.direction());
            }
        }
        out.push(Batch { constants: record.words(), items });
    }
    out
}

pub(super) fn cameras(count: usize, r: &mut Random) -> Vec<Batch> {
    let mut out = Vec::new();
    for lens in [0.0, 0.25] {
        for resolution in [[1, 1], [640, 480], [32768, 3]] {
            let mut constants = Vec::new();
            put(&mut constants, &r.vector(-3.0, 3.0));
            put(&mut constants, &[lens, 0.6, 0.0, 0.8, 4.0]);
            // Right and up span half an image: perpendicular to the axis.
            put(&mut constants, &[0.8 * 0.5, 0.0, -0.6 * 0.5]);
            constants.push(resolution[0]);
            put(&mut constants, &[0.0, 0.375, 0.0]);
            constants.push(resolution[1]);
            let mut items = Vec::new();
            for i in 0..count / 6 + 81 {
                items.extend([r.below(resolution[0]), r.below(resolution[1])]);
                put(&mut items, &unit_pair(i, r));
                put(&mut items, &unit_pair(80_usize.saturating_sub(i), r));
            }
            out.push(Batch { constants, items });
        }
    }
    out
}

pub(super) fn tones(count: usize, r: &mut Random) -> Vec<Batch> {
    let mut out = Vec::new();
    for map in 0..3_u32 {
        for [exposure, a, c, gamma] in
            [[0.0, 1.0, 0.0, 1.0 / 2.2], [2.0, 0.9, 0.01, 0.5], [-3.5, 1.0, 0.0, 1.0_f32]]
        {
            let mut constants = vec![map];
            put(&mut constants, &[exposure, a, c, gamma]);
            let mut items = Vec::new();
            put(&mut items, &[0.0, -1.0, 1.0, f32::MAX, 1e-30, 1e-45, 0.0031308, 0.5, 100.0]);
            for _ in 0..count / 9 {
                put(&mut items, &[r.log_range(1e-6, 1e4), r.unit(), r.log_range(0.1, 10.0)]);
            }
            out.push(Batch { constants, items });
        }
    }
    out
}

pub(super) fn bitmaps(count: usize, r: &mut Random) -> Vec<Batch> {
    let mut out = Vec::new();
    for [width, height] in [[1_u32, 1], [2, 2], [7, 3], [64, 32]] {
        let mut constants = vec![width, height];
        constants.extend((0..width * height).map(|_| r.word() >> 8));
        let mut items = pairs(count / 8, r, |_| Vec::new());
        for _ in 0..count / 8 {
            put(&mut items, &[r.range(-3.0, 3.0) as f32, r.range(-3.0, 3.0) as f32]);
        }
        out.push(Batch { constants, items });
    }
    out
}
