//! Rays against triangles and round shapes: the one test that every tree must agree with.
//!
//! A ray is `origin + t direction` with `t` in `[0, t_max]`, both ends included; lengths are metres, `t` is in
//! units of `|direction|`. The triangle test is that of Woop, Benthin and Wald, "Watertight Ray/Triangle
//! Intersection" (JCGT 2(1), 2013) in plain f32 products and differences; the box test is the conservative form of
//! Ize, "Robust BVH Ray Traversal" (JCGT 2(2), 2013).
//!
//! **Any tree gives the same bits.** Each primitive's `t` is clamped from below to the entry of the ray into the
//! primitive's own box, and missing that box is a miss. Rounding is monotone, so a box that contains another is
//! never entered later nor left earlier: a tree whose nodes are tested with [`slab_entry`] (or with anything more
//! generous), and visited while `entry <= t`, finds the same `t`, the same primitive and the same barycentrics as
//! [`BruteForce`]. Ties go to the smallest `t`, then to the lowest primitive index.

mod bvh2;
mod hilbert;
mod primitives;
mod ray;
mod shape;
mod surface;
mod triangle;

pub use bvh2::{BoxTree, Bvh2};
pub use hilbert::{HilbertGrid, hilbert_index};
pub use primitives::{BruteForce, Hit, Intersector, NO_PRIMITIVE, PrimitiveId, Primitives};
pub use ray::{Aabb, PreparedRay, Ray, slab_entry};
pub use shape::{DISK, RoundShape, SPHERE, bounds, intersect_shape, shape_normal};
pub use surface::{
    SurfacePoint, geometric_normal, hit_point, hit_point_with, interpolate, offset_origin, segment,
    shape_point, sliver_factor, triangle_area,
};
pub use triangle::{TriangleHit, intersect_triangle, triangle_bounds};
