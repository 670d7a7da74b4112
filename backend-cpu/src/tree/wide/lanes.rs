//! What the walk asks of a node and of a block, and the portable answer.
//!
//! Each instruction set answers with the same operations in the same order, those of core's scalar tests
//! ([`etendue_core::geometry::slab_entry`], [`etendue_core::geometry::intersect_triangle`]), so all give the same bits.

use super::layout::{Block, LANES, Node, WIDTH};
use etendue_core::geometry::{PreparedRay, intersect_triangle, slab_entry};
use etendue_core::math::Vec3;

/// Where a ray meets the triangles of a block; lanes that it misses hold anything.
#[derive(Clone, Copy, Debug)]
pub(super) struct BlockHits {
    /// Ray parameters.
    pub(super) t: [f32; LANES],
    /// Barycentrics of vertex 1.
    pub(super) b1: [f32; LANES],
    /// Barycentrics of vertex 2.
    pub(super) b2: [f32; LANES],
}

/// A ray against eight boxes and against four triangles, in one instruction set.
pub(super) trait Lanes: Sized {
    /// The ray with what this instruction set keeps of it.
    fn new(ray: &PreparedRay) -> Self;

    /// Entries into the children's boxes, and a bit for each child that the ray may touch within `[0, t_max]`.
    fn node(&self, node: &Node, t_max: f32, entries: &mut [f32; WIDTH]) -> u32;

    /// A bit for each triangle hit within `[0, t_max]`; `hits` is written where there is one.
    fn block(&self, block: &Block, t_max: f32, hits: &mut BlockHits) -> u32;
}

/// Core's own tests, one lane after the other.
pub(super) struct Scalar(PreparedRay);

impl Lanes for Scalar {
    #[inline(always)]
    fn new(ray: &PreparedRay) -> Self {
        Self(*ray)
    }

    #[inline(always)]
    fn node(&self, node: &Node, t_max: f32, entries: &mut [f32; WIDTH]) -> u32 {
        let mut mask = 0;
        for (slot, entry) in entries.iter_mut().enumerate() {
            let b = node.child_box(slot);
            if let Some(t) = slab_entry(&self.0, b.lo, b.hi, t_max) {
                *entry = t;
                mask |= 1 << slot;
            }
        }
        mask
    }

    #[inline(always)]
    fn block(&self, block: &Block, t_max: f32, hits: &mut BlockHits) -> u32 {
        let mut mask = 0;
        for lane in 0..LANES {
            let v = [0, 3, 6]
                .map(|r| Vec3::new(block.rows[r][lane], block.rows[r + 1][lane], block.rows[r + 2][lane]));
            if let Some(hit) = intersect_triangle(&self.0, v, t_max) {
                (hits.t[lane], hits.b1[lane], hits.b2[lane]) = (hit.t, hit.b1, hit.b2);
                mask |= 1 << lane;
            }
        }
        mask
    }
}
