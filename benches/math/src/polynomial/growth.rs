//! Error over the number of bounces.

use super::{RELATIVE, albedos, box_operator, by_rows, horner_wide, relative, wide};
use crate::figure::{Curves, Series};
use etendue_core::radiosity::operator::{Dense, LinearOperator};
use etendue_core::radiosity::polynomial::{Doubling, Horner, Portable, PowerSum, infinite, series};
use nalgebra::{DMatrix, DVector};

/// How the error of each form grows with the number of bounces in a closed box of 150 patches: once with the albedos of
/// a furnished room, once with 0.999 everywhere.
pub fn curves() -> Vec<Curves> {
    let (f, _) = box_operator(5);
    let n = f.len();
    let room = albedos(n);
    let white = vec![0.999_f32; n];
    [
        (&room, "Error over bounces, albedo 0.2 to 0.9, n = 150", "polynomial_growth_room"),
        (&white, "Error over bounces, albedo 0.999, n = 150", "polynomial_growth_white"),
    ]
    .map(|(rho, title, file)| growth(&f, rho, title, file))
    .into()
}

fn growth(f: &Dense, rho: &[f32], title: &'static str, file: &'static str) -> Curves {
    let n = f.len();
    let a = f.reflecting(rho).expect("as many albedos as patches");
    let wide_a = wide(&a);
    let b0: Vec<[f32; 1]> = (0..n).map(|i| [if i % 7 == 0 { 3.0 } else { 0.1 }]).collect();
    let albedo: Vec<[f32; 1]> = rho.iter().map(|r| [*r]).collect();
    // The same numbers for the vector: R F in f64, unrounded.
    let reflecting = DMatrix::from_fn(n, n, |i, j| f64::from(rho[i]) * f64::from(f.row(i)[j]));
    let wide_b = DVector::from_fn(n, |i, _| f64::from(b0[i][0]));
    let mut series_of: Vec<Series> =
        ["Horner", "Doubling", "k passes", "LU in f32 (k = infinity)", "LU in f64 (k = infinity)"]
            .iter()
            .map(|name| Series { name: (*name).into(), points: Vec::new() })
            .collect();
    let lu_truth = by_rows(&(DMatrix::identity(n, n) - &wide_a).lu().solve(&wide_a).expect("a contraction"));
    let narrow = relative(
        infinite::<f32, _>(&Portable, &a).expect("a contraction").entries().iter().copied(),
        &lu_truth,
    );
    let double = relative(
        infinite::<f64, _>(&Portable, &a).expect("a contraction").entries().iter().copied(),
        &lu_truth,
    );
    for k in [1_u32, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64] {
        let truth = by_rows(&horner_wide(&wide_a, k));
        let x = f64::from(k);
        let of = |m: &Dense| relative(m.entries().iter().copied(), &truth);
        let horner = Horner.sum(&Portable, &a, k).expect("a contraction");
        let doubling = Doubling.sum(&Portable, &a, k).expect("a contraction");
        // At k = 1 the sum is A itself, without error: a logarithmic axis cannot show it.
        if k > 1 {
            series_of[0].points.push((x, of(&horner)));
            series_of[1].points.push((x, of(&doubling)));
        }
        let mut t = DVector::zeros(n);
        for _ in 0..k {
            t = &reflecting * (&wide_b + t);
        }
        let got = series(f, &albedo, &b0, k).expect("lengths agree");
        series_of[2].points.push((x, relative(got.iter().map(|x| x[0]), t.as_slice())));
        series_of[3].points.push((x, narrow));
        series_of[4].points.push((x, double));
    }
    Curves { title, file, x_label: "bounces k", y_label: RELATIVE, series: series_of }
}
