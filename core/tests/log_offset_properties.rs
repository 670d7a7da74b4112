//! Log/offset maps: round trip, monotony, error bounds, means, fits and refusals.
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use etendue_core::codec::log_offset::{
    ByFormula, Decoding, LogOffset, LogOffsetError, MAX_WIDTH, MIN_WIDTH, Quantiser, Span, mean_at, value_at,
};
use proptest::prelude::*;

/// A width over the whole range, even in its logarithm, and a largest number that leaves room for it.
fn parameters() -> impl Strategy<Value = (f32, f32)> {
    (0.0..1.0_f64, 0.0..1.0_f64).prop_map(|(a, b)| {
        let width = (f64::from(MIN_WIDTH).ln() + a * f64::from(MAX_WIDTH / MIN_WIDTH).ln()).exp() as f32;
        let width = width.clamp(MIN_WIDTH, MAX_WIDTH);
        let low = 2.0_f64.powi(-126).ln() + f64::from(width);
        let high = f64::from(f32::MAX).ln();
        (width, (low + b * (high - low)).exp().min(f64::from(f32::MAX)) as f32)
    })
}

fn decodings(width: f32, max: f32) -> [LogOffset; 4] {
    let plain = LogOffset::try_new(width, max).unwrap();
    let mean = plain.clone().mean_preserving();
    // Numbers of every third cell, not at its middle.
    let some: Vec<f32> = plain.thresholds().iter().step_by(3).flat_map(|t| [*t, t.next_up()]).collect();
    let energy = plain.clone().energy_preserving();
    [plain.clone(), mean, energy, plain.measured(&some)]
}

/// Half a step in the logarithm.
fn half(q: &LogOffset) -> f64 {
    f64::from(q.width()) / 510.0
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_code_comes_back((width, max) in parameters()) {
        for q in decodings(width, max) {
            for code in 0..=255 {
                let x = q.decode(code);
                prop_assert!(x.is_finite() && x >= 0.0 && x <= max);
                prop_assert_eq!(q.encode(x), code, "{:?} {} {}", q.decoding(), width, max);
            }
            prop_assert!(q.values().windows(2).all(|w| w[0] < w[1]));
            prop_assert_eq!(q.decode(0), 0.0);
        }
        prop_assert_eq!(decodings(width, max)[0].decode(255), max);
    }

    #[test]
    fn codes_never_fall((width, max) in parameters(), a in any::<f32>(), b in any::<f32>(), u in 0.0..1.0_f32, v in 0.0..1.0_f32) {
        let q = LogOffset::try_new(width, max).unwrap();
        let f = ByFormula::try_new(width, max).unwrap();
        let inside = |u: f32| (f64::from(max) * (-f64::from(width * u)).exp()) as f32;
        for (a, b) in [(a, b), (inside(u), inside(v)), (inside(u), inside(u).next_up())] {
            let (low, high) = if a <= b { (a, b) } else { (b, a) };
            prop_assert!(q.encode(low) <= q.encode(high));
            prop_assert!(f.encode(low) <= f.encode(high));
        }
    }

    #[test]
    fn decodes_are_within_their_bounds((width, max) in parameters(), u in 0.0..1.0_f64) {
        let [plain, mean, energy, measured] = decodings(width, max);
        let h = half(&plain);
        let x = (f64::from(max) * (-u * f64::from(width) * 509.0 / 510.0).exp()) as f32;
        let x = if x < plain.thresholds()[0] { plain.thresholds()[0] } else { x };
        let x = if x > max { max } else { x };
        let off = |q: &LogOffset| (f64::from(q.decode(q.encode(x))) / f64::from(x)).ln();
        // Of the decoded number only its own rounding comes on top.
        let rounding = 2.0_f64.powi(-24);
        prop_assert!(off(&plain).abs() <= h + rounding);
        prop_assert!(off(&plain).exp_m1().abs() <= h.exp_m1() + 2.0 * rounding);
        prop_assert!(off(&mean).abs() <= h + (h.sinh() / h).ln() + rounding);
        // The same in relative terms.
        prop_assert!(off(&mean).exp_m1().abs() <= h.exp_m1() * (h.sinh() / h) + (h.sinh() / h - 1.0) + 2.0 * rounding);
        prop_assert!(off(&energy).abs() <= h + (h.sinh() / h).ln() + rounding);
        prop_assert!(off(&measured).abs() <= 2.0 * h + rounding);
    }

    #[test]
    fn levels_between_codes_follow_the_formula((width, max) in parameters(), level in 0.0..256.0_f32) {
        let (w, m, l) = (f64::from(width), f64::from(max), f64::from(level.min(255.0)));
        let (step, u) = (w / 255.0, 2.0_f64.powi(-24));
        let a = (l - 255.0) * step;
        let (value, mean) = (f64::from(value_at(width, max, level)), f64::from(mean_at(width, max, level)));
        if level < 0.5 {
            prop_assert!(value == 0.0 && mean == 0.0);
        } else {
            let own = if a < -86.0 { 5.0 } else { 3.0 };
            prop_assert!((value / (m * a.exp()) - 1.0).abs() <= (3.0 * a.abs() + own) * u);
            let (low, high) = ((l - 0.5) * step, (l + 0.5).min(255.0) * step);
            let truth = m * ((high - w).exp() - (low - w).exp()) / (high - low);
            let allowed = (3.0 * (high - w).abs() + 6.0) * u;
            // The difference in f64 loses up to the step.
            prop_assert!((mean / truth - 1.0).abs() <= allowed + 1e-14 / step);
        }
    }

    #[test]
    fn fits_keep_every_number(list in prop::collection::vec(0.0..1.0_f64, 1..200), scale in -60.0..60.0_f64) {
        let values: Vec<f32> = list.iter().map(|u| (scale - 20.0 * u).exp() as f32).collect();
        let span = Span::of(&values).unwrap();
        let q = LogOffset::fitted(&values).unwrap();
        prop_assert_eq!(q.max(), span.max);
        prop_assert_eq!(q.encode(span.max), 255);
        for v in &values {
            prop_assert!(q.encode(*v) > 0);
        }
        // And it is not wider than that needs, but for a few floats.
        let least = (f64::from(span.max) / f64::from(span.min)).ln() * 510.0 / 509.0;
        prop_assert!(f64::from(q.width()) <= (least * (1.0 + 1e-6)).max(f64::from(MIN_WIDTH)));
    }

    #[test]
    fn fits_lose_no_more_than_allowed(list in prop::collection::vec(0.0..1.0_f64, 2..200), share in 0.0..0.5_f32) {
        let values: Vec<f32> = list.iter().map(|u| (-20.0 * u).exp() as f32).collect();
        let q = LogOffset::fitted_losing(&values, share).unwrap();
        let all: f64 = values.iter().map(|v| f64::from(*v)).sum();
        let lost: f64 = values.iter().filter(|v| q.encode(**v) == 0).map(|v| f64::from(*v)).sum();
        prop_assert!(lost <= all * f64::from(share) * (1.0 + 1e-12));
        prop_assert!(q.width() <= LogOffset::fitted(&values).unwrap().width());
    }
}

#[test]
fn means_are_those_of_an_even_spread() {
    for (width, max) in [(25.0, 1.0), (11.5, 0.218), (MIN_WIDTH, 3.0), (MAX_WIDTH, f32::MAX), (90.0, 1e9)] {
        let q = LogOffset::try_new(width, max).unwrap().mean_preserving();
        assert_eq!(q.decoding(), Decoding::MeanPreserving);
        for code in 1..=255 {
            // Midpoints in the logarithm over the cell, of which 255 has the lower half only.
            let n = 2000;
            let (low, high) = (f64::from(code) - 0.5, (f64::from(code) + 0.5).min(255.0));
            let sum: f64 = (0..n)
                .map(|i| {
                    let level = low + (high - low) * (f64::from(i) + 0.5) / f64::from(n);
                    (f64::from(width) * (level - 255.0) / 255.0).exp()
                })
                .sum();
            let truth = f64::from(max) * sum / f64::from(n);
            let error = f64::from(q.decode(code)) / truth - 1.0;
            // Rounded once (2^-24); the midpoint rule's own error is d^2 / 24 n^2 < 6e-9.
            assert!(error.abs() <= 6.0e-8 + 6.0e-9, "width {width}, code {code}: {error:e}");
        }
    }
}

/// Random numbers whose logarithm is spread evenly over whole cells. In a cell of density 1/x the mean of x over the
/// decode is 1 for the mean-preserving one; weighted by 1/x (density 1/x^2) the mean of the decode over x is 1 for the energy-preserving one.
///
/// n = 400 000, alpha = 1e-6 for six tests together (Sidak: 1.7e-7 each, two-sided 5.23 sigma).
#[test]
fn each_decode_keeps_the_mean_of_its_spread() {
    let (width, n) = (100.0_f32, 400_000_u32);
    let plain = LogOffset::try_new(width, 1e20).unwrap();
    let maps = [plain.clone(), plain.clone().mean_preserving(), plain.clone().energy_preserving()];
    let (h, mut state) = (half(&plain), 99_u64);
    let s = h.sinh() / h;
    let (mut sums, mut squares) = ([[0.0; 2]; 3], [[0.0; 2]; 3]);
    for _ in 0..n {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        // Whole cells: from the upper end of code 0 to the upper end of code 254.
        let level = 0.5 + 254.0 * ((state >> 11) as f64 * 2.0_f64.powi(-53));
        let x = (1e20 * (f64::from(width) * (level - 255.0) / 255.0).exp()) as f32;
        for (k, q) in maps.iter().enumerate() {
            let ratio = f64::from(x) / f64::from(q.decode(q.encode(x)));
            for (j, r) in [ratio, 1.0 / ratio].into_iter().enumerate() {
                sums[k][j] += r;
                squares[k][j] += r * r;
            }
        }
    }
    let n = f64::from(n);
    for (k, expected) in [[s, s], [1.0, s * s], [s * s, 1.0]].into_iter().enumerate() {
        for (j, expected) in expected.into_iter().enumerate() {
            let average = sums[k][j] / n;
            let sigma = ((squares[k][j] / n - average * average) / n).sqrt();
            assert!(
                (average - expected).abs() <= 5.23 * sigma,
                "{k} {j}: {average} +- {sigma}, not {expected}"
            );
            // The test can tell them apart.
            assert!(s - 1.0 >= 20.0 * sigma);
        }
    }
}

#[test]
fn energy_means_are_the_middle_over_the_mean_of_the_exponential() {
    for (width, max) in [(25.0_f32, 1.0_f32), (11.5, 0.218), (MIN_WIDTH, 3.0), (MAX_WIDTH, f32::MAX)] {
        let q = LogOffset::try_new(width, max).unwrap().energy_preserving();
        assert_eq!((q.decoding(), q.decode(255), q.decode(0)), (Decoding::EnergyPreserving, max, 0.0));
        let h = half(&q);
        for code in 1..255_u8 {
            let middle = f64::from(max) * (f64::from(width) * (f64::from(code) - 255.0) / 255.0).exp();
            let error = f64::from(q.decode(code)) / (middle * h / h.sinh()) - 1.0;
            assert!(error.abs() <= 6.0e-8, "width {width}, code {code}: {error:e}");
        }
    }
}

#[test]
fn measured_decodes_keep_the_sum() {
    let values: Vec<f32> =
        (0..50_000).map(|i| (-(f64::from(i) * 0.618_034).fract() * 9.0).exp() as f32).collect();
    let plain = LogOffset::fitted(&values).unwrap();
    let sum = |q: &LogOffset| values.iter().map(|v| f64::from(q.decode(q.encode(*v)))).sum::<f64>();
    let square = |q: &LogOffset| {
        values.iter().map(|v| (f64::from(q.decode(q.encode(*v))) - f64::from(*v)).powi(2)).sum::<f64>()
    };
    let truth: f64 = values.iter().map(|v| f64::from(*v)).sum();
    let measured = plain.clone().measured(&values);
    assert!((sum(&measured) / truth - 1.0).abs() <= 2.0_f64.powi(-24), "{}", sum(&measured) / truth);
    assert!(
        square(&measured) <= square(&plain) && square(&measured) <= square(&plain.clone().mean_preserving())
    );
    // Codes without numbers keep theirs; infinities and NaN change nothing.
    let few = plain.clone().mean_preserving().measured(&[
        f32::INFINITY,
        f32::NAN,
        f32::NEG_INFINITY,
        -1.0,
        plain.max(),
    ]);
    let mean = plain.clone().mean_preserving();
    assert_eq!(few.values()[..255], mean.values()[..255]);
    assert_eq!(few.values()[255], plain.max());
}

#[test]
fn a_matrix_of_zeros_decodes_to_zeros() {
    for q in [
        LogOffset::published(0.0).unwrap(),
        LogOffset::published(-0.0).unwrap().mean_preserving(),
        LogOffset::fitted(&[]).unwrap(),
        LogOffset::fitted(&[0.0, -0.0, -1.0]).unwrap().measured(&[0.0, 1.0, f32::MAX]),
        LogOffset::fitted_losing(&[0.0], 0.5).unwrap(),
    ] {
        assert!(q.values().iter().all(|v| *v == 0.0), "{:?}", q.decoding());
        for x in [0.0, 1.0, 1e30, f32::MAX, f32::INFINITY, f32::NAN, -1.0] {
            assert_eq!(q.decode(q.encode(x)), 0.0);
        }
        assert_eq!(q.encode(1e30), 0);
    }
    assert_eq!(ByFormula::try_new(25.0, 0.0).unwrap().encode(1.0), 0);
}

#[test]
fn equal_and_tiny_numbers_are_fitted() {
    let q = LogOffset::fitted(&[0.25; 9]).unwrap();
    assert_eq!((q.width(), q.encode(0.25), q.decode(255)), (MIN_WIDTH, 255, 0.25));
    // Of numbers below 2^-125 nothing is kept.
    let q = LogOffset::fitted(&[1.0, f32::from_bits(1)]).unwrap();
    assert_eq!((q.encode(1.0), q.encode(f32::from_bits(1)), q.encode(2.0 * f32::MIN_POSITIVE)), (255, 0, 1));
    assert!(q.width() < 88.0);
    let q = LogOffset::fitted(&[f32::MAX, f32::MIN_POSITIVE]).unwrap();
    assert_eq!(q.encode(f32::MAX), 255);
}

#[test]
fn what_makes_no_map_is_refused() {
    for width in [0.0, -1.0, MIN_WIDTH.next_down(), MAX_WIDTH.next_up(), f32::INFINITY] {
        assert_eq!(LogOffset::try_new(width, 1.0), Err(LogOffsetError::Width { width }));
        assert_eq!(ByFormula::try_new(width, 1.0), Err(LogOffsetError::Width { width }));
    }
    assert!(
        matches!(LogOffset::try_new(f32::NAN, 1.0), Err(LogOffsetError::Width { width }) if width.is_nan())
    );
    for max in [-1.0, f32::INFINITY, f32::NEG_INFINITY, -f32::MIN_POSITIVE] {
        assert_eq!(LogOffset::published(max), Err(LogOffsetError::Max { max }));
    }
    assert!(matches!(LogOffset::published(f32::NAN), Err(LogOffsetError::Max { max }) if max.is_nan()));
    let tiny = 8e-28;
    assert_eq!(LogOffset::published(tiny), Err(LogOffsetError::TooSmall { width: 25.0, max: tiny }));
    assert!(LogOffset::published(8.5e-28).is_ok());
    assert!(matches!(LogOffset::fitted(&[f32::from_bits(1)]), Err(LogOffsetError::TooSmall { .. })));
    for bad in [f32::INFINITY, f32::NEG_INFINITY] {
        let error = Err(LogOffsetError::Value { index: 1, value: bad });
        assert_eq!(LogOffset::fitted(&[1.0, bad]), error);
        assert_eq!(LogOffset::fitted_losing(&[1.0, bad], 0.1), error);
    }
    assert!(matches!(Span::of(&[f32::NAN]), Err(LogOffsetError::Value { index: 0, .. })));
    let q = LogOffset::published(1.0).unwrap();
    let error = Err(LogOffsetError::Lengths { values: 3, codes: 2 });
    let (mut codes, mut values) = ([9; 2], [9.0; 3]);
    assert_eq!(q.encode_slice(&[1.0; 3], &mut codes), error);
    assert_eq!(q.decode_slice(&[1; 2], &mut values), error);
    assert_eq!((codes, values), ([9; 2], [9.0; 3]));
    // Each says its numbers.
    for (e, word) in [
        (LogOffsetError::Width { width: 7.5 }, "7.5"),
        (LogOffsetError::Max { max: -3.0 }, "-3"),
        (LogOffsetError::TooSmall { width: 25.0, max: 8e-28 }, "25"),
        (LogOffsetError::Value { index: 41, value: f32::NAN }, "41"),
        (LogOffsetError::Lengths { values: 3, codes: 2 }, "3"),
    ] {
        assert!(e.to_string().contains(word), "{e}");
    }
}

#[test]
fn slices_equal_single_calls_at_every_length() {
    let q = LogOffset::published(1.0).unwrap().mean_preserving();
    let values: Vec<f32> = (0..70).map(|i| (-f64::from(i) * 0.36).exp() as f32).collect();
    for n in 0..values.len() {
        let (mut codes, mut back) = (vec![1; n], vec![7.0; n]);
        q.encode_slice(&values[..n], &mut codes).unwrap();
        q.decode_slice(&codes, &mut back).unwrap();
        for i in 0..n {
            assert_eq!((codes[i], back[i]), (q.encode(values[i]), q.decode(codes[i])));
        }
    }
}

#[test]
fn levels_end_where_codes_do() {
    let (below, half) = (0.5_f32.next_down(), 0.5);
    for decode in [value_at, mean_at] {
        for level in [below, 0.0, -0.0, -1.0, f32::NEG_INFINITY, f32::NAN] {
            assert_eq!(decode(25.0, 1.0, level), 0.0);
        }
        assert!(decode(25.0, 1.0, half) > 0.0);
        assert_eq!(decode(25.0, 0.7, 255.0), decode(25.0, 0.7, f32::INFINITY));
    }
    assert_eq!(value_at(25.0, 0.7, 255.0), 0.7);
}
