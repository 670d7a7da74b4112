//! Warps: one harness for all trios. Each is given an independent f64 parametrisation of its domain, and must pass the round trip, the
//! integral of the density, a chi-square of samples against the density, and the ends of the unit interval.
//!
//! Joint level of the chi-square tests: alpha = 0.001 (Sidak over the trios), seed fixed.
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

#[path = "sampling_support.rs"]
mod support;

use core::f64::consts::{PI, TAU};
use etendue_core::math::Vec3;
use etendue_core::sampling::counter::Counter;
use etendue_core::sampling::warp::*;
use support::{chi2_p, sidak};

/// Trios under test: `trio!` instances below.
const TRIOS: usize = 20;
const ALPHA: f64 = 0.001;
/// The ends of the unit interval, and its middle.
const EDGES: [f32; 7] =
    [0.0, 1.0 / 16_777_216.0, 0.25, 0.5 - 1.0 / 16_777_216.0, 0.5, 0.75, 1.0 - 1.0 / 16_777_216.0];

/// A trio with its domain charted by (s, t) in the unit square, in f64 and independently of the library.
struct Trio<'a, V> {
    name: &'a str,
    sample: &'a dyn Fn([f32; 2]) -> V,
    pdf: &'a dyn Fn(&V) -> f32,
    invert: &'a dyn Fn(&V) -> [f32; 2],
    /// The value at (s, t) and the measure per unit of s and t there.
    chart: &'a dyn Fn(f64, f64) -> (V, f64),
    /// (s, t) of a value.
    locate: &'a dyn Fn(&V) -> (f64, f64),
    /// Fails if the value is not on the domain.
    check: &'a dyn Fn(&V),
    /// Largest round-trip error, in `u`.
    round_trip: f64,
    /// Whether u[1] is an azimuth, to be compared modulo 1.
    periodic: bool,
}

impl<V> Trio<'_, V> {
    fn run(&self) {
        self.edges_and_round_trips();
        self.density();
    }

    fn trip(&self, u: [f32; 2], azimuth_is_lost: bool) {
        let name = self.name;
        let v = (self.sample)(u);
        (self.check)(&v);
        let pdf = (self.pdf)(&v);
        assert!(pdf > 0.0 && pdf.is_finite(), "{name}: pdf {pdf} at {u:?}");
        let back = (self.invert)(&v);
        for k in 0..2 {
            assert!((0.0..1.0).contains(&back[k]), "{name}: {u:?} -> {back:?}");
            let mut error = (f64::from(back[k]) - f64::from(u[k])).abs();
            if k == 1 && self.periodic {
                error = error.min(1.0 - error);
            }
            let lost = k == 1 && azimuth_is_lost;
            assert!(lost || error <= self.round_trip, "{name}: {u:?} -> {back:?}, error {error:e}");
        }
    }

    fn edges_and_round_trips(&self) {
        for a in EDGES {
            for b in EDGES {
                // On the axis an azimuth cannot come back.
                self.trip([a, b], self.periodic && (a == 0.0));
            }
        }
        let g = Counter::new(77);
        for i in 0..20_000 {
            let [a, b, c, _] = g.bits4(0, i, 0);
            let unit = |x: u32| (x >> 8) as f32 / 16_777_216.0;
            self.trip([unit(a), unit(b)], false);
            // Near the ends of u[0], by powers of two.
            let small = unit(a | 0x8000_0000) / (1 << (c & 15)) as f32;
            self.trip([small, unit(b)], false);
            self.trip([1.0 - (small * 16_777_216.0).ceil() / 16_777_216.0, unit(b)], false);
        }
    }

    /// The integral of the density, and the samples' chi-square against it, over 32 x 32 cells of the chart.
    fn density(&self) {
        let (cells, fine, n) = (32_usize, 16_usize, 1 << 18);
        let mut expected = vec![0.0_f64; cells * cells];
        let steps = cells * fine;
        for i in 0..steps {
            for j in 0..steps {
                let (s, t) = ((i as f64 + 0.5) / steps as f64, (j as f64 + 0.5) / steps as f64);
                let (v, measure) = (self.chart)(s, t);
                expected[i / fine * cells + j / fine] +=
                    f64::from((self.pdf)(&v)) * measure / (steps * steps) as f64;
            }
        }
        let integral: f64 = expected.iter().sum();
        assert!((integral - 1.0).abs() <= 2e-3, "{}: the density integrates to {integral}", self.name);
        let mut observed = vec![0_u64; cells * cells];
        let g = Counter::new(2024);
        for i in 0..n {
            let [a, b, ..] = g.bits4(1, i, 0);
            let v = (self.sample)([(a >> 8) as f32 / 16_777_216.0, (b >> 8) as f32 / 16_777_216.0]);
            let (s, t) = (self.locate)(&v);
            let cell = |x: f64| ((x * cells as f64) as usize).min(cells - 1);
            observed[cell(s) * cells + cell(t)] += 1;
        }
        let scaled: Vec<f64> = expected.iter().map(|e| e / integral * f64::from(n)).collect();
        let p = chi2_p(&observed, &scaled);
        assert!(p >= sidak(ALPHA, TRIOS), "{}: p = {p:e}", self.name);
    }
}

/// Declares one test that runs a trio through the harness.
macro_rules! trio {
    ($test:ident, $($field:ident: $value:expr),+ $(,)?) => {
        #[test]
        fn $test() {
            Trio { name: stringify!($test), $($field: $value),+ }.run();
        }
    };
}

fn to_vec3(x: f64, y: f64, z: f64) -> Vec3 {
    Vec3::new(x as f32, y as f32, z as f32)
}

/// Chart of the directions with 1 - cos <= `size`: s is 1 - cos over `size` to the power `power`, t the azimuth.
fn cap(size: f64, power: f64, s: f64, t: f64) -> (Vec3, f64) {
    let h = size * s.powf(power);
    let r = (h * (2.0 - h)).sqrt();
    (to_vec3(r * (TAU * t).cos(), r * (TAU * t).sin(), 1.0 - h), TAU * size * power * s.powf(power - 1.0))
}

fn locate_cap(size: f64, power: f64, w: &Vec3) -> (f64, f64) {
    let (x, y, z) = (f64::from(w.x), f64::from(w.y), f64::from(w.z));
    let r = x.hypot(y);
    let h = if z > 0.0 { r * r / (1.0 + (1.0 - r * r).max(0.0).sqrt()) } else { 1.0 - z };
    ((h / size).powf(1.0 / power), (y.atan2(x) / TAU).rem_euclid(1.0))
}

fn is_unit(w: &Vec3) {
    let l = f64::from(w.x).powi(2) + f64::from(w.y).powi(2) + f64::from(w.z).powi(2);
    assert!((l - 1.0).abs() <= 6e-7, "{w} has squared length {l}");
}

fn is_up(w: &Vec3) {
    is_unit(w);
    assert!(w.z > 0.0, "{w}");
}

trio!(sphere,
    sample: &sample_sphere,
    pdf: &|w| pdf_solid_angle_sphere(*w),
    invert: &|w| invert_sphere(*w),
    chart: &|s, t| cap(2.0, 1.0, s, t),
    locate: &|w| locate_cap(2.0, 1.0, w),
    check: &is_unit,
    round_trip: 2.4e-7,
    periodic: true,
);
trio!(hemisphere,
    sample: &sample_hemisphere,
    pdf: &|w| pdf_solid_angle_hemisphere(*w),
    invert: &|w| invert_hemisphere(*w),
    chart: &|s, t| cap(1.0, 1.0, s, t),
    locate: &|w| locate_cap(1.0, 1.0, w),
    check: &is_up,
    round_trip: 2.4e-7,
    periodic: true,
);
trio!(cosine_hemisphere,
    sample: &sample_cosine_hemisphere,
    pdf: &|w| pdf_solid_angle_cosine_hemisphere(*w),
    invert: &|w| invert_cosine_hemisphere(*w),
    chart: &|s, t| cap(1.0, 1.0, s, t),
    locate: &|w| locate_cap(1.0, 1.0, w),
    check: &is_up,
    round_trip: 2.4e-7,
    periodic: false,
);
trio!(disk,
    sample: &sample_disk,
    pdf: &|p| pdf_area_disk(*p),
    invert: &|p| invert_disk(*p),
    // Polar, not concentric: another chart than the library's.
    chart: &|s, t| ([(s.sqrt() * (TAU * t).cos()) as f32, (s.sqrt() * (TAU * t).sin()) as f32], PI),
    locate: &|p| {
        let (x, y) = (f64::from(p[0]), f64::from(p[1]));
        (x * x + y * y, (y.atan2(x) / TAU).rem_euclid(1.0))
    },
    check: &|p| assert!(f64::from(p[0]).hypot(f64::from(p[1])) <= 1.0 + 2e-7),
    round_trip: 2.4e-7,
    periodic: false,
);

const ORIGIN: Vec3 = Vec3::new(1.0, -2.0, 0.5);
const EDGE0: Vec3 = Vec3::new(2.0, 0.5, -1.0);
const EDGE1: Vec3 = Vec3::new(-0.3, 1.5, 0.7);

/// Area of the parallelogram of the two edges, by Lagrange's identity.
fn area() -> f64 {
    let dot = |a: Vec3, b: Vec3| {
        f64::from(a.x) * f64::from(b.x) + f64::from(a.y) * f64::from(b.y) + f64::from(a.z) * f64::from(b.z)
    };
    (dot(EDGE0, EDGE0) * dot(EDGE1, EDGE1) - dot(EDGE0, EDGE1).powi(2)).sqrt()
}

trio!(parallelogram,
    sample: &|u| sample_parallelogram(u, ORIGIN, EDGE0, EDGE1),
    pdf: &|_| pdf_area_parallelogram(EDGE0, EDGE1),
    invert: &|p| invert_parallelogram(ORIGIN, EDGE0, EDGE1, *p),
    chart: &|s, t| (ORIGIN + EDGE0 * s as f32 + EDGE1 * t as f32, area()),
    locate: &|p| {
        // Solve for (s, t) from x and y alone, by Cramer's rule.
        let (x, y) = (f64::from(p.x - ORIGIN.x), f64::from(p.y - ORIGIN.y));
        let (a, b, c, d) = (f64::from(EDGE0.x), f64::from(EDGE1.x), f64::from(EDGE0.y), f64::from(EDGE1.y));
        let det = a * d - b * c;
        ((x * d - b * y) / det, (a * y - x * c) / det)
    },
    check: &|p| assert!(p.is_finite()),
    round_trip: 1e-6,
    periodic: false,
);
trio!(triangle,
    sample: &sample_triangle,
    pdf: &|_| pdf_area_triangle(EDGE0, EDGE1),
    invert: &|b| invert_triangle(*b),
    // The square-root chart, not the folded square.
    chart: &|s, t| {
        let r = s.sqrt();
        ([(1.0 - r) as f32, (r * (1.0 - t)) as f32, (r * t) as f32], area() / 2.0)
    },
    locate: &|b| {
        let r = 1.0 - f64::from(b[0]);
        (r * r, f64::from(b[2]) / r)
    },
    check: &|b| {
        assert!(b.iter().all(|x| (0.0..=1.0).contains(x)) && b[2] > 0.0, "{b:?}");
        assert!((b.iter().map(|&x| f64::from(x)).sum::<f64>() - 1.0).abs() <= 1e-7, "{b:?}");
    },
    round_trip: 6e-8,
    periodic: false,
);

macro_rules! cone {
    ($($test:ident $size:expr;)+) => { $(trio!($test,
        sample: &|u| sample_cone(u, $size),
        pdf: &|w| pdf_solid_angle_cone($size, *w),
        invert: &|w| invert_cone($size, *w),
        chart: &|s, t| cap(f64::from($size), 1.0, s, t),
        locate: &|w| locate_cap(f64::from($size), 1.0, w),
        check: &is_unit,
        round_trip: 4.8e-7,
        periodic: true,
    );)+ };
}
cone! {
    cone_whole_sphere 2.0_f32;
    cone_beyond_a_hemisphere 1.3_f32;
    cone_hemisphere 1.0_f32;
    cone_wide 0.3_f32;
    cone_sun 1.1e-5_f32;
    cone_star 1e-12_f32;
    cone_least 1e-30_f32;
}

macro_rules! lobe {
    ($($test:ident $exponent:expr;)+) => { $(trio!($test,
        sample: &|u| sample_power_cosine(u, $exponent),
        pdf: &|w| pdf_solid_angle_power_cosine($exponent, *w),
        invert: &|w| invert_power_cosine($exponent, *w),
        // Squeezed towards the axis as the lobe is: 1 - cos up to where the density is 1e-11 of its peak.
        chart: &|s, t| cap(lobe_size($exponent), 2.0, s, t),
        locate: &|w| {
            let (s, t) = locate_cap(lobe_size($exponent), 2.0, w);
            (s.min(1.0), t)
        },
        check: &is_up,
        round_trip: 9.6e-7,
        periodic: true,
    );)+ };
}
fn lobe_size(exponent: f32) -> f64 {
    (25.0 / (f64::from(exponent) + 1e-9)).min(1.0)
}
lobe! {
    lobe_uniform 0.0_f32;
    lobe_lambert 1.0_f32;
    lobe_fractional 0.37_f32;
    lobe_soft 20.0_f32;
    lobe_sharp 1000.0_f32;
    lobe_mirror 1e6_f32;
    lobe_beam 1e12_f32;
}

/// A disk trio with one member wrong: the harness must notice.
fn wrong_disk(sample: &dyn Fn([f32; 2]) -> [f32; 2], density: f32) {
    Trio {
        name: "wrong disk",
        sample,
        pdf: &|_| density,
        invert: &|p| invert_disk(*p),
        chart: &|s, t| ([(s.sqrt() * (TAU * t).cos()) as f32, (s.sqrt() * (TAU * t).sin()) as f32], PI),
        locate: &|p| {
            let (x, y) = (f64::from(p[0]), f64::from(p[1]));
            (x * x + y * y, (y.atan2(x) / TAU).rem_euclid(1.0))
        },
        check: &|_| (),
        round_trip: 2.0,
        periodic: false,
    }
    .density();
}

#[test]
#[should_panic(expected = "integrates to")]
fn a_wrong_density_is_caught() {
    wrong_disk(&sample_disk, 1.01 / core::f32::consts::PI);
}

#[test]
#[should_panic(expected = "p = ")]
fn a_wrong_sampler_is_caught() {
    // One part in a hundred too near the centre.
    wrong_disk(&|u| sample_disk(u).map(|x| x * 0.99), 1.0 / core::f32::consts::PI);
}

#[test]
fn cone_of_a_sphere_is_exact() {
    for k in 0..2000 {
        let s = (10.0_f64).powf(-f64::from(k) / 70.0) as f32;
        // 2 sin^2 of half the angle, another form than the library's.
        let truth = 2.0 * (0.5 * f64::from(s).sqrt().asin()).sin().powi(2);
        let got = f64::from(one_minus_cos_of_sin_squared(s));
        assert!((got / truth - 1.0).abs() <= 2.0e-7 || s < 1e-37, "{s}: {got} for {truth}");
    }
    assert_eq!(one_minus_cos_of_sin_squared(1.5), 1.0);
    assert_eq!(one_minus_cos_of_sin_squared(-1.0), 0.0);
}

#[test]
fn degenerate_shapes_have_documented_values() {
    let flat = Vec3::new(1.0, 1.0, 0.0);
    assert_eq!(pdf_area_parallelogram(flat, flat * 2.0), 0.0);
    assert_eq!(pdf_area_triangle(Vec3::ZERO, flat), 0.0);
    assert_eq!(invert_parallelogram(flat, flat, flat, flat), [0.0, 0.0]);
    assert_eq!(pdf_solid_angle_cone(0.0, Vec3::Z), 0.0);
    assert_eq!(invert_cone(0.0, Vec3::Z), [0.0, 0.0]);
    assert_eq!(sample_cone([0.5, 0.3], 0.0), Vec3::Z);
    assert_eq!(pdf_solid_angle_hemisphere(-Vec3::Z), 0.0);
    assert_eq!(pdf_solid_angle_cosine_hemisphere(-Vec3::Z), 0.0);
    assert_eq!(pdf_solid_angle_power_cosine(5.0, -Vec3::Z), 0.0);
    assert_eq!(pdf_solid_angle_cone(0.1, -Vec3::Z), 0.0);
    assert_eq!(pdf_area_disk([1.0, 1.0]), 0.0);
    // Tiny and huge shapes: the density is the inverse area still.
    for scale in [1e-16_f32, 1e-9, 1e9, 1e16] {
        let (a, b) = (Vec3::new(scale, 0.0, 0.0), Vec3::new(0.0, 2.0 * scale, 0.0));
        let truth = 0.5 / f64::from(scale).powi(2);
        assert!((f64::from(pdf_area_parallelogram(a, b)) / truth - 1.0).abs() <= 4e-7);
        let u = invert_parallelogram(Vec3::ZERO, a, b, a * 0.25 + b * 0.5);
        assert!((u[0] - 0.25).abs() <= 4e-7 && (u[1] - 0.5).abs() <= 4e-7, "{u:?}");
    }
}

#[test]
fn densities_match_their_formulas_away_from_samples() {
    for k in 0..500 {
        let theta = f64::from(k) / 500.0 * PI * 0.499;
        let w = to_vec3(theta.sin() * 0.6, theta.sin() * 0.8, theta.cos());
        for n in [0.0_f32, 1.0, 7.5, 100.0, 1e4] {
            let truth = (f64::from(n) + 1.0) / TAU * theta.cos().powf(f64::from(n));
            let got = f64::from(pdf_solid_angle_power_cosine(n, w));
            // The direction is rounded to f32, which moves cos^n by n tan(theta) 6e-8 of itself.
            let tolerance = 1e-6 + f64::from(n) * theta.tan() * 1.2e-7;
            assert!(
                (got - truth).abs() <= truth * tolerance + 1e-30,
                "n {n}, theta {theta}: {got} for {truth}"
            );
        }
    }
}
