//! Closed meshes and rays from within them, for every tree: aimed at vertices, at edges, along axes and anywhere.
#![allow(dead_code, reason = "each test uses a part; by itself it is an empty test")]
#![allow(clippy::disallowed_methods, reason = "set-up in f64")]

#[path = "geometry_support.rs"]
pub(crate) mod support;

use etendue_core::geometry::{Intersector, Primitives, Ray};
use etendue_core::math::Vec3;
use support::{Mesh, Random, ball, box_grid, ray};

/// What a ray is aimed at.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Aim {
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

/// How many rays of a kind get out of a closed mesh.
pub(crate) fn misses(
    mesh: &Mesh,
    tracer: &dyn Intersector,
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

pub(crate) const AIMS: [Aim; 5] = [Aim::Vertex, Aim::Edge, Aim::Anywhere, Aim::AxisVertex, Aim::GridPlane];

/// Shoots `rays` rays of each kind from within each closed mesh at the tree that `build` makes of it, and panics if one gets
/// out.
pub(crate) fn hold(
    levels: u32,
    grid: i32,
    rays: usize,
    build: impl for<'a> Fn(Primitives<'a>) -> Box<dyn Intersector + 'a>,
) {
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
        let tree = build(mesh.primitives());
        for aim in AIMS {
            let n = misses(mesh, &*tree, *center, *inside, aim, rays, seed as u64);
            println!("{name} ({} triangles), {aim:?}: {n} misses of {rays}", mesh.triangles.len());
            total += n;
        }
    }
    assert_eq!(total, 0, "rays left a closed mesh");
}
