//! Rays that leave an offset point never meet what they leave: own triangle, its coplanar neighbours, own shape.
//! Long run: `cargo test -p etendue-core --release --test geometry_offset -- --ignored --nocapture`.
#![allow(clippy::disallowed_methods, reason = "set-up in f64")]

#[path = "geometry_support.rs"]
mod support;

use etendue_core::geometry::{
    BruteForce, Bvh2, Intersector, PreparedRay, RoundShape, SurfacePoint, geometric_normal, hit_point,
    intersect_shape, intersect_triangle, offset_origin, segment, shape_normal, shape_point,
};
use etendue_core::math::Vec3;
use support::{Mesh, Random, ball, ray};

/// Cosine from `10^-decades` to 1, evenly in its logarithm, about `n`.
fn leaving(n: Vec3, decades: f32, random: &mut Random) -> Vec3 {
    let cosine = 10f32.powf(-decades * random.unit());
    // A short cross product is perpendicular only to eps over its length, which is above 1e-6.
    let cross = n.cross(random.direction());
    let tangent = if cross.length() > 0.3 { cross.normalize() } else { n.any_orthonormal_vector() };
    (tangent * (1.0 - cosine * cosine).sqrt() + n * cosine) * [1.0, 1e-3, 50.0][random.below(3)]
}

/// Barycentrics anywhere, also on edges and at vertices.
fn barycentrics(random: &mut Random) -> (f32, f32) {
    match random.below(8) {
        0 => [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)][random.below(3)],
        1 => [(0.0, random.unit()), (random.unit(), 0.0)][random.below(2)],
        _ => {
            let (a, b) = (random.unit(), random.unit());
            if a + b > 1.0 { (1.0 - a, 1.0 - b) } else { (a, b) }
        }
    }
}

/// A parallelogram of the given sides about `center`, in two halves: oblique or in an axis plane.
fn quad(center: Vec3, size: f32, ratio: f32, flat: bool, random: &mut Random) -> [[Vec3; 3]; 2] {
    let (e1, e2) = if flat {
        let axis = random.below(3);
        (Vec3::AXES[(axis + 1) % 3] * size, Vec3::AXES[(axis + 2) % 3] * size * ratio)
    } else {
        let e1 = random.direction();
        let e2 = e1.cross(random.direction()).normalize_or(e1.any_orthonormal_vector());
        (e1 * size, e2 * size * ratio)
    };
    let p = center - e1 * random.unit() - e2 * random.unit();
    [[p, p + e1, p + e1 + e2], [p, p + e1 + e2, p + e2]]
}

/// One line of the list of scenes.
struct Scene {
    name: &'static str,
    /// Centres lie within this distance of the origin, then everything is moved.
    spread: f32,
    moved: f32,
    sizes: [f32; 2],
    /// Second side of a quad over its first.
    ratio: f32,
    /// Smallest cosine, as decades. The two halves of a long quad are coplanar only to eps / ratio, so a direction
    /// 1e-6 above the one may lie below the other.
    decades: f32,
}

const fn scene(
    name: &'static str,
    spread: f32,
    moved: f32,
    sizes: [f32; 2],
    ratio: f32,
    decades: f32,
) -> Scene {
    Scene { name, spread, moved, sizes, ratio, decades }
}

const SCENES: [Scene; 6] = [
    scene("unit", 1.0, 0.0, [0.3, 2.0], 0.7, 6.0),
    scene("moved by 1e5", 1.0, 1e5, [0.5, 2.0], 0.7, 6.0),
    scene("1e-3 and 1e3 together", 1.0, 0.0, [1e-3, 1e3], 0.7, 6.0),
    scene("huge quads", 1e3, 0.0, [1e4, 1e5], 1.0, 6.0),
    scene("long quads", 1.0, 0.0, [1.0, 1e3], 0.05, 5.0),
    scene("slivers", 1.0, 0.0, [1.0, 1e3], 0.01, 4.0),
];

/// Hits of own triangle, its other half and reordered duplicates, with the offset scaled by `factor`.
fn self_hits(scene: &Scene, flat: bool, rays: usize, factor: f32, seed: u64) -> usize {
    let &Scene { spread, moved, sizes, ratio, decades, .. } = scene;
    let mut random = Random(seed);
    let mut hits = 0;
    for i in 0..rays / 16 {
        let center = random.vector(spread) + random.direction().signum() * moved;
        let halves = quad(center, sizes[i % 2], ratio, flat, &mut random);
        let own = random.below(2);
        let v = halves[own];
        let turn = random.below(3);
        let v = [v[turn], v[(turn + 1) % 3], v[(turn + 2) % 3]];
        let Some(n) = geometric_normal(v) else { continue };
        let twin = [v[1], v[2], v[0]];
        let back = [v[2], v[1], v[0]];
        for _ in 0..16 {
            let (b1, b2) = barycentrics(&mut random);
            let point = hit_point(v, b1, b2);
            let side = if random.below(2) == 0 { n } else { -n };
            let d = leaving(side, decades, &mut random);
            let full = offset_origin(&point, n, d);
            let origin = point.position + (full - point.position) * factor;
            let r = PreparedRay::new(&ray(origin, d));
            for tested in [v, twin, back, halves[1 - own]] {
                hits += usize::from(intersect_triangle(&r, tested, f32::INFINITY).is_some());
            }
        }
    }
    hits
}

fn shape_self_hits(rays: usize, factor: f32) -> usize {
    let mut random = Random(9);
    let mut hits = 0;
    for i in 0..rays {
        let moved = [0.0, 0.0, 1e5][i % 3];
        let c = random.vector(1.0) + random.direction().signum() * moved;
        let r = if moved > 0.0 { random.range(0.5, 20.0) } else { 10f32.powf(random.range(-3.0, 3.0)) };
        let w = random.direction();
        let (shape, p) = if random.below(2) == 0 {
            (RoundShape::sphere(c.to_array(), r), c + w * r)
        } else {
            let n = if random.below(3) == 0 { Vec3::AXES[random.below(3)] } else { random.direction() };
            let p = c + n.cross(w) * r * 0.99;
            (RoundShape::disk(c.to_array(), n.to_array(), r), p)
        };
        let point = shape_point(&shape, p);
        let n = shape_normal(&shape, point.position).unwrap();
        // A sphere is left outward (inward its far side is rightly hit), a disk on both sides.
        let side = if shape.kind == etendue_core::geometry::SPHERE || random.below(2) == 0 { n } else { -n };
        let d = leaving(side, 6.0, &mut random);
        let full = offset_origin(&point, n, d);
        let origin = point.position + (full - point.position) * factor;
        let prepared = PreparedRay::new(&ray(origin, d));
        hits += usize::from(intersect_shape(&prepared, &shape, f32::INFINITY).is_some());
    }
    hits
}

#[test]
fn leaving_rays_never_meet_their_own_surface() {
    for scene in &SCENES {
        for flat in [false, true] {
            let n = self_hits(scene, flat, 100_000, 1.0, 3);
            assert_eq!(n, 0, "{} flat {flat}", scene.name);
        }
    }
    // The same measurement finds thousands when nothing is moved.
    assert!(self_hits(&SCENES[0], false, 10_000, 0.0, 3) > 1_000);
}

#[test]
fn leaving_rays_never_meet_their_own_shape() {
    assert_eq!(shape_self_hits(100_000, 1.0), 0);
    assert!(shape_self_hits(10_000, 0.0) > 1_000);
}

/// An extent that overflows, a normal with zeros, a point at the limits: still no NaN.
#[test]
fn offsets_are_never_nan() {
    for extent in [0.0, 1e-45, 1.0, f32::MAX, f32::INFINITY] {
        for position in [Vec3::ZERO, Vec3::splat(-3e38), Vec3::new(1e-40, 1.0, 1e38)] {
            for toward in [Vec3::Z, -Vec3::Z, Vec3::ZERO, Vec3::splat(3e38)] {
                let o = offset_origin(&SurfacePoint { position, extent }, Vec3::Z, toward);
                assert!(!o.is_nan());
            }
        }
    }
    let side =
        |toward: Vec3| offset_origin(&SurfacePoint { position: Vec3::ONE, extent: 1.0 }, Vec3::Z, toward).z;
    assert!(side(Vec3::Z) > 1.0 && side(-Vec3::Z) < 1.0 && side(Vec3::X) > 1.0);
}

/// Also prints how many hits smaller offsets would give: the margin of the constants.
#[test]
#[ignore = "10^7 rays a scene, minutes; command in the file's head"]
fn leaving_rays_never_meet_their_own_surface_long() {
    for scene in &SCENES {
        for flat in [false, true] {
            let margin: Vec<(f32, usize)> = [0.0, 0.125, 0.25, 0.35, 0.5, 0.7]
                .into_iter()
                .map(|f| (f, self_hits(scene, flat, 1_000_000, f, 4)))
                .collect();
            let n = self_hits(scene, flat, 10_000_000, 1.0, 5);
            println!("{}, flat {flat}: {n} of 1e7; of 1e6 with the offset scaled: {margin:?}", scene.name);
            assert_eq!(n, 0);
        }
    }
}

#[test]
#[ignore = "10^7 rays; command in the file's head"]
fn leaving_rays_never_meet_their_own_shape_long() {
    let margin: Vec<(f32, usize)> =
        [0.0, 0.125, 0.25, 0.35, 0.5, 0.7].into_iter().map(|f| (f, shape_self_hits(1_000_000, f))).collect();
    let n = shape_self_hits(10_000_000, 1.0);
    println!("shapes: {n} of 1e7; of 1e6 with the offset scaled: {margin:?}");
    assert_eq!(n, 0);
}

/// A box of 1e-3 on a floor of 1e3, level and tilted: a floor point 2e-4 from the box is in its shadow.
#[test]
fn a_small_box_on_a_large_floor_shadows_its_contact() {
    let mut floor = Mesh::default();
    let f = 500.0;
    floor.triangle([[-f, -f, 0.0], [f, -f, 0.0], [f, f, 0.0]]);
    floor.triangle([[-f, -f, 0.0], [f, f, 0.0], [-f, f, 0.0]]);
    // The wall of the box that faces -x, 1e-3 high and wide, its foot on the floor at x = 0.
    let w = 5e-4;
    floor.triangle([[0.0, -w, 0.0], [0.0, w, 0.0], [0.0, w, 1e-3]]);
    floor.triangle([[0.0, -w, 0.0], [0.0, w, 1e-3], [0.0, -w, 1e-3]]);
    // The floor point, then directions to the light: 45 degrees and nearly level.
    let positions = vec![[-2e-4, 0.0, 0.0], [1.0, 0.0, 1.0], [1.0, 0.0, 0.01]];
    let probe = Mesh { positions, ..Mesh::default() };
    for (floor, probe) in [(floor.clone(), probe.clone()), (floor.oblique(), probe.oblique())] {
        let brute = BruteForce { primitives: floor.primitives() };
        let target = Vec3::from_array(probe.positions[0]);
        let n = geometric_normal(floor.primitives().vertices(0).unwrap()).unwrap();
        // The floor point by a ray from above, as a renderer finds it.
        let down = brute.closest_hit(&ray(target + n, -n)).unwrap();
        let point = hit_point(floor.primitives().vertices(down.primitive).unwrap(), down.b1, down.b2);
        assert!(down.primitive < 2 && (point.position - target).length() < 1.5e-4);
        for to_light in [probe.positions[1], probe.positions[2]].map(Vec3::from_array) {
            let origin = offset_origin(&point, n, to_light);
            let height = (origin - point.position).length();
            assert!(height < 4e-4, "offset {height}");
            let hit = brute.closest_hit(&ray(origin, to_light)).expect("contact shadow");
            assert!(hit.primitive >= 2);
        }
    }
}

/// Segments between offset points of two surfaces that see each other are blocked by neither.
fn segment_hits(pairs: usize, seed: u64) -> (usize, usize) {
    let mut random = Random(seed);
    let (mut blocked, mut tested) = (0, 0);
    while tested < pairs {
        let moved = random.direction().signum() * [0.0, 0.0, 1e4][random.below(3)];
        let sizes = [1e-2, 1.0, 100.0];
        let make = |random: &mut Random| {
            let spread = [1.0, 100.0][random.below(2)];
            let (c, size, flat) =
                (random.vector(spread) + moved, sizes[random.below(3)], random.below(3) == 0);
            quad(c, size, 0.7, flat, random)
        };
        let (a, b) = (make(&mut random), make(&mut random));
        let ((b1, b2), (c1, c2)) = (barycentrics(&mut random), barycentrics(&mut random));
        let (p, q) = (hit_point(a[0], b1, b2), hit_point(b[0], c1, c2));
        let d = q.position - p.position;
        let length = d.length();
        let (Some(n), Some(m)) = (geometric_normal(a[0]), geometric_normal(b[0])) else { continue };
        // Grazing down to 1e-4 on either side; not where one quad cuts the other near the points.
        if (d.dot(n) / length).abs() < 1e-4 || (d.dot(m) / length).abs() < 1e-4 {
            continue;
        }
        let mut mesh = Mesh::default();
        for t in a.iter().chain(&b) {
            mesh.triangle(t.map(|v| v.to_array()));
        }
        let inside = |n: Vec3, o: Vec3, quad: &[[Vec3; 3]; 2]| {
            let s = quad.as_flattened().iter().map(|v| n.dot(*v - o));
            s.clone().fold(f32::INFINITY, f32::min) > 1e-3 * length
                || s.fold(f32::NEG_INFINITY, f32::max) < -1e-3 * length
        };
        if !inside(n, p.position, &b) || !inside(m, q.position, &a) {
            continue;
        }
        let from = offset_origin(&p.within(length), n, d);
        let to = offset_origin(&q.within(length), m, -d);
        // Nor where the planes are closer than the offsets (the moved scenes have ulps of 1e-3).
        let offsets = (from - p.position).length() + (to - q.position).length();
        if d.dot(n).abs() < 4.0 * offsets || d.dot(m).abs() < 4.0 * offsets {
            continue;
        }
        tested += 1;
        let ray = segment(from, to);
        blocked += usize::from(BruteForce { primitives: mesh.primitives() }.occluded(&ray));
    }
    (blocked, tested)
}

#[test]
fn segments_do_not_meet_their_ends() {
    assert_eq!(segment_hits(100_000, 21).0, 0);
}

#[test]
#[ignore = "10^7 segments; command in the file's head"]
fn segments_do_not_meet_their_ends_long() {
    let (blocked, tested) = segment_hits(10_000_000, 22);
    println!("{blocked} of {tested} segments blocked by their own ends");
    assert_eq!(blocked, 0);
}

/// Inside a convex mesh all pairs of surface points see each other.
#[test]
fn all_points_of_a_convex_mesh_see_each_other() {
    let mut mesh = ball(3);
    for p in &mut mesh.positions {
        let v = Vec3::from_array(*p);
        *p = (v / v.length()).to_array();
    }
    let tree = Bvh2::new(mesh.primitives());
    let mut random = Random(31);
    let mut blocked = 0;
    for _ in 0..50_000 {
        let mut pick = || {
            let v = mesh.primitives().vertices(random.below(mesh.triangles.len()) as u32).unwrap();
            let (b1, b2) = (0.1 + 0.4 * random.unit(), 0.1 + 0.4 * random.unit());
            (hit_point(v, b1, b2), geometric_normal(v).unwrap())
        };
        let ((p, n), (q, m)) = (pick(), pick());
        let d = q.position - p.position;
        if d.length() < 0.2 {
            continue;
        }
        let length = d.length();
        let ray = segment(offset_origin(&p.within(length), n, d), offset_origin(&q.within(length), m, -d));
        blocked += usize::from(tree.occluded(&ray));
    }
    assert_eq!(blocked, 0);
}
