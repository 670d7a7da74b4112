//! No ray from inside a closed mesh gets out: aimed at vertices, at edges, along axes and anywhere.
//! Long run: `cargo test -p etendue-core --release --test geometry_watertight -- --ignored --nocapture`.
#![allow(clippy::disallowed_methods, reason = "set-up in f64")]

#[path = "geometry_support.rs"]
mod support;

use etendue_core::geometry::{BruteForce, Bvh2, Intersector, Ray};
use etendue_core::math::Vec3;
use support::{Mesh, Random, ball, box_grid, ray};

/// What a ray is aimed at.
#[derive(Clone, Copy, Debug)]
enum Aim {
    Vertex,
    Edge,
    Anywhere,
    /// Parallel to an axis, through a vertex.
    AxisVertex,
    /// With one direction component zero and the origin in the plane of a vertex.
    GridPlane,
}

fn aimed(mesh: &Mesh, center: Vec3, inside: f32, aim: Aim, random: &mut Random) -> Ray {
    let vertex = |i: u32| Vec3::from_array(mesh.positions[i as usize]);
    let triangle = mesh.triangles[random.below(mesh.triangles.len())];
    let k = random.below(3);
    let (a, b) = (vertex(triangle[k]), vertex(triangle[(k + 1) % 3]));
    let mut origin = center + random.vector(inside);
    let target = match aim {
        Aim::Vertex | Aim::AxisVertex | Aim::GridPlane => a,
        Aim::Edge => a + (b - a) * random.unit(),
        Aim::Anywhere => return ray(origin, random.direction()),
    };
    match aim {
        Aim::AxisVertex => {
            // Move the origin onto the axis-parallel line through the vertex, if that stays inside.
            let axis = random.below(3);
            for other in [(axis + 1) % 3, (axis + 2) % 3] {
                if (target[other] - center[other]).abs() < inside {
                    origin[other] = target[other];
                }
            }
        }
        Aim::GridPlane => {
            let axis = random.below(3);
            if (target[axis] - center[axis]).abs() < inside {
                origin[axis] = target[axis];
            }
        }
        _ => {}
    }
    // Any length of direction must do.
    let scale = [1.0, 0.1, 1000.0][random.below(3)];
    ray(origin, (target - origin) * scale)
}

fn misses(
    mesh: &Mesh,
    tracer: &impl Intersector,
    center: Vec3,
    inside: f32,
    aim: Aim,
    rays: usize,
    seed: u64,
) -> usize {
    let mut random = Random(seed);
    (0..rays)
        .filter(|_| {
            let ray = aimed(mesh, center, inside, aim, &mut random);
            let hit = tracer.closest_hit(&ray);
            assert_eq!(hit.is_some(), tracer.occluded(&ray));
            hit.is_none()
        })
        .count()
}

const AIMS: [Aim; 5] = [Aim::Vertex, Aim::Edge, Aim::Anywhere, Aim::AxisVertex, Aim::GridPlane];

fn run(levels: u32, grid: i32, rays: usize) {
    let far = [1000.0, 500.0, -300.0];
    let cells = [
        ("ball", ball(levels), Vec3::ZERO, 0.5),
        ("ball, moved", ball(levels).moved(far), Vec3::from_array(far), 0.5),
        ("box", box_grid(grid), Vec3::ZERO, 0.999),
        ("box, oblique", box_grid(grid).oblique(), Vec3::ZERO, 0.55),
        ("box, moved", box_grid(grid).moved(far), Vec3::from_array(far), 0.999),
        ("box, oblique, moved", box_grid(grid).oblique().moved(far), Vec3::from_array(far), 0.55),
    ];
    let mut total = 0;
    for (seed, (name, mesh, center, inside)) in cells.iter().enumerate() {
        let tree = Bvh2::new(mesh.primitives());
        for aim in AIMS {
            let n = misses(mesh, &tree, *center, *inside, aim, rays, seed as u64);
            println!("{name} ({} triangles), {aim:?}: {n} misses of {rays}", mesh.triangles.len());
            total += n;
        }
    }
    assert_eq!(total, 0, "rays left a closed mesh");
}

#[test]
fn no_ray_leaves_a_closed_mesh() {
    run(5, 16, 3_000);
}

#[test]
#[ignore = "15 M rays, minutes; command in the file's head"]
fn no_ray_leaves_a_closed_mesh_long() {
    run(5, 40, 500_000);
}

#[test]
fn no_ray_leaves_a_small_mesh_by_brute_force() {
    let mut total = 0;
    for (seed, mesh) in [ball(1), ball(2), box_grid(2), box_grid(4).oblique()].iter().enumerate() {
        let brute = BruteForce { primitives: mesh.primitives() };
        for aim in AIMS {
            total += misses(mesh, &brute, Vec3::ZERO, 0.5, aim, 2_000, 100 + seed as u64);
        }
    }
    assert_eq!(total, 0);
}
