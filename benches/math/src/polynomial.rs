//! Contenders for `polynomial`: sums of powers of an operator, applying it, and all bounces at once.

#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use crate::figure::{Contender, Contest, Curves, Series};
use etendue_conformance::statistics::Random;
use etendue_conformance::truth::empty_box::EmptyBox;
use etendue_core::radiosity::lanes::dot_reference;
use etendue_core::radiosity::operator::{Dense, LinearOperator, SymmetricHalf};
use etendue_core::radiosity::polynomial::{
    ConjugateGradients, Doubling, GaussSeidel, Horner, Inner, Jacobi, Multiply, Portable, PowerSum, Settings,
    Target, View, gather, infinite, multiply_add_reference, series, solve,
};
use etendue_cpu::Linear;
use nalgebra::{DMatrix, DVector};
use std::hint::black_box;
use std::sync::Arc;

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
    fn operator<O: LinearOperator + 'static>(
        name: &str,
        o: Arc<O>,
        x: &Arc<Vec<f32>>,
        truth: &[f64],
        threads: Option<usize>,
    ) -> Contender
    where
        O: etendue_cpu::WideStripe<f32, 1>
            + etendue_cpu::WideStripe<f32, 3>
            + etendue_cpu::WideStripe<f64, 1>
            + etendue_cpu::WideStripe<f64, 3>
            + etendue_cpu::WideStripe<etendue_core::radiosity::lanes::Magnitude, 1>,
    {
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
    fn by<I: Inner<Dense> + 'static>(
        name: &str,
        inner: I,
        data: (&Arc<Dense>, &Arc<Vec<f32>>, &Arc<Vec<[f32; 3]>>, &Arc<Vec<[f32; 3]>>),
        truth: &[f64],
    ) -> Contender {
        let (f, areas, albedo, b0) = (data.0.clone(), data.1.clone(), data.2.clone(), data.3.clone());
        let once = move || {
            solve(&inner, &*f, &areas, &albedo, &b0, Settings::default()).expect("a contraction").radiosity
        };
        let error = relative(once().as_flattened().iter().copied(), truth);
        ours(name, error, move || drop(black_box(once())))
    }
    let data = (&f, &areas, &albedo, &b0);
    contenders.push(by("conjugate gradients, portable", ConjugateGradients, data, &truth));
    contenders.push(by("Gauss-Seidel, portable", GaussSeidel, data, &truth));
    contenders.push(by("Jacobi, portable", Jacobi, data, &truth));
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

/// A matrix that a test can compare with: direct radiosity to indirect irradiance.
pub fn gather_of(f: &Dense, albedo: &[f32]) -> Dense {
    gather::<f64, _>(&Portable, f, albedo).expect("a contraction")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Instant;

    /// Nanoseconds that this thread has had a processor for: what other programs take is not counted.
    fn own_time() -> f64 {
        let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
        text.split(' ').next().and_then(|t| t.parse().ok()).unwrap_or(f64::NAN)
    }

    #[test]
    #[ignore = "prints times: cargo test -p etendue-benches --release --lib polynomial -- --ignored --nocapture of_a_pass"]
    fn of_a_pass() {
        let (f, areas) = random_operator(512, 3);
        let half = SymmetricHalf::from_dense(&f, &areas).expect("as many areas as patches");
        let one = linear(1);
        let x = vec![0.5_f32; 512];
        let x3 = vec![[0.5_f32, 0.3, 0.2]; 512];
        let (w, w3) = (vec![0.5_f64; 512], vec![[0.5_f64, 0.3, 0.2]; 512]);
        fn time(name: &str, mut f: impl FnMut()) {
            let mut best = f64::INFINITY;
            for _ in 0..60 {
                let start = Instant::now();
                (0..20).for_each(|_| f());
                best = best.min(start.elapsed().as_secs_f64() * 1e9 / 20.0);
            }
            println!("{name:32} {:8.1} us", best * 1e-3);
        }
        fn all<O: LinearOperator>(name: &str, o: &O, x: &[f32], x3: &[[f32; 3]], w: &[f64], w3: &[[f64; 3]]) {
            let mut y = vec![0.0; x.len()];
            time(&format!("{name}, f32"), || o.apply(x, black_box(&mut y)).expect("lengths agree"));
            let mut y = vec![[0.0; 3]; x.len()];
            time(&format!("{name}, f32 rgb"), || o.apply_rgb(x3, black_box(&mut y)).expect("lengths agree"));
            let mut y = vec![0.0; x.len()];
            time(&format!("{name}, f64"), || o.apply_wide(w, black_box(&mut y)).expect("lengths agree"));
            let mut y = vec![[0.0; 3]; x.len()];
            time(&format!("{name}, f64 rgb"), || {
                o.apply_wide_rgb(w3, black_box(&mut y)).expect("lengths agree")
            });
        }
        all("dense, portable", &f, &x, &x3, &w, &w3);
        all("dense, AVX2", &one.operator(&f), &x, &x3, &w, &w3);
        all("half, portable", &half, &x, &x3, &w, &w3);
        all("half, AVX2", &one.operator(&half), &x, &x3, &w, &w3);
    }

    #[test]
    #[ignore = "prints times: cargo test -p etendue-benches --release --lib polynomial -- --ignored --nocapture times"]
    fn times() {
        for mut contest in contests() {
            println!("{}", contest.title);
            let count = contest.contenders.len();
            let mut found = vec![Vec::new(); count];
            for _ in 0..9 {
                for (c, times) in contest.contenders.iter_mut().zip(&mut found) {
                    let (start, own) = (Instant::now(), own_time());
                    (c.work)();
                    times.push((start.elapsed().as_secs_f64() * 1e3, (own_time() - own) * 1e-6));
                }
            }
            for (c, times) in contest.contenders.iter().zip(&mut found) {
                let wall = times.iter().fold(f64::INFINITY, |m, t| m.min(t.0));
                times.sort_by(|a, b| a.1.total_cmp(&b.1));
                let own = [times[0].1, times[4].1];
                println!("  {:40} wall {wall:8.2} ms, own {own:8.2?} ms, error {:.2e}", c.name, c.error);
            }
        }
    }

    #[test]
    #[ignore = "prints curves: cargo test -p etendue-benches --release --lib polynomial -- --ignored --nocapture error_over_bounces"]
    fn error_over_bounces() {
        for curves in curves() {
            println!("{}", curves.title);
            for s in &curves.series {
                let points: Vec<String> = s.points.iter().map(|(x, y)| format!("{x}: {y:.2e}")).collect();
                println!("  {}: {}", s.name, points.join(", "));
            }
        }
    }
}
