//! Areas, mean irradiance and emission coefficients against exact products in f64 and integers.
#![allow(clippy::disallowed_methods, reason = "truth in f64")]
#![allow(clippy::needless_range_loop, reason = "vertices and channels go by index")]

use etendue_core::direct::emission::{
    VertexAlbedo, emission, emission_textured, importance, mean_irradiance, piece_area,
};
use etendue_core::math::Vec3;
use etendue_core::sampling::counter::Counter;

/// Error in ulp of f32 at the truth.
fn ulp(got: f32, truth: f64) -> f64 {
    let exponent = ((truth.abs().to_bits() >> 52) as i32 - 1023).max(-126);
    (f64::from(got) - truth).abs() / 2.0_f64.powi(exponent - 23)
}

/// Twice the area squared of a triangle of small integer coordinates, exactly.
fn twice_squared(p: [[i64; 3]; 3]) -> i128 {
    let e = [0, 1, 2].map(|i| i128::from(p[1][i] - p[0][i]));
    let f = [0, 1, 2].map(|i| i128::from(p[2][i] - p[0][i]));
    let c = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
    c.iter().map(|x| x * x).sum()
}

fn area_of(p: [[i64; 3]; 3], scale: i32) -> (f32, f64) {
    // Integers below 2^24 times a power of two are floats.
    let v = p.map(|p| Vec3::from_array(p.map(|x| (x as f64 * 2.0_f64.powi(scale)) as f32)));
    let truth = 0.5 * (twice_squared(p) as f64).sqrt() * 2.0_f64.powi(2 * scale);
    (piece_area(v), truth)
}

#[test]
fn areas_have_their_digits_on_slivers_and_far_from_the_origin() {
    let g = Counter::new(21);
    let mut worst = 0.0_f64;
    for n in 0..20_000_u32 {
        let word = |d: u32| i64::from(g.bits(n % 4, n, d) >> 9) - (1 << 22);
        let mut p = [[word(0), word(1), word(2)], [word(3), word(4), word(5)], [word(6), word(7), word(8)]];
        match n % 4 {
            // A sliver: the third vertex a few units beside the line through the others.
            1 => {
                for i in 0..3 {
                    p[1][i] = p[0][i] + (p[1][i] - p[0][i]) / 4 * 2;
                    p[2][i] = (p[0][i] + p[1][i]) / 2 + (word(6 + i as u32) & 3);
                }
            }
            // Small and far away.
            2 => {
                for i in 0..3 {
                    p[1][i] = p[0][i] + (p[1][i] & 63);
                    p[2][i] = p[0][i] + (p[2][i] & 63);
                }
            }
            _ => {}
        }
        let (got, truth) = area_of(p, [0, -30, 30, -60][(n / 4 % 4) as usize]);
        if truth == 0.0 {
            assert_eq!(got, 0.0, "{p:?}");
        } else {
            let here = ulp(got, truth);
            assert!(here <= 4.0, "{p:?}: {got} for {truth}, {here} ulp");
            worst = worst.max(here);
        }
    }
    println!("piece_area: worst {worst:.2} ulp");
}

#[test]
fn areas_are_total() {
    let v = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
    let zero = v(0.0, 0.0, 0.0);
    assert_eq!(piece_area([zero; 3]), 0.0);
    assert_eq!(piece_area([v(1.0, 2.0, 3.0); 3]), 0.0);
    assert_eq!(piece_area([zero, v(1.0, 1.0, 1.0), v(2.0, 2.0, 2.0)]), 0.0);
    assert_eq!(piece_area([zero, v(f32::NAN, 0.0, 0.0), v(0.0, 1.0, 0.0)]), 0.0);
    assert_eq!(piece_area([zero, v(f32::INFINITY, 0.0, 0.0), v(0.0, 1.0, 0.0)]), 0.0);
    assert_eq!(piece_area([zero, v(f32::MAX, 0.0, 0.0), v(0.0, f32::MAX, 0.0)]), f32::MAX);
    // Edges of 1e-19 and of 1e19: the square of a square leaves the range, the area does not.
    for (size, area) in [(1e-19_f64, 0.5e-38), (1e19, 0.5e38)] {
        let s = size as f32;
        let truth = area * (f64::from(s) / size).powi(2);
        let got = piece_area([zero, v(s, 0.0, 0.0), v(0.0, s, 0.0)]);
        assert!(ulp(got, truth) <= 4.0, "{got} for {truth}");
    }
    // Corners at both ends of the range, where the edge alone would overflow; the area does.
    let far = piece_area([v(-f32::MAX, 0.0, 0.0), v(f32::MAX, 0.0, 0.0), v(0.0, 1e33, 0.0)]);
    assert_eq!(far, f32::MAX);
    // One edge 2^50 times the other.
    let long = piece_area([zero, v(3e20, 0.0, 0.0), v(0.0, 0.0, 5e5)]);
    assert!(ulp(long, 0.5 * f64::from(3e20_f32) * 5e5) <= 4.0, "{long}");
    assert_eq!(piece_area([zero, v(f32::from_bits(1), 0.0, 0.0), v(0.0, f32::from_bits(1), 0.0)]), 0.0);
}

/// A float of any scale within `decades` of 1.
fn wide(g: &Counter, n: u32, d: u32, decades: f64) -> f32 {
    let u = f64::from(g.unit(9, n, d));
    10.0_f64.powf(decades * (2.0 * u - 1.0)) as f32
}

#[test]
fn coefficients_are_the_product_at_any_scale() {
    let g = Counter::new(22);
    let (mut worst, mut worst_mean, mut worst_textured) = (0.0_f64, 0.0_f64, 0.0_f64);
    for n in 0..100_000_u32 {
        let decades = [1.0, 12.0, 37.0][(n % 3) as usize];
        let e = [0, 1, 2].map(|i| wide(&g, n, i, decades));
        let area = wide(&g, n, 3, decades);
        let ka = g.unit(1, n, 4);
        let hats = [5, 6, 7].map(|d| g.unit(1, n, d));
        let irradiance = e.map(|x| Vec3::new(x, 0.0, x));
        let mean = (f64::from(e[0]) + f64::from(e[1]) + f64::from(e[2])) / 3.0;
        let saturate = |x: f64| x.min(f64::from(f32::MAX));
        let check = |got: f32, truth: f64, limit: f64| {
            let here = ulp(got, saturate(truth));
            assert!(here <= limit, "{n}: {got} for {truth}: {here} ulp");
            here
        };
        let got = mean_irradiance(irradiance);
        assert_eq!((got.x.to_bits(), got.y), (got.z.to_bits(), 0.0));
        worst_mean = worst_mean.max(check(got.x, mean, 2.0));
        let got = emission(Vec3::splat(ka), area, irradiance);
        worst = worst.max(check(got.x, f64::from(ka) * f64::from(area) * mean, 4.0));
        let textured = (0..3).map(|i| f64::from(hats[i]) * f64::from(e[i])).sum::<f64>() / 3.0
            * f64::from(ka)
            * f64::from(area);
        let albedo = VertexAlbedo { at: hats.map(Vec3::splat) };
        let got = emission_textured(Vec3::splat(ka), area, irradiance, &albedo);
        worst_textured = worst_textured.max(check(got.x, textured, 5.0));
    }
    println!(
        "mean_irradiance {worst_mean:.2} ulp, emission {worst:.2} ulp, textured {worst_textured:.2} ulp"
    );
}

#[test]
fn bad_values_count_as_nothing_and_nothing_overflows() {
    let big = [Vec3::splat(f32::MAX); 3];
    assert_eq!(mean_irradiance(big), Vec3::splat(f32::MAX));
    assert_eq!(emission(Vec3::ONE, f32::MAX, big), Vec3::splat(f32::MAX));
    let tiny = Vec3::splat(f32::from_bits(3));
    assert_eq!(mean_irradiance([tiny; 3]), tiny);
    let bad = [Vec3::new(f32::NAN, -1.0, f32::INFINITY), Vec3::ZERO, Vec3::ONE];
    let mean = mean_irradiance(bad);
    assert!(mean.is_finite() && mean.min_element() > 0.0);
    assert_eq!(emission(Vec3::new(f32::NAN, -1.0, 0.5), 1.0, [Vec3::ONE; 3]), Vec3::new(0.0, 0.0, 0.5));
    assert_eq!(emission(Vec3::ONE, f32::NAN, [Vec3::ONE; 3]), Vec3::ZERO);
    assert_eq!(emission(Vec3::ONE, 2.0, [Vec3::ZERO; 3]), Vec3::ZERO);
}

#[test]
fn importance_is_positive_wherever_light_can_be_reflected() {
    let one = Vec3::ONE;
    assert_eq!(importance(one, one), 1.0);
    assert_eq!(importance(Vec3::ZERO, Vec3::ZERO), 0.0);
    assert_eq!(importance(Vec3::ZERO, one), 1.0 / 16_777_216.0);
    // The smallest bounds do not vanish.
    for bits in [1, 2, 3, 100] {
        let bound = Vec3::splat(f32::from_bits(bits));
        assert!(importance(Vec3::ZERO, bound) > 0.0, "{bits}");
    }
    let weight = importance(Vec3::splat(0.25), one);
    assert_eq!(weight, 0.25);
}

fn double(v: Vec3) -> [f64; 3] {
    v.to_array().map(f64::from)
}

fn single(v: [f64; 3]) -> Vec3 {
    Vec3::from_array(v.map(|x| x as f32))
}

fn half(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| 0.5 * (a[i] + b[i]))
}

#[test]
fn pieces_of_a_piece_emit_what_it_emits() {
    let g = Counter::new(23);
    for n in 0..500_u32 {
        let v =
            |d: u32| Vec3::new(g.unit(0, n, d), g.unit(0, n, d + 1), g.unit(0, n, d + 2)) * 4.0 - Vec3::ONE;
        let corners = [v(0), v(3), v(6)];
        let light = [v(9), v(12), v(15)].map(|x| x.abs() * 100.0);
        let albedo = Vec3::new(0.2, 0.5, 0.9);
        let whole = emission(albedo, piece_area(corners), light);
        // Halved at the longest edge's middle, again and again, in f64 so that the parts fit.
        let mut parts = vec![[0, 1, 2].map(|i| (double(corners[i]), double(light[i])))];
        for _ in 0..8 {
            let mut next = Vec::new();
            for part in parts {
                let longest = (0..3)
                    .max_by(|a, b| {
                        let l = |k: usize| {
                            (0..3).map(|c| (part[k].0[c] - part[(k + 1) % 3].0[c]).powi(2)).sum::<f64>()
                        };
                        l(*a).total_cmp(&l(*b))
                    })
                    .unwrap();
                let (p, q, r) = (part[longest], part[(longest + 1) % 3], part[(longest + 2) % 3]);
                let middle = (half(p.0, q.0), half(p.1, q.1));
                next.push([p, middle, r]);
                next.push([middle, q, r]);
            }
            parts = next;
        }
        let mut sum = [0.0_f64; 3];
        for part in &parts {
            let em = emission(albedo, piece_area(part.map(|p| single(p.0))), part.map(|p| single(p.1)));
            for (s, x) in sum.iter_mut().zip(em.to_array()) {
                *s += f64::from(x);
            }
        }
        for (got, want) in sum.iter().zip(whole.to_array()) {
            let want = f64::from(want);
            assert!((got - want).abs() <= 1e-6 * want + 1e-12, "{n}: {got} for {want}");
        }
    }
}
