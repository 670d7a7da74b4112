//! The eight-wide tree: obvhs builds a binary tree, [`convert`] makes nodes of eight boxes and leaf blocks of eight
//! triangles of it, and a walk in the widest instruction set at hand asks them.
//!
//! Node and block layouts are those of [`layout`]: also what a GPU reads.

#[cfg(target_arch = "x86_64")]
mod avx2;
mod convert;
mod fit;
mod floats;
mod isa;
mod lanes;
pub mod layout;
mod memory;
mod packet;
mod refit;
mod walk;

use super::packed::{Effort, build_bvh2_of};
use convert::{Converted, convert};
use etendue_core::geometry::{Aabb, Hit, Intersector, Primitives, Ray, RoundShape};
use fit::Fit;
pub use isa::Isa;
use packet::RAYS;
pub use refit::RefitError;
use std::time::{Duration, Instant};
use walk::View;

/// A tree of eight-wide nodes. Every walk of it gives the hits of core's brute force, bit for bit.
#[derive(Clone, Debug)]
pub struct WideTree {
    converted: Converted,
    shapes: Vec<RoundShape>,
    first_shape: u32,
    /// Primitives that nothing can hit, which the tree does not hold.
    absent: Vec<u32>,
    isa: Isa,
    fit: Fit,
}

impl WideTree {
    /// Builds the tree over up to 2^28 primitives, for the widest instruction set of this processor.
    pub fn build(primitives: &Primitives<'_>) -> Self {
        Self::build_timed(primitives, Effort::Standard).0
    }

    /// The same with more or less effort, and how long obvhs and the conversion took.
    pub fn build_timed(primitives: &Primitives<'_>, effort: Effort) -> (Self, [Duration; 2]) {
        let start = Instant::now();
        let (ids, absent, reach) = present(primitives);
        let fit = Fit::new(reach);
        let binary = build_bvh2_of(primitives, &ids, effort);
        let built = start.elapsed();
        let start = Instant::now();
        let mut converted = convert(&binary, &ids, primitives, fit.margin);
        if converted.depth > walk::MAX_DEPTH {
            // As of a long chain of nested boxes: halves by order are never deeper than 28.
            converted = convert(&balanced(primitives, &ids), &ids, primitives, fit.margin);
        }
        converted.nodes = memory::in_large_pages(converted.nodes);
        converted.blocks = memory::in_large_pages(converted.blocks);
        let this = Self {
            converted,
            shapes: primitives.shapes.to_vec(),
            first_shape: primitives.triangles.len() as u32,
            absent,
            isa: Isa::widest(),
            fit,
        };
        (this, [built, start.elapsed()])
    }

    /// The same tree, walked in another instruction set; the widest of the processor where that one is not there.
    #[must_use]
    pub fn with_isa(mut self, isa: Isa) -> Self {
        self.isa = if isa.is_here() { isa } else { Isa::widest() };
        self
    }

    /// The instruction set of its walks.
    pub fn isa(&self) -> Isa {
        self.isa
    }

    /// Bytes of nodes and blocks.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.converted.nodes) + size_of_val(&*self.converted.blocks)
    }

    /// Number of nodes, of blocks, and depth in nodes.
    pub fn counts(&self) -> (usize, usize, usize) {
        (self.converted.nodes.len(), self.converted.blocks.len(), self.converted.depth)
    }

    /// The tree as it lies in memory, for backends with walks of their own.
    pub fn parts(&self) -> Parts<'_> {
        Parts {
            nodes: &self.converted.nodes,
            blocks: &self.converted.blocks,
            root: self.converted.root,
            depth: self.converted.depth,
        }
    }

    /// The closest hits of rays that run alike, those of neighbouring pixels say: eight at a time. The same hits as one by one;
    /// order rays so that eight neighbours have one direction, about.
    ///
    /// `hits` gets one for each ray, as far as it reaches.
    pub fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        let (packets, rest) = rays.as_chunks::<RAYS>();
        let (out, out_rest) = hits.split_at_mut((packets.len() * RAYS).min(hits.len()));
        for (rays, hits) in packets.iter().zip(out.chunks_mut(RAYS)) {
            let found = isa::closest_packet(self.isa, self.view(), rays);
            hits.copy_from_slice(&found[..hits.len()]);
        }
        for (ray, hit) in rest.iter().zip(out_rest) {
            *hit = self.closest_hit(ray);
        }
    }

    /// Whether rays that run alike hit anything, shadow rays to one light say; as [`WideTree::closest_hits`].
    pub fn any_hits(&self, rays: &[Ray], occluded: &mut [bool]) {
        let (packets, rest) = rays.as_chunks::<RAYS>();
        let (out, out_rest) = occluded.split_at_mut((packets.len() * RAYS).min(occluded.len()));
        for (rays, occluded) in packets.iter().zip(out.chunks_mut(RAYS)) {
            let bits = isa::any_packet(self.isa, self.view(), rays);
            for (i, o) in occluded.iter_mut().enumerate() {
                *o = bits >> i & 1 != 0;
            }
        }
        for (ray, occluded) in rest.iter().zip(out_rest) {
            *occluded = self.occluded(ray);
        }
    }

    #[inline(always)]
    fn view(&self) -> View<'_> {
        View {
            nodes: &self.converted.nodes,
            blocks: &self.converted.blocks,
            shapes: &self.shapes,
            first_shape: self.first_shape,
            root: self.converted.root,
            fit: self.fit,
        }
    }
}

/// A tree's memory; see [`layout`].
#[derive(Clone, Copy, Debug)]
pub struct Parts<'a> {
    /// Nodes, each before its children.
    pub nodes: &'a [layout::Node],
    /// Leaf blocks.
    pub blocks: &'a [layout::Block],
    /// The root as a child word.
    pub root: u32,
    /// Nodes on the longest way down: a stack needs 7 (depth - 1) + 8 entries.
    pub depth: usize,
}

/// The primitives with a box, those without (NaN vertices among them: nothing hits them), and the largest coordinate of all
/// boxes, -infinity where there is none.
fn present(primitives: &Primitives<'_>) -> (Vec<u32>, Vec<u32>, f32) {
    let mut whole = Aabb::EMPTY;
    let (ids, absent) = (0..primitives.count() as u32).partition(|id| {
        let b = primitives.bounds(*id);
        if b.is_empty() {
            return false;
        }
        whole = whole.union(b);
        true
    });
    (ids, absent, whole.hi.max(-whole.lo).max_element())
}

/// Halves by order, whatever the boxes are.
fn balanced(primitives: &Primitives<'_>, ids: &[u32]) -> obvhs::bvh2::Bvh2 {
    use obvhs::bvh2::node::Bvh2Node;
    let mut tree =
        obvhs::bvh2::Bvh2 { primitive_indices: (0..ids.len() as u32).collect(), ..Default::default() };
    let bounds = |first: usize, count: usize| {
        let all = ids[first..first + count].iter().map(|id| primitives.bounds(*id));
        let b = all.fold(etendue_core::geometry::Aabb::EMPTY, |a, b| a.union(b));
        obvhs::aabb::Aabb::new(b.lo.into(), b.hi.into())
    };
    let mut todo = vec![(0_usize, 0_usize, ids.len())];
    tree.nodes.push(Bvh2Node::new(bounds(0, ids.len()), 0, 0));
    while let Some((node, first, count)) = todo.pop() {
        if count == 1 {
            tree.nodes[node] = Bvh2Node::new(bounds(first, 1), 1, first as u32);
            continue;
        }
        let half = count / 2;
        let child = tree.nodes.len();
        tree.nodes[node] = Bvh2Node::new(bounds(first, count), 0, child as u32);
        for (at, first, count) in [(child, first, half), (child + 1, first + half, count - half)] {
            tree.nodes.push(Bvh2Node::new(bounds(first, count), 0, 0));
            todo.push((at, first, count));
        }
    }
    tree
}

impl Intersector for WideTree {
    #[inline]
    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        isa::closest(self.isa, self.view(), ray)
    }

    #[inline]
    fn occluded(&self, ray: &Ray) -> bool {
        isa::any(self.isa, self.view(), ray)
    }
}
