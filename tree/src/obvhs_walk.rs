//! obvhs's own walks, as rivals: their node tests are not conservative and may lose a ray in a million.

use super::packed::{Leaves, build_bvh2, build_cwbvh};
use etendue_core::geometry::{Hit, Intersector, PreparedRay, Primitives, Ray};

/// The ray as obvhs wants it, with core's reciprocals (obvhs's own clamp them at 1e-7).
#[inline(always)]
fn foreign_ray(ray: &Ray, prepared: &PreparedRay) -> obvhs::ray::Ray {
    let inverse = |near: f32| near / (1.0 - 3.0 * f32::EPSILON);
    obvhs::ray::Ray {
        origin: ray.origin.into(),
        direction: ray.direction.into(),
        inv_direction: glam::Vec3A::new(
            inverse(prepared.near.x),
            inverse(prepared.near.y),
            inverse(prepared.near.z),
        ),
        tmin: 0.0,
        tmax: next_up(ray.t_max),
    }
}

/// obvhs accepts t < tmax; the next float above makes that t <= tmax.
#[inline(always)]
fn next_up(t: f32) -> f32 {
    if (0.0..f32::MAX).contains(&t) { f32::from_bits(t.to_bits() + 1) } else { t }
}

/// Takes a leaf's answer into `best`; returns obvhs's new limit, or infinity where nothing changed.
#[inline(always)]
fn take(best: &mut Option<Hit>, hit: Option<Hit>) -> f32 {
    match hit {
        Some(h) if best.is_none_or(|b| h.before(&b)) => {
            *best = Some(h);
            next_up(h.t)
        }
        _ => f32::INFINITY,
    }
}

macro_rules! obvhs_tree {
    ($name:ident, $tree:ty, $build:expr, $doc:literal) => {
        #[doc = $doc]
        pub struct $name {
            tree: $tree,
            leaves: Leaves,
        }

        impl $name {
            /// Builds the tree.
            pub fn build(primitives: &Primitives<'_>) -> Self {
                let tree = $build(primitives);
                let leaves = Leaves::new(primitives, &tree.primitive_indices);
                Self { tree, leaves }
            }
        }

        impl Intersector for $name {
            fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
                let prepared = PreparedRay::new(ray);
                let mut best = None;
                let mut hit = obvhs::ray::RayHit::none();
                self.tree.ray_traverse(foreign_ray(ray, &prepared), &mut hit, |_, place| {
                    let t_max = best.map_or(ray.t_max, |b: Hit| b.t);
                    take(&mut best, self.leaves.intersect(place, &prepared, t_max))
                });
                best
            }

            fn occluded(&self, ray: &Ray) -> bool {
                let prepared = PreparedRay::new(ray);
                !self.tree.ray_traverse_miss(foreign_ray(ray, &prepared), |_, place| {
                    match self.leaves.intersect(place, &prepared, ray.t_max) {
                        Some(_) => -1.0,
                        None => f32::INFINITY,
                    }
                })
            }
        }
    };
}

obvhs_tree!(Bvh2Tree, obvhs::bvh2::Bvh2, |p| build_bvh2(p, 8), "obvhs's binary tree, walked by obvhs.");
obvhs_tree!(
    CwbvhTree,
    obvhs::cwbvh::CwBvh,
    build_cwbvh,
    "obvhs's eight-wide compressed tree, walked by obvhs."
);
