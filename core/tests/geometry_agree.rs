//! The tree and the oracle agree bit for bit, on soups made to disagree; rules for ties and interval ends.
//! Long run: `cargo test -p etendue-core --release --test geometry_agree -- --ignored`.
#![allow(clippy::disallowed_methods, reason = "set-up in f64")]

#[path = "geometry_support.rs"]
mod support;

use etendue_core::geometry::{
    Aabb, BruteForce, Bvh2, Hit, Intersector, NO_PRIMITIVE, PreparedRay, Primitives, Ray, RoundShape,
    slab_entry,
};
use etendue_core::math::Vec3;
use proptest::prelude::*;
use support::{Mesh, Random, ray};

fn bits(hit: Option<Hit>) -> [u32; 4] {
    hit.map_or([0, NO_PRIMITIVE, 0, 0], |h| [h.t.to_bits(), h.primitive, h.b1.to_bits(), h.b2.to_bits()])
}

/// Triangles from 1e-3 to 1e3, flat and oblique, degenerate, coincident, sharing vertices; shapes of every kind.
fn soup(random: &mut Random, count: usize) -> Mesh {
    let mut mesh = Mesh::default();
    let scales = [1e-3, 0.1, 1.0, 1.0, 30.0, 1e3];
    for _ in 0..count {
        let s = scales[random.below(scales.len())];
        let c = random.vector(5.0);
        let mut v = [c, c + random.vector(s), c + random.vector(s)];
        match random.below(10) {
            0 => v[1] = v[0],
            1 => v[2] = v[0] + (v[1] - v[0]) * 2.0,
            2 | 3 => {
                let axis = random.below(3);
                let level = random.range(-3.0, 3.0).round();
                v.iter_mut().for_each(|p| p[axis] = level);
            }
            4 => v = v.map(|p| p.round()),
            _ => {}
        }
        mesh.triangle(v.map(|p| p.to_array()));
        if random.below(6) == 0 {
            let again = mesh.triangles[random.below(mesh.triangles.len())];
            mesh.triangles.push([again[1], again[2], again[0]]);
            mesh.triangles.push(again);
        }
    }
    mesh.triangles.push([0, 1, u32::MAX]);
    for _ in 0..count / 4 {
        let c = random.vector(5.0).to_array();
        let r = [1e-3, 0.3, 1.0, 2.0, 1e3, 0.0, -1.0, 1.0][random.below(8)];
        let n = [Vec3::Z, -Vec3::X, random.direction(), random.direction(), Vec3::ZERO][random.below(5)];
        let shape = match random.below(9) {
            0..4 => RoundShape::sphere(c, r),
            4..8 => RoundShape::disk(c, n.to_array(), r),
            _ => RoundShape { kind: 7, radius: r, center: c, normal: [0.0; 3] },
        };
        mesh.shapes.push(shape);
        if random.below(4) == 0 {
            mesh.shapes.push(shape);
        }
    }
    mesh
}

fn soup_ray(mesh: &Mesh, random: &mut Random) -> Ray {
    let vertex = |r: &mut Random| Vec3::from_array(mesh.positions[r.below(mesh.positions.len())]);
    let origin = match random.below(4) {
        0 => vertex(random),
        1 => (vertex(random) + vertex(random)) * 0.5,
        2 => random.vector(5.0).round(),
        _ => random.vector(8.0),
    };
    let mut direction = match random.below(3) {
        0 => vertex(random) - origin,
        _ => random.direction() * [1.0, 1e-3, 300.0][random.below(3)],
    };
    for axis in 0..3 {
        if random.below(5) == 0 {
            direction[axis] = [0.0, -0.0, 1e-20][random.below(3)];
        }
    }
    let t_max = [f32::INFINITY, 1.0, 3.0, 0.0, -1.0][random.below(5)];
    Ray { origin, direction, t_max }
}

fn agree(soups: usize, rays: usize, size: usize) {
    let mut hits = 0usize;
    for seed in 0..soups {
        let mut random = Random(seed as u64);
        let mesh = soup(&mut random, 5 + seed % size);
        let brute = BruteForce { primitives: mesh.primitives() };
        let tree = Bvh2::new(mesh.primitives());
        for _ in 0..rays {
            let mut ray = soup_ray(&mesh, &mut random);
            let truth = brute.closest_hit(&ray);
            assert_eq!(bits(truth), bits(tree.closest_hit(&ray)), "{ray:?}");
            assert_eq!(truth.is_some(), brute.occluded(&ray));
            assert_eq!(truth.is_some(), tree.occluded(&ray));
            if let Some(hit) = truth {
                hits += 1;
                assert!(hit.t >= 0.0 && hit.t <= ray.t_max && hit.t.is_finite());
                assert!(hit.b1 >= 0.0 && hit.b2 >= 0.0 && hit.b1 + hit.b2 <= 1.0);
                // The end of the interval is included, and what was found does not depend on it.
                ray.t_max = hit.t;
                assert_eq!(bits(truth), bits(tree.closest_hit(&ray)));
                assert_eq!(bits(truth), bits(brute.closest_hit(&ray)));
                if hit.t > 0.0 {
                    ray.t_max = hit.t.next_down();
                    assert_eq!(None, brute.closest_hit(&ray));
                    assert!(!tree.occluded(&ray));
                }
            }
        }
    }
    assert!(hits > soups * rays / 20, "the soup was too thin: {hits}");
}

#[test]
fn tree_and_oracle_agree_bit_for_bit() {
    agree(40, 1_000, 120);
}

#[test]
#[ignore = "100 times the rays; command in the file's head"]
fn tree_and_oracle_agree_bit_for_bit_long() {
    agree(2_000, 2_000, 400);
}

#[test]
fn ties_go_to_the_lowest_number() {
    let mut mesh = Mesh::default();
    let v = [[-1.0, -1.0, 2.0], [1.0, -1.0, 2.0], [0.0, 1.0, 2.0]];
    for _ in 0..9 {
        mesh.triangle(v);
    }
    mesh.shapes.push(RoundShape::disk([0.0, 0.0, 2.0], [0.0, 0.0, 1.0], 1.0));
    mesh.shapes.push(RoundShape::sphere([0.0, 0.0, 3.0], 1.0));
    for skip in 0..mesh.triangles.len() {
        let part = Primitives { triangles: &mesh.triangles[skip..], ..mesh.primitives() };
        let ray = ray(Vec3::ZERO, Vec3::Z);
        let hit = Bvh2::new(part).closest_hit(&ray).unwrap();
        assert_eq!((hit.primitive, hit.t), (0, 2.0));
        assert_eq!(Some(hit), BruteForce { primitives: part }.closest_hit(&ray));
    }
}

#[test]
fn both_ends_of_the_interval_are_included() {
    let mut mesh = Mesh::default();
    mesh.triangle([[-1.0, -1.0, 2.0], [1.0, -1.0, 2.0], [0.0, 1.0, 2.0]]);
    let brute = BruteForce { primitives: mesh.primitives() };
    let at = |z: f32, d: Vec3, t_max: f32| {
        brute.closest_hit(&Ray { origin: Vec3::new(0.1, 0.1, z), direction: d, t_max }).map(|h| h.t)
    };
    assert_eq!(at(0.0, Vec3::Z, 2.0), Some(2.0));
    assert_eq!(at(0.0, Vec3::Z, 2f32.next_down()), None);
    assert_eq!(at(0.0, Vec3::Z * 4.0, 0.5), Some(0.5));
    assert_eq!(at(2.0, Vec3::Z, 0.0), Some(0.0));
    assert_eq!(at(2.0, -Vec3::Z, 5.0), Some(0.0));
    assert_eq!(at(2f32.next_up(), Vec3::Z, 5.0), None);
    assert_eq!(at(0.0, Vec3::Z, f32::NAN), None);
    assert_eq!(at(0.0, Vec3::ZERO, 5.0), None);
    assert_eq!(at(0.0, Vec3::Z * 1e-30, f32::INFINITY), None);
}

/// Origins in the plane of a flat triangle hit at exactly 0 whatever the direction; so do origins at a vertex.
#[test]
fn a_triangle_that_contains_the_origin_is_hit_at_zero() {
    let mut random = Random(5);
    let mut inside = 0;
    for _ in 0..20_000 {
        let axis = random.below(3);
        let level = random.range(-2.0, 2.0);
        let mut v = [random.vector(3.0), random.vector(3.0), random.vector(3.0)];
        v.iter_mut().for_each(|p| p[axis] = level);
        let (b1, b2) = (random.range(0.05, 0.45), random.range(0.05, 0.45));
        let origin = v[0] + ((v[1] - v[0]) * b1 + (v[2] - v[0]) * b2);
        let mut mesh = Mesh::default();
        mesh.triangle(v.map(|p| p.to_array()));
        let direction = random.direction();
        let n = (v[1] - v[0]).cross(v[2] - v[0]).length();
        if n < 0.5 || direction[axis].abs() < 0.01 {
            continue;
        }
        inside += 1;
        let tree = Bvh2::new(mesh.primitives());
        assert_eq!(tree.closest_hit(&ray(origin, direction)).map(|h| h.t), Some(0.0), "{v:?} {direction}");
        let oblique = mesh.oblique();
        let at = Vec3::from_array(oblique.positions[random.below(3)]);
        let hit = BruteForce { primitives: oblique.primitives() }.closest_hit(&ray(at, direction));
        assert_eq!(hit.map(|h| h.t), Some(0.0));
    }
    assert!(inside > 10_000);
}

#[test]
fn boxes() {
    let p = |o: [f32; 3], d: [f32; 3]| PreparedRay::new(&ray(Vec3::from_array(o), Vec3::from_array(d)));
    let inf = f32::INFINITY;
    let one = (Vec3::splat(-1.0), Vec3::splat(1.0));
    let entry = |r: PreparedRay, (lo, hi): (Vec3, Vec3), t: f32| slab_entry(&r, lo, hi, t);
    let x = entry(p([-3.0, 0.0, 0.0], [1.0, 0.0, 0.0]), one, inf).unwrap();
    assert!((2.0 - 1e-6..=2.0).contains(&x));
    assert_eq!(entry(p([0.5, 0.2, 0.1], [1.0, -0.0, 0.0]), one, inf), Some(0.0));
    assert_eq!(entry(p([-3.0, 0.0, 0.0], [-1.0, 0.0, 0.0]), one, inf), None);
    assert_eq!(entry(p([-3.0, 0.0, 0.0], [1.0, 0.0, 0.0]), one, 1.9), None);
    assert_eq!(entry(p([0.0; 3], [1.0, 1.0, 1.0]), (Aabb::EMPTY.lo, Aabb::EMPTY.hi), inf), None);
    assert_eq!(entry(p([0.0; 3], [-1.0, 1.0, 0.0]), (Aabb::EMPTY.lo, Aabb::EMPTY.hi), inf), None);
    // On a flat box, and on its rim.
    let flat = (Vec3::new(-1.0, -1.0, 0.0), Vec3::new(1.0, 1.0, 0.0));
    for d in [[1.0, 0.0, 0.0], [0.0, -0.0, 1.0], [0.3, 0.2, -1.0]] {
        assert_eq!(entry(p([0.0, 0.0, 0.0], d), flat, inf), Some(0.0));
        assert_eq!(entry(p([-1.0, -1.0, 0.0], [d[0].abs(), d[1].abs(), d[2]]), flat, inf), Some(0.0));
    }
    // A box without inside is still met when it is a point on the ray.
    assert!(
        entry(p([0.0; 3], [1.0, 2.0, 3.0]), (Vec3::new(1.0, 2.0, 3.0), Vec3::new(1.0, 2.0, 3.0)), inf)
            .is_some()
    );
}

#[test]
fn batches_equal_single_queries() {
    let mut random = Random(77);
    let mesh = soup(&mut random, 60);
    let tree = Bvh2::new(mesh.primitives());
    let rays: Vec<Ray> = (0..500).map(|_| soup_ray(&mesh, &mut random)).collect();
    let (mut hits, mut occluded) = (vec![None; 500], vec![false; 500]);
    tree.closest_hits(&rays, &mut hits);
    tree.occluded_each(&rays, &mut occluded);
    for i in 0..500 {
        assert_eq!(bits(hits[i]), bits(tree.closest_hit(&rays[i])));
        assert_eq!(occluded[i], hits[i].is_some());
    }
    assert!(Bvh2::new(Primitives::default()).closest_hit(&rays[0]).is_none());
}

/// Every finite float, subnormals and 3e38 included, evenly over the exponents; half of the time from few values.
fn any_finite() -> impl Strategy<Value = f32> {
    prop_oneof![
        any::<u32>().prop_map(f32::from_bits).prop_filter("finite", |x| x.is_finite()),
        prop::sample::select(vec![
            0.0,
            -0.0,
            1.0,
            -1.0,
            1e-45,
            -1e-40,
            1e38,
            -3.4e38,
            f32::MAX,
            1e-18,
            1e19,
            0.5
        ]),
    ]
}

fn any_vector() -> impl Strategy<Value = [f32; 3]> {
    [any_finite(), any_finite(), any_finite()]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn any_finite_input_gives_values_and_agreement(
        positions in prop::collection::vec(any_vector(), 6..18),
        shapes in prop::collection::vec((0u32..3, any_finite(), any_vector(), any_vector()), 0..6),
        origin in any_vector(), direction in any_vector(), t_max in any_finite(),
    ) {
        let triangles: Vec<[u32; 3]> = (0..positions.len() as u32 - 2).map(|i| [i, i + 1, i + 2]).collect();
        let shapes: Vec<RoundShape> = shapes
            .into_iter()
            .map(|(kind, radius, center, normal)| RoundShape { kind, radius, center, normal })
            .collect();
        let primitives = Primitives { positions: &positions, triangles: &triangles, shapes: &shapes };
        let (brute, tree) = (BruteForce { primitives }, Bvh2::new(primitives));
        for t_max in [t_max, f32::INFINITY] {
            let ray = Ray { origin: Vec3::from_array(origin), direction: Vec3::from_array(direction), t_max };
            let hit = brute.closest_hit(&ray);
            prop_assert_eq!(bits(hit), bits(tree.closest_hit(&ray)));
            prop_assert_eq!(hit.is_some(), tree.occluded(&ray));
            if let Some(h) = hit {
                prop_assert!(h.t >= 0.0 && h.t <= t_max && h.t < f32::INFINITY);
                prop_assert!(h.b1 >= 0.0 && h.b2 >= 0.0 && h.b1 + h.b2 <= 1.0);
            }
        }
    }
}
