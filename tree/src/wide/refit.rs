//! New boxes for moved vertices, the tree's shape kept: a tenth of the time of a build.

use super::fit::Fit;
use super::layout::{Block, KIND_SHIFT, LEAF, NOTHING, PLACE, SHAPE};
use super::{WideTree, present};
use etendue_core::geometry::{Aabb, Primitives};
use etendue_core::math::Vec3;
use rayon::prelude::*;

/// Why a tree cannot be refitted; it is as it was, and a new one has to be built.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RefitError {
    /// Other numbers of triangles or round shapes than the tree was built of.
    #[error(
        "the tree holds {tree:?} triangles and round shapes, but the scene now has {scene:?}: build a new tree"
    )]
    Count {
        /// Triangles and shapes of the tree.
        tree: [usize; 2],
        /// Triangles and shapes given.
        scene: [usize; 2],
    },
    /// A primitive that nothing could hit (a vertex was NaN, say) now has a box, and the tree no place for it.
    #[error(
        "primitive {primitive} could not be hit when the tree was built, but can be now: build a new tree"
    )]
    Appeared {
        /// Its number.
        primitive: u32,
    },
}

impl WideTree {
    /// Fits the tree to moved vertices and shapes. Hits are those of brute force on the new scene, as after a build; rays get
    /// slower the farther things have moved apart, which [`WideTree::cost`] tells.
    ///
    /// # Errors
    /// [`RefitError`]; the tree is then as it was.
    pub fn refit(&mut self, primitives: &Primitives<'_>) -> Result<(), RefitError> {
        let tree = [self.first_shape as usize, self.shapes.len()];
        let scene = [primitives.triangles.len(), primitives.shapes.len()];
        if tree != scene {
            return Err(RefitError::Count { tree, scene });
        }
        if let Some(primitive) = self.absent.iter().find(|id| !primitives.bounds(**id).is_empty()) {
            return Err(RefitError::Appeared { primitive: *primitive });
        }
        self.fit = Fit::new(present(primitives).2);
        self.shapes.copy_from_slice(primitives.shapes);
        let boxes: Vec<Aabb> =
            self.converted.blocks.par_iter_mut().map(|block| refit_block(block, primitives)).collect();
        let nodes = &mut self.converted.nodes;
        let mut whole = vec![Aabb::EMPTY; nodes.len()];
        // Children come after their parents.
        for at in (0..nodes.len()).rev() {
            let mut all = Aabb::EMPTY;
            for (slot, word) in nodes[at].child.into_iter().enumerate() {
                let b = match word {
                    NOTHING => continue,
                    node if node & LEAF == 0 => whole[node as usize],
                    shape if shape >> KIND_SHIFT & 7 == SHAPE => {
                        joined(Aabb::EMPTY, primitives.bounds(self.first_shape + (shape & PLACE)))
                    }
                    leaf => {
                        let first = (leaf & PLACE) as usize;
                        let count = (leaf >> KIND_SHIFT & 7) as usize + 1;
                        boxes[first..first + count].iter().fold(Aabb::EMPTY, |a, b| a.union(*b))
                    }
                };
                nodes[at].set_box(slot, &b, self.fit.margin);
                all = all.union(b);
            }
            whole[at] = all;
        }
        Ok(())
    }

    /// What a ray through the whole scene is expected to cost, in node tests: by areas, as rays that run anywhere with equal
    /// chance hit boxes. Worth a build once a refitted tree has become twice as dear. 0 for a tree of one leaf, or one that is
    /// flat in two directions or infinite.
    pub fn cost(&self) -> f64 {
        let mut sum = 0.0;
        let mut root = 0.0;
        for (at, node) in self.converted.nodes.iter().enumerate() {
            let mut own = Aabb::EMPTY;
            for (slot, word) in node.child.into_iter().enumerate().filter(|c| c.1 != NOTHING) {
                let b = node.child_box(slot);
                own = own.union(b);
                if word & LEAF != 0 {
                    let blocks =
                        if word >> KIND_SHIFT & 7 == SHAPE { 1 } else { (word >> KIND_SHIFT & 7) + 1 };
                    sum += area(&b) * f64::from(blocks) * f64::from(super::convert::BLOCK_COST);
                }
            }
            sum += area(&own);
            if at == 0 {
                root = area(&own);
            }
        }
        if root > 0.0 && sum.is_finite() { sum / root } else { 0.0 }
    }
}

fn area(b: &Aabb) -> f64 {
    let [x, y, z] = [0, 1, 2].map(|k| (f64::from(b.hi[k]) - f64::from(b.lo[k])).max(0.0));
    x * y + y * z + z * x
}

/// The union; a box of NaN counts as empty.
fn joined(a: Aabb, b: Aabb) -> Aabb {
    if b.is_empty() { a } else { a.union(b) }
}

/// Puts the new vertices into a block; the box of them all.
fn refit_block(block: &mut Block, primitives: &Primitives<'_>) -> Aabb {
    let mut all = Aabb::EMPTY;
    for lane in 0..block.id.len() {
        let id = block.id[lane];
        if id != NOTHING {
            block.set(lane, id, primitives.vertices(id).unwrap_or([Vec3::NAN; 3]));
            all = joined(all, primitives.bounds(id));
        }
    }
    all
}
