//! Lit triangles with their irradiance in f64, and the error of pieces against it: for the tests of subdivision and its bench.
#![allow(dead_code, reason = "each crate includes this file and uses a part of it")]
#![allow(clippy::disallowed_methods, reason = "truth in f64")]
#![allow(unreachable_pub, reason = "the bench crate includes this file as a module of its own")]

use etendue_core::direct::subdivide::{Criterion, Limits, Node, Piece, Published, Robust, Workspace, refine};
use etendue_core::math::Vec3;

type V = [f64; 3];

fn sub(a: V, b: V) -> V {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: V, b: V) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Irradiance [W m^-2] of the plane z = 0 from above by a point light of 1 W sr^-1 at `light`: z / d^3; 0 from below.
pub fn point(light: V, p: V) -> f64 {
    let d = sub(light, p);
    let square = dot(d, d);
    if d[2] > 0.0 && square > 0.0 { d[2] / (square * square.sqrt()) } else { 0.0 }
}

/// A smooth step from 0 at `low` to 1 at `high`.
fn smoothstep(low: f64, high: f64, x: f64) -> f64 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// [`point`] times the falloff of a spot that looks down: none within `inner` (cosine), nothing beyond `outer`.
pub fn spot(light: V, [inner, outer]: [f64; 2], p: V) -> f64 {
    let d = sub(light, p);
    let cos = d[2] / dot(d, d).sqrt();
    point(light, p) * smoothstep(outer, inner, cos)
}

/// A lit triangle.
pub struct Scene {
    /// Its name.
    pub name: &'static str,
    /// Corners, metres, in the plane z = 0.
    pub corners: [V; 3],
    /// Irradiance at a point, W m^-2.
    pub irradiance: fn(V) -> f64,
}

const EQUILATERAL: [V; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 0.866, 0.0]];
const RIGHT: [V; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
const OBTUSE: [V; 3] = [[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [-0.6, 0.7, 0.0]];

/// The scenes of the figures. Shadows are those of an opaque half plane, bar or disk between light and triangle, at the
/// heights written.
pub const SCENES: [Scene; 8] = [
    Scene { name: "point light 1 m away", corners: EQUILATERAL, irradiance: |p| point([0.3, 0.2, 1.0], p) },
    Scene { name: "point light 5 cm away", corners: EQUILATERAL, irradiance: |p| point([0.4, 0.3, 0.05], p) },
    Scene {
        name: "shadow edge",
        corners: RIGHT,
        // Half plane y > 0.3 + 0.2 x of the plane z = 0.5 in the way.
        irradiance: |p| {
            let light = [0.2, 0.4, 1.0];
            let q = [0.5 * (light[0] + p[0]), 0.5 * (light[1] + p[1])];
            if q[1] > 0.3 + 0.2 * q[0] { 0.0 } else { point(light, p) }
        },
    },
    Scene {
        name: "thin shadow",
        corners: RIGHT,
        // A bar 1 cm wide halfway to the light: a shadow 2 cm wide.
        irradiance: |p| {
            let light = [0.2, 0.4, 1.0];
            let q = [0.5 * (light[0] + p[0]), 0.5 * (light[1] + p[1])];
            if (q[1] - 0.5 * q[0] - 0.15).abs() < 0.005 { 0.0 } else { point(light, p) }
        },
    },
    Scene {
        name: "spot's rim",
        corners: EQUILATERAL,
        irradiance: |p| spot([0.45, 0.3, 1.0], [0.99, 0.97], p),
    },
    Scene { name: "grazing", corners: RIGHT, irradiance: |p| point([-0.05, 0.4, 0.02], p) },
    Scene { name: "obtuse, light near an edge", corners: OBTUSE, irradiance: |p| point([0.2, 0.4, 0.15], p) },
    Scene {
        name: "round shadow",
        corners: OBTUSE,
        irradiance: |p| {
            let light = [0.0, 0.3, 0.8];
            let q = [0.5 * (light[0] + p[0]), 0.5 * (light[1] + p[1])];
            let (x, y) = (q[0] - 0.05, q[1] - 0.28);
            if x * x + y * y < 0.01 { 0.0 } else { point(light, p) }
        },
    },
];

impl Scene {
    /// Position of barycentric coordinates.
    pub fn at(&self, bary: [f64; 3]) -> V {
        let [a, b, c] = self.corners;
        [0, 1, 2].map(|i| bary[0] * a[i] + bary[1] * b[i] + bary[2] * c[i])
    }

    /// Corners as core takes them.
    pub fn vertices(&self) -> [Vec3; 3] {
        self.corners.map(|v| Vec3::from_array(v.map(|x| x as f32)))
    }

    /// Irradiance as a renderer's sample gives it: right, and rounded once.
    pub fn sample(&self, bary: [f32; 3]) -> f32 {
        (self.irradiance)(self.at(bary.map(f64::from))) as f32
    }

    /// Pieces of a depth-first walk, and the samples taken.
    pub fn subdivide(
        &self,
        criterion: &impl Criterion,
        limits: &Limits,
        work: &mut Workspace<f32>,
    ) -> (Vec<Piece<f32>>, u32) {
        let mut pieces = Vec::new();
        let summary =
            work.subdivide(self.vertices(), criterion, limits, |b| self.sample(b), |p| pieces.push(p));
        assert_eq!(summary.pieces as usize, pieces.len());
        (pieces, summary.samples)
    }

    /// Pieces of [`refine`] with room for `budget`, and the samples taken.
    pub fn refine(
        &self,
        criterion: &impl Criterion,
        limits: &Limits,
        budget: usize,
        work: &mut Workspace<f32>,
    ) -> (Vec<Piece<f32>>, u32) {
        let mut nodes = vec![Node::default(); budget];
        let summary = refine(self.vertices(), criterion, limits, work, &mut nodes, |b| self.sample(b));
        let pieces = nodes[..summary.pieces as usize].iter().map(Node::piece).collect();
        (pieces, summary.samples)
    }

    /// Pieces of equal shape: n^2 of them for n = 2^level, each corner sampled once.
    pub fn uniform(&self, level: u8, work: &mut Workspace<f32>) -> (Vec<Piece<f32>>, u32) {
        let limits = Limits { least_depth: level, depth: level, budget: u32::MAX, ..Limits::default() };
        let (pieces, _) = self.subdivide(&Quarters, &limits, work);
        let n = (1_u32 << level) + 1;
        (pieces, n * (n + 1) / 2)
    }
}

/// A measured subdivision.
#[derive(Clone, Debug)]
pub struct Point {
    /// What made it.
    pub method: &'static str,
    /// Pieces.
    pub pieces: usize,
    /// Samples of irradiance.
    pub samples: usize,
    /// Root mean square error over the root mean square of irradiance.
    pub error: f64,
}

/// All methods over all their settings, as far as 6000 pieces. The published rule as it is walked in its text, with tolerances and sizes to choose the
/// best from; the mended one by tolerance on a piece's part in the error, and with a budget.
pub fn contest(scene: &Scene, truth: &Truth, work: &mut Workspace<f32>) -> Vec<Point> {
    let mut points = Vec::new();
    let mut add = |method, (pieces, samples): (Vec<Piece<f32>>, u32)| {
        if pieces.len() <= 6000 {
            let (error, _) = truth.error(&pieces);
            points.push(Point { method, pieces: pieces.len(), samples: samples as usize, error });
        }
    };
    for level in 0..=6 {
        add("uniform", scene.uniform(level, work));
    }
    let free = Limits { budget: 100_000, ..Limits::default() };
    for relative in [0.0, 0.001, 0.003, 0.01, 0.03, 0.1, 0.3] {
        for size in [0.4, 0.28, 0.2, 0.14, 0.1, 0.07, 0.05, 0.035, 0.025, 0.018, 0.012, 0.008, 0.004] {
            let rule = Published { relative, absolute: 0.0 };
            add("published", scene.subdivide(&rule, &Limits { size, ..free }, work));
        }
    }
    let scale = truth.mean_square().sqrt();
    for step in 0..24 {
        let share = (scale * 0.06 * 0.75_f64.powi(step)) as f32;
        let rule = Robust { relative: 0.0, absolute: 0.0, share };
        // A least depth, since seven probes miss what is small.
        let limits = Limits { least_depth: 1, ..free };
        add("robust depth first", scene.subdivide(&rule, &limits, work));
    }
    for step in 4..=24 {
        let budget = 2.0_f64.powf(f64::from(step) / 2.0).round() as usize;
        let rule = Robust { relative: 0.0, absolute: 0.0, share: 0.0 };
        add("robust best first", scene.refine(&rule, &free, budget, work));
    }
    points
}

/// Accepts everything; where it must cut, cuts in four.
pub struct Quarters;

impl Criterion for Quarters {
    fn examine(
        &self,
        _: &etendue_core::direct::subdivide::Shape,
        _: &etendue_core::direct::subdivide::Samples,
        _: f32,
    ) -> etendue_core::direct::subdivide::Verdict {
        etendue_core::direct::subdivide::Verdict::Accept
    }
    fn demanded(&self, _: &etendue_core::direct::subdivide::Shape) -> etendue_core::direct::subdivide::Split {
        etendue_core::direct::subdivide::Split::Four { corner: 0 }
    }
}

/// Irradiance of a scene at the centres of the n^2 small triangles of a lattice: none of them lies on an edge of a dyadic piece.
pub struct Truth {
    n: usize,
    /// By row b2, then b1, then up or down; the down ones of a row follow the up ones at 2 i + 1.
    values: Vec<f64>,
    square: f64,
}

impl Truth {
    /// Samples a scene.
    pub fn new(scene: &Scene, n: usize) -> Self {
        let mut values = Vec::with_capacity(n * n);
        for j in 0..n {
            for k in 0..2 * (n - j) - 1 {
                let (b1, b2) = centre(n, j, k);
                values.push((scene.irradiance)(scene.at([1.0 - b1 - b2, b1, b2])));
            }
        }
        let square = values.iter().map(|x| x * x).sum();
        Self { n, values, square }
    }

    /// Mean square of irradiance.
    pub fn mean_square(&self) -> f64 {
        self.square / self.values.len() as f64
    }

    /// Root mean square error of pieces over the root mean square of irradiance; and the centres that no piece or more than one claims.
    pub fn error(&self, pieces: &[Piece<f32>]) -> (f64, usize) {
        let n = self.n;
        let mut claims = vec![0_u8; self.values.len()];
        let mut sum = 0.0;
        for piece in pieces {
            let [a, b, c] = piece.corners.map(|p| p.steps().map(|x| f64::from(x) / 16_777_216.0 * n as f64));
            let area = (b[1] - a[1]) * (c[2] - a[2]) - (c[1] - a[1]) * (b[2] - a[2]);
            let low = |i: usize| (a[i].min(b[i]).min(c[i]) - 1.0).floor().max(0.0) as usize;
            let high = |i: usize| (a[i].max(b[i]).max(c[i]) + 1.0).floor() as usize;
            for j in low(2)..=high(2).min(n - 1) {
                let row = j * (2 * n - j);
                for k in 2 * low(1)..=(2 * high(1) + 1) {
                    if k >= 2 * (n - j) - 1 {
                        break;
                    }
                    let (x, y) = centre(n, j, k);
                    let (x, y) = (x * n as f64, y * n as f64);
                    let wb = ((x - a[1]) * (c[2] - a[2]) - (c[1] - a[1]) * (y - a[2])) / area;
                    let wc = ((b[1] - a[1]) * (y - a[2]) - (x - a[1]) * (b[2] - a[2])) / area;
                    let wa = 1.0 - wb - wc;
                    if wa >= 0.0 && wb >= 0.0 && wc >= 0.0 {
                        claims[row + k] = claims[row + k].saturating_add(1);
                        let [la, lb, lc] = piece.irradiance.map(f64::from);
                        let e = wa * la + wb * lb + wc * lc - self.values[row + k];
                        sum += e * e;
                    }
                }
            }
        }
        let wrong = claims.iter().filter(|c| **c != 1).count();
        ((sum / self.square).sqrt(), wrong)
    }
}

/// A point near the centre k of row j: even ones in upward triangles, odd ones in downward. Not the centroid, on which cuts at centroids meet.
fn centre(n: usize, j: usize, k: usize) -> (f64, f64) {
    let (i, third) = (k / 2, if k.is_multiple_of(2) { 0.315 } else { 0.685 });
    ((i as f64 + third) / n as f64, (j as f64 + third) / n as f64)
}
