//! Products and sums of powers: the stated order bit for bit, and the error against f64.
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

#[path = "polynomial_support.rs"]
mod support;

use etendue_core::radiosity::operator::{Dense, LinearOperator, OperatorError, SymmetricHalf};
use etendue_core::radiosity::polynomial::{
    Doubling, Horner, Multiply, Portable, PowerSum, SMALL, Target, View, multiply_add_reference, series,
    small_apply, small_apply_half, small_series,
};
use proptest::prelude::*;
use std::cell::Cell;
use support::{Random, closed, powers, product, relative, wide, worst};

const U: f64 = 1.0 / 16_777_216.0;

/// Counts what it is asked to form.
struct Counting(Cell<u32>);

impl Multiply for Counting {
    fn multiply_add(&self, c: Target<'_, f32>, a: View<'_, f32>, b: View<'_, f32>) {
        self.0.set(self.0.get() + 1);
        Portable.multiply_add(c, a, b);
    }
    fn multiply_add_wide(&self, c: Target<'_, f64>, a: View<'_, f64>, b: View<'_, f64>) {
        Portable.multiply_add_wide(c, a, b);
    }
}

#[test]
fn products_have_the_bits_of_the_reference() {
    let mut random = Random(1);
    // Rows, inner length, columns, stride of C, first column: tiles of every incomplete kind, several blocks of terms.
    for (m, k, n, stride, column) in [
        (1, 1, 1, 1, 0),
        (4, 8, 8, 8, 0),
        (5, 3, 9, 12, 2),
        (49, 256, 17, 17, 0),
        (50, 257, 31, 40, 9),
        (7, 600, 40, 40, 0),
        (100, 0, 5, 5, 0),
        (3, 5, 0, 4, 1),
    ] {
        let (a, b, c) = (random.signed(m * k), random.signed(k * n), random.signed(m * stride));
        let view = |entries, rows, columns| View { entries, stride: columns, rows, columns };
        let (mut fast, mut slow) = (c.clone(), c.clone());
        Portable.multiply_add(Target { entries: &mut fast, stride, column }, view(&a, m, k), view(&b, k, n));
        multiply_add_reference(Target { entries: &mut slow, stride, column }, view(&a, m, k), view(&b, k, n));
        assert!(fast.iter().zip(&slow).all(|(f, s)| f.to_bits() == s.to_bits()), "{m} {k} {n}");
        let to_wide = |x: &[f32]| x.iter().map(|x| f64::from(*x) / 3.0).collect::<Vec<f64>>();
        let (a, b) = (to_wide(&a), to_wide(&b));
        let (mut fast, mut slow) = (to_wide(&c), to_wide(&c));
        let view = |entries, rows, columns| View { entries, stride: columns, rows, columns };
        Portable.multiply_add_wide(
            Target { entries: &mut fast, stride, column },
            view(&a, m, k),
            view(&b, k, n),
        );
        multiply_add_reference(Target { entries: &mut slow, stride, column }, view(&a, m, k), view(&b, k, n));
        assert!(fast.iter().zip(&slow).all(|(f, s)| f.to_bits() == s.to_bits()), "{m} {k} {n} in f64");
        // And what lies beside the product is untouched.
        for i in 0..m {
            for j in (0..column).chain(column + n..stride) {
                assert_eq!(slow[i * stride + j], f64::from(c[i * stride + j]) / 3.0);
            }
        }
    }
}

#[test]
fn products_that_do_not_fit_are_cut() {
    let (a, b) = (vec![1.0_f32; 12], vec![2.0_f32; 40]);
    let a = View { entries: &a[..], stride: 4, rows: 3, columns: 4 };
    for b in [
        View { entries: &b[..], stride: 10, rows: 4, columns: 10 },
        View { entries: &b[..25], stride: 10, rows: 4, columns: 10 },
        View { entries: &b[..], stride: 10, rows: 2, columns: 10 },
        View { entries: &b[..], stride: usize::MAX, rows: 4, columns: 7 },
    ] {
        for (len, stride, column) in
            [(0, 0, 0), (30, 0, 3), (30, 10, 0), (29, 10, 0), (60, 12, 5), (9, 3, 7), (50, 10, usize::MAX)]
        {
            let (mut fast, mut slow) = (vec![0.5_f32; len], vec![0.5_f32; len]);
            Portable.multiply_add(Target { entries: &mut fast, stride, column }, a, b);
            multiply_add_reference(Target { entries: &mut slow, stride, column }, a, b);
            if stride > 0 {
                assert_eq!(fast, slow, "{len} {stride} {column}");
            }
        }
    }
}

#[test]
fn a_product_adds_block_sums_in_turn() {
    // 2^24 in the first block; 1 in each of the next two: each block's own sum is added, so both ones are lost; within one
    // block they would first make 2.
    let n = 3 * 256;
    let mut a = vec![0.0_f32; n];
    (a[0], a[256], a[512]) = (16_777_216.0, 1.0, 1.0);
    let b = vec![1.0_f32; n];
    let form = |a: &[f32]| {
        let mut c = [0.0_f32];
        Portable.multiply_add(
            Target { entries: &mut c, stride: 1, column: 0 },
            View { entries: a, stride: n, rows: 1, columns: n },
            View { entries: &b, stride: 1, rows: n, columns: 1 },
        );
        c[0]
    };
    assert_eq!(form(&a), 16_777_216.0);
    (a[512], a[257]) = (0.0, 1.0);
    assert_eq!(form(&a), 16_777_218.0);
}

/// The entrywise bound of a nested sum: each bounce adds the rounding of one product of that many terms.
fn bound(n: usize, a: &[f64], k: u32) -> Vec<f64> {
    let magnitudes: Vec<f64> = a.iter().map(|x| x.abs()).collect();
    let gamma = (n.min(256) as f64 + n as f64 / 256.0 + 3.0) * U;
    let mut total = vec![0.0; n * n];
    let mut power: Vec<f64> = (0..n * n).map(|i| f64::from(i / n == i % n)).collect();
    for h in 1..=k {
        power = product(n, &power, &magnitudes);
        total.iter_mut().zip(&power).for_each(|(t, p)| *t += f64::from(h) * gamma * p);
    }
    total
}

#[test]
fn horner_and_doubling_equal_the_powers_in_f64() {
    for (n, seed) in [(1, 1), (2, 2), (17, 3), (40, 4)] {
        let mut random = Random(seed);
        let (f, _) = closed(n.max(2), seed);
        let n = f.len();
        let rho = random.vector(n);
        let mixed = Dense::try_new(n, random.signed(n * n).iter().map(|x| x / n as f32).collect()).unwrap();
        for a in [f.reflecting(&rho).unwrap(), f.reflecting(&vec![0.999; n]).unwrap(), mixed] {
            let wide_a = wide(&a);
            for k in (0..=9).chain([16, 33, 64]) {
                let truth = powers(n, &wide_a, k);
                let limit = bound(n, &wide_a, k);
                let horner = Horner.sum(&Portable, &a, k).unwrap();
                let doubling = Doubling.sum(&Portable, &a, k).unwrap();
                for (name, m) in [("Horner", &horner), ("doubling", &doubling)] {
                    for ((got, t), l) in m.entries().iter().zip(&truth).zip(&limit) {
                        let error = (f64::from(*got) - t).abs();
                        assert!(
                            error <= *l,
                            "{name}, n = {n}, k = {k}: {got} for {t}, off by {error:e} > {l:e}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn both_forms_cost_what_they_say() {
    let a = Dense::try_new(3, vec![0.1; 9]).unwrap();
    for k in 0..200 {
        let count = |form: &dyn Fn(&Counting) -> Dense| {
            let counting = Counting(Cell::new(0));
            form(&counting);
            counting.0.get()
        };
        assert_eq!(count(&|m| Horner.sum(m, &a, k).unwrap()), Horner.products(k), "Horner, k = {k}");
        assert_eq!(count(&|m| Doubling.sum(m, &a, k).unwrap()), Doubling.products(k), "doubling, k = {k}");
        assert!(Doubling.products(k) <= Horner.products(k), "k = {k}");
    }
    assert_eq!((Horner.products(64), Doubling.products(64)), (63, 10));
    assert_eq!((Horner.products(3), Doubling.products(3)), (2, 2));
}

#[test]
fn powers_that_overflow_are_an_error_and_end() {
    let a = Dense::try_new(2, vec![1e30; 4]).unwrap();
    for k in [2, 3, 1000, u32::MAX] {
        assert!(matches!(Horner.sum(&Portable, &a, k), Err(OperatorError::NotFinite { .. })));
        assert!(matches!(Doubling.sum(&Portable, &a, k), Err(OperatorError::NotFinite { .. })));
    }
    let none = Dense::try_new(0, vec![]).unwrap();
    assert_eq!(Horner.sum(&Portable, &none, 3).unwrap().entries(), []);
    assert_eq!(Doubling.sum(&Portable, &none, 3).unwrap().entries(), []);
}

#[test]
fn passes_equal_the_matrix_and_channels_are_apart() {
    let (f, areas) = closed(90, 6);
    let half = SymmetricHalf::from_dense(&f, &areas).unwrap();
    let n = f.len();
    let mut random = Random(7);
    let albedo: Vec<[f32; 3]> = (0..n).map(|_| [0, 1, 2].map(|_| random.unit() as f32)).collect();
    let b0: Vec<[f32; 3]> = (0..n).map(|_| [0, 1, 2].map(|_| 10.0 * random.unit() as f32)).collect();
    let wide_f = wide(&f);
    for k in [0, 1, 2, 3, 7, 20] {
        let rgb = series(&f, &albedo, &b0, k).unwrap();
        let by_half = series(&half, &albedo, &b0, k).unwrap();
        for c in 0..3 {
            let rho: Vec<[f32; 1]> = albedo.iter().map(|x| [x[c]]).collect();
            let b: Vec<[f32; 1]> = b0.iter().map(|x| [x[c]]).collect();
            let one = series(&f, &rho, &b, k).unwrap();
            assert!(one.iter().zip(&rgb).all(|(a, b)| a[0].to_bits() == b[c].to_bits()));
            let a: Vec<f64> = (0..n * n).map(|x| f64::from(rho[x / n][0]) * wide_f[x]).collect();
            let m = powers(n, &a, k);
            let truth: Vec<f64> =
                (0..n).map(|i| (0..n).map(|j| m[i * n + j] * f64::from(b[j][0])).sum()).collect();
            let got: Vec<f32> = rgb.iter().map(|x| x[c]).collect();
            assert!(worst(&got, &truth) <= 3e-7 || k == 0, "k = {k}: {:e}", worst(&got, &truth));
            let got: Vec<f32> = by_half.iter().map(|x| x[c]).collect();
            assert!(worst(&got, &truth) <= 6e-7 || k == 0, "half, k = {k}: {:e}", worst(&got, &truth));
        }
        // Two channels go through one after the other.
        let two: Vec<[f32; 2]> = albedo.iter().map(|x| [x[2], x[0]]).collect();
        let b: Vec<[f32; 2]> = b0.iter().map(|x| [x[2], x[0]]).collect();
        let two = series(&f, &two, &b, k).unwrap();
        assert!(two.iter().zip(&rgb).all(|(t, r)| *t == [r[2], r[0]]));
    }
    assert!(series(&f, &albedo[1..], &b0, 1).is_err());
    assert!(series(&f, &albedo, &b0[1..], 1).is_err());
}

/// A closed scene of one albedo under uniform light: k bounces give rho (1 - rho^k) / (1 - rho) of it, everywhere.
#[test]
fn uniform_light_in_a_closed_scene_is_a_geometric_series() {
    let (f, _) = closed(200, 8);
    for rho in [0.5_f32, 0.9, 0.999] {
        for k in [1, 3, 64] {
            let r = f64::from(rho);
            let truth = r * (1.0 - r.powi(k as i32)) / (1.0 - r);
            let x = series(&f, &vec![[rho]; 200], &vec![[1.0]; 200], k).unwrap();
            for x in x {
                let error = (f64::from(x[0]) - truth).abs() / truth;
                assert!(error <= 3e-8 * f64::from(k) + 1.5e-7, "albedo {rho}, k = {k}: {error:e}");
            }
        }
    }
}

#[test]
fn small_forms_equal_the_general_ones() {
    let mut random = Random(9);
    for n in 0..=SMALL {
        let (a, x) = (random.signed(n * n), random.signed(n));
        let full: [f32; SMALL] = std::array::from_fn(|i| x.get(i).copied().unwrap_or(7.0));
        let dense = Dense::try_new(n, a.clone()).unwrap();
        let albedo = vec![[1.0]; n];
        let b: Vec<[f32; 1]> = x.iter().map(|x| [*x]).collect();
        for k in [0, 1, 3, 10] {
            let general = series(&dense, &albedo, &b, k).unwrap();
            let small = small_series(n, &a, full, k);
            assert!(general.iter().zip(&small).all(|(g, s)| g[0] == *s), "n = {n}, k = {k}");
            assert!(small[n..].iter().all(|s| *s == 0.0));
        }
        assert_eq!(small_series(n, &a, full, 1), small_apply(n, &a, full));
        let areas: Vec<f32> = random.vector(n).iter().map(|x| x + 0.1).collect();
        let half = random.signed(n * (n + 1) / 2);
        let general = series(&SymmetricHalf::try_new(areas.clone(), half.clone()).unwrap(), &albedo, &b, 1);
        let small = small_apply_half(n, &areas, &half, full);
        assert!(general.unwrap().iter().zip(&small).all(|(g, s)| g[0] == *s), "half, n = {n}");
    }
    // Too large an n, a table that ends early, areas of zero: values, no panic.
    assert_eq!(small_apply(usize::MAX, &[1.0; 3], [1.0; 8])[0], 3.0);
    assert_eq!(small_apply_half(8, &[], &[1.0; 36], [1.0; 8]), [0.0; 8]);
    assert!(small_series(8, &[f32::MAX; 64], [f32::MAX; 8], u32::MAX).iter().all(|x| !x.is_nan()));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, rng_seed: proptest::test_runner::RngSeed::Fixed(1), ..ProptestConfig::default() })]

    /// Horner, doubling and passes agree on any matrix whose rows sum to at most 1 in magnitude.
    #[test]
    fn three_forms_agree(n in 1_usize..20, k in 0_u32..40, seed in any::<u64>(), share in 0.0_f32..1.0) {
        let mut random = Random(seed);
        let mut entries = random.signed(n * n);
        for row in entries.chunks_mut(n) {
            let size: f32 = row.iter().map(|x| x.abs()).sum();
            row.iter_mut().for_each(|x| *x *= share / size.max(1e-6));
        }
        let a = Dense::try_new(n, entries).unwrap();
        let b = random.signed(n);
        let horner = Horner.sum(&Portable, &a, k).unwrap();
        let doubling = Doubling.sum(&Portable, &a, k).unwrap();
        let x = series(&a, &vec![[1.0]; n], &b.iter().map(|b| [*b]).collect::<Vec<_>>(), k).unwrap();
        for (i, x) in x.iter().enumerate() {
            let by = |m: &Dense| m.row(i).iter().zip(&b).map(|(m, b)| f64::from(*m) * f64::from(*b)).sum::<f64>();
            let limit = 2e-6 * (1.0 + f64::from(k));
            prop_assert!((by(&horner) - by(&doubling)).abs() <= limit);
            prop_assert!((by(&horner) - f64::from(x[0])).abs() <= limit);
        }
    }
}

/// Error of M_k against f64 over the number of bounces.
#[test]
#[ignore = "prints: cargo test -p etendue-core --test polynomial_sums -- --ignored --nocapture error_grows"]
fn error_grows_slowly_with_bounces() {
    let (f, _) = closed(150, 11);
    let n = f.len();
    for rho in [0.6_f32, 0.999] {
        let a = f.reflecting(&vec![rho; n]).unwrap();
        for k in [1, 2, 4, 8, 16, 32, 64] {
            let truth = powers(n, &wide(&a), k);
            let horner = relative(Horner.sum(&Portable, &a, k).unwrap().entries(), &truth);
            let doubling = relative(Doubling.sum(&Portable, &a, k).unwrap().entries(), &truth);
            println!("albedo {rho}, k = {k}: Horner {horner:.2e}, doubling {doubling:.2e}");
            assert!(horner <= 1e-6 && doubling <= 1e-6);
        }
    }
}
