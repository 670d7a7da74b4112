//! The integer distribution: exact totals, exact picks, exact remainders, against slow definitions.
//!
//! Joint level of the statistical tests of this file: alpha = 0.001, seeds fixed.
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

#[path = "sampling_support.rs"]
mod support;

use etendue_core::sampling::counter::Counter;
use etendue_core::sampling::discrete::{IntegerCdf, TOTAL, WeightError, pick_in, pmf_in};

fn cdf(weights: &[f32]) -> IntegerCdf {
    IntegerCdf::try_new(weights).unwrap_or_else(|e| panic!("{e}"))
}

/// Weights of hard kinds, by name.
fn cases() -> Vec<(&'static str, Vec<f32>)> {
    let g = Counter::new(11);
    let random = |n: u32, f: &dyn Fn(f32) -> f32| (0..n).map(|i| f(g.unit(0, i, n))).collect::<Vec<f32>>();
    vec![
        ("one", vec![3.0]),
        ("one among zeros", vec![0.0, 0.0, 1e-30, 0.0]),
        ("equal", vec![1.0; 3]),
        ("many equal", vec![1.0; 100_003]),
        ("two, far apart", vec![f32::MAX, f32::from_bits(1)]),
        ("subnormal", vec![f32::from_bits(1), f32::from_bits(3), 0.0]),
        ("huge", vec![f32::MAX; 7]),
        ("powers of two", (-120..120).map(|e| 2.0_f64.powi(e) as f32).collect()),
        ("powers of two, falling", (-120..120).rev().map(|e| 2.0_f64.powi(e) as f32).collect()),
        ("uniform", random(1000, &|u| u)),
        ("half zero", random(1000, &|u| (u - 0.5).max(0.0))),
        ("heavy tail", random(5000, &|u| 1.0 / (u + 1e-7).powi(3))),
        ("many", random(1 << 18, &|u| u * u)),
        ("many, 60 decades", random(1 << 18, &|u| 10.0_f64.powf(f64::from(u) * 60.0 - 30.0) as f32)),
        (
            "shares about one count",
            (0..20_000).map(|i| if i == 0 { 1.0 } else { (0.5 + i as f32 / 20_000.0) / 4.295e9 }).collect(),
        ),
        ("one heavy, many light", (0..1 << 18).map(|i| if i == 77 { 1e30 } else { 1.0 }).collect()),
    ]
}

#[test]
fn counts_sum_to_the_total_and_follow_the_weights() {
    for (name, weights) in cases() {
        let d = cdf(&weights);
        let counts: Vec<u64> = (0..weights.len() as u32).map(|i| d.count(i)).collect();
        assert_eq!(counts.iter().sum::<u64>(), TOTAL, "{name}");
        for (i, (&c, &w)) in counts.iter().zip(&weights).enumerate() {
            assert_eq!(c == 0, w == 0.0, "{name}: entry {i}");
        }
        // The slow definition: entries below one count get one; repeat for the rest until none is below.
        let mut light: Vec<bool> = weights.iter().map(|_| false).collect();
        let (rate, rest) = loop {
            let lights = light.iter().filter(|&&l| l).count() as f64;
            let sum: f64 = weights.iter().zip(&light).filter(|(_, l)| !**l).map(|(&w, _)| f64::from(w)).sum();
            let rate = (TOTAL as f64 - lights) / sum;
            let before = lights;
            for (l, &w) in light.iter_mut().zip(&weights) {
                *l |= w > 0.0 && f64::from(w) * rate < 1.0 - 1e-12;
            }
            if light.iter().filter(|&&l| l).count() as f64 == before {
                break (rate, TOTAL as f64 - lights);
            }
        };
        for (i, (&c, &w)) in counts.iter().zip(&weights).enumerate() {
            if light[i] {
                assert_eq!(c, 1, "{name}: light entry {i}");
            } else {
                let share = f64::from(w) * rate;
                assert!(
                    (c as f64 - share).abs() <= 1.0 + 1e-9 * rest.sqrt(),
                    "{name}: entry {i}: {c} of {share}"
                );
            }
        }
        // Equal weights differ by at most one count, larger ones never have less.
        let mut order: Vec<usize> = (0..weights.len()).collect();
        order.sort_by(|&a, &b| weights[a].total_cmp(&weights[b]));
        for w in order.windows(2) {
            let (a, b) = (w[0], w[1]);
            assert!(counts[a] <= counts[b] + u64::from(weights[a] == weights[b]), "{name}: {a} and {b}");
        }
    }
}

#[test]
fn picks_and_remainders_are_exact_at_every_edge() {
    for (name, weights) in cases() {
        let d = cdf(&weights);
        let mut start = 0_u64;
        let stride = 1 + weights.len() / 2000;
        for i in 0..weights.len() as u32 {
            let count = d.count(i);
            let end = start + count;
            assert_eq!(d.pmf(i), count as f32 / 4_294_967_296.0, "{name}");
            if count > 0 && (i as usize).is_multiple_of(stride) {
                for x in [start, start + count / 3, end - 1] {
                    let p = d.pick(x as u32);
                    assert_eq!((p.index, p.pmf), (i, d.pmf(i)), "{name}: word {x}");
                    assert!(p.pmf > 0.0);
                    assert_eq!(
                        u128::from(p.remainder),
                        (u128::from(x - start) << 32) / u128::from(count),
                        "{name}: word {x}"
                    );
                }
            }
            start = end;
        }
        assert_eq!(start, TOTAL);
        assert_eq!(d.pmf(weights.len() as u32), 0.0);
        assert_eq!(d.len(), weights.len());
        assert!(!d.is_empty());
        assert_eq!(pick_in(d.cumulative(), 12345), d.pick(12345));
        assert_eq!(pmf_in(d.cumulative(), 0), d.pmf(0));
    }
}

#[test]
fn a_certain_entry_keeps_the_whole_word() {
    let d = cdf(&[0.0, 2.0, 0.0]);
    assert_eq!(d.cumulative(), &[0, 0]);
    for x in [0, 1, 77, u32::MAX] {
        let p = d.pick(x);
        assert_eq!((p.index, p.pmf, p.remainder), (1, 1.0, x));
    }
    assert_eq!(d.count(1), TOTAL);
}

#[test]
fn scale_and_precision_do_not_matter() {
    let weights = [1.0_f32, 2.5, 0.0, 1e-6, 7.0];
    let scaled: Vec<f32> = weights.iter().map(|w| w * 2.0_f32.powi(-90)).collect();
    let wide: Vec<f64> = weights.iter().map(|&w| f64::from(w) * 2.0_f64.powi(1000)).collect();
    assert_eq!(cdf(&weights), cdf(&scaled));
    assert_eq!(IntegerCdf::try_new_f64(&wide), Ok(cdf(&weights)));
    assert!(IntegerCdf::try_new_f64(&[f64::MAX, f64::MAX, f64::from_bits(1)]).is_ok());
}

#[test]
fn bad_weights_are_named() {
    assert_eq!(IntegerCdf::try_new(&[]), Err(WeightError::Empty));
    assert_eq!(IntegerCdf::try_new(&[0.0, 0.0]), Err(WeightError::AllZero { len: 2 }));
    assert_eq!(IntegerCdf::try_new(&[1.0, -2.0]), Err(WeightError::Invalid { index: 1, weight: -2.0 }));
    assert_eq!(
        IntegerCdf::try_new(&[f32::INFINITY]),
        Err(WeightError::Invalid { index: 0, weight: f64::INFINITY })
    );
    let nan = IntegerCdf::try_new(&[1.0, 1.0, f32::NAN]);
    assert!(matches!(nan, Err(WeightError::Invalid { index: 2, weight }) if weight.is_nan()), "{nan:?}");
    assert_eq!(IntegerCdf::try_new(&[-0.0, 1.0]).map(|d| d.count(0)), Ok(0));
    assert_eq!(
        WeightError::Invalid { index: 1, weight: -2.0 }.to_string(),
        "weight 1 is -2, not finite and >= 0"
    );
}

#[test]
fn malformed_runs_are_total() {
    assert_eq!(pick_in(&[], 9).pmf, 0.0);
    for run in [&[5_u32, 3, 9][..], &[u32::MAX], &[0, u32::MAX, 0]] {
        for x in [0, 4, u32::MAX] {
            let p = pick_in(run, x);
            assert!((p.index as usize) < run.len() && p.pmf > 0.0 && p.pmf <= 1.0);
            assert!(pmf_in(run, p.index) >= 0.0);
        }
    }
}

#[test]
fn random_words_pick_in_proportion() {
    let weights: Vec<f32> = (0..200).map(|i| ((i * 37) % 100) as f32).collect();
    let (d, g, n) = (cdf(&weights), Counter::new(5), 1 << 20);
    let mut seen = vec![0_u64; weights.len()];
    let mut low = vec![0_u64; 256];
    for i in 0..n {
        let p = d.pick(g.bits(1, i, 0));
        seen[p.index as usize] += 1;
        low[(p.remainder >> 24) as usize] += 1;
    }
    let total: f64 = weights.iter().map(|&w| f64::from(w)).sum();
    let used: Vec<usize> = (0..weights.len()).filter(|&i| weights[i] > 0.0).collect();
    let expected: Vec<f64> = used.iter().map(|&i| f64::from(weights[i]) / total * f64::from(n)).collect();
    let observed: Vec<u64> = used.iter().map(|&i| seen[i]).collect();
    let level = support::sidak(0.001, 2);
    support::assert_random(support::chi2_p(&observed, &expected), level, "entries");
    support::assert_random(support::chi2_uniform_p(&low), level, "remainders");
    assert_eq!(observed.iter().sum::<u64>(), u64::from(n));
}

/// Quotient of a 64-bit by a 32-bit number (high word less than the divisor) with 32-bit operations alone, as a shader forms remainders:
/// two steps of schoolbook division in base 2^16 (D. E. Knuth, TAOCP 2, algorithm 4.3.1 D).
fn divide_wide(high: u32, low: u32, divisor: u32) -> u32 {
    let shift = divisor.leading_zeros();
    let d = divisor << shift;
    let (d1, d0) = (d >> 16, d & 0xFFFF);
    let high = if shift == 0 { high } else { (high << shift) | (low >> (32 - shift)) };
    let low = low << shift;
    let step = |top: u32, next: u32| {
        let (mut q, mut r) = (top / d1, top % d1);
        while q > 0xFFFF || q * d0 > ((r << 16) | next) {
            q -= 1;
            r += d1;
            if r > 0xFFFF {
                break;
            }
        }
        (q, (top << 16).wrapping_add(next).wrapping_sub(q.wrapping_mul(d)))
    };
    let (q1, rest) = step(high, low >> 16);
    let (q0, _) = step(rest, low & 0xFFFF);
    (q1 << 16) | q0
}

#[test]
fn remainders_need_no_64_bit_integers() {
    let g = Counter::new(3);
    for i in 0..200_000 {
        let [a, b, c, _] = g.bits4(0, i, 0);
        let count = (a >> (c & 31)).max(1);
        let offset = b % count;
        assert_eq!(
            u64::from(divide_wide(offset, 0, count)),
            (u64::from(offset) << 32) / u64::from(count),
            "{offset} of {count}"
        );
    }
}
