//! Target `linear_triangle`: any weights, any random numbers, any points.

use etendue_core::sampling::linear_triangle::{
    Dirichlet, LinearTriangle, apex_distance, invert, pdf, sample, sample_slice,
};

const UNIT: f64 = 1.0 / 8_388_608.0;

/// Weights, two random numbers, a point: eight words an item.
pub fn linear_triangle(bytes: &[u8]) {
    let words: Vec<f32> =
        bytes.chunks_exact(4).map(|c| f32::from_le_bytes([c[0], c[1], c[2], c[3]])).collect();
    let (mut weights, mut numbers) = (Vec::new(), Vec::new());
    for x in words.chunks_exact(8).take(200) {
        let (w, u, point) = ([x[0], x[1], x[2]], [x[3], x[4]], [x[5], x[6], x[7]]);
        one(w, u, point);
        weights.push(w);
        numbers.push(u);
    }
    let mut out = vec![[0.0; 3]; weights.len()];
    assert_eq!(sample_slice(&weights, &numbers, &mut out), weights.len());
    for ((w, u), b) in weights.iter().zip(&numbers).zip(&out) {
        assert_eq!(b.map(f32::to_bits), sample(*w, *u).map(f32::to_bits), "lanes differ for {w:?} {u:?}");
    }
}

fn one(w: [f32; 3], u: [f32; 2], point: [f32; 3]) {
    let b = sample(w, u);
    assert!(b.iter().all(|x| (0.0..=1.0).contains(x)), "{w:?} {u:?}: {b:?}");
    let sum: f64 = b.iter().map(|x| f64::from(*x)).sum();
    assert!((sum - 1.0).abs() <= UNIT, "{w:?} {u:?}: {b:?} sums to {sum}");
    let d = apex_distance(w, u[0]);
    assert_eq!(b[d.apex].to_bits(), d.complement.to_bits());
    let apart = f64::from(d.distance) + f64::from(d.complement) - 1.0;
    assert!(apart.abs() <= UNIT, "{w:?} {u:?}: {d:?}");
    let back = invert(w, b);
    assert!(back.iter().all(|x| (0.0..1.0).contains(x)), "{w:?} {b:?}: {back:?}");
    let first = f64::from(u[0].clamp(0.0, 1.0 - 1.0 / 16_777_216.0));
    if !u[0].is_nan() {
        assert!((f64::from(back[0]) - first).abs() <= 4.0 * UNIT, "{w:?} {u:?}: {back:?}");
    }
    // A point further along the first number is further from the apex.
    let later = apex_distance(w, if u[0].is_nan() { 0.0 } else { u[0] } + 0.01);
    assert!(later.distance >= d.distance, "{w:?} {u:?}");
    for b in [b, point] {
        let (p, mixed) = (f64::from(pdf(w, b)), f64::from(Dirichlet.pdf(w, b)));
        assert!((0.0..=3.0).contains(&p), "{w:?} {b:?}: {p}");
        let coordinates: f64 = b.iter().map(|x| f64::from(*x)).sum();
        if (coordinates - 1.0).abs() <= 1e-6 {
            assert!((p - mixed).abs() <= 2e-6 * p.max(1e-30), "{w:?} {b:?}: {p} {mixed}");
        }
        assert!(invert(w, b).iter().all(|x| (0.0..1.0).contains(x)), "{w:?} {b:?}");
    }
}
