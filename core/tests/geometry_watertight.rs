//! No ray from inside a closed mesh gets out: aimed at vertices, at edges, along axes and anywhere.
//! Long run: `cargo test -p etendue-core --release --test geometry_watertight -- --ignored --nocapture`.

#[path = "geometry_closed.rs"]
mod closed;

use closed::support::{ball, box_grid};
use closed::{AIMS, hold, misses};
use etendue_core::geometry::{BruteForce, Bvh2};
use etendue_core::math::Vec3;

#[test]
fn no_ray_leaves_a_closed_mesh() {
    hold(5, 16, 3_000, |p| Box::new(Bvh2::new(p)));
}

#[test]
#[ignore = "15 M rays, minutes; command in the file's head"]
fn no_ray_leaves_a_closed_mesh_long() {
    hold(5, 40, 500_000, |p| Box::new(Bvh2::new(p)));
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
