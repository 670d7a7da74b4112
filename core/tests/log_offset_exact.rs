//! Log/offset codes against exact arithmetic, and all forms of encoding against each other.
#![allow(clippy::disallowed_methods, reason = "truth in f64 and in integers")]

use etendue_core::codec::log_offset::{
    ByFormula, LogOffset, MAX_WIDTH, MIN_WIDTH, PUBLISHED_WIDTH, Quantiser, count_in,
};

/// Fraction bits of a [`exp_negative`].
const BITS: u32 = 120;

/// a b as (upper, lower) 128 bits.
fn wide(a: u128, b: u128) -> (u128, u128) {
    let low = |x: u128| x & u128::from(u64::MAX);
    let (a1, a0, b1, b0) = (a >> 64, low(a), b >> 64, low(b));
    let middle = ((a0 * b0) >> 64) + low(a1 * b0) + low(a0 * b1);
    let upper = a1 * b1 + ((a1 * b0) >> 64) + ((a0 * b1) >> 64) + (middle >> 64);
    (upper, a.wrapping_mul(b))
}

fn times(a: u128, b: u128) -> u128 {
    let (upper, lower) = wide(a, b);
    (upper << (128 - BITS)) | (lower >> BITS)
}

/// A positive normal f32 as integer times power of two.
fn parts(x: f32) -> (u128, i32) {
    let bits = x.to_bits();
    (u128::from(bits & 0x007f_ffff | 0x0080_0000), (bits >> 23) as i32 - 150)
}

/// e^(-width k / 510) in units of 2^-120, in integers alone: Taylor's series of the 4096th part, squared 12 times.
/// Error below 2^20 units for width k / 510 <= 60.
fn exp_negative(width: f32, k: u32) -> u128 {
    let (m, e) = parts(width);
    let (n, shift) = (m * u128::from(k), (BITS as i32 + e - 12) as u32);
    let t = ((n / 510) << shift) + ((n % 510) << shift) / 510;
    let (mut term, mut sum) = (1_u128 << BITS, 1_u128 << BITS);
    for i in 1..30_u128 {
        term = times(term, t) / i;
        sum = if i % 2 == 1 { sum - term } else { sum + term };
    }
    (0..12).fold(sum, |x, _| times(x, x))
}

/// Whether `twice`/2 2^exponent is above max e, e in units of 2^-120, where both are decided by more than 2^20 units: +1, -1, 0.
fn side(twice: u128, exponent: i32, max: f32, e: u128) -> i32 {
    let (m, me) = parts(max);
    // twice 2^(exponent - 1) against m e 2^(me - 120).
    let shift = exponent - 1 - me + BITS as i32;
    let left = if shift >= 0 {
        let s = shift as u32;
        (
            if s == 0 {
                0
            } else if s < 128 {
                twice >> (128 - s)
            } else {
                twice << (s - 128)
            },
            if s < 128 { twice << s } else { 0 },
        )
    } else {
        panic!("the widths of this test are below 2^-60")
    };
    if left > wide(m, e + (1 << 20)) {
        1
    } else if left < wide(m, e - (1 << 20)) {
        -1
    } else {
        0
    }
}

const PARAMETERS: [(f32, f32); 10] = [
    (25.0, 1.0),
    (25.0, 0.218_37),
    (25.0, 1.0e-20),
    (11.5, 1.0),
    (11.5, 3.4e38),
    (13.773_1, 0.999_999_94),
    (1.0, 2.0),
    (0.1, 1.234_567),
    (MIN_WIDTH, 1.999_999_9),
    (40.0, 7.0),
];

#[test]
fn thresholds_are_the_least_floats_of_their_codes() {
    for (width, max) in PARAMETERS {
        let q = LogOffset::try_new(width, max).unwrap();
        for (i, t) in q.thresholds().iter().enumerate() {
            let e = exp_negative(width, 509 - 2 * i as u32);
            let ((m, x), (m1, x1)) = (parts(*t), parts(t.next_down()));
            assert_eq!(side(2 * m, x, max, e), 1, "threshold {i} of width {width} is below the boundary");
            assert_eq!(side(2 * m1, x1, max, e), -1, "threshold {i} of width {width} is not the least");
        }
    }
}

#[test]
fn plain_decodes_are_correctly_rounded() {
    for (width, max) in PARAMETERS {
        let q = LogOffset::try_new(width, max).unwrap();
        assert_eq!(q.values()[0], 0.0);
        assert_eq!(q.values()[255], max);
        for code in 1..255_u32 {
            let e = exp_negative(width, 510 - 2 * code);
            let (m, x) = parts(q.values()[code as usize]);
            // The middles between it and its neighbours (the lower one is nearer below a power of two).
            let lower = if m == 1 << 23 { (4 * m - 1, x - 1) } else { (2 * m - 1, x) };
            assert_eq!(side(2 * m + 1, x, max, e), 1, "value {code} of width {width}");
            assert_eq!(side(lower.0, lower.1, max, e), -1, "value {code} of width {width}");
        }
    }
}

#[test]
fn the_integer_exponential_is_right() {
    for (width, _) in PARAMETERS {
        for k in [1, 2, 255, 509] {
            let x = exp_negative(width, k) as f64 / 2.0_f64.powi(BITS as i32);
            let y = (-f64::from(width) * f64::from(k) / 510.0).exp();
            assert!((x / y - 1.0).abs() <= 2e-14, "{width} {k}: {x} is not {y}");
        }
    }
}

/// Words of a generator (Numerical Recipes' constants, mixed).
fn words() -> impl FnMut() -> u32 {
    let mut state = 0x2545_f491_u64;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 32) as u32 ^ (state >> 15) as u32
    }
}

fn agree(q: &LogOffset, x: f32) -> u8 {
    let code = count_in(q.thresholds(), x);
    assert_eq!(q.encode_by_search(x), code, "search of {x:e}");
    assert_eq!(q.encode(x), code, "buckets of {x:e}, width {} max {:e}", q.width(), q.max());
    code
}

#[test]
fn all_forms_give_the_same_code() {
    let mut word = words();
    let mut parameters = PARAMETERS.to_vec();
    parameters.extend([(MAX_WIDTH, f32::MAX), (100.0, 1.0e20), (25.0, 0.0)]);
    for _ in 0..100 {
        let width = MIN_WIDTH * (f64::from(word()) / 4_294_967_296.0 * 6.9).exp() as f32;
        parameters.push((width, f32::from_bits(0x3f80_0000 | word() & 0x1ff_ffff)));
    }
    for (width, max) in parameters {
        let q = LogOffset::try_new(width, max).unwrap();
        let mut inputs = vec![0.0, -0.0, 1.0, -1.0, f32::MIN_POSITIVE, f32::from_bits(1), f32::MAX, f32::MIN];
        inputs.extend([f32::INFINITY, f32::NEG_INFINITY, f32::NAN, -f32::NAN, max, max.next_up()]);
        for t in q.thresholds() {
            let b = t.to_bits();
            inputs.extend([b - 2, b - 1, b, b + 1, b ^ 1 << 31].map(f32::from_bits));
        }
        inputs.extend((0..1000).map(|_| f32::from_bits(word())));
        inputs.extend((0..1000).map(|_| max * (-width * (word() as f32 / 4.2e9)).exp()));
        let expected: Vec<u8> = inputs.iter().map(|x| agree(&q, *x)).collect();
        let mut codes = vec![7; inputs.len()];
        q.encode_slice(&inputs, &mut codes).unwrap();
        assert_eq!(codes, expected);
    }
}

#[test]
fn what_is_no_number_of_the_range_has_a_stated_code() {
    let q = LogOffset::published(0.5).unwrap();
    let f = ByFormula::try_new(PUBLISHED_WIDTH, 0.5).unwrap();
    for x in [0.0, -0.0, -1.0, f32::NEG_INFINITY, f32::NAN, f32::from_bits(1), f32::MIN_POSITIVE, 1e-12] {
        assert_eq!((q.encode(x), f.encode(x)), (0, 0), "{x:e}");
    }
    for x in [0.5, 0.5_f32.next_up(), 1.0, f32::MAX, f32::INFINITY] {
        assert_eq!((q.encode(x), f.encode(x)), (255, 255), "{x:e}");
    }
}

/// The formula in f32 differs from the exact codes only next to a boundary, by one code, and seldom.
#[test]
fn the_formula_differs_seldom_and_by_one() {
    let mut word = words();
    // The last one's quotients are mostly below the normal floats.
    for (width, max) in [(25.0, 1.0), (25.0, 0.218_37), (11.5, 1.0), (1.0, 2.0), (MAX_WIDTH, f32::MAX)] {
        let (q, f) = (LogOffset::try_new(width, max).unwrap(), ByFormula::try_new(width, max).unwrap());
        let n = 200_000;
        let mut different = 0;
        for _ in 0..n {
            let ratio = (-f64::from(width) * f64::from(word()) / 4_294_967_296.0).exp();
            let x = (f64::from(max) * ratio) as f32;
            let (a, b) = (q.encode(x), f.encode(x));
            different += u32::from(a != b);
            assert!(a.abs_diff(b) <= 1, "{x:e}: {a} {b}");
            let level = 255.0 * (1.0 + (f64::from(x) / f64::from(max)).ln() / f64::from(width));
            let off = ((level + 0.5).fract() - 0.5).abs();
            // Within rounding of a boundary, fract(level + 1/2) is within it of 0 or 1.
            assert!(a == b || 0.5 - off <= 1e-4, "{x:e} at level {level}: {a} {b}");
        }
        assert!(different <= n / 2000, "{different} of {n} differ for width {width}");
    }
}

#[test]
#[ignore = "75 s: cargo test --release -p etendue-core --test log_offset_exact -- --ignored --nocapture"]
fn every_float_has_the_same_code_by_all_forms() {
    for (width, max) in [(25.0, 1.0), (11.5, 0.218_37)] {
        let q = LogOffset::try_new(width, max).unwrap();
        let f = ByFormula::try_new(width, max).unwrap();
        let (mut different, mut inside) = (0_u64, 0_u64);
        let mut before = 0;
        let (mut values, mut codes) = ([0.0_f32; 4096], [0_u8; 4096]);
        for block in 0..1 << 20_u32 {
            for (i, v) in values.iter_mut().enumerate() {
                *v = f32::from_bits(block << 12 | i as u32);
            }
            q.encode_slice(&values, &mut codes).unwrap();
            for (v, code) in values.iter().zip(&codes) {
                assert_eq!(q.encode_by_search(*v), *code, "{v:e}");
                if !v.is_sign_negative() && !v.is_nan() {
                    assert!(*code >= before, "{v:e}");
                    before = *code;
                }
                if *v >= q.thresholds()[0] && *v <= max {
                    inside += 1;
                    different += u64::from(f.encode(*v) != *code);
                }
            }
        }
        println!(
            "width {width}, max {max}: the formula in f32 gives another code for {different} of {inside} floats"
        );
        assert!(different > 0 && different * 2000 <= inside);
    }
}
