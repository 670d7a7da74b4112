//! Error-free sums and products, quadratic roots, vectors: each against f64 or a second formula.
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use etendue_core::math::*;

/// A generator for the tests (Marsaglia 2003, xorshift), fixed seed.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 32) as u32
    }

    /// In [-1, 1).
    fn signed(&mut self) -> f32 {
        2.0 * u32_to_unit(self.bits()) - 1.0
    }

    /// A float with any sign and any exponent in the range.
    fn wide(&mut self, low: i32, high: i32) -> f32 {
        let k = low + (self.bits() % (high - low + 1) as u32) as i32;
        ldexp(f32::copysign(1.0 + u32_to_unit(self.bits()), self.signed()), k)
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.signed(), self.signed(), self.signed())
    }
}

#[test]
fn sums_and_products_lose_nothing() {
    let mut r = Random(7);
    for _ in 0..300_000 {
        // In these ranges the exact sum and product fit an f64.
        let (a, b) = (r.wide(-12, 12), r.wide(-12, 12));
        let (s, e) = two_sum(a, b);
        assert_eq!(s, a + b);
        assert_eq!(f64::from(s) + f64::from(e), f64::from(a) + f64::from(b), "{a:e} + {b:e}");
        let (a, b) = (r.wide(-50, 63), r.wide(-50, 63));
        let (p, e) = two_prod(a, b);
        assert_eq!(p, a * b);
        assert_eq!(f64::from(p) + f64::from(e), f64::from(a) * f64::from(b), "{a:e} * {b:e}");
    }
    let (p, e) = two_prod(f32::MAX, ONE_MINUS_EPSILON);
    assert_eq!(f64::from(p) + f64::from(e), f64::from(f32::MAX) * f64::from(ONE_MINUS_EPSILON));
}

#[test]
fn compensated_sums_keep_what_is_lost() {
    // 1 + n eps/2 - 1: plain addition keeps nothing of it.
    let mut sum = Compensated::<f32>::new(1.0);
    for _ in 0..100_000 {
        sum.add(ldexp(1.0, -25));
    }
    sum.add(-1.0);
    assert_eq!(sum.value(), 100_000.0 * ldexp(1.0, -25));
    // Neumaier's own example, which defeats Kahan's sum.
    assert_eq!([1.0, 1.0e30, 1.0, -1.0e30].into_iter().collect::<Compensated<f32>>().value(), 2.0);
    assert_eq!([1.0, 1.0e100, 1.0, -1.0e100].into_iter().collect::<Compensated<f64>>().value(), 2.0);

    let mut r = Random(11);
    let terms: Vec<f32> = (0..100_000).map(|_| r.wide(-10, 10)).collect();
    // Multiples of 2^-33 below 2^28 in all: the f64 sum of these f32 is exact to far below an f32 ulp.
    let truth: f64 = terms.iter().copied().map(f64::from).sum();
    let whole: Compensated<f32> = terms.iter().copied().collect();
    assert!((f64::from(whole.value()) - truth).abs() <= truth.abs() * 6.0e-8 + 1.0e-7 * 100.0, "{truth}");
    let (left, right) = terms.split_at(33_333);
    let mut merged: Compensated<f32> = left.iter().copied().collect();
    merged.merge(right.iter().copied().collect());
    assert!((f64::from(merged.value()) - truth).abs() <= truth.abs() * 1.2e-7 + 1.0e-7 * 100.0, "{truth}");

    let mut sum = Compensated::<f32>::new(f32::MAX);
    sum.add(f32::MAX);
    sum.add(1.0);
    assert_eq!(sum.value(), f32::INFINITY);
    assert_eq!(Compensated::<f64>::default().value(), 0.0);
}

/// The roots in f64, by the same stable split: its 53 bits hold the products of f32 exactly.
fn roots_f64(a: f64, b: f64, c: f64) -> Option<[f64; 2]> {
    let d = b * b - 4.0 * a * c;
    if d < 0.0 {
        return None;
    }
    let q = -0.5 * (b + d.sqrt().copysign(b));
    let (x, y) = (q / a, c / q);
    Some([x.min(y), x.max(y)])
}

#[test]
fn roots_of_wide_coefficients_are_within_four_ulp() {
    let mut r = Random(3);
    let mut worst = 0.0_f64;
    for i in 0..400_000 {
        let range = [2, 8, 40, 60][i % 4];
        let (a, b, c) = (r.wide(-range, range), r.wide(-range, range), r.wide(-range, range));
        // The sign of the discriminant decides; both sums below are exact enough to agree on it.
        match (quadratic_roots(a, b, c), roots_f64(a.into(), b.into(), c.into())) {
            (None, None) => {}
            (Some(got), Some(truth)) => {
                assert!(got[0] <= got[1]);
                for (g, t) in got.into_iter().zip(truth) {
                    let t = t.clamp(-f64::from(f32::MAX), f64::from(f32::MAX));
                    if t.abs() > f64::from(f32::MIN_POSITIVE) {
                        let error = ((f64::from(g) - t) / t).abs() * 8_388_608.0;
                        assert!(error <= 4.0, "{a:e} {b:e} {c:e}: {g:e} for {t:e}");
                        worst = worst.max(error);
                    }
                }
            }
            (got, truth) => panic!("{a:e} {b:e} {c:e}: {got:?} for {truth:?}"),
        }
    }
    println!("worst relative error of a root: {worst} eps");
}

#[test]
fn nearly_double_roots_survive() {
    // (x - p)(x - q) with p, q neighbours on a grid of 2^-11: the coefficients are exact, b^2 and 4ac agree to 24 bits.
    for i in 1..2000 {
        let (p, q) = (1.0 + i as f32 / 2048.0, 1.0 + (i + 1) as f32 / 2048.0);
        let roots = quadratic_roots(1.0, -(p + q), p * q);
        assert_eq!(roots, Some([p, q]));
        assert_eq!(quadratic_roots(1.0, -2.0 * p, p * p), Some([p, p]));
    }
}

#[test]
fn degenerate_quadratics_have_their_documented_value() {
    assert_eq!(quadratic_roots(0.0, 2.0, -6.0), Some([3.0, 3.0]));
    assert_eq!(quadratic_roots(0.0, 0.0, 1.0), None);
    assert_eq!(quadratic_roots(0.0, 0.0, 0.0), None);
    assert_eq!(quadratic_roots(1.0, 0.0, 0.0), Some([0.0, 0.0]));
    assert_eq!(quadratic_roots(2.0, 6.0, 0.0), Some([-3.0, 0.0]));
    assert_eq!(quadratic_roots(2.0, -6.0, 0.0), Some([0.0, 3.0]));
    assert_eq!(quadratic_roots(1.0, 0.0, 1.0), None);
    assert_eq!(quadratic_roots(1.0, 0.0, -4.0), Some([-2.0, 2.0]));
    assert_eq!(quadratic_roots(f32::NAN, 0.0, 1.0), None);
    assert_eq!(quadratic_roots(1.0, f32::INFINITY, 1.0), None);
    assert_eq!(quadratic_roots(0.0, f32::from_bits(1), f32::MAX), Some([-f32::MAX, -f32::MAX]));
    let mut r = Random(5);
    for _ in 0..200_000 {
        let mut any = || [r.wide(-149, 127), 0.0, f32::from_bits(r.bits() & 3)][r.bits() as usize % 3];
        if let Some(x) = quadratic_roots(any(), any(), any()) {
            assert!(x[0].is_finite() && x[1].is_finite() && x[0] <= x[1]);
        }
    }
}

#[test]
fn normalised_vectors_have_unit_length_at_every_scale() {
    let mut r = Random(9);
    for i in 0..200_000 {
        let k = (i % 270) - 145;
        let v = r.vector();
        let v = Vec3::new(ldexp(v.x, k), ldexp(v.y, k), ldexp(v.z, k));
        let n = normalize_or(v, Vec3::ZERO);
        let [x, y, z] = v.to_array().map(f64::from);
        let length = (x * x + y * y + z * z).sqrt();
        if length == 0.0 {
            assert_eq!(n, Vec3::ZERO);
            continue;
        }
        for (got, truth) in n.to_array().into_iter().zip([x / length, y / length, z / length]) {
            assert!((f64::from(got) - truth).abs() <= 3.0 * 6.0e-8 * truth.abs() + 1.0e-44, "{v:?} {n:?}");
        }
    }
    for bad in [Vec3::ZERO, Vec3::new(f32::NAN, 1.0, 0.0), Vec3::new(f32::INFINITY, 1.0, 0.0)] {
        assert_eq!(normalize_or(bad, Vec3::Y), Vec3::Y);
    }
    assert_eq!(normalize_or(Vec3::new(f32::MAX, 0.0, 0.0), Vec3::Y), Vec3::X);
    assert_eq!(normalize_or(Vec3::new(0.0, 0.0, -f32::from_bits(1)), Vec3::Y), Vec3::NEG_Z);
}

#[test]
fn bases_are_orthonormal_and_right_handed() {
    let mut r = Random(13);
    let mut normals: Vec<Vec3> = (0..200_000).map(|_| normalize_or(r.vector(), Vec3::Z)).collect();
    for z in [0.0, -0.0, 1.0e-30, -1.0e-30] {
        normals.push(Vec3::new(0.6, 0.8, z));
    }
    normals.extend([Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z]);
    for n in normals {
        let (t, b) = orthonormal_basis(n);
        let [t64, b64, n64] = [t, b, n].map(|v| v.to_array().map(f64::from));
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let eps = 5.0e-7;
        for error in [dot(t64, t64) - 1.0, dot(b64, b64) - 1.0, dot(t64, b64), dot(t64, n64), dot(b64, n64)] {
            assert!(error.abs() <= eps, "{n:?} {error:e}");
        }
        assert!(((t.cross(b)) - n).abs().max_element() <= 5.0e-7, "{n:?}");
        let v = r.vector();
        let back = from_local(to_local(v, t, b, n), t, b, n);
        assert!((back - v).abs().max_element() <= 2.0e-6, "{n:?}");
        let m = reflect(v, n);
        assert!(
            (m.dot(n) - v.dot(n)).abs() <= 1.0e-6 && (m + v).cross(n).abs().max_element() <= 2.0e-6,
            "{n:?}"
        );
    }
}

#[test]
fn components() {
    let v = Vec3::new(1.0, -3.0, 2.0);
    assert_eq!((max_component(v), min_component(v)), (2.0, -3.0));
    assert_eq!(max_component(Vec3::new(f32::NAN, 1.0, 0.0)), 1.0);
    assert_eq!(mean(Vec3::new(3.0, 6.0, 0.0)), 3.0);
    assert!(mean(Vec3::splat(f32::MAX)).is_finite());
}
