//! Contenders for `linear_triangle`: points of linear density over 4096 triangles, weights and random numbers uniform.
//!
//! The error is that of the marginal coordinate that each form solves for: the distance from its apex (the lightest vertex for
//! ours, vertex 1 for Cardano's formula), relative, root mean square over the samples, against f64; a NaN counts as an error of one.
//! The mixture's is that of the barycentric of the vertex that it picks, rejection's that of the first barycentric of its uniform point.
#![allow(clippy::disallowed_methods, reason = "errors in f64; rivals as anyone would write them")]

use crate::figure::{Contender, Contest};
use etendue_core::sampling::linear_triangle::{
    Cardano, Dirichlet, LinearTriangle, apex_distance, sample, sample_slice,
};
use std::hint::black_box;
use std::rc::Rc;

const COUNT: usize = 4096;

/// A sampler over slices.
type Slices = fn(&[[f32; 3]], &[[f32; 2]], &mut [[f32; 3]]) -> usize;

struct Inputs {
    weights: Vec<[f32; 3]>,
    numbers: Vec<[f32; 2]>,
}

/// A linear congruential generator's upper bits.
fn inputs() -> Inputs {
    let mut state = 1_u64;
    let mut unit = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / 16_777_216.0
    };
    let weights = (0..COUNT).map(|_| [unit(), unit(), unit()]).collect();
    let numbers = (0..COUNT).map(|_| [unit(), unit()]).collect();
    Inputs { weights, numbers }
}

/// The distance from the apex of weight `w`, the two others weighing `v` in sum, by halving.
fn distance(w: f64, v: f64, xi: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..200 {
        let s: f64 = 0.5 * (low + high);
        if s * s * (w * (3.0 - 2.0 * s) + v * s) < xi * (w + v) {
            low = s;
        } else {
            high = s;
        }
    }
    0.5 * (low + high)
}

fn rms(errors: impl Iterator<Item = f64>) -> f64 {
    let errors: Vec<f64> = errors.map(|e| if e.is_nan() { 1.0 } else { e.min(1.0) }).collect();
    (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt()
}

/// Cardano's trigonometric and hyperbolic formulas in f64 with std's functions: what a reader of the published form might write.
fn cardano_f64(w: [f32; 3], u: [f32; 2]) -> [f64; 3] {
    let [a, b, c] = w.map(f64::from);
    let s = a + b + c;
    let leading = s - 3.0 * b;
    let (k2, k1, k0) =
        (-3.0 * (s - 2.0 * b) / leading, 3.0 * (s - b) / leading, -f64::from(u[0]) * s / leading);
    let shift = k2 / 3.0;
    let (p, q) = (k1 - k2 * shift, 2.0 * shift.powi(3) - shift * k1 + k0);
    let discriminant = 0.25 * q * q + p * p * p / 27.0;
    let inside = |x: f64| (-1e-9..1.0 + 1e-9).contains(&x);
    let x = if discriminant >= 0.0 {
        let d = discriminant.sqrt();
        (-0.5 * q + d).cbrt() + (-0.5 * q - d).cbrt() - shift
    } else {
        let r = (-p / 3.0).sqrt();
        let phi = (-0.5 * q / (r * r * r)).clamp(-1.0, 1.0).acos();
        let root = |k: f64| 2.0 * r * ((phi + k * std::f64::consts::TAU) / 3.0).cos() - shift;
        [root(0.0), root(1.0), root(2.0)].into_iter().find(|x| inside(*x)).unwrap_or(f64::NAN)
    };
    let rest = 1.0 - x;
    let (from, to, eta) = (a * rest + b * x, c * rest + b * x, f64::from(u[1]));
    let v = rest * (eta * (from + to) / (from + (from * from * (1.0 - eta) + to * to * eta).sqrt()));
    [rest - v, x, v]
}

/// Uniform points until one lies below the density, with the two numbers of the last; more random numbers from a hash of the two
/// given.
fn rejection(w: [f32; 3], u: [f32; 2]) -> ([f32; 3], [f32; 2]) {
    let most = w[0].max(w[1]).max(w[2]);
    let mut state = (u64::from(u[0].to_bits()) << 32 | u64::from(u[1].to_bits())) | 1;
    let mut unit = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / 16_777_216.0
    };
    loop {
        let u = [unit(), unit()];
        let b = etendue_core::sampling::warp::sample_triangle(u);
        if unit() * most <= w[0] * b[0] + w[1] * b[1] + w[2] * b[2] {
            return (b, u);
        }
    }
}

/// Heitz's map in f64: the first barycentric.
fn uniform_first(u: [f32; 2]) -> f64 {
    let [u0, u1] = u.map(f64::from);
    if u0 < u1 { 0.5 * u0 } else { u0 - 0.5 * u1 }
}

/// The mixture in f64: which vertex is picked, and its barycentric, the root of 3 x^2 - 2 x^3.
fn mixture_own(w: [f32; 3], u: [f32; 2]) -> (usize, f64) {
    let w = w.map(f64::from);
    let mut left = f64::from(u[0]) * w.iter().sum::<f64>();
    let mut vertex = 0;
    while vertex < 2 && left >= w[vertex] {
        left -= w[vertex];
        vertex += 1;
    }
    // A vertex of weight 1 alone.
    (vertex, distance(1.0, 0.0, left / w[vertex]))
}

/// One contender that makes one point at a time.
fn single(
    name: &str,
    ours: bool,
    error: f64,
    inputs: &Rc<Inputs>,
    f: impl Fn([f32; 3], [f32; 2]) -> [f32; 3] + 'static,
) -> Contender {
    let inputs = inputs.clone();
    let mut out = vec![[0.0; 3]; COUNT];
    let work = move || {
        for ((w, u), out) in inputs.weights.iter().zip(&inputs.numbers).zip(&mut out) {
            *out = f(*w, *u);
        }
        black_box(&out);
    };
    Contender { name: name.into(), ours, error, work: Box::new(work) }
}

/// All contenders; the first is the published form.
pub fn contest() -> Contest {
    let inputs = Rc::new(inputs());
    let each = || inputs.weights.iter().zip(&inputs.numbers);
    let marginal = |found: &dyn Fn([f32; 3], [f32; 2]) -> f64| {
        rms(each().map(|(w, u)| {
            // Vertex 1 is the apex, and the first number counts from the far side.
            let v = w.map(f64::from);
            let truth = 1.0 - distance(v[1], v[0] + v[2], 1.0 - f64::from(u[0]));
            (found(*w, *u) - truth) / truth.max(1e-300)
        }))
    };
    let robust = rms(each().map(|(w, u)| {
        let found = apex_distance(*w, u[0]);
        let v = w.map(f64::from);
        let truth = distance(v[found.apex], v.iter().sum::<f64>() - v[found.apex], f64::from(u[0]));
        (f64::from(found.distance) - truth) / truth.max(1e-300)
    }));
    let cardano = marginal(&|w, u| f64::from(Cardano.sample(w, u)[1]));
    let cardano_wide = marginal(&|w, u| cardano_f64(w, u)[1]);
    let relative = |x: f32, truth: f64| (f64::from(x) - truth) / truth.max(1e-300);
    let mixture = rms(each().map(|(w, u)| {
        let (vertex, own) = mixture_own(*w, *u);
        relative(Dirichlet.sample(*w, *u)[vertex], own)
    }));
    let uniform = rms(each().map(|(w, u)| {
        let (b, u) = rejection(*w, *u);
        relative(b[0], uniform_first(u))
    }));
    let slices = |name: &str, f: Slices| {
        let inputs = inputs.clone();
        let mut out = vec![[0.0; 3]; COUNT];
        let work = move || {
            f(&inputs.weights, &inputs.numbers, &mut out);
            black_box(&out);
        };
        Contender { name: name.into(), ours: true, error: robust, work: Box::new(work) }
    };
    let contenders = vec![
        single("Cardano, f32, as published", false, cardano, &inputs, |w, u| Cardano.sample(w, u)),
        single("Cardano, f64", false, cardano_wide, &inputs, |w, u| cardano_f64(w, u).map(|x| x as f32)),
        single("mixture (Dirichlet)", false, mixture, &inputs, |w, u| Dirichlet.sample(w, u)),
        single("rejection", false, uniform, &inputs, |w, u| rejection(w, u).0),
        single("robust, one by one", true, robust, &inputs, sample),
        slices("robust, slices, portable", sample_slice),
        slices("robust, slices, AVX2 where it is", etendue_cpu::linear_triangle::sample_slice),
    ];
    Contest {
        title: "Points of linear density over a triangle",
        file: "linear_triangle",
        error_label: "relative error of the marginal coordinate (rms)",
        item: "sample",
        items: COUNT as u64,
        contenders,
    }
}
