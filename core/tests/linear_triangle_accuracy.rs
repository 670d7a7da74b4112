//! The inversion of the cubic against f64, over the inputs that break the published form; the published form beside it.
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

#[path = "linear_triangle_support.rs"]
mod support;

use etendue_core::sampling::linear_triangle::{Cardano, LinearTriangle, apex_distance, sample};
use support::{Random, distance, hard_unit, hard_weights, scaled};

/// Units of the stated errors.
const UNIT: f64 = 1.0 / 8_388_608.0;

#[derive(Default, Debug)]
struct Worst {
    distance: f64,
    complement: f64,
    other_barycentrics: f64,
    sum: f64,
    cardano_distance: f64,
    cardano_complement: f64,
    cardano_nan: u64,
}

/// Relative error in units of 2^-23; NaN is infinite.
fn relative(x: f64, truth: f64) -> f64 {
    if x == truth {
        return 0.0;
    }
    let e = (x - truth).abs() / truth.abs() / UNIT;
    if e.is_nan() { f64::INFINITY } else { e }
}

fn measure(seed: u64, count: u64) -> Worst {
    let mut r = Random(seed);
    let mut worst = Worst::default();
    for _ in 0..count {
        let (w, u) = (hard_weights(&mut r), [hard_unit(&mut r), hard_unit(&mut r)]);
        let found = apex_distance(w, u[0]);
        let (apex, s, c) = (found.apex, found.distance, found.complement);
        let v = scaled(w);
        let [w0, w1, w2] = [0, 1, 2].map(|i| v[(apex + i) % 3]);
        assert!(w0 <= w1 && w0 <= w2, "{w:?}: vertex {apex} is not the lightest");
        let xi = f64::from(u[0]);
        let [ts, tc] = distance(w0, [w1, w2], xi);
        worst.distance = worst.distance.max(relative(f64::from(s), ts));
        worst.complement = worst.complement.max(relative(f64::from(c), tc));

        let (b, truth) = (sample(w, u), support::sample(w, u));
        for i in 0..3 {
            // Below 2^-126 a float has no relative accuracy.
            if truth[i] > 1.2e-38 && i != apex {
                worst.other_barycentrics = worst.other_barycentrics.max(relative(f64::from(b[i]), truth[i]));
            }
        }
        let sum = b.iter().map(|x| f64::from(*x)).sum::<f64>();
        worst.sum = worst.sum.max((sum - 1.0).abs() / UNIT);

        let x = Cardano.sample(w, u)[1];
        if x.is_nan() {
            worst.cardano_nan += 1;
        } else {
            let [tx, tw] =
                [distance(v[1], [v[0], v[2]], 1.0 - xi)[1], distance(v[1], [v[0], v[2]], 1.0 - xi)[0]];
            worst.cardano_distance = worst.cardano_distance.max(relative(f64::from(x), tx));
            worst.cardano_complement = worst.cardano_complement.max(relative(1.0 - f64::from(x), tw));
        }
    }
    println!("{count} inputs: {worst:?}, NaN share {:.3}", worst.cardano_nan as f64 / count as f64);
    worst
}

fn hold(worst: &Worst, count: u64) {
    assert!(worst.distance <= 1.0, "{worst:?}");
    assert!(worst.complement <= 1.0, "{worst:?}");
    assert!(worst.other_barycentrics <= 4.0, "{worst:?}");
    assert!(worst.sum <= 1.0, "{worst:?}");
    // The published form fails where it is said to.
    assert!(worst.cardano_nan > count / 50, "{worst:?}");
    assert!(worst.cardano_distance > 1e6, "{worst:?}");
}

#[test]
fn hard_inputs() {
    hold(&measure(1, 100_000), 100_000);
}

#[test]
#[ignore = "minutes: cargo test --release -p etendue-core --test linear_triangle_accuracy -- --ignored --nocapture"]
fn a_hundred_million_hard_inputs() {
    let parts: Vec<Worst> = (0..10).map(|seed| measure(100 + seed, 10_000_000)).collect();
    for worst in parts {
        hold(&worst, 10_000_000);
    }
}
