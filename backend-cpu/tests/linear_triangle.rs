//! The wide form of the linear-triangle sampler has the bits of the scalar one, and its price.

use etendue_core::sampling::linear_triangle::{Cardano, LinearTriangle, sample};
use etendue_cpu::linear_triangle::sample_slice;
use std::hint::black_box;
use std::time::Instant;

struct Random(u64);

impl Random {
    fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / 16_777_216.0
    }
}

fn inputs(n: usize) -> (Vec<[f32; 3]>, Vec<[f32; 2]>) {
    let mut r = Random(1);
    let w = (0..n).map(|_| [r.unit(), r.unit(), r.unit()]).collect();
    let u = (0..n).map(|_| [r.unit(), r.unit()]).collect();
    (w, u)
}

#[test]
fn the_bits_are_the_scalar_ones() {
    let (mut w, mut u) = inputs(10_000);
    w[0] = [0.0; 3];
    w[1] = [1e-40, f32::MAX, f32::NAN];
    w[2] = [0.0, 0.0, 1.0];
    u[3] = [0.0, 1.0];
    u[4] = [f32::from_bits(1), 1.0 - 1.0 / 16_777_216.0];
    let mut out = vec![[0.0; 3]; w.len()];
    assert_eq!(sample_slice(&w, &u, &mut out), w.len());
    for i in 0..w.len() {
        assert_eq!(out[i].map(f32::to_bits), sample(w[i], u[i]).map(f32::to_bits), "{:?} {:?}", w[i], u[i]);
    }
}

/// Least time of one pass \[s\].
fn least(mut work: impl FnMut()) -> f64 {
    (0..200).fold(f64::INFINITY, |best, _| {
        let start = Instant::now();
        work();
        best.min(start.elapsed().as_secs_f64())
    })
}

#[test]
#[ignore = "a measurement: cargo test --release -p etendue-cpu --test linear_triangle -- --ignored --nocapture"]
fn slices_are_four_times_as_fast_as_the_published_form() {
    let (w, u) = inputs(4096);
    let mut out = vec![[0.0; 3]; w.len()];
    let published = least(|| {
        for ((w, u), out) in w.iter().zip(&u).zip(&mut out) {
            *out = Cardano.sample(*w, *u);
        }
        black_box(&out);
    });
    let slices = least(|| {
        sample_slice(&w, &u, &mut out);
        black_box(&out);
    });
    println!("published {:.1} ns, slices {:.1} ns a sample", published / 4.096e-6, slices / 4.096e-6);
    assert!(published >= 4.0 * slices);
}
