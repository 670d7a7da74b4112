//! The distribution of the linear-triangle samplers, their densities and inverses, and that nothing breaks them.
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

#[path = "sampling_support.rs"]
mod statistics;
#[path = "linear_triangle_support.rs"]
mod support;

use etendue_core::sampling::linear_triangle::{
    Cardano, Dirichlet, LinearTriangle, invert, pdf, sample, sample_slice,
};
use proptest::prelude::*;
use statistics::{assert_random, chi2_p, sidak};
use support::{Random, hard_unit, hard_weights};

/// Cells along an edge: the triangle is cut into SIDE^2 equal ones.
const SIDE: usize = 8;
/// Joint level of all chi-square tests of one test function.
const ALPHA: f64 = 1e-3;

/// The cell of a point, and the probability of each cell: the density is linear, so that a cell's mean is that of its centroid.
fn cell(b: [f32; 3]) -> usize {
    let at = |x: f32| ((x * SIDE as f32) as usize).min(SIDE - 1);
    let (i, j) = (at(b[0]), at(b[1]));
    let up = (f64::from(b[0]) * SIDE as f64 - i as f64) + (f64::from(b[1]) * SIDE as f64 - j as f64) <= 1.0;
    2 * (i * SIDE + j) + usize::from(!up)
}

fn expected(w: [f32; 3], n: u64) -> Vec<f64> {
    let w = support::scaled(w);
    let sum: f64 = w.iter().sum();
    let mut out = vec![0.0; 2 * SIDE * SIDE];
    for i in 0..SIDE {
        for j in 0..SIDE - i {
            for (up, third) in [(true, 1.0 / 3.0), (false, 2.0 / 3.0)] {
                if !up && i + j + 2 > SIDE {
                    continue;
                }
                let b0 = (i as f64 + third) / SIDE as f64;
                let b1 = (j as f64 + third) / SIDE as f64;
                let density = 3.0 * (w[0] * b0 + w[1] * b1 + w[2] * (1.0 - b0 - b1)) / sum;
                out[2 * (i * SIDE + j) + usize::from(!up)] = n as f64 * density / (SIDE * SIDE) as f64;
            }
        }
    }
    out
}

/// 200 triples: flat, alone, with zeros, with ratios, any.
fn triples() -> Vec<[f32; 3]> {
    let mut r = Random(77);
    let mut list = vec![
        [1.0; 3],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 1.0, 1.0],
        [1e-30, 1.0, 1e-30],
    ];
    list.resize_with(200, || hard_weights(&mut r));
    list
}

fn chi_square(points: impl Fn(&mut Random, [f32; 3]) -> [f32; 3], n: u64) {
    let triples = triples();
    let level = sidak(ALPHA, 2 * triples.len());
    for (seed, w) in triples.into_iter().enumerate() {
        let mut r = Random(1000 + seed as u64);
        let mut counts = vec![0; 2 * SIDE * SIDE];
        for _ in 0..n {
            counts[cell(points(&mut r, w))] += 1;
        }
        assert_random(chi2_p(&counts, &expected(w, n)), level, &format!("{w:?}"));
    }
}

#[test]
fn robust_samples_have_the_density() {
    chi_square(|r, w| sample(w, [r.unit(), r.unit()]), 1 << 13);
}

#[test]
fn the_mixture_has_it_too() {
    chi_square(|r, w| Dirichlet.sample(w, [r.unit(), r.unit()]), 1 << 13);
}

/// The same statistics see a density that is off by a little: a quarter more of one weight.
#[test]
fn the_statistics_have_teeth() {
    let w = [0.5, 1.0, 0.7];
    let n = 1 << 17;
    let mut r = Random(5);
    let mut counts = vec![0; 2 * SIDE * SIDE];
    for _ in 0..n {
        counts[cell(sample([w[0] * 1.25, w[1], w[2]], [r.unit(), r.unit()]))] += 1;
    }
    assert!(chi2_p(&counts, &expected(w, n)) < sidak(ALPHA, 400));
}

#[test]
fn densities_agree_and_integrate_to_one() {
    let mut r = Random(3);
    for w in triples() {
        let scaled = support::scaled(w);
        let sum: f64 = scaled.iter().sum();
        for _ in 0..200 {
            let b = sample(w, [hard_unit(&mut r), hard_unit(&mut r)]);
            let truth = 3.0 * (0..3).map(|i| scaled[i] * f64::from(b[i])).sum::<f64>() / sum;
            let p = f64::from(pdf(w, b));
            assert!(
                (p - truth).abs() <= 5.0 * truth * f64::from(f32::EPSILON) / 2.0,
                "{w:?} {b:?}: {p} {truth}"
            );
            let m = f64::from(Dirichlet.pdf(w, b));
            assert!((m - truth).abs() <= 1e-6 * truth, "{w:?} {b:?}: {m} {truth}");
        }
        // A linear function's mean over the triangle is that of the edge midpoints.
        let mean = [[0.5, 0.5, 0.0], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5]]
            .map(|b| f64::from(pdf(w, b)))
            .iter()
            .sum::<f64>()
            / 3.0;
        assert!((mean - 1.0).abs() <= 1e-6, "{w:?}: {mean}");
    }
    assert_eq!(pdf([1.0; 3], [0.2, 0.3, 0.5]), 1.0);
    assert_eq!(Cardano.pdf([1.0; 3], [0.25, 0.25, 0.5]), 1.0);
}

/// What [`invert`] states: units of 2^-24, and the first number's relative error in units of 2^-23.
const ROUND_TRIP: f64 = 4.0;
const ROUND_TRIP_RELATIVE: f64 = 8.0;

#[test]
fn the_inverse_returns_the_random_numbers() {
    let mut r = Random(9);
    let (mut worst, mut relative) = ([0.0_f64; 2], 0.0_f64);
    for _ in 0..200_000 {
        let (w, u) = (hard_weights(&mut r), [hard_unit(&mut r), hard_unit(&mut r)]);
        let b = sample(w, u);
        let back = invert(w, b);
        assert!(back.iter().all(|x| (0.0..1.0).contains(x)), "{w:?} {u:?}: {back:?}");
        worst[0] = worst[0].max(f64::from((back[0] - u[0]).abs()) * 16_777_216.0);
        // Where the distance is subnormal, so are the barycentrics, and their quotient is anything.
        if b.iter().filter(|x| **x > 1e-30).count() >= 2 {
            worst[1] = worst[1].max(f64::from((back[1] - u[1]).abs()) * 16_777_216.0);
        }
        if u[0] > 1e-30 {
            relative = relative.max(f64::from((back[0] - u[0]).abs() / u[0]) * 8_388_608.0);
        }
    }
    println!("round trip: {worst:?} of 2^-24, relative {relative} of 2^-23");
    assert!(worst[0] <= ROUND_TRIP && worst[1] <= ROUND_TRIP, "{worst:?}");
    assert!(relative <= ROUND_TRIP_RELATIVE, "{relative}");
}

#[test]
fn slices_have_the_bits_of_single_samples() {
    let mut r = Random(11);
    for n in [0, 1, 63, 64, 65, 1000] {
        let w: Vec<_> = (0..n).map(|_| hard_weights(&mut r)).collect();
        let u: Vec<_> = (0..n).map(|_| [hard_unit(&mut r), hard_unit(&mut r)]).collect();
        let mut out = vec![[-1.0; 3]; n + 1];
        assert_eq!(sample_slice(&w, &u, &mut out), n);
        for i in 0..n {
            assert_eq!(
                out[i].map(f32::to_bits),
                sample(w[i], u[i]).map(f32::to_bits),
                "{:?} {:?}",
                w[i],
                u[i]
            );
        }
        assert_eq!(out[n], [-1.0; 3], "what is beyond the shortest slice stays");
    }
}

#[test]
fn the_lightest_vertex_is_the_apex_even_where_scaling_makes_two_equal() {
    // Scaled by 2^-127 both small weights are 0; a sample at u = 0 lies at the lightest vertex as given.
    assert_eq!(sample([1e-10, 3e38, 5e-11], [0.0, 0.3]), [0.0, 0.0, 1.0]);
    assert_eq!(sample([3e38, 5e-11, 1e-10], [0.0, 0.3]), [0.0, 1.0, 0.0]);
    assert_eq!(sample([1e-40, 3e38, 2e-40], [0.0, 0.3]), [1.0, 0.0, 0.0]);
}

#[test]
fn degenerate_input_has_its_documented_value() {
    let u = [0.3, 0.6];
    assert_eq!(sample([0.0; 3], u), sample([1.0; 3], u));
    assert_eq!(sample([-1.0, f32::NAN, 2.0], u), sample([0.0, 0.0, 2.0], u));
    assert_eq!(sample([f32::INFINITY, 1.0, 0.0], u), sample([f32::MAX, 1.0, 0.0], u));
    assert_eq!(sample([1.0; 3], [f32::NAN, 7.0]), sample([1.0; 3], [0.0, 1.0]));
    assert_eq!(sample([2.0, 1.0, 3.0], [0.0, 0.9]), [0.0, 1.0, 0.0]);
    assert_eq!(pdf([1.0; 3], [-0.1, 0.6, 0.5]), 0.0);
    assert_eq!(pdf([1.0; 3], [f32::NAN, 0.6, 0.5]), 0.0);
    assert_eq!(invert([2.0, 1.0, 3.0], [0.0, 1.0, 0.0]), [0.0, 0.0]);
}

proptest! {
    #[test]
    fn any_bits_give_a_point(w in prop::array::uniform3(any::<u32>()), u in prop::array::uniform2(any::<u32>())) {
        let (w, u) = (w.map(f32::from_bits), u.map(f32::from_bits));
        let b = sample(w, u);
        prop_assert!(b.iter().all(|x| (0.0..=1.0).contains(x)), "{:?}", b);
        let sum: f64 = b.iter().map(|x| f64::from(*x)).sum();
        prop_assert!((sum - 1.0).abs() <= 1.0 / 8_388_608.0, "{:?} sums to {}", b, sum);
        let p = pdf(w, b);
        prop_assert!((0.0..=3.000_001).contains(&p), "{}", p);
        prop_assert!(invert(w, b).iter().all(|x| (0.0..1.0).contains(x)));
        let raw = [u[0], u[1], w[0]];
        prop_assert!(!pdf(w, raw).is_nan());
        prop_assert!(invert(w, raw).iter().all(|x| (0.0..1.0).contains(x)));
    }
}
