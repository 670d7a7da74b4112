//! Linear algebra on threads: the bits of core's scalar definitions, for any number of threads.

use etendue_core::radiosity::operator::{Dense, LinearOperator, SymmetricHalf};
use etendue_core::radiosity::polynomial::{
    ConjugateGradients, Doubling, Horner, Lu, Multiply, Portable, PowerSum, Settings, Target, View, infinite,
    multiply_add_reference, series, solve,
};
use etendue_cpu::Linear;

fn linear(threads: usize) -> Linear {
    Linear::new(Some(threads)).expect("threads can be started")
}

/// SplitMix64 (Steele et al. 2014), in [-1, 1).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / 8_388_608.0 - 1.0
    }
    fn many(&mut self, n: usize) -> Vec<f32> {
        (0..n).map(|_| self.next()).collect()
    }
}

/// Rows that sum to at most 0.9 in magnitude, symmetric weights.
fn scene(n: usize) -> (Dense, Vec<f32>) {
    let mut random = Random(n as u64);
    let mut s = vec![0.0_f32; n * n];
    for i in 0..n {
        for j in 0..i {
            let x = random.next().abs() + 0.01;
            (s[i * n + j], s[j * n + i]) = (x, x);
        }
    }
    let areas: Vec<f32> = (0..n).map(|i| s[i * n..][..n].iter().sum::<f32>() + 0.01).collect();
    let entries = (0..n * n).map(|k| 0.9 * s[k] / areas[k / n]).collect();
    (Dense::try_new(n, entries).expect("finite"), areas)
}

fn bits(x: &[f32]) -> Vec<u32> {
    x.iter().map(|x| x.to_bits()).collect()
}

#[test]
fn products_have_the_bits_of_the_definition() {
    let mut random = Random(1);
    for (m, k, n, stride, column) in [
        (1, 1, 1, 1, 0),
        (6, 8, 16, 16, 0),
        (7, 300, 33, 40, 5),
        (97, 257, 49, 49, 0),
        (200, 64, 130, 200, 64),
        (48, 520, 15, 15, 0),
    ] {
        let (a, b, c) = (random.many(m * k), random.many(k * n), random.many(m * stride));
        let mut expected = c.clone();
        let view = |entries, rows, columns| View { entries, stride: columns, rows, columns };
        multiply_add_reference(
            Target { entries: &mut expected, stride, column },
            view(&a, m, k),
            view(&b, k, n),
        );
        let wide = |x: &[f32]| x.iter().map(|x| f64::from(*x) / 3.0).collect::<Vec<f64>>();
        let (wide_a, wide_b) = (wide(&a), wide(&b));
        let mut expected_wide = wide(&c);
        let wide_view = |entries, rows, columns| View { entries, stride: columns, rows, columns };
        multiply_add_reference(
            Target { entries: &mut expected_wide, stride, column },
            wide_view(&wide_a, m, k),
            wide_view(&wide_b, k, n),
        );
        for threads in [1, 2, 5] {
            let l = linear(threads);
            let mut got = c.clone();
            l.multiply_add(Target { entries: &mut got, stride, column }, view(&a, m, k), view(&b, k, n));
            assert_eq!(bits(&got), bits(&expected), "{m} {k} {n}, {threads} threads");
            let mut got = wide(&c);
            l.multiply_add_wide(
                Target { entries: &mut got, stride, column },
                wide_view(&wide_a, m, k),
                wide_view(&wide_b, k, n),
            );
            assert!(got.iter().zip(&expected_wide).all(|(g, e)| g.to_bits() == e.to_bits()));
        }
    }
}

fn same(name: &str, plain: &dyn LinearOperator, parallel: &dyn LinearOperator) {
    let n = plain.len();
    assert_eq!(parallel.len(), n);
    let mut random = Random(7);
    let x: Vec<[f32; 3]> = (0..n).map(|_| [random.next(), random.next(), random.next()]).collect();
    let one: Vec<f32> = x.iter().map(|x| x[1]).collect();
    let wide: Vec<[f64; 3]> = x.iter().map(|x| x.map(|x| f64::from(x) / 3.0)).collect();
    let wide_one: Vec<f64> = wide.iter().map(|x| x[1]).collect();
    macro_rules! compare {
        ($method:ident, $x:expr, $zero:expr) => {{
            let (mut a, mut b) = (vec![$zero; n], vec![$zero; n]);
            plain.$method($x, &mut a).expect("lengths agree");
            parallel.$method($x, &mut b).expect("lengths agree");
            assert_eq!(a, b, "{name}, {n} patches: {}", stringify!($method));
            assert!(parallel.$method($x, &mut b[..n.saturating_sub(1)]).is_err() || n == 0);
        }};
    }
    compare!(apply, &one, 9.0_f32);
    compare!(apply_rgb, &x, [9.0_f32; 3]);
    compare!(apply_wide, &wide_one, 9.0_f64);
    compare!(apply_wide_rgb, &wide, [9.0_f64; 3]);
    compare!(apply_magnitudes, &wide_one, 9.0_f64);
}

#[test]
fn operators_have_the_same_bits_on_any_number_of_threads() {
    for n in [0, 1, 17, 255, 256, 257, 700] {
        let mut random = Random(n as u64);
        let dense = Dense::try_new(n, random.many(n * n)).expect("finite");
        let areas: Vec<f32> = random.many(n).iter().map(|x| x.abs() + 0.1).collect();
        let half = SymmetricHalf::try_new(areas, random.many(n * (n + 1) / 2)).expect("finite");
        for threads in [1, 2, 5] {
            let l = linear(threads);
            same("dense", &dense, &l.operator(&dense));
            same("half", &half, &l.operator(&half));
        }
    }
}

#[test]
fn sums_and_solutions_have_the_same_bits_on_any_number_of_threads() {
    let (f, areas) = scene(300);
    let n = f.len();
    let half = SymmetricHalf::from_dense(&f, &areas).expect("finite");
    let mut random = Random(3);
    let albedo: Vec<[f32; 3]> = (0..n).map(|_| [0, 1, 2].map(|_| random.next().abs())).collect();
    let b0: Vec<[f32; 3]> = (0..n).map(|_| [0, 1, 2].map(|_| random.next().abs())).collect();
    let settings = Settings::default();
    let horner = Horner.sum(&Portable, &f, 3).expect("a contraction");
    let doubling = Doubling.sum(&Portable, &f, 6).expect("a contraction");
    let passes = series(&f, &albedo, &b0, 5).expect("lengths agree");
    let dense = solve(&ConjugateGradients, &f, &areas, &albedo, &b0, settings).expect("a contraction");
    let halved = solve(&ConjugateGradients, &half, &areas, &albedo, &b0, settings).expect("a contraction");
    let all = infinite::<f32, _>(&Portable, &f).expect("a contraction");
    let lu = Lu::<f64>::factor(&Portable, n, f.entries().iter().map(|x| f64::from(*x)).collect());
    for threads in [1, 2, 3] {
        let l = linear(threads);
        assert_eq!(Horner.sum(&l, &f, 3).expect("a contraction"), horner);
        assert_eq!(Doubling.sum(&l, &f, 6).expect("a contraction"), doubling);
        assert_eq!(series(&l.operator(&f), &albedo, &b0, 5).expect("lengths agree"), passes);
        let s = solve(&ConjugateGradients, &l.operator(&f), &areas, &albedo, &b0, settings);
        assert_eq!(s.expect("a contraction"), dense);
        let s = solve(&ConjugateGradients, &l.operator(&half), &areas, &albedo, &b0, settings);
        assert_eq!(s.expect("a contraction"), halved);
        assert_eq!(infinite::<f32, _>(&l, &f).expect("a contraction"), all);
        assert_eq!(Lu::<f64>::factor(&l, n, f.entries().iter().map(|x| f64::from(*x)).collect()), lu);
    }
}
