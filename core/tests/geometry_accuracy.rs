//! The f32 tests against f64 truths by other formulas: Moeller-Trumbore, the quadratic, plain cross products.
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

#[path = "geometry_support.rs"]
mod support;

use etendue_core::geometry::{
    PreparedRay, Primitives, RoundShape, bounds, geometric_normal, interpolate, intersect_shape,
    intersect_triangle, triangle_area,
};
use etendue_core::math::Vec3;
use support::{Random, ray};

type V = [f64; 3];
fn wide(v: Vec3) -> V {
    v.to_array().map(f64::from)
}
fn sub(a: V, b: V) -> V {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}
fn dot(a: V, b: V) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
fn cross(a: V, b: V) -> V {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
fn length(a: V) -> f64 {
    dot(a, a).sqrt()
}

/// Moeller and Trumbore 1997 in f64: (t, b1, b2) on the plane, inside or not.
fn moeller(o: V, d: V, v: [V; 3]) -> (f64, f64, f64) {
    let (e1, e2) = (sub(v[1], v[0]), sub(v[2], v[0]));
    let p = cross(d, e2);
    let det = dot(e1, p);
    let s = sub(o, v[0]);
    let q = cross(s, e1);
    (dot(e2, q) / det, dot(s, p) / det, dot(d, q) / det)
}

/// Errors in units of 2^-24: of t relative to (distance + extent) / cosine, of the barycentrics relative to
/// (distance + extent) / (smallest height * cosine).
#[test]
fn triangle_against_moeller_trumbore_in_f64() {
    let u = 2f64.powi(-24);
    let mut random = Random(1);
    let (mut worst_t, mut worst_b, mut hits) = (0f64, 0f64, 0);
    for _ in 0..400_000 {
        let size = 10f32.powf(random.range(-3.0, 3.0));
        let c = random.vector(2.0);
        let v = [c + random.vector(size), c + random.vector(size), c + random.vector(size)];
        let (b1, b2) = (random.range(0.05, 0.45), random.range(0.05, 0.45));
        let target = interpolate(v, b1, b2);
        let origin = target + random.direction() * 10f32.powf(random.range(-2.0, 3.0));
        let direction = (target - origin) * 10f32.powf(random.range(-3.0, 3.0));
        let w = v.map(wide);
        let (o, d) = (wide(origin), wide(direction));
        let n = cross(sub(w[1], w[0]), sub(w[2], w[0]));
        let cosine = (dot(n, d) / length(n) / length(d)).abs();
        let longest = (0..3).map(|k| length(sub(w[(k + 1) % 3], w[k]))).fold(0.0, f64::max);
        let height = length(n) / longest;
        let (t, b1, b2) = moeller(o, d, w);
        let reach = (0..3).map(|k| length(sub(w[k], o))).fold(0.0, f64::max);
        let unit_b = u * reach / (height * cosine);
        // Interior: the truth is farther from every edge than the error that is allowed.
        let margin = 20.0 * unit_b;
        let unit_t = u * reach / (length(d) * cosine);
        if !(b1 > margin && b2 > margin && 1.0 - b1 - b2 > margin && t > 20.0 * unit_t) {
            continue;
        }
        let hit = intersect_triangle(&PreparedRay::new(&ray(origin, direction)), v, f32::INFINITY);
        let hit = hit.unwrap_or_else(|| panic!("missed {v:?} from {origin} along {direction}"));
        hits += 1;
        worst_t = worst_t.max((f64::from(hit.t) - t).abs() / unit_t);
        worst_b = worst_b.max((f64::from(hit.b1) - b1).abs() / unit_b);
        worst_b = worst_b.max((f64::from(hit.b2) - b2).abs() / unit_b);
    }
    println!("{hits} hits; worst t {worst_t:.2} u reach/cosine, bary {worst_b:.2} u reach/(height cosine)");
    assert!(hits > 100_000);
    assert!(worst_t <= 16.0, "t {worst_t}");
    assert!(worst_b <= 4.0, "barycentrics {worst_b}");
}

#[test]
fn sphere_against_the_quadratic_in_f64() {
    let u = 2f64.powi(-24);
    let mut random = Random(2);
    let (mut worst, mut hits, mut wrong) = (0f64, 0, 0);
    for i in 0..400_000 {
        let r = 10f32.powf(random.range(-3.0, 4.0));
        let c = random.vector(1.0);
        let shape = RoundShape::sphere(c.to_array(), r);
        // Far away, near, inside; aimed within the silhouette.
        let away = [10f32.powf(random.range(0.0, 4.0)), 1.0 + random.unit(), random.unit()][i % 3];
        let origin = c + random.direction() * (r * away);
        let target = c + random.direction() * (r * random.unit());
        let direction = (target - origin) * 10f32.powf(random.range(-2.0, 2.0));
        let (o, d) = (sub(wide(origin), wide(c)), wide(direction));
        let (rr, reach) = (f64::from(r), length(o) + f64::from(r));
        let a = dot(d, d);
        let b = dot(o, d);
        let discriminant = b * b - a * (dot(o, o) - rr * rr);
        let root = discriminant.max(0.0).sqrt();
        let truth = {
            let near = (-b - root) / a;
            if near >= 0.0 { near } else { (-b + root) / a }
        };
        // Cosine of incidence: what multiplies every error along the ray.
        let cosine = root / (a.sqrt() * rr);
        let unit = u * reach / (a.sqrt() * cosine);
        if cosine < 0.05 || (length(o) - rr).abs() < 1e-4 * reach || (reach / rr) * u > 1e-3 * cosine * cosine
        {
            continue;
        }
        hits += 1;
        match intersect_shape(&PreparedRay::new(&ray(origin, direction)), &shape, f32::INFINITY) {
            Some(t) if truth >= 0.0 => worst = worst.max((f64::from(t) - truth).abs() / unit),
            None if truth < 0.0 => {}
            _ => wrong += 1,
        }
    }
    println!("{hits} rays; worst t {worst:.2} u reach/cosine");
    assert!(hits > 200_000);
    assert_eq!(wrong, 0);
    assert!(worst <= 8.0, "t {worst}");
}

#[test]
fn disk_against_f64() {
    let u = 2f64.powi(-24);
    let mut random = Random(3);
    let (mut worst, mut hits) = (0f64, 0);
    for _ in 0..200_000 {
        let r = 10f32.powf(random.range(-2.0, 2.0));
        let c = random.vector(1.0);
        let n = random.direction() * 10f32.powf(random.range(-3.0, 3.0));
        let rim = n.cross(random.direction()).normalize_or_zero() * (r * random.range(0.0, 1.5));
        let origin = c + random.direction() * 10f32.powf(random.range(-1.0, 2.0));
        let direction = c + rim - origin;
        let (o, d, m) = (sub(wide(origin), wide(c)), wide(direction), wide(n));
        let t = -dot(m, o) / dot(m, d);
        let q = [o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]];
        let cosine = (dot(m, d) / length(m) / length(d)).abs();
        let unit = u * (length(o) + f64::from(r)) / cosine;
        let slack = length(q) - f64::from(r);
        if slack.abs() < 10.0 * unit {
            continue;
        }
        let hit = intersect_shape(
            &PreparedRay::new(&ray(origin, direction)),
            &RoundShape::disk(c.to_array(), n.to_array(), r),
            f32::INFINITY,
        );
        assert_eq!(hit.is_some(), slack < 0.0 && t >= 0.0);
        if let Some(hit) = hit {
            hits += 1;
            worst = worst.max((f64::from(hit) - t).abs() * length(d) / unit);
        }
    }
    println!("{hits} hits; worst t {worst:.2} u reach/cosine");
    assert!(hits > 50_000);
    assert!(worst <= 8.0, "t {worst}");
}

#[test]
fn special_places_on_spheres() {
    let unit = RoundShape::sphere([0.0; 3], 1.0);
    let t = |o: [f32; 3], d: [f32; 3]| {
        intersect_shape(
            &PreparedRay::new(&ray(Vec3::from_array(o), Vec3::from_array(d))),
            &unit,
            f32::INFINITY,
        )
    };
    assert_eq!(t([0.0, 0.0, -3.0], [0.0, 0.0, 1.0]), Some(2.0));
    assert_eq!(t([0.0, 0.0, -3.0], [0.0, 0.0, 4.0]), Some(0.5));
    assert_eq!(t([0.0; 3], [0.0, 0.0, 1.0]), Some(1.0));
    assert_eq!(t([0.0, 0.0, 1.0], [0.0, 0.0, 1.0]), Some(0.0));
    assert_eq!(t([0.0, 0.0, 1.0], [0.0, 0.0, -1.0]), Some(0.0));
    assert_eq!(t([0.0, 0.0, 1.0], [1.0, 0.0, 0.0]), Some(0.0));
    assert_eq!(t([0.0, 0.0, 3.0], [0.0, 0.0, 1.0]), None);
    // The ground as a planet, seen from 2 m: the textbook discriminant is off by metres here.
    let planet = RoundShape::sphere([0.0, 0.0, -6.4e6], 6.4e6);
    let up = PreparedRay::new(&ray(Vec3::new(0.0, 0.0, 2.0), Vec3::new(0.0, 0.0, -1.0)));
    assert_eq!(intersect_shape(&up, &planet, 100.0), Some(2.0));
    // A pea at a thousand kilometres.
    let pea = RoundShape::sphere([0.0, 0.0, 1e6], 0.5);
    let far = PreparedRay::new(&ray(Vec3::ZERO, Vec3::Z));
    assert_eq!(intersect_shape(&far, &pea, f32::INFINITY), Some(999_999.5));
}

#[test]
fn boxes_of_shapes_hold_the_shape() {
    let mut random = Random(4);
    for _ in 0..50_000 {
        let c = random.vector(100.0);
        let r = 10f32.powf(random.range(-3.0, 3.0));
        let n = random.direction();
        let w = n.cross(random.direction()).normalize_or_zero();
        for (shape, p) in
            [(RoundShape::sphere(c.to_array(), r), n), (RoundShape::disk(c.to_array(), n.to_array(), r), w)]
        {
            let b = bounds(&shape);
            let p64 = wide(p);
            for k in 0..3 {
                let x = f64::from(c[k]) + p64[k] / length(p64) * f64::from(r);
                // `w` itself is perpendicular only to 1e-7.
                let slack = if shape.kind == 1 { 4e-7 * f64::from(r) } else { 0.0 };
                assert!(f64::from(b.lo[k]) <= x + slack && x - slack <= f64::from(b.hi[k]));
            }
        }
    }
    let flat = bounds(&RoundShape::disk([1.0, 2.0, 3.0], [0.0, 0.0, -2.0], 0.5));
    assert_eq!((flat.lo.z, flat.hi.z), (3.0, 3.0));
    let primitives = Primitives { shapes: &[RoundShape::sphere([0.0; 3], -1.0)], ..Primitives::default() };
    assert!(primitives.bounds(0).is_empty() && primitives.bounds(1).is_empty());
}

/// Normals and areas over forty orders of magnitude: relative to what the shape of the triangle allows.
#[test]
fn normal_and_area_against_f64() {
    let mut random = Random(6);
    let (mut worst_n, mut worst_a) = (0f64, 0f64);
    for _ in 0..200_000 {
        let scale = 10f32.powf(random.range(-37.0, 37.0));
        let v = [0; 3].map(|_| random.vector(1.0) * scale);
        let w = v.map(wide);
        let (e1, e2) = (sub(w[1], w[0]), sub(w[2], w[0]));
        let truth = cross(e1, e2);
        let sine = length(truth) / (length(e1) * length(e2));
        // The largest angle: between the two shortest edges.
        let mut edges = [length(e1), length(e2), length(sub(w[2], w[1]))];
        edges.sort_by(f64::total_cmp);
        let largest = length(truth) / (edges[0] * edges[1]);
        if sine < 1e-3 {
            continue;
        }
        let n = wide(geometric_normal(v).expect("not degenerate"));
        let t = truth.map(|x| x / length(truth));
        worst_n = worst_n.max(length(sub(n, t)) * largest / f64::from(f32::EPSILON));
        let area = length(truth) / 2.0;
        if area > 1e-37 && area < 3e38 {
            let a = f64::from(triangle_area(v));
            worst_a = worst_a.max((a - area).abs() / area * sine / f64::from(f32::EPSILON));
        }
    }
    println!("normal {worst_n:.2} eps / largest sine, area {worst_a:.2} eps / sine");
    assert!(worst_n <= 4.0 && worst_a <= 4.0);
    assert_eq!(geometric_normal([Vec3::ONE; 3]), None);
    assert_eq!(geometric_normal([Vec3::ZERO, Vec3::X, Vec3::X * 3.0]), None);
    assert_eq!(triangle_area([Vec3::ZERO, Vec3::X, Vec3::X * 3.0]), 0.0);
    let tiny = [Vec3::ZERO, Vec3::X * 1e-42, Vec3::Y * 1e-42];
    assert_eq!(geometric_normal(tiny), Some(Vec3::Z));
    let huge = [Vec3::splat(-3e38), Vec3::new(3e38, -3e38, -3e38), Vec3::new(-3e38, 3e38, -3e38)];
    assert_eq!(geometric_normal(huge), Some(Vec3::Z));
    assert_eq!(triangle_area(huge), f32::INFINITY);
    // A needle of 1e38 by 1e-38, exactly representable as powers of two.
    let (long, thin) = (2f32.powi(126), 2f32.powi(-140));
    assert_eq!(triangle_area([Vec3::ZERO, Vec3::X * long, Vec3::Y * thin]), 2f32.powi(-15));
}
