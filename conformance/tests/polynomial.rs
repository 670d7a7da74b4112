//! Sums of powers over the form factors of an empty box, which are known in closed form.

#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use etendue_conformance::truth::empty_box::EmptyBox;
use etendue_core::radiosity::operator::{Dense, LinearOperator, SymmetricHalf};
use etendue_core::radiosity::polynomial::{
    ConjugateGradients, Doubling, Horner, Portable, PowerSum, Settings, gather, infinite, series, solve,
};
use etendue_cpu::Linear;

/// M^-1 x by Gaussian elimination with partial pivoting.
fn eliminate(n: usize, mut m: Vec<f64>, mut x: Vec<f64>) -> Vec<f64> {
    let columns = x.len() / n;
    for c in 0..n {
        let pivot =
            (c..n).max_by(|i, j| m[i * n + c].abs().total_cmp(&m[j * n + c].abs())).expect("not empty");
        (0..n).for_each(|j| m.swap(c * n + j, pivot * n + j));
        (0..columns).for_each(|j| x.swap(c * columns + j, pivot * columns + j));
        for i in (0..n).filter(|i| *i != c) {
            let f = m[i * n + c] / m[c * n + c];
            (c..n).for_each(|j| m[i * n + j] -= f * m[c * n + j]);
            (0..columns).for_each(|j| x[i * columns + j] -= f * x[c * columns + j]);
        }
    }
    (0..x.len()).map(|k| x[k] / m[k / columns * n + k / columns]).collect()
}

/// A box of 6 `cells`^2 patches: the operator in f32, its areas, and the form factors before rounding.
fn room(cells: usize) -> (Dense, Vec<f32>, Vec<f64>) {
    let b = EmptyBox::new([1.0, 1.5, 0.7], cells);
    let f = Dense::try_new(b.len(), b.form_factors.iter().map(|f| *f as f32).collect()).expect("finite");
    (f, b.areas.iter().map(|a| *a as f32).collect(), b.form_factors)
}

/// Albedo of each wall; the floor is red.
fn albedos(n: usize, most: f32) -> Vec<[f32; 3]> {
    (0..n)
        .map(|i| match 6 * i / n {
            4 => [0.9, 0.2, 0.1],
            5 => [1.0, 1.0, 1.0],
            wall => [0.5 + 0.05 * wall as f32; 3],
        })
        .map(|rho| rho.map(|rho| rho * most))
        .collect()
}

fn worst(got: impl Iterator<Item = f64>, truth: &[f64]) -> f64 {
    let size = truth.iter().fold(0.0_f64, |m, t| m.max(t.abs()));
    got.zip(truth).fold(0.0_f64, |m, (g, t)| {
        let e = (g - t).abs() / size;
        if e <= m { m } else { e }
    })
}

#[test]
fn all_bounces_in_a_box_by_every_form() {
    let linear = Linear::new(Some(2)).expect("threads can be started");
    for most in [0.9_f32, 0.999] {
        let (f, areas, exact) = room(5);
        let n = f.len();
        let half = SymmetricHalf::from_dense(&f, &areas).expect("finite");
        let albedo = albedos(n, most);
        // A lamp in a corner of the ceiling.
        let b0: Vec<[f32; 3]> =
            (0..n).map(|i| if i + 1 == n { [10.0, 9.0, 7.0] } else { [0.0; 3] }).collect();
        let settings = Settings::default();
        let dense = solve(&ConjugateGradients, &linear.operator(&f), &areas, &albedo, &b0, settings)
            .expect("a closed box");
        let halved = solve(&ConjugateGradients, &half, &areas, &albedo, &b0, settings).expect("a closed box");
        for c in 0..3 {
            let system = |f: &dyn Fn(usize) -> f64| {
                (0..n * n)
                    .map(|k| f64::from(u8::from(k / n == k % n)) - f64::from(albedo[k / n][c]) * f(k))
                    .collect::<Vec<f64>>()
            };
            let b: Vec<f64> = b0.iter().map(|b| f64::from(b[c])).collect();
            // Against the f32 operator: rounded once. Against the exact form factors: what rounding them does.
            let rounded = eliminate(n, system(&|k| f64::from(f.entries()[k])), b.clone());
            let truth = eliminate(n, system(&|k| exact[k]), b);
            let of = |s: &[[f32; 3]]| s.iter().map(|x| f64::from(x[c])).collect::<Vec<f64>>();
            let e = worst(of(&dense.radiosity).into_iter(), &rounded);
            assert!(e <= 2.0 / 16_777_216.0, "albedo {most}, channel {c}: {e:e}");
            for s in [&dense, &halved] {
                let e = worst(of(&s.radiosity).into_iter(), &truth);
                assert!(e <= 2e-7, "albedo {most}, channel {c}: {e:e}");
            }
        }
    }
}

#[test]
fn matrices_of_a_box() {
    let (f, areas, _) = room(4);
    let n = f.len();
    let rho: Vec<f32> = albedos(n, 0.999).iter().map(|x| x[0]).collect();
    let a = f.reflecting(&rho).expect("finite");
    let wide: Vec<f64> = a.entries().iter().map(|x| f64::from(*x)).collect();
    let system = (0..n * n).map(|k| f64::from(u8::from(k / n == k % n)) - wide[k]).collect();
    let truth = eliminate(n, system, wide.clone());
    let m = infinite::<f64, _>(&Portable, &a).expect("a closed box");
    let e = worst(m.entries().iter().map(|x| f64::from(*x)), &truth);
    assert!(e <= 1.0 / 16_777_216.0, "f64: {e:e}");
    let m = infinite::<f32, _>(&Portable, &a).expect("a closed box");
    let e = worst(m.entries().iter().map(|x| f64::from(*x)), &truth);
    assert!(e <= 5e-6, "f32: {e:e}");
    // R G = M, and A G is symmetric.
    let g = gather::<f64, _>(&Portable, &f, &rho).expect("a closed box");
    let e = worst((0..n * n).map(|k| f64::from(rho[k / n]) * f64::from(g.entries()[k])), &truth);
    assert!(e <= 2e-6, "R G: {e:e}");
    for i in 0..n {
        for j in 0..i {
            let (ij, ji) = (areas[i] * g.row(i)[j], areas[j] * g.row(j)[i]);
            assert!((ij - ji).abs() <= 1e-5 * ij, "A G is symmetric: {ij} {ji}");
        }
    }
    // Sums of powers approach it from below, as fast as the albedo says.
    let mut last = f64::INFINITY;
    for k in [1, 2, 4, 8, 16, 32, 64, 128] {
        let horner = Horner.sum(&Portable, &a, k).expect("a contraction");
        let doubling = Doubling.sum(&Portable, &a, k).expect("a contraction");
        let e = worst(doubling.entries().iter().map(|x| f64::from(*x)), &truth);
        let apart =
            horner.entries().iter().zip(doubling.entries()).fold(0.0_f32, |m, (h, d)| m.max((h - d).abs()));
        assert!(apart <= 1e-6, "k = {k}: {apart:e}");
        assert!(e <= 0.9 * last + 2e-6, "k = {k}: {e:e} after {last:e}");
        last = e;
    }
    assert!(last <= 1e-5, "{last:e}");
}

/// One albedo, uniform light: B = B0 / (1 - rho) wherever rows sum to 1.
#[test]
fn the_closed_form_of_an_integrating_box() {
    let (f, areas, _) = room(5);
    let n = f.len();
    for (rho, limit) in [(0.5_f32, 2e-7), (0.9, 3e-7), (0.999, 3e-6)] {
        let (albedo, b0) = (vec![[rho]; n], vec![[1.0_f32]; n]);
        let s = solve(&ConjugateGradients, &f, &areas, &albedo, &b0, Settings::default()).expect("absorbs");
        let closed = 1.0 / (1.0 - f64::from(rho));
        let e = s.radiosity.iter().fold(0.0_f64, |m, x| m.max((f64::from(x[0]) - closed).abs() / closed));
        println!("albedo {rho}: error {e:.2e}, {} passes in f32, {} in f64", s.passes, s.wide_passes);
        assert!(e <= limit, "albedo {rho}: {e:e}");
        // k bounces miss rho^k of it, and no more than that and rounding.
        for k in [1, 8, 64] {
            let x = series(&f, &albedo, &b0, k).expect("lengths agree");
            let r = f64::from(rho);
            let truth = r * (1.0 - r.powi(k as i32)) / (1.0 - r);
            let e = x.iter().fold(0.0_f64, |m, x| m.max((f64::from(x[0]) - truth).abs() / truth));
            assert!(e <= 2e-7 + 4e-8 * f64::from(k), "albedo {rho}, k = {k}: {e:e}");
        }
    }
}
