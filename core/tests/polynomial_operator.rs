//! Operators against plain sums in f64, their order against the scalar reference, and what they refuse.
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

#[path = "polynomial_support.rs"]
mod support;

use etendue_core::radiosity::lanes::{LANES, dot, dot_reference, dots};
use etendue_core::radiosity::operator::{
    Dense, LinearOperator, OperatorError, Scaled, Striped, SymmetricHalf,
};
use support::{Random, closed, wide};

const U: f64 = 1.0 / 16_777_216.0;

/// Lengths around multiples of the lanes and the stripes.
const SIZES: [usize; 14] = [0, 1, 2, 15, 16, 17, 31, 33, 100, 255, 256, 257, 300, 530];

#[test]
fn every_form_of_a_dot_product_has_the_bits_of_the_reference() {
    let mut random = Random(1);
    for n in SIZES {
        let rows: [Vec<f32>; 2] = [random.signed(n), random.signed(n)];
        let x: [Vec<f32>; 3] = [random.signed(n), random.vector(n), random.signed(n)];
        let all = dots(rows.each_ref().map(|r| &r[..]), x.each_ref().map(|x| &x[..]));
        let x_wide = x.each_ref().map(|x| x.iter().map(|x| f64::from(*x) * 1.1).collect::<Vec<f64>>());
        let all_wide = dots(rows.each_ref().map(|r| &r[..]), x_wide.each_ref().map(|x| &x[..]));
        for r in 0..2 {
            for c in 0..3 {
                let expected = dot_reference(&rows[r], &x[c]);
                assert_eq!(all[r][c].to_bits(), expected.to_bits(), "n = {n}");
                assert_eq!(dot(&rows[r], &x[c]).to_bits(), expected.to_bits(), "n = {n}");
                let expected = dot_reference(&rows[r], &x_wide[c]);
                assert_eq!(all_wide[r][c].to_bits(), expected.to_bits(), "n = {n}, f64");
            }
        }
    }
}

#[test]
fn the_stated_order_and_no_other() {
    // 2^24 + 1 is no f32. Lane 0 has 2^24 and then -2^24, lane 1 has 1: the order keeps it.
    let (mut a, x) = ([0.0_f32; 32], [1.0_f32; 32]);
    (a[0], a[1], a[16]) = (16_777_216.0, 1.0, -16_777_216.0);
    assert_eq!(dot(&a, &x), 1.0);
    // In lane 0 and lane 8 they meet before 1 from lane 4 comes in; the other way about the 1 is lost.
    let mut a = [0.0_f32; 32];
    (a[0], a[8], a[4]) = (16_777_216.0, -16_777_216.0, 1.0);
    assert_eq!(dot(&a, &x), 1.0);
    let mut a = [0.0_f32; 32];
    (a[0], a[4], a[8]) = (16_777_216.0, -16_777_216.0, 1.0);
    assert_eq!(dot(&a, &x), 0.0);
}

#[test]
fn dot_products_are_within_their_bound() {
    let mut random = Random(2);
    for n in SIZES {
        for _ in 0..20 {
            let (a, x) = (random.signed(n), random.signed(n));
            let terms = || a.iter().zip(&x).map(|(a, x)| f64::from(*a) * f64::from(*x));
            let (truth, size): (f64, f64) = (terms().sum(), terms().map(f64::abs).sum());
            let bound = (n.div_ceil(LANES) as f64 + 4.0) * U * size;
            let error = (f64::from(dot(&a, &x)) - truth).abs();
            assert!(error <= bound, "n = {n}: {error} > {bound}");
        }
    }
}

#[test]
fn sums_without_a_value_are_zero() {
    let x = [f32::MAX; 16];
    let mut a = [0.0_f32; 16];
    (a[0], a[8]) = (2.0, -2.0);
    assert_eq!(dot(&a, &x), 0.0);
    a[8] = 0.0;
    assert_eq!(dot(&a, &x), f32::INFINITY);
    assert_eq!(dot(&[f32::NAN; 16], &x), 0.0);
    let dense = Dense::try_new(1, vec![f32::MAX]).unwrap();
    let mut y = [0.0];
    dense.apply(&[f32::MAX], &mut y).unwrap();
    assert_eq!(y[0], f32::INFINITY);
}

/// `rows` roundings of f32 in a row's sum, `inexact` units of 2^-24 between the operator's entries and `f`.
fn check_operator(name: &str, o: &dyn LinearOperator, f: &[f64], rows: f64, inexact: f64) {
    let n = o.len();
    let mut random = Random(n as u64);
    let planes: [Vec<f32>; 3] = [random.vector(n), random.signed(n), random.vector(n)];
    let x3: Vec<[f32; 3]> = (0..n).map(|i| [0, 1, 2].map(|c| planes[c][i])).collect();
    let mut y3 = vec![[9.0_f32; 3]; n];
    o.apply_rgb(&x3, &mut y3).unwrap();
    let w3: Vec<[f64; 3]> = x3.iter().map(|x| x.map(|x| f64::from(x) * 1.1)).collect();
    let mut v3 = vec![[9.0_f64; 3]; n];
    o.apply_wide_rgb(&w3, &mut v3).unwrap();
    for c in 0..3 {
        let mut y = vec![9.0_f32; n];
        o.apply(&planes[c], &mut y).unwrap();
        let w: Vec<f64> = w3.iter().map(|w| w[c]).collect();
        let mut v = vec![9.0_f64; n];
        o.apply_wide(&w, &mut v).unwrap();
        let magnitudes: Vec<f64> = planes[c].iter().map(|x| f64::from(x.abs())).collect();
        let mut m = vec![9.0_f64; n];
        o.apply_magnitudes(&magnitudes, &mut m).unwrap();
        for i in 0..n {
            assert_eq!(y[i].to_bits(), y3[i][c].to_bits(), "{name}: {n} patches, row {i}");
            assert_eq!(v[i].to_bits(), v3[i][c].to_bits(), "{name}: {n} patches, row {i}, f64");
            let terms = || f[i * n..][..n].iter().zip(&planes[c]).map(|(f, x)| f * f64::from(*x));
            let (truth, size): (f64, f64) = (terms().sum(), terms().map(f64::abs).sum());
            let error = (f64::from(y[i]) - truth).abs();
            assert!(error <= (rows + inexact) * U * size, "{name}: {n} patches, row {i}: {error}");
            let wide = (2.0 * rows * 1.2e-16 + 1.2 * inexact * U) * size;
            assert!((v[i] - 1.1 * truth).abs() <= wide, "{name}: f64 row {i}");
            assert!((m[i] - size).abs() <= wide, "{name}: magnitudes row {i}");
        }
    }
}

#[test]
fn operators_equal_plain_sums_in_f64() {
    for n in SIZES {
        let mut random = Random(40 + n as u64);
        let dense = Dense::try_new(n, random.signed(n * n)).unwrap();
        check_operator("dense", &dense, &wide(&dense), n as f64 / 16.0 + 5.0, 0.0);
        // Any symmetric S, and the operator that it stands for.
        let half = random.signed(n * (n + 1) / 2);
        let areas: Vec<f32> = random.vector(n).iter().map(|x| x + 0.1).collect();
        let at = |i: usize, j: usize| f64::from(half[i.max(j) * (i.max(j) + 1) / 2 + i.min(j)]);
        let full: Vec<f64> = (0..n * n).map(|k| at(k / n, k % n) / f64::from(areas[k / n])).collect();
        let symmetric = SymmetricHalf::try_new(areas.clone(), half.clone()).unwrap();
        check_operator("half", &symmetric, &full, n as f64 / 16.0 + 256.0 + n as f64 / 256.0 + 6.0, 0.0);
        let scale = random.signed(n);
        let scaled: Vec<f64> = (0..n * n).map(|k| f64::from(scale[k / n]) * full[k]).collect();
        let operator = Scaled::try_new(&symmetric, &scale).unwrap();
        check_operator("scaled", &operator, &scaled, n as f64 / 16.0 + 256.0 + n as f64 / 256.0 + 7.0, 0.0);
    }
}

#[test]
fn the_half_is_the_dense_operator_where_areas_are_reciprocal() {
    for n in [1, 2, 40, 300] {
        let (dense, areas) = closed(n.max(2), 5);
        let half = SymmetricHalf::from_dense(&dense, &areas).unwrap();
        let n = dense.len();
        let f = wide(&dense);
        // Areas, form factors and S are rounded one by one: up to three halves of an ulp.
        check_operator("half of dense", &half, &f, n as f64 / 16.0 + 256.0 + 8.0, 3.0);
        for i in 0..n {
            assert_eq!(half.row(i).len(), i + 1);
        }
        assert!(half.row(n).is_empty() && dense.row(n).is_empty());
        assert_eq!(half.areas(), areas);
    }
}

/// The half's order, spelled out: row dot product, then each stripe's column sum from zero, then the area.
#[test]
fn the_half_sums_in_its_stated_order() {
    let n = 600;
    let mut random = Random(8);
    let half = random.signed(n * (n + 1) / 2);
    let areas: Vec<f32> = random.vector(n).iter().map(|x| x + 0.1).collect();
    let x = random.signed(n);
    let operator = SymmetricHalf::try_new(areas.clone(), half).unwrap();
    let mut y = vec![0.0; n];
    operator.apply(&x, &mut y).unwrap();
    for j in 0..n {
        let mut sum = dot_reference(operator.row(j), &x);
        for first in (j / 256 * 256..n).step_by(256) {
            let mut column = 0.0_f32;
            for i in (first..(first + 256).min(n)).filter(|i| *i > j) {
                column += operator.row(i)[j] * x[i];
            }
            sum += column;
        }
        assert_eq!(y[j].to_bits(), (sum / areas[j]).to_bits(), "patch {j}");
    }
}

#[test]
fn stripes_are_total() {
    let dense = Dense::try_new(3, vec![1.0; 9]).unwrap();
    let half = SymmetricHalf::try_new(vec![1.0; 3], vec![1.0; 6]).unwrap();
    for stripe in [0, 1, usize::MAX] {
        for (x, rows, columns) in [(3, 3, 3), (2, 3, 3), (3, 9, 3), (3, 3, 1), (3, 2, 2), (0, 0, 0)] {
            let x = vec![1.0_f32; x];
            let (mut y, mut c) = (vec![7.0; rows], vec![0.0; columns]);
            dense.stripe(stripe, [&x[..]], [&mut y[..]], [&mut c[..]]);
            half.stripe(stripe, [&x[..]], [&mut y[..]], [&mut c[..]]);
            assert!(y.get(3..).unwrap_or(&[]).iter().all(|y| *y == 7.0));
        }
        assert_eq!(half.finish(3, 5.0_f32), 5.0);
    }
}

#[test]
fn what_is_no_operator_is_refused_with_its_numbers() {
    use OperatorError as E;
    let wrong = |slice, found, expected| E::WrongLength { slice, found, expected };
    assert_eq!(Dense::try_new(2, vec![0.0; 3]).unwrap_err(), wrong("entries", 3, 4));
    assert_eq!(Dense::try_new(usize::MAX, vec![]).unwrap_err(), E::TooLarge { patches: usize::MAX });
    let bad = Dense::try_new(2, vec![0.0, 1.0, f32::INFINITY, 0.0]).unwrap_err();
    assert_eq!(bad, E::NotFinite { row: 1, column: 0, value: f32::INFINITY });
    assert_eq!(SymmetricHalf::try_new(vec![1.0; 2], vec![0.0; 4]).unwrap_err(), wrong("half", 4, 3));
    for area in [0.0, -1.0, f32::INFINITY] {
        let bad = SymmetricHalf::try_new(vec![1.0, area], vec![0.0; 3]).unwrap_err();
        assert_eq!(bad, E::BadArea { patch: 1, area });
    }
    assert!(SymmetricHalf::try_new(vec![1.0, f32::NAN], vec![0.0; 3]).is_err());
    let bad = SymmetricHalf::try_new(vec![1.0; 2], vec![0.0, 1.0, f32::NEG_INFINITY]).unwrap_err();
    assert_eq!(bad, E::NotFinite { row: 1, column: 1, value: f32::NEG_INFINITY });
    let dense = Dense::try_new(2, vec![0.5; 4]).unwrap();
    assert_eq!(dense.apply(&[0.0; 3], &mut [0.0; 2]).unwrap_err(), wrong("x", 3, 2));
    assert_eq!(dense.apply_rgb(&[[0.0; 3]; 2], &mut [[0.0; 3]; 1]).unwrap_err(), wrong("y", 1, 2));
    assert_eq!(dense.apply_wide(&[0.0; 1], &mut [0.0; 2]).unwrap_err(), wrong("x", 1, 2));
    assert_eq!(dense.apply_magnitudes(&[0.0; 2], &mut [0.0; 3]).unwrap_err(), wrong("y", 3, 2));
    assert_eq!(dense.reflecting(&[1.0]).unwrap_err(), wrong("albedo", 1, 2));
    assert!(dense.reflected(&[f32::INFINITY, 0.0]).is_err());
    assert!(Scaled::try_new(&dense, &[1.0, f32::NAN]).is_err());
    assert_eq!(Scaled::try_new(&dense, &[1.0]).unwrap_err(), wrong("scale", 1, 2));
    for e in [wrong("x", 1, 2), E::TooLarge { patches: 3 }, bad] {
        assert!(e.to_string().bytes().any(|b| b.is_ascii_digit()), "{e}");
    }
}

/// Is one plain lane of f32 enough at 4096 patches? Prints the error of a bounce for plain, lanes, and f64 sums.
#[test]
#[ignore = "five seconds: cargo test -p etendue-core --test polynomial_operator -- --ignored --nocapture error_of_a_bounce"]
fn error_of_a_bounce_at_4096_patches() {
    let n = 4096;
    let (dense, areas) = closed(n, 9);
    let half = SymmetricHalf::from_dense(&dense, &areas).unwrap();
    let x = Random(10).vector(n);
    let (mut lanes, mut halved) = (vec![0.0; n], vec![0.0; n]);
    dense.apply(&x, &mut lanes).unwrap();
    half.apply(&x, &mut halved).unwrap();
    let (mut errors, mut worst) = ([0.0_f64; 4], [0.0_f64; 4]);
    for i in 0..n {
        let terms = || dense.row(i).iter().zip(&x);
        let truth: f64 = terms().map(|(f, x)| f64::from(*f) * f64::from(*x)).sum();
        let plain: f32 = terms().map(|(f, x)| f * x).sum();
        let best = truth as f32;
        for (k, got) in [plain, lanes[i], halved[i], best].into_iter().enumerate() {
            let e = (f64::from(got) - truth).abs() / truth / U;
            errors[k] += e / n as f64;
            worst[k] = worst[k].max(e);
        }
    }
    println!("in 2^-24: plain, 16 lanes, half, rounded once: mean {errors:.3?}, worst {worst:.2?}");
    assert!(errors[1] <= 1.5 && worst[1] <= 8.0);
    assert!(errors[2] <= 2.0 && worst[2] <= 10.0);
}
