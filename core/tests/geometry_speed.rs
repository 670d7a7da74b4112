//! Nanoseconds per test and per ray, not asserted. Run with
//! `cargo test -p etendue-core --release --test geometry_speed -- --ignored --nocapture`.
#![allow(clippy::disallowed_methods, reason = "set-up outside the measured part")]

#[path = "geometry_support.rs"]
mod support;

use etendue_core::geometry::{
    BruteForce, Bvh2, Intersector, PreparedRay, intersect_triangle, slab_entry, triangle_bounds,
};
use etendue_core::math::Vec3;
use std::hint::black_box;
use std::time::Instant;
use support::{Random, ball, ray};

/// The fastest of 2000 passes over 1024 items: other work on the machine does not count.
fn report<R, T>(name: &str, rays: &[R], items: &[T], test: impl Fn(&R, &T) -> u32) {
    let (mut best, mut total) = (f64::INFINITY, 0u32);
    for r in black_box(rays) {
        let start = Instant::now();
        total += black_box(items).iter().map(|item| test(r, item)).sum::<u32>();
        best = best.min(start.elapsed().as_secs_f64());
    }
    println!("{name}: {:.2} ns ({total} hits)", best * 1e9 / items.len() as f64);
}

#[test]
#[ignore = "timing; command in the file's head"]
fn nanoseconds() {
    let mesh = ball(5);
    let p = mesh.primitives();
    let triangles: Vec<[Vec3; 3]> = (0..1024u32).map(|i| p.vertices(i * 20).unwrap()).collect();
    let boxes: Vec<_> = triangles.iter().map(|v| triangle_bounds(*v)).collect();
    let mut random = Random(1);
    // Few hits (random rays) and all hits (one ray through each of many stacked triangles).
    let rays: Vec<PreparedRay> =
        (0..2000).map(|_| PreparedRay::new(&ray(random.vector(0.3), random.direction()))).collect();
    let stacked: Vec<[Vec3; 3]> = (0..1024)
        .map(|i| {
            let z = 2.0 + i as f32 / 64.0;
            [Vec3::new(-1e3, -1e3, z), Vec3::new(1e3, -1e3, z + 0.1), Vec3::new(0.0, 1e3, z)]
        })
        .collect();
    let up: Vec<PreparedRay> =
        (0..2000).map(|_| PreparedRay::new(&ray(random.vector(0.3), Vec3::Z + random.vector(0.3)))).collect();
    let inf = f32::INFINITY;
    let hit = |r: &PreparedRay, v: &[Vec3; 3]| u32::from(intersect_triangle(r, *v, inf).is_some());
    report("triangle", &rays, &triangles, hit);
    report("triangle, every one hit", &up, &stacked, hit);
    report("slab", &rays, &boxes, |r, b| u32::from(slab_entry(r, b.lo, b.hi, inf).is_some()));
    let start = Instant::now();
    let tree = Bvh2::new(p);
    println!("build 20k: {:.1} ms", start.elapsed().as_secs_f64() * 1e3);
    let outside: Vec<_> = (0..200_000).map(|_| ray(random.vector(0.5), random.direction())).collect();
    let start = Instant::now();
    let hits = outside.iter().filter(|r| tree.closest_hit(r).is_some()).count();
    println!("closest {:.0} ns ({hits})", start.elapsed().as_secs_f64() * 1e9 / outside.len() as f64);
    let start = Instant::now();
    let hits = outside.iter().filter(|r| tree.occluded(r)).count();
    println!("occluded {:.0} ns ({hits})", start.elapsed().as_secs_f64() * 1e9 / outside.len() as f64);
    let brute = BruteForce { primitives: p };
    let start = Instant::now();
    let hits = outside[..200].iter().filter(|r| brute.closest_hit(r).is_some()).count();
    println!("brute {:.2} ns/tri ({hits})", start.elapsed().as_secs_f64() * 1e9 / 200.0 / p.count() as f64);
}
