//! Primitives in the order of a tree's leaves, and the obvhs builder behind one call.

use etendue_core::geometry::{
    Aabb, Hit, PreparedRay, Primitives, RoundShape, intersect_shape, intersect_triangle,
};
use etendue_core::math::Vec3;
use obvhs::{Boundable, BvhBuildParams};
use rayon::prelude::*;

/// A primitive as a leaf holds it.
#[derive(Clone, Copy, Debug)]
struct Packed {
    /// Vertices of a triangle; of a round shape, unused.
    vertices: [Vec3; 3],
    /// Number of the primitive in the scene.
    id: u32,
}

/// Primitives in leaf order.
#[derive(Clone, Debug, Default)]
pub(super) struct Leaves {
    packed: Vec<Packed>,
    shapes: Vec<RoundShape>,
    /// First number that belongs to a round shape.
    first_shape: u32,
}

impl Leaves {
    /// Packs primitives in the order of `indices`.
    pub(super) fn new(primitives: &Primitives<'_>, indices: &[u32]) -> Self {
        let packed = indices
            .iter()
            .map(|&id| Packed { vertices: primitives.vertices(id).unwrap_or([Vec3::ZERO; 3]), id })
            .collect();
        Self { packed, shapes: primitives.shapes.to_vec(), first_shape: primitives.triangles.len() as u32 }
    }

    /// Tests the primitive at a place of the leaf order.
    #[inline(always)]
    pub(super) fn intersect(&self, place: usize, ray: &PreparedRay, t_max: f32) -> Option<Hit> {
        let p = self.packed.get(place)?;
        if p.id >= self.first_shape {
            let t = intersect_shape(ray, self.shapes.get((p.id - self.first_shape) as usize)?, t_max)?;
            return Some(Hit { t, primitive: p.id, b1: 0.0, b2: 0.0 });
        }
        let hit = intersect_triangle(ray, p.vertices, t_max)?;
        Some(Hit { t: hit.t, primitive: p.id, b1: hit.b1, b2: hit.b2 })
    }

    /// Number of primitives.
    pub(super) fn len(&self) -> usize {
        self.packed.len()
    }
}

struct Bounds(Aabb);

impl Boundable for Bounds {
    fn aabb(&self) -> obvhs::aabb::Aabb {
        obvhs::aabb::Aabb::new(self.0.lo.into(), self.0.hi.into())
    }
}

/// Builds obvhs's binary tree with its medium settings: no pre-splitting, so each primitive occurs once.
pub(super) fn build_bvh2(primitives: &Primitives<'_>, per_leaf: u32) -> obvhs::bvh2::Bvh2 {
    let bounds: Vec<Bounds> =
        (0..primitives.count() as u32).map(|id| Bounds(primitives.bounds(id))).collect();
    let config = BvhBuildParams { max_prims_per_leaf: per_leaf, ..BvhBuildParams::medium_build() };
    let mut time = core::time::Duration::default();
    obvhs::bvh2::builder::build_bvh2(&bounds, config, &mut time)
}

/// How long to look for a good tree.
///
/// Measured against the standard one (`cargo bench --bench rays`): the times on 995 000 triangles and two threads, conversion included.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Effort {
    /// For scenes that are edited all the time: half of the time, and rays a tenth slower, on scenes of large triangles up to two fifths.
    Quick,
    /// For most.
    #[default]
    Standard,
    /// For long renders: three times the time, and rays up to 3 % faster.
    Thorough,
}

/// The same over some of the primitives, one to a leaf.
pub(super) fn build_bvh2_of(primitives: &Primitives<'_>, ids: &[u32], effort: Effort) -> obvhs::bvh2::Bvh2 {
    let bounds: Vec<Bounds> = ids.par_iter().map(|id| Bounds(primitives.bounds(*id))).collect();
    let preset = match effort {
        Effort::Quick => BvhBuildParams::fastest_build(),
        // A search by pairs from the second step on, and twice the reinsertions: measured, 8 % more rays a second.
        Effort::Standard => BvhBuildParams {
            search_depth_threshold: 1,
            reinsertion_batch_ratio: 0.1,
            ..BvhBuildParams::medium_build()
        },
        Effort::Thorough => BvhBuildParams {
            search_depth_threshold: 1,
            reinsertion_batch_ratio: 1.0,
            post_collapse_reinsertion_batch_ratio_multiplier: 0.0,
            ..BvhBuildParams::medium_build()
        },
    };
    let config = BvhBuildParams { max_prims_per_leaf: 1, ..preset };
    let mut time = core::time::Duration::default();
    obvhs::bvh2::builder::build_bvh2(&bounds, config, &mut time)
}

/// Builds obvhs's eight-wide compressed tree with its medium settings.
pub(super) fn build_cwbvh(primitives: &Primitives<'_>) -> obvhs::cwbvh::CwBvh {
    let bounds: Vec<Bounds> =
        (0..primitives.count() as u32).map(|id| Bounds(primitives.bounds(id))).collect();
    let mut time = core::time::Duration::default();
    obvhs::cwbvh::builder::build_cwbvh(&bounds, BvhBuildParams::medium_build(), &mut time)
}
