//! Special values, totality, symmetry, monotonicity and identities of the float functions.
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use etendue_core::math::*;

const INF: f32 = f32::INFINITY;
const NAN: f32 = f32::NAN;
const TINY: f32 = f32::from_bits(1);

/// Equal to the bit, or both NaN.
#[track_caller]
fn same(got: f32, expected: f32) {
    assert!(
        got.to_bits() == expected.to_bits() || got.is_nan() && expected.is_nan(),
        "got {got:e}, expected {expected:e}"
    );
}

/// Floats spread over all bit patterns, and the hard ones.
fn spread() -> impl Iterator<Item = f32> {
    let hard =
        [0.0, -0.0, TINY, -TINY, 1.0, -1.0, 0.5, f32::MIN_POSITIVE, f32::MAX, f32::MIN, INF, -INF, NAN];
    (0..=u32::MAX / 40_961).map(|i| f32::from_bits(i * 40_961)).chain(hard)
}

#[test]
fn logarithms_of_special_values() {
    for f in [ln as fn(f32) -> f32, log2] {
        same(f(0.0), -INF);
        same(f(-0.0), -INF);
        same(f(-1.0), -INF);
        same(f(-INF), -INF);
        same(f(INF), INF);
        same(f(NAN), NAN);
        same(f(1.0), 0.0);
    }
    same(ln(TINY), (-149.0 * std::f64::consts::LN_2) as f32);
    for k in -149..=127 {
        same(log2(ldexp(1.0, k)), k as f32);
        same(exp2(k as f32), ldexp(1.0, k));
    }
}

#[test]
fn exponentials_of_special_values() {
    for f in [exp as fn(f32) -> f32, exp2] {
        same(f(0.0), 1.0);
        same(f(-0.0), 1.0);
        same(f(TINY), 1.0);
        same(f(INF), INF);
        same(f(f32::MAX), INF);
        same(f(-INF), 0.0);
        same(f(f32::MIN), 0.0);
        same(f(NAN), NAN);
    }
    // The documented ends.
    assert!(exp(88.722_83) < INF && exp(88.722_85) == INF);
    assert!(exp(-103.972) > 0.0 && exp(-103.973) == 0.0);
    assert!(exp2(127.99999) < INF && exp2(128.0) == INF);
    assert!(exp2(-149.99998) == TINY && exp2(-150.0) == 0.0);
}

#[test]
fn pow_of_special_values() {
    for x in [0.0, -0.0, TINY, 0.3, 1.0, 7.0, INF, -2.0, NAN] {
        same(pow(x, 0.0), 1.0);
        same(pow(x, -0.0), 1.0);
    }
    for y in [TINY, 0.5, 1.0, 1.0e5, f32::MAX, INF] {
        same(pow(0.0, y), 0.0);
        same(pow(-3.0, y), 0.0);
        same(pow(0.0, -y), INF);
        same(pow(INF, y), INF);
        same(pow(INF, -y), 0.0);
        same(pow(1.0, y), 1.0);
        same(pow(1.0, -y), 1.0);
    }
    same(pow(0.5, f32::MAX), 0.0);
    same(pow(0.5, -INF), INF);
    same(pow(2.0, INF), INF);
    same(pow(ONE_MINUS_EPSILON, f32::MAX), 0.0);
    same(pow(1.0 + f32::EPSILON, f32::MAX), INF);
    same(pow(TINY, 0.5), ldexp(core::f32::consts::SQRT_2, -75));
    same(pow(2.0, -149.0), TINY);
    same(pow(2.0, 127.0), ldexp(1.0, 127));
    same(pow(NAN, 1.0), NAN);
    same(pow(0.5, NAN), NAN);
    same(pow(0.0, NAN), NAN);
    for (x, y, p) in
        [(3.0, 2.0, 9.0), (3.0, 4.0, 81.0), (10.0, 3.0, 1000.0), (0.25, 0.5, 0.5), (4.0, -1.5, 0.125)]
    {
        same(pow(x, y), p);
    }
}

#[test]
fn trigonometry_of_special_values() {
    assert_eq!(sin_cos(0.0), (0.0, 1.0));
    same(sin(-0.0), 0.0);
    same(sin(TINY), TINY);
    for x in [3216.1, -3300.0, f32::MAX, INF, -INF] {
        assert_eq!(sin_cos(x), (0.0, 1.0), "{x}");
    }
    assert!(sin(NAN).is_nan() && cos(NAN).is_nan() && tan(NAN).is_nan());
    same(acos(1.0), 0.0);
    same(acos(1.5), 0.0);
    same(acos(INF), 0.0);
    same(acos(-1.0), PI);
    same(acos(-1.5), PI);
    same(acos(-INF), PI);
    same(acos(0.0), HALF_PI);
    same(acos(NAN), NAN);
    same(asin(1.0), HALF_PI);
    same(asin(-7.0), -HALF_PI);
    same(asin(-0.0), -0.0);
    same(asin(NAN), NAN);
    same(atan2(0.0, 0.0), 0.0);
    same(atan2(0.0, -0.0), 0.0);
    same(atan2(-0.0, 0.0), -0.0);
    same(atan2(0.0, 1.0), 0.0);
    same(atan2(0.0, -1.0), PI);
    same(atan2(-0.0, -1.0), -PI);
    same(atan2(1.0, 0.0), HALF_PI);
    same(atan2(-1.0, -0.0), -HALF_PI);
    // The diagonal is not special-cased: within its ulp, and the same for every pair of equals.
    let diagonal = atan2(2.0, 2.0);
    assert!((diagonal - PI / 4.0).abs() <= f32::EPSILON / 2.0);
    same(atan2(INF, INF), diagonal);
    same(atan2(-INF, 1.0), -HALF_PI);
    same(atan2(1.0, INF), 0.0);
    same(atan2(1.0, -INF), PI);
    same(atan2(TINY, TINY), diagonal);
    same(atan2(TINY, f32::MAX), 0.0);
    same(atan2(NAN, 1.0), NAN);
    same(atan2(1.0, NAN), NAN);
}

#[test]
fn roots_of_special_values() {
    for (x, y) in [(0.0, 0.0), (-0.0, -0.0), (INF, INF), (-INF, -INF), (NAN, NAN), (-8.0, -2.0), (27.0, 3.0)]
    {
        same(cbrt(x), y);
    }
    // Cubes that a float holds exactly.
    for i in (-256..0).chain(1..=256) {
        same(cbrt((i * i * i) as f32), i as f32);
    }
    same(sqrt(4.0), 2.0);
    same(sqrt(-0.0), -0.0);
    same(sqrt(TINY), (f64::from(TINY)).sqrt() as f32);
    same(sqrt_clamped(-1.0), 0.0);
    same(sqrt_clamped(NAN), 0.0);
    for x in spread().filter(|x| *x > 0.0) {
        same(sqrt(x), x.sqrt());
    }
}

#[test]
fn finite_arguments_never_give_nan() {
    for x in spread().filter(|x| x.is_finite()) {
        let (s, c) = sin_cos(x);
        for y in [ln(x), log2(x), exp(x), exp2(x), s, c, tan(x), acos(x), asin(x), atan(x), cbrt(x), fract(x)]
        {
            assert!(!y.is_nan(), "{x:e}");
        }
        assert!(s.abs() <= 1.0 && c.abs() <= 1.0 && tan(x).is_finite(), "{x:e}");
        assert!((0.0..1.0).contains(&fract(x)), "{x:e}");
    }
    for x in spread().step_by(101).filter(|x| x.is_finite()) {
        for y in spread().step_by(103).filter(|y| y.is_finite()) {
            assert!(!pow(x, y).is_nan() && !atan2(x, y).is_nan(), "{x:e} {y:e}");
        }
    }
}

#[test]
fn symmetries_hold_to_the_bit() {
    for x in spread().filter(|x| !x.is_nan()) {
        let ((s, c), (sm, cm)) = (sin_cos(x), sin_cos(-x));
        if x.abs() <= 3216.0 && x != 0.0 {
            same(sm, -s);
            same(cm, c);
        }
        same(sin(x), s);
        same(cos(x), c);
        same(asin(-x), -asin(x));
        same(atan(-x), -atan(x));
        same(cbrt(-x), -cbrt(x));
    }
}

#[test]
fn identities_hold_within_their_rounding() {
    for i in 0..200_000 {
        let x = (i as f32 - 100_000.0) * 3.1e-2;
        let (s, c) = sin_cos(x);
        let one = f64::from(s) * f64::from(s) + f64::from(c) * f64::from(c);
        // Each of s, c is within 0.9 ulp <= 0.9 * 2^-24 below 1.
        assert!((one - 1.0).abs() <= 4.0 * 0.9 / 16_777_216.0, "{x} {one}");
    }
    // Above, ln x may round to a logarithm beyond the largest float's.
    for x in spread().filter(|x| *x > 0.0 && *x < 3.4e38) {
        // The rounding of ln x is multiplied by |ln x| in relative terms, 0.82 ulp of it.
        let l = ln(x);
        let tolerance = f64::from(l.abs()).max(1.0) * 1.2e-7 * 2.0;
        assert!(
            (f64::from(exp(l)) / f64::from(x) - 1.0).abs() <= tolerance || x < f32::MIN_POSITIVE,
            "{x:e}"
        );
        let r = f64::from(cbrt(x));
        assert!((r * r * r / f64::from(x) - 1.0).abs() <= 3.0 * 0.54 / 8_388_608.0, "{x:e}");
    }
}

/// Every float of [low, high], in steps of `stride`, mapped without a decrease.
#[track_caller]
fn never_falls(low: f32, high: f32, stride: usize, f: impl Fn(f32) -> f32) {
    let key = |x: f32| {
        let b = x.to_bits() as i32;
        if b < 0 { i32::MIN.wrapping_sub(b) } else { b }
    };
    let back = |k: i32| f32::from_bits(if k < 0 { i32::MIN.wrapping_sub(k) } else { k } as u32);
    let mut last = f(low);
    for k in (key(low)..=key(high)).step_by(stride) {
        let y = f(back(k));
        assert!(y >= last, "falls at {:e}: {last:e} to {y:e}", back(k));
        last = y;
    }
}

#[test]
fn monotone_where_sampling_needs_it() {
    // Inverting a CDF near its ends: every float of a run of neighbours.
    never_falls(ONE_MINUS_EPSILON - 0.05, 1.0, 1, ln);
    never_falls(1.0, 1.05, 1, ln);
    never_falls(1.0e-9, 1.1e-9, 1, ln);
    never_falls(-0.05, 0.05, 4099, exp);
    never_falls(-1.0e-3, -1.0e-5, 61, exp);
    never_falls(-104.0, -103.0, 1, exp);
    never_falls(0.95, 1.0, 1, |x| -acos(x));
    never_falls(-1.0, -0.95, 1, |x| -acos(x));
    never_falls(0.95, 1.0, 1, asin);
    never_falls(1.0e-3, 1.1e-3, 1, cbrt);
    never_falls(0.99, 1.01, 1, cbrt);
    // Across the seams of the pieces.
    never_falls(0.4999, 0.5001, 1, asin);
    never_falls(0.4999, 0.5001, 1, |x| -acos(x));
    never_falls(-0.5001, -0.4999, 1, |x| -acos(x));
    never_falls(0.7070, 0.7072, 1, ln);
    never_falls(0.3465, 0.3467, 1, exp);
}

#[test]
fn rounding_is_std_to_the_bit() {
    let halves = (-4000..4000).flat_map(|i| {
        let x = i as f32 * 0.5;
        [x, f32::from_bits(x.to_bits().wrapping_add(1)), f32::from_bits(x.to_bits().wrapping_sub(1))]
    });
    for x in spread().chain(halves).chain([8_388_607.5, 8_388_608.0, -8_388_607.5, 0.499_999_97]) {
        same(floor(x), x.floor());
        same(ceil(x), x.ceil());
        same(round(x), x.round());
        same(trunc(x), x.trunc());
    }
    same(fract(-1.0e-9), ONE_MINUS_EPSILON);
    same(fract(-0.25), 0.75);
    same(fract(2.5), 0.5);
    same(abs(-3.0), 3.0);
    same(copysign(3.0, -0.0), -3.0);
    same(clamp(NAN, 1.0, 2.0), 1.0);
    same(clamp(5.0, 1.0, 2.0), 2.0);
    same(clamp(0.0, 2.0, 1.0), 1.0);
    same(min(1.0, 2.0), 1.0);
    same(max(1.0, 2.0), 2.0);
    same(max(NAN, 2.0), 2.0);
}

#[test]
fn bits_are_exact() {
    same(u32_to_unit(0), 0.0);
    same(u32_to_unit(255), 0.0);
    same(u32_to_unit(256), ldexp(1.0, -24));
    same(u32_to_unit(u32::MAX), ONE_MINUS_EPSILON);
    same(u32_to_unit(1 << 31), 0.5);
    same(INV_TAU, (0.5 / std::f64::consts::PI) as f32);
    same(INV_FOUR_PI, (0.25 / std::f64::consts::PI) as f32);
    for x in spread().filter(|x| x.is_finite() && *x != 0.0) {
        let e = f64::from(x).abs().log2().floor();
        assert_eq!(f64::from(exponent(x)), e, "{x:e}");
        for k in [-400, -253, -149, -127, -24, -1, 0, 1, 23, 126, 127, 128, 200, 254, 400] {
            // One rounding: the f64 product is exact.
            same(ldexp(x, k), (f64::from(x) * 2.0_f64.powi(k)) as f32);
        }
    }
    assert_eq!((exponent(0.0), exponent(INF), exponent(NAN), exponent(TINY)), (0, 128, 128, -149));
}
