//! All bounces of light: solvers and eliminations against elimination in f64, and what they refuse.
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

#[path = "polynomial_support.rs"]
mod support;

use etendue_core::radiosity::operator::{Dense, LinearOperator, OperatorError, SymmetricHalf};
use etendue_core::radiosity::polynomial::{
    ConjugateGradients, GaussSeidel, Inner, Jacobi, Lu, Portable, Settings, Solution, SolveError,
    contraction, gather, infinite, series, solve,
};
use proptest::prelude::*;
use support::{Random, closed, eliminate, relative, system, wide, worst};

const HALF_ULP: f64 = 1.0 / 16_777_216.0;

fn truth<const C: usize>(f: &Dense, albedo: &[[f32; C]], b0: &[[f32; C]], c: usize) -> Vec<f64> {
    let n = f.len();
    let rho: Vec<f32> = albedo.iter().map(|x| x[c]).collect();
    eliminate(n, system(n, &wide(f), &rho), b0.iter().map(|b| f64::from(b[c])).collect(), 1)
}

/// The solution is the truth rounded once: half an ulp of its own, and the proved bound.
fn check<const C: usize>(name: &str, s: &Solution<C>, f: &Dense, albedo: &[[f32; C]], b0: &[[f32; C]]) {
    for c in 0..C {
        let truth = truth(f, albedo, b0, c);
        let size = truth.iter().fold(0.0_f64, |m, t| m.max(t.abs()));
        assert!(s.bound[c] <= HALF_ULP * size * 1.001, "{name}: bound {:e}", s.bound[c]);
        for (x, t) in s.radiosity.iter().zip(&truth) {
            let error = (f64::from(x[c]) - t).abs();
            // Elimination in f64 has an error of its own.
            assert!(
                error <= s.bound[c] + HALF_ULP * t.abs() + 1e-12 * size,
                "{name}: {} for {t}, off by {error:e}, bound {:e}",
                x[c],
                s.bound[c]
            );
        }
    }
}

/// Form factors, areas, albedos, B0.
type Scene = (Dense, Vec<f32>, Vec<[f32; 3]>, Vec<[f32; 3]>);

fn scene(n: usize, seed: u64, low: f32, high: f32) -> Scene {
    let (f, areas) = closed(n, seed);
    let mut random = Random(seed + 100);
    let albedo = (0..n).map(|_| [0, 1, 2].map(|_| low + (high - low) * random.unit() as f32)).collect();
    // Few patches are lit: the rest is indirect light alone.
    let b0 = (0..n).map(|i| if i % 10 == 0 { [5.0, 3.0, random.unit() as f32] } else { [0.0; 3] }).collect();
    (f, areas, albedo, b0)
}

#[test]
fn every_solver_gives_the_truth_rounded_once() {
    for (n, low, high) in [(2, 0.0, 1.0), (30, 0.0, 0.9), (120, 0.2, 0.8), (200, 0.9, 0.99)] {
        let (f, areas, albedo, b0) = scene(n, n as u64, low, high);
        let settings = Settings::default();
        let cg = solve(&ConjugateGradients, &f, &areas, &albedo, &b0, settings).unwrap();
        check("conjugate gradients", &cg, &f, &albedo, &b0);
        let jacobi = solve(&Jacobi, &f, &areas, &albedo, &b0, settings).unwrap();
        check("Jacobi", &jacobi, &f, &albedo, &b0);
        let seidel = solve(&GaussSeidel, &f, &areas, &albedo, &b0, settings).unwrap();
        check("Gauss-Seidel", &seidel, &f, &albedo, &b0);
        if n == 200 {
            assert!(cg.passes < seidel.passes && seidel.passes < jacobi.passes);
        }
        // Through the half, the truth is that of the half's own entries.
        let half = SymmetricHalf::from_dense(&f, &areas).unwrap();
        let at = |i: usize, j: usize| f64::from(half.row(i.max(j))[i.min(j)]) / f64::from(areas[i]);
        let s = solve(&ConjugateGradients, &half, &areas, &albedo, &b0, settings).unwrap();
        for c in 0..3 {
            let rho: Vec<f32> = albedo.iter().map(|x| x[c]).collect();
            let entries: Vec<f64> = (0..n * n).map(|k| at(k / n, k % n)).collect();
            let b = b0.iter().map(|b| f64::from(b[c])).collect();
            let truth = eliminate(n, system(n, &entries, &rho), b, 1);
            let got: Vec<f32> = s.radiosity.iter().map(|x| x[c]).collect();
            assert!(worst(&got, &truth) <= 2.0 * HALF_ULP, "half: {:e}", worst(&got, &truth));
        }
        // One channel alone.
        let rho: Vec<[f32; 1]> = albedo.iter().map(|x| [x[1]]).collect();
        let b: Vec<[f32; 1]> = b0.iter().map(|x| [x[1]]).collect();
        check(
            "one channel",
            &solve(&ConjugateGradients, &f, &areas, &rho, &b, settings).unwrap(),
            &f,
            &rho,
            &b,
        );
    }
}

/// B = 1 / (1 - rho) in a closed scene of albedo rho where every patch sends 1; the rows of F in f32 sum to 1 only within
/// rounding, which 1 / (1 - rho) amplifies: that is the error of the data, and the solver adds none.
#[test]
fn an_almost_white_room() {
    let (f, areas) = closed(200, 3);
    let off = f.entries().chunks(200).map(|r| (r.iter().map(|x| f64::from(*x)).sum::<f64>() - 1.0).abs());
    let off = off.fold(0.0_f64, f64::max);
    for rho in [0.9_f32, 0.999, 0.99999] {
        let (albedo, b0) = (vec![[rho]; 200], vec![[1.0_f32]; 200]);
        let s = solve(&ConjugateGradients, &f, &areas, &albedo, &b0, Settings::default()).unwrap();
        check("white", &s, &f, &albedo, &b0);
        println!("albedo {rho}: {} passes in f32, {} in f64", s.passes, s.wide_passes);
        // Bounces alone would take 16 / (1 - rho) passes: 16 000 at 0.999.
        assert!(s.passes + s.wide_passes <= 40, "{} and {} passes", s.passes, s.wide_passes);
        let closed_form = 1.0 / (1.0 - f64::from(rho));
        for x in &s.radiosity {
            let error = (f64::from(x[0]) - closed_form).abs() / closed_form;
            let data = off * f64::from(rho) * closed_form;
            assert!(error <= 1.1 * data + HALF_ULP, "albedo {rho}: {error:e}, data {data:e}");
        }
    }
}

#[test]
fn truncation_is_what_the_solution_has_and_bounces_have_not() {
    let (f, areas, albedo, b0) = scene(60, 4, 0.4, 0.6);
    let s = solve(&ConjugateGradients, &f, &areas, &albedo, &b0, Settings::default()).unwrap();
    let mut last = f64::INFINITY;
    for k in [1, 2, 4, 8, 16, 32] {
        let x = series(&f, &albedo, &b0, k).unwrap();
        let missing = s
            .radiosity
            .iter()
            .zip(&x)
            .zip(&b0)
            .map(|((s, x), b)| (f64::from(s[0]) - f64::from(x[0]) - f64::from(b[0])).abs())
            .fold(0.0_f64, f64::max);
        assert!(missing <= 0.5 * last + 2e-6, "k = {k}: {missing}");
        last = missing;
    }
    assert!(last <= 2e-6);
}

#[test]
fn the_whole_matrix_by_elimination() {
    for (n, rho) in [(1, 0.5_f32), (30, 0.7), (64, 0.9), (65, 0.2), (150, 0.999)] {
        let (f, areas) = closed(n.max(2), 5);
        let n = f.len();
        let mut random = Random(6);
        let albedo: Vec<f32> = (0..n).map(|_| rho * (0.5 + 0.5 * random.unit() as f32)).collect();
        let albedo = if rho == 0.999 { vec![rho; n] } else { albedo };
        let a = f.reflecting(&albedo).unwrap();
        let identity_less = system(n, &wide(&a), &vec![1.0; n]);
        let truth = eliminate(n, identity_less, wide(&a), n);
        let narrow = relative(infinite::<f32, _>(&Portable, &a).unwrap().entries(), &truth);
        let double = relative(infinite::<f64, _>(&Portable, &a).unwrap().entries(), &truth);
        assert!(double <= 5e-8, "n = {n}: {double:e}");
        assert!(narrow <= 1e-6 / (1.0 - f64::from(rho)), "n = {n}: {narrow:e}");
        // G = F (I - R F)^-1, whose A G is symmetric and R G = M.
        let g = gather::<f64, _>(&Portable, &f, &albedo).unwrap();
        let flipped: Vec<f64> = system(n, &wide(&f), &albedo);
        let inverse = eliminate(n, flipped, (0..n * n).map(|k| f64::from(k / n == k % n)).collect(), n);
        let truth = support::product(n, &wide(&f), &inverse);
        assert!(relative(g.entries(), &truth) <= 5e-8);
        for i in 0..n {
            for j in 0..i {
                let (ij, ji) = (areas[i] * g.row(i)[j], areas[j] * g.row(j)[i]);
                assert!((ij - ji).abs() <= 2e-6 * ij.abs().max(ji.abs()) / (1.0 - rho), "{ij} {ji}");
            }
        }
    }
}

#[test]
fn elimination_pivots() {
    // Zero on the diagonal, and a tiny pivot that must not be taken.
    for m in [[0.0, 1.0, 2.0, 0.0], [1e-30, 1.0, 1.0, 1.0]] {
        let lu = Lu::<f64>::factor(&Portable, 2, m.to_vec()).unwrap();
        let mut x = vec![1.0, 2.0];
        lu.solve_in_place(&Portable, &mut x, 1).unwrap();
        let truth = eliminate(2, m.to_vec(), vec![1.0, 2.0], 1);
        assert!((x[0] - truth[0]).abs() + (x[1] - truth[1]).abs() <= 1e-14);
    }
    // Random matrices of several panels, not diagonally dominant at all.
    for n in [5, 64, 130, 200] {
        let m: Vec<f64> = Random(n as u64).signed(n * n).iter().map(|x| f64::from(*x)).collect();
        let b: Vec<f64> = Random(7).signed(n * 3).iter().map(|x| f64::from(*x)).collect();
        let lu = Lu::<f64>::factor(&Portable, n, m.clone()).unwrap();
        let mut x = b.clone();
        lu.solve_in_place(&Portable, &mut x, 3).unwrap();
        for i in 0..n {
            for c in 0..3 {
                let row: f64 = (0..n).map(|j| m[i * n + j] * x[j * 3 + c]).sum();
                assert!((row - b[i * 3 + c]).abs() <= 1e-10, "n = {n}");
            }
        }
        assert!(lu.solve_in_place(&Portable, &mut x, 2).is_err());
    }
    let singular = Lu::<f32>::factor(&Portable, 3, vec![1.0, 2.0, 3.0, 2.0, 4.0, 6.0, 0.0, 0.0, 1.0]);
    assert_eq!(singular.unwrap_err(), SolveError::Singular { column: 1 });
    let infinite = Lu::<f32>::factor(&Portable, 1, vec![f32::INFINITY]);
    assert_eq!(infinite.unwrap_err(), SolveError::Singular { column: 0 });
    assert!(Lu::<f32>::factor(&Portable, 2, vec![1.0; 3]).is_err());
    assert!(Lu::<f32>::factor(&Portable, 0, vec![]).is_ok());
}

/// The quotients enclose the spectral radius: known for a cycle, for a triangle of zeros and for a closed scene.
#[test]
fn contraction_encloses_the_spectral_radius() {
    let c = contraction(&Dense::try_new(2, vec![0.0, 4.0, 0.2, 0.0]).unwrap()).unwrap();
    assert!(c.low <= 0.8_f64.sqrt() + 1e-6 && c.high >= 0.8_f64.sqrt() - 1e-6 && c.proved(), "{c:?}");
    // A row sum of 4 and yet it contracts; the bound of the error must hold in those weights.
    assert!(c.error_bound([1.0, 0.0].into_iter()) >= 1.0 / (1.0 - 0.8));
    let c = contraction(&Dense::try_new(2, vec![0.0, 100.0, 0.0, 0.0]).unwrap()).unwrap();
    assert!(c.proved() && c.low <= 1e-12, "{c:?}");
    let c = contraction(&closed(50, 1).0.reflecting(&[0.75; 50]).unwrap()).unwrap();
    assert!((c.high - 0.75).abs() <= 1e-5 && (c.low - 0.75).abs() <= 1e-5, "{c:?}");
    let c = contraction(&Dense::try_new(2, vec![0.0, -4.0, 0.3, 0.0]).unwrap()).unwrap();
    assert!(!c.proved() && c.low >= 1.0, "{c:?}");
    assert_eq!(c.error_bound([0.0].into_iter()), f64::INFINITY);
    let c = contraction(&Dense::try_new(0, vec![]).unwrap()).unwrap();
    assert!(c.proved());
}

#[test]
fn what_has_no_solution_is_an_error_with_its_numbers() {
    let (f, areas) = closed(20, 1);
    let (albedo, b0) = (vec![[0.5_f32]; 20], vec![[1.0_f32]; 20]);
    let run = |albedo: &[[f32; 1]], b0: &[[f32; 1]], settings| {
        solve(&ConjugateGradients, &f, &areas, albedo, b0, settings)
    };
    // White: nothing is absorbed.
    let e = run(&[[1.01]; 20], &b0, Settings::default()).unwrap_err();
    assert!(matches!(e, SolveError::NotContracting { low, high } if low >= 1.0 && high >= low), "{e}");
    let e = infinite::<f32, _>(&Portable, &f.reflecting(&[1.01; 20]).unwrap()).unwrap_err();
    assert!(matches!(e, SolveError::NotContracting { .. }), "{e}");
    let e = gather::<f32, _>(&Portable, &f, &[1.01; 20]).unwrap_err();
    assert!(matches!(e, SolveError::NotContracting { .. }), "{e}");
    assert!(matches!(gather::<f32, _>(&Portable, &f, &[-0.1; 20]), Err(SolveError::BadValue { .. })));
    let mut bad = albedo.clone();
    bad[7] = [-0.5];
    let e = run(&bad, &b0, Settings::default()).unwrap_err();
    assert_eq!(e, SolveError::BadValue { slice: "albedo", patch: 7, value: -0.5 });
    bad[7] = [f32::NAN];
    assert!(matches!(run(&bad, &b0, Settings::default()), Err(SolveError::BadValue { patch: 7, .. })));
    let mut dark = b0.clone();
    dark[3] = [f32::INFINITY];
    let e = run(&albedo, &dark, Settings::default()).unwrap_err();
    assert_eq!(e, SolveError::BadValue { slice: "radiosity", patch: 3, value: f32::INFINITY });
    let e = run(&albedo[1..], &b0, Settings::default()).unwrap_err();
    let expected = OperatorError::WrongLength { slice: "albedo", found: 19, expected: 20 };
    assert_eq!(e, SolveError::Operator(expected));
    let e = run(&albedo, &b0, Settings { max_passes: 2, ..Settings::default() }).unwrap_err();
    assert!(matches!(e, SolveError::PassLimit { passes, bound } if passes <= 3 && bound > 0.0), "{e}");
    // A tolerance below what f64 can prove.
    let e = run(&albedo, &b0, Settings { tolerance: 1e-18, ..Settings::default() }).unwrap_err();
    assert!(matches!(e, SolveError::Stalled { bound, .. } if bound < 1e-12), "{e}");
    let e = solve(&Jacobi, &f, &areas[1..], &albedo, &b0, Settings::default()).unwrap_err();
    assert!(matches!(e, SolveError::Operator(OperatorError::WrongLength { slice: "areas", .. })), "{e}");
    assert!(!e.to_string().is_empty());
    // Darkness, no patches, and black surfaces are answers.
    let s = run(&albedo, &[[0.0]; 20], Settings::default()).unwrap();
    assert!(s.radiosity.iter().all(|x| x[0] == 0.0) && s.bound[0] == 0.0);
    let none = Dense::try_new(0, vec![]).unwrap();
    assert!(solve::<_, _, 3>(&ConjugateGradients, &none, &[], &[], &[], Settings::default()).is_ok());
    let s = run(&[[0.0]; 20], &b0, Settings::default()).unwrap();
    assert_eq!(s.radiosity, b0);
}

/// Wrong areas make the symmetric form wrong: the result is right all the same, or an error.
#[test]
fn conjugate_gradients_do_not_trust_reciprocity() {
    let (f, _, albedo, b0) = scene(40, 9, 0.3, 0.7);
    let mut random = Random(3);
    let wrong: Vec<f32> = random.vector(40).iter().map(|x| x + 0.01).collect();
    match solve(&ConjugateGradients, &f, &wrong, &albedo, &b0, Settings::default()) {
        Ok(s) => check("wrong areas", &s, &f, &albedo, &b0),
        Err(e) => assert!(matches!(e, SolveError::Stalled { .. } | SolveError::PassLimit { .. }), "{e}"),
    }
    // A cyclic operator, as far from symmetric as can be.
    let mut entries = vec![0.0_f32; 100];
    (0..10).for_each(|i| entries[i * 10 + (i + 1) % 10] = 1.0);
    let cycle = Dense::try_new(10, entries).unwrap();
    let (albedo, b0): (Vec<[f32; 1]>, Vec<[f32; 1]>) =
        (vec![[0.9]; 10], (0..10).map(|i| [i as f32]).collect());
    for outcome in [
        solve(&ConjugateGradients, &cycle, &[1.0; 10], &albedo, &b0, Settings::default()),
        solve(&GaussSeidel, &cycle, &[1.0; 10], &albedo, &b0, Settings::default()),
        solve(&Jacobi, &cycle, &[1.0; 10], &albedo, &b0, Settings::default()),
    ] {
        match outcome {
            Ok(s) => check("cycle", &s, &cycle, &albedo, &b0),
            Err(e) => assert!(matches!(e, SolveError::Stalled { .. } | SolveError::PassLimit { .. }), "{e}"),
        }
    }
}

/// An inner solver that does nothing must not pass for one that works.
struct Lazy;

impl<O: LinearOperator + ?Sized> Inner<O> for Lazy {
    fn correct<const C: usize>(
        &self,
        _: &etendue_core::radiosity::polynomial::Residual<'_, O, C>,
        _: &mut [[f32; C]],
    ) -> Result<u32, OperatorError> {
        Ok(1)
    }
}

#[test]
fn a_lazy_inner_solver_is_found_out() {
    let (f, areas, albedo, b0) = scene(20, 2, 0.3, 0.7);
    let e = solve(&Lazy, &f, &areas, &albedo, &b0, Settings::default()).unwrap_err();
    assert!(matches!(e, SolveError::Stalled { .. }), "{e}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, rng_seed: proptest::test_runner::RngSeed::Fixed(2), ..ProptestConfig::default() })]

    /// Light in, light out: in a closed scene what is absorbed, sum A E (1 - rho) with E = F B, is what B0 sends.
    #[test]
    fn energy_is_conserved(n in 2_usize..60, seed in any::<u32>(), rho in 0.0_f32..0.99) {
        let (f, areas) = closed(n, u64::from(seed));
        let mut random = Random(u64::from(seed) + 1);
        let albedo: Vec<[f32; 1]> = (0..n).map(|_| [rho * random.unit() as f32]).collect();
        let b0: Vec<[f32; 1]> = (0..n).map(|_| [random.unit() as f32]).collect();
        let s = solve(&ConjugateGradients, &f, &areas, &albedo, &b0, Settings::default()).unwrap();
        let b: Vec<f64> = s.radiosity.iter().map(|b| f64::from(b[0])).collect();
        let mut e = vec![0.0; n];
        f.apply_wide(&b, &mut e).unwrap();
        let sum = |g: &dyn Fn(usize) -> f64| (0..n).map(|i| f64::from(areas[i]) * g(i)).sum::<f64>();
        let sent = sum(&|i| f64::from(b0[i][0]));
        let absorbed = sum(&|i| (1.0 - f64::from(albedo[i][0])) * e[i]);
        // Rows of F sum to 1, and A F is symmetric, within rounding of f32.
        prop_assert!((sent - absorbed).abs() <= 3e-5 * sent, "{sent} sent, {absorbed} absorbed");
    }
}
