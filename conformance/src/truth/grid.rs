//! Media on grids from the definition: a trilinear field, and its integral between all planes that a ray meets.

use super::vec::{self, V};
use super::{Answer, Expect, Words};
use etendue_core::kernel::Kernel;

/// Places this near a face of the box are on either side of it \[cells\].
const NEAR: f64 = 1.0 / 512.0;
/// Gauss' rule of three points on [-1, 1].
const GAUSS: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

struct Field {
    size: [usize; 3],
    channels: usize,
    to_cells: [[f64; 4]; 3],
    values: Vec<f64>,
}

impl Field {
    fn new(constants: &[u32]) -> Self {
        let mut r = Words::new(constants);
        let size = [(); 3].map(|()| r.word() as usize);
        let channels = r.word() as usize;
        let to_cells = [(); 3].map(|()| [(); 4].map(|()| r.real()));
        let values = r.rest().iter().map(|w| f64::from(f32::from_bits(*w))).collect();
        Self { size, channels, to_cells, values }
    }

    fn turned(&self, v: V) -> V {
        self.to_cells.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
    }

    /// Cells from the corner of the box.
    fn cells(&self, p: V) -> V {
        self.turned(vec::sub(p, self.to_cells.map(|row| row[3])))
    }

    fn largest(&self) -> f64 {
        self.values.iter().fold(0.0, |m, v| v.abs().max(m))
    }

    /// The value at cells, which must lie in the box.
    fn at(&self, q: V) -> V {
        // Between the centres of cells, in the outer halves at the nearest.
        let place = [0, 1, 2].map(|k| (q[k] - 0.5).clamp(0.0, (self.size[k] - 1) as f64));
        let mut sum = [0.0; 3];
        for corner in 0..8 {
            let (mut weight, mut index) = (1.0, [0; 3]);
            for k in 0..3 {
                let low = (place[k] as usize).min(self.size[k] - 1);
                let f = place[k] - low as f64;
                let up = corner >> k & 1;
                weight *= if up == 1 { f } else { 1.0 - f };
                index[k] = (low + up).min(self.size[k] - 1);
            }
            let cell = (index[2] * self.size[1] + index[1]) * self.size[0] + index[0];
            for (c, sum) in sum.iter_mut().enumerate() {
                *sum += weight * self.values[cell * self.channels + c % self.channels];
            }
        }
        sum
    }
}

fn value(field: &Field, p: V) -> Answer {
    let q = field.cells(p);
    let from_face = |k: usize| q[k].abs().min((q[k] - field.size[k] as f64).abs());
    if (0..3).any(|k| from_face(k) < NEAR) {
        return Answer::Undecided;
    }
    if (0..3).any(|k| q[k] < 0.0 || q[k] > field.size[k] as f64) {
        return Answer::Is(vec![Expect::Ulp(0.0); 3]);
    }
    // Values differ by no more than the largest from cell to cell, and places are off by roundings of their own coordinates.
    let scale = field.largest() * (2.0 + q.iter().fold(0.0_f64, |m, x| m.max(x.abs())) + vec::largest(p));
    Answer::Is(super::scaled(field.at(q), scale))
}

fn optical_length(field: &Field, origin: V, direction: V, limit: f64) -> Answer {
    let (o, d) = (field.cells(origin), field.turned(direction));
    let mut stops = vec![0.0, limit];
    for k in 0..3 {
        // The faces, and the planes through the centres of cells.
        let planes = (0..field.size[k]).map(|i| i as f64 + 0.5).chain([0.0, field.size[k] as f64]);
        stops.extend(planes.filter(|_| d[k] != 0.0).map(|p| (p - o[k]) / d[k]));
    }
    stops.retain(|t| (0.0..=limit).contains(t));
    stops.sort_by(f64::total_cmp);
    let (mut sum, mut within) = ([0.0; 3], 0.0);
    for pair in stops.windows(2) {
        let (half, span) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
        let at = |t: f64| [0, 1, 2].map(|k| o[k] + d[k] * t);
        let middle = at(half);
        if (0..3).any(|k| middle[k] < 0.0 || middle[k] > field.size[k] as f64) {
            continue;
        }
        within += 2.0 * span;
        for (x, weight) in GAUSS {
            let v = field.at(at(half + x * span));
            sum = [0, 1, 2].map(|c| sum[c] + weight * span * v[c]);
        }
    }
    // A ray along a face is in the box or out of it.
    if (0..3).any(|k| d[k].abs() < 1e-3 && (o[k].abs() < NEAR || (o[k] - field.size[k] as f64).abs() < NEAR))
    {
        return Answer::Undecided;
    }
    // What the roundings of coordinates amount to, along the way and where it enters and leaves: the more so where faces are met at grazing angles.
    let cells = field.size.iter().fold(0, |m, n| *n.max(&m)) as f64;
    let reach = vec::largest(o) + cells + limit.min(2.0 * (vec::largest(o) + cells)) * vec::largest(d);
    let steepest = d.iter().fold(f64::INFINITY, |m, x| if *x == 0.0 { m } else { m.min(x.abs()) });
    let scale = field.largest() * (within * (4.0 + reach) + reach / steepest.max(1e-6));
    Answer::Is(super::scaled(sum, scale))
}

pub(super) fn truth(kernel: Kernel, constants: &[u32], r: &mut Words<'_>) -> Answer {
    let field = Field::new(constants);
    match kernel {
        Kernel::GridAt => value(&field, r.vec3()),
        Kernel::GridOpticalLength => optical_length(&field, r.vec3(), r.vec3(), r.real()),
        _ => Answer::Undecided,
    }
}
