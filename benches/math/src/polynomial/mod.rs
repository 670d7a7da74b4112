//! Contenders for `polynomial`: sums of powers of an operator, applying it, and all bounces at once.

#![allow(clippy::disallowed_methods, reason = "truth in f64")]

mod growth;
#[cfg(test)]
mod tests;

use crate::figure::{Contender, Contest};
use etendue_conformance::statistics::Random;
use etendue_conformance::truth::empty_box::EmptyBox;
use etendue_core::radiosity::lanes::dot_reference;
use etendue_core::radiosity::operator::{Dense, LinearOperator, SymmetricHalf};
use etendue_core::radiosity::polynomial::{
    ConjugateGradients, Doubling, GaussSeidel, Horner, Inner, Jacobi, Multiply, Portable, PowerSum, Settings,
    Target, View, infinite, multiply_add_reference, series, solve,
};
use etendue_cpu::{Linear, WideOperator};
use nalgebra::{DMatrix, DVector};
use std::hint::black_box;
use std::sync::Arc;

pub use growth::curves;

const RELATIVE: &str = "relative L2 error against f64";
const NALGEBRA: &str = "nalgebra 0.35";

/// |got - truth| / |truth| in the Euclidean norm.
fn relative(got: impl IntoIterator<Item = f32>, truth: &[f64]) -> f64 {
    let (mut error, mut size) = (0.0, 0.0);
    for (g, t) in got.into_iter().zip(truth) {
        error += (f64::from(g) - t).powi(2);
        size += t * t;
    }
    (error / size).sqrt()
}

fn ours(name: &str, error: f64, work: impl FnMut() + 'static) -> Contender {
    Contender { name: name.into(), ours: true, error, work: Box::new(work) }
}

fn rival(name: &str, error: f64, work: impl FnMut() + 'static) -> Contender {
    Contender { name: format!("{name}, {NALGEBRA}"), ours: false, error, work: Box::new(work) }
}

fn linear(threads: usize) -> Linear {
    Linear::new(Some(threads)).expect("threads can be started")
}

/// The elimination and the products as their definitions say them.
struct Scalar;

impl Multiply for Scalar {
    fn multiply_add(&self, c: Target<'_, f32>, a: View<'_, f32>, b: View<'_, f32>) {
        multiply_add_reference(c, a, b);
    }
    fn multiply_add_wide(&self, c: Target<'_, f64>, a: View<'_, f64>, b: View<'_, f64>) {
        multiply_add_reference(c, a, b);
    }
}

/// Form factors of an empty box of 6 `cells`^2 patches, rounded to f32, and the areas.
pub fn box_operator(cells: usize) -> (Dense, Vec<f32>) {
    let b = EmptyBox::new([1.0, 1.5, 0.7], cells);
    let entries = b.form_factors.iter().map(|f| *f as f32).collect();
    (
        Dense::try_new(b.len(), entries).expect("form factors are finite"),
        b.areas.iter().map(|a| *a as f32).collect(),
    )
}

/// A closed scene of random reciprocal form factors: S symmetric, A its row sums, F = S / A.
pub fn random_operator(n: usize, seed: u64) -> (Dense, Vec<f32>) {
    let mut random = Random::new(seed);
    let mut s = vec![0.0_f64; n * n];
    for i in 0..n {
        for j in 0..i {
            let x = random.range(0.0, 1.0).powi(4);
            (s[i * n + j], s[j * n + i]) = (x, x);
        }
    }
    let areas: Vec<f64> = (0..n).map(|i| s[i * n..][..n].iter().sum()).collect();
    let entries = (0..n * n).map(|k| (s[k] / areas[k / n]) as f32).collect();
    (Dense::try_new(n, entries).expect("rows are finite"), areas.iter().map(|a| *a as f32).collect())
}

/// Albedos of a furnished room: between 0.2 and 0.9.
fn albedos(n: usize) -> Vec<f32> {
    let mut random = Random::new(7);
    (0..n).map(|_| random.range(0.2, 0.9) as f32).collect()
}

fn wide(a: &Dense) -> DMatrix<f64> {
    let n = a.len();
    DMatrix::from_fn(n, n, |i, j| f64::from(a.row(i)[j]))
}

/// Row by row, as `Dense` has it.
fn by_rows(m: &DMatrix<f64>) -> Vec<f64> {
    m.transpose().as_slice().to_vec()
}

fn horner_wide(a: &DMatrix<f64>, k: u32) -> DMatrix<f64> {
    (1..k).fold(a.clone(), |m, _| a + a * m)
}

fn power_sum<P: PowerSum + 'static, M: Multiply + 'static>(
    name: &str,
    form: P,
    multiply: M,
    a: &Arc<Dense>,
    k: u32,
    truth: &[f64],
) -> Contender {
    let a = a.clone();
    let sum = move || form.sum(&multiply, &a, k).expect("the powers of a contraction are finite");
    let error = relative(sum().entries().iter().copied(), truth);
    ours(name, error, move || drop(black_box(sum())))
}

fn sums(k: u32, title: &'static str, file: &'static str) -> Contest {
    let (f, _) = box_operator(10);
    let a = Arc::new(f.reflecting(&albedos(f.len())).expect("as many albedos as patches"));
    let n = a.len();
    let wide_a = wide(&a);
    let truth = by_rows(&horner_wide(&wide_a, k));
    let narrow: DMatrix<f32> = DMatrix::from_fn(n, n, |i, j| a.row(i)[j]);
    let rival_sum = move || (1..k).fold(narrow.clone(), |m, _| &narrow + &narrow * m);
    let rival_error = relative(rival_sum().transpose().as_slice().iter().copied(), &truth);
    let mut contenders = vec![
        power_sum("Horner, portable, 1 thread", Horner, Portable, &a, k, &truth),
        power_sum("Horner, AVX2, 1 thread", Horner, linear(1), &a, k, &truth),
        power_sum("Horner, AVX2, 2 threads", Horner, linear(2), &a, k, &truth),
        power_sum("Doubling, AVX2, 1 thread", Doubling, linear(1), &a, k, &truth),
        rival("Horner in f32, 1 thread", rival_error, move || drop(black_box(rival_sum()))),
    ];
    if k <= 3 {
        contenders.insert(0, power_sum("Horner, scalar reference", Horner, Scalar, &a, k, &truth));
    }
    Contest { title, file, error_label: RELATIVE, item: "matrix", items: 1, contenders }
}

/// M_3 of a box of 600 patches, as a matrix.
pub fn three_bounces() -> Contest {
    sums(3, "Three bounces as a matrix, n = 600", "polynomial_k3")
}

/// M_16 of the same box.
pub fn sixteen_bounces() -> Contest {
    sums(16, "Sixteen bounces as a matrix, n = 600", "polynomial_k16")
}

/// All bounces of the same box as a matrix.
pub fn all_bounces_matrix() -> Contest {
    let (f, _) = box_operator(10);
    let rho = albedos(f.len());
    let a = Arc::new(f.reflecting(&rho).expect("as many albedos as patches"));
    let n = a.len();
    let wide_a = wide(&a);
    let solve_wide = {
        let wide_a = wide_a.clone();
        move || (DMatrix::identity(n, n) - &wide_a).lu().solve(&wide_a).expect("a contraction")
    };
    let truth = by_rows(&solve_wide());
    let mut contenders = Vec::new();
    let mut add = |name: &str, f: Box<dyn Fn(&Dense) -> Dense>| {
        let a = a.clone();
        let error = relative(f(&a).entries().iter().copied(), &truth);
        contenders.push(ours(name, error, move || drop(black_box(f(&a)))));
    };
    let (one, two) = (linear(1), linear(2));
    let (one_wide, horner) = (linear(1), linear(1));
    add("LU in f32, portable", Box::new(|a| infinite::<f32, _>(&Portable, a).expect("a contraction")));
    add("LU in f32, AVX2, 1 thread", Box::new(move |a| infinite::<f32, _>(&one, a).expect("a contraction")));
    add("LU in f32, AVX2, 2 threads", Box::new(move |a| infinite::<f32, _>(&two, a).expect("a contraction")));
    add(
        "LU in f64, AVX2, 1 thread",
        Box::new(move |a| infinite::<f64, _>(&one_wide, a).expect("a contraction")),
    );
    add("Horner, k = 3", Box::new(move |a| Horner.sum(&horner, a, 3).expect("a contraction")));
    let narrow: DMatrix<f32> = DMatrix::from_fn(n, n, |i, j| a.row(i)[j]);
    let lu = move || (DMatrix::identity(n, n) - &narrow).lu().solve(&narrow).expect("a contraction");
    let error = relative(lu().transpose().as_slice().iter().copied(), &truth);
    contenders.push(rival("LU in f32", error, move || drop(black_box(lu()))));
    let error = relative(truth.iter().map(|x| *x as f32), &truth);
    contenders.push(rival("LU in f64", error, move || drop(black_box(solve_wide()))));
    Contest {
        title: "All bounces as a matrix, n = 600",
        file: "polynomial_infinite",
        error_label: RELATIVE,
        item: "matrix",
        items: 1,
        contenders,
    }
}

/// F x for 2048 patches, one channel.
pub fn apply() -> Contest {
    let n = 2048;
    let (f, areas) = random_operator(n, 3);
    let half = Arc::new(SymmetricHalf::from_dense(&f, &areas).expect("as many areas as patches"));
    let f = Arc::new(f);
    let mut random = Random::new(5);
    let x: Arc<Vec<f32>> = Arc::new((0..n).map(|_| random.range(0.0, 1.0) as f32).collect());
    let truth: Vec<f64> =
        (0..n).map(|i| f.row(i).iter().zip(&*x).map(|(f, x)| f64::from(*f) * f64::from(*x)).sum()).collect();
    fn operator<O: WideOperator + 'static>(
        name: &str,
        o: Arc<O>,
        x: &Arc<Vec<f32>>,
        truth: &[f64],
        threads: Option<usize>,
    ) -> Contender {
        let x = x.clone();
        let mut y = vec![0.0; x.len()];
        let linear = threads.map(linear);
        let mut once = move || {
            match &linear {
                Some(linear) => linear.operator(&*o).apply(&x, &mut y),
                None => o.apply(&x, &mut y),
            }
            .expect("lengths agree");
            black_box(&y).clone()
        };
        let error = relative(once(), truth);
        ours(name, error, move || drop(once()))
    }
    let scalar = {
        let (f, x) = (f.clone(), x.clone());
        move || (0..n).map(|i| dot_reference(f.row(i), &x)).collect::<Vec<f32>>()
    };
    let scalar_error = relative(scalar(), &truth);
    let narrow: DMatrix<f32> = DMatrix::from_fn(n, n, |i, j| f.row(i)[j]);
    let vector = DVector::from_column_slice(&x);
    let mut out = DVector::zeros(n);
    let mut gemv = move || {
        out.gemv(1.0, &narrow, &vector, 0.0);
        black_box(&out).as_slice().to_vec()
    };
    let rival_error = relative(gemv(), &truth);
    let contenders = vec![
        ours("dense, scalar reference", scalar_error, move || drop(black_box(scalar()))),
        operator("dense, portable", f.clone(), &x, &truth, None),
        operator("dense, AVX2, 1 thread", f.clone(), &x, &truth, Some(1)),
        operator("dense, AVX2, 2 threads", f, &x, &truth, Some(2)),
        operator("half, portable", half.clone(), &x, &truth, None),
        operator("half, AVX2, 1 thread", half.clone(), &x, &truth, Some(1)),
        operator("half, AVX2, 2 threads", half, &x, &truth, Some(2)),
        rival("gemv in f32", rival_error, move || drop(gemv())),
    ];
    Contest {
        title: "One bounce of one channel, n = 2048",
        file: "polynomial_apply",
        error_label: RELATIVE,
        item: "bounce",
        items: 1,
        contenders,
    }
}

#[derive(Clone)]
struct Room {
    f: Arc<Dense>,
    areas: Arc<Vec<f32>>,
    albedo: Arc<Vec<[f32; 3]>>,
    b0: Arc<Vec<[f32; 3]>>,
}

/// All bounces of three channels in a box of 600 patches of which half are almost white.
pub fn all_bounces() -> Contest {
    let (f, areas) = box_operator(10);
    let (f, areas) = (Arc::new(f), Arc::new(areas));
    let n = f.len();
    let mut random = Random::new(11);
    let albedo: Arc<Vec<[f32; 3]>> = Arc::new(
        (0..n)
            .map(|i| if i % 2 == 0 { [0.99, 0.98, 0.97] } else { [0.9, 0.5, random.range(0.2, 0.9) as f32] })
            .collect(),
    );
    let b0: Arc<Vec<[f32; 3]>> =
        Arc::new((0..n).map(|i| if i < 60 { [10.0, 9.0, 8.0] } else { [0.0; 3] }).collect());
    let lu_wide = {
        let (f, albedo, b0) = (f.clone(), albedo.clone(), b0.clone());
        move || -> Vec<f64> {
            let planes: Vec<Vec<f64>> = (0..3)
                .map(|c| {
                    let m = DMatrix::from_fn(n, n, |i, j| {
                        f64::from(i == j) - f64::from(albedo[i][c]) * f64::from(f.row(i)[j])
                    });
                    let b = DVector::from_fn(n, |i, _| f64::from(b0[i][c]));
                    m.lu().solve(&b).expect("a contraction").as_slice().to_vec()
                })
                .collect();
            (0..3 * n).map(|k| planes[k % 3][k / 3]).collect()
        }
    };
    let truth = lu_wide();
    let mut contenders = Vec::new();
    fn by<I: Inner<Dense> + 'static>(name: &str, inner: I, data: &Room, truth: &[f64]) -> Contender {
        let Room { f, areas, albedo, b0 } = data.clone();
        let once = move || {
            solve(&inner, &*f, &areas, &albedo, &b0, Settings::default()).expect("a contraction").radiosity
        };
        let error = relative(once().as_flattened().iter().copied(), truth);
        ours(name, error, move || drop(black_box(once())))
    }
    let data = Room { f: f.clone(), areas: areas.clone(), albedo: albedo.clone(), b0: b0.clone() };
    contenders.push(by("conjugate gradients, portable", ConjugateGradients, &data, &truth));
    contenders.push(by("Gauss-Seidel, portable", GaussSeidel, &data, &truth));
    contenders.push(by("Jacobi, portable", Jacobi, &data, &truth));
    for threads in [1, 2] {
        let (f, areas, albedo, b0) = (f.clone(), areas.clone(), albedo.clone(), b0.clone());
        let linear = linear(threads);
        let once = move || {
            solve(&ConjugateGradients, &linear.operator(&*f), &areas, &albedo, &b0, Settings::default())
                .expect("a contraction")
                .radiosity
        };
        let error = relative(once().as_flattened().iter().copied(), &truth);
        let name =
            format!("conjugate gradients, AVX2, {threads} thread{}", if threads > 1 { "s" } else { "" });
        contenders.push(ours(&name, error, move || drop(black_box(once()))));
    }
    for k in [3, 64] {
        let (f, albedo, b0) = (f.clone(), albedo.clone(), b0.clone());
        let linear = linear(1);
        let once = move || {
            let x = series(&linear.operator(&*f), &albedo, &b0, k).expect("lengths agree");
            x.iter().zip(&*b0).map(|(x, b)| [x[0] + b[0], x[1] + b[1], x[2] + b[2]]).collect::<Vec<_>>()
        };
        let error = relative(once().as_flattened().iter().copied(), &truth);
        contenders
            .push(ours(&format!("{k} bounces, AVX2, 1 thread"), error, move || drop(black_box(once()))));
    }
    {
        let (f, albedo) = (f.clone(), albedo.clone());
        let b0 = b0.clone();
        let once = move || -> Vec<[f32; 3]> {
            let planes: Vec<DVector<f32>> = (0..3)
                .map(|c| {
                    let m = DMatrix::from_fn(n, n, |i, j| {
                        f32::from(u8::from(i == j)) - albedo[i][c] * f.row(i)[j]
                    });
                    m.lu().solve(&DVector::from_fn(n, |i, _| b0[i][c])).expect("a contraction")
                })
                .collect();
            (0..n).map(|i| [planes[0][i], planes[1][i], planes[2][i]]).collect()
        };
        let error = relative(once().as_flattened().iter().copied(), &truth);
        contenders.push(rival("LU in f32", error, move || drop(black_box(once()))));
    }
    let error = relative(truth.iter().map(|x| *x as f32), &truth);
    contenders.push(rival("LU in f64", error, move || drop(black_box(lu_wide()))));
    Contest {
        title: "All bounces of three channels, n = 600, albedo up to 0.99",
        file: "polynomial_solve",
        error_label: RELATIVE,
        item: "solution",
        items: 1,
        contenders,
    }
}

/// All contests.
pub fn contests() -> Vec<Contest> {
    vec![three_bounces(), sixteen_bounces(), all_bounces_matrix(), apply(), all_bounces()]
}
