//! obvhs's binary tree, walked with core's conservative node test.
//!
//! A node holds the boxes of both children; entries wait on a stack with their distance and are skipped only when
//! farther than the best hit, never when equal, so that ties are decided by the lowest primitive.

use super::packed::{Leaves, build_bvh2};
use etendue_core::geometry::{Aabb, Hit, Intersector, PreparedRay, Primitives, Ray, slab_entry};

/// Marks a leaf in a child word; the low bits are the place of its first primitive, `LEAF_COUNT` bits their number.
const LEAF: u32 = 1 << 31;
/// Bits of a leaf's first place.
const PLACE_BITS: u32 = 27;
/// Most primitives in a leaf.
const LEAF_MAX: u32 = 8;
/// Entries of the stack that need no allocation; deeper trees spill.
const STACK: usize = 96;

/// Two children with their boxes.
#[derive(Clone, Copy, Debug)]
struct Node {
    boxes: [Aabb; 2],
    child: [u32; 2],
}

/// A binary tree whose walk loses no ray.
#[derive(Clone, Debug)]
pub struct WalkTree {
    nodes: Vec<Node>,
    leaves: Leaves,
    /// Entry: box and child word of the root; an empty scene has an empty box.
    root: (Aabb, u32),
}

fn aabb(node: &obvhs::bvh2::node::Bvh2Node) -> Aabb {
    let b = node.aabb();
    Aabb { lo: b.min.into(), hi: b.max.into() }
}

impl WalkTree {
    /// Builds the tree over up to 2^27 primitives.
    pub fn build(primitives: &Primitives<'_>) -> Self {
        let tree = build_bvh2(primitives, LEAF_MAX);
        let leaves = Leaves::new(primitives, &tree.primitive_indices);
        let Some(root) = tree.nodes.first() else {
            return Self { nodes: Vec::new(), leaves, root: (Aabb::EMPTY, LEAF) };
        };
        let mut out = Self { nodes: Vec::new(), leaves, root: (aabb(root), 0) };
        // Depth first without recursion: (obvhs node, where its child word goes).
        let mut todo = vec![(0_usize, None::<(usize, usize)>)];
        while let Some((index, slot)) = todo.pop() {
            let node = &tree.nodes[index];
            let word = if node.is_leaf() {
                LEAF | (node.prim_count - 1) << PLACE_BITS | node.first_index
            } else {
                let at = out.nodes.len();
                let (left, right) = (node.first_index as usize, node.first_index as usize + 1);
                out.nodes
                    .push(Node { boxes: [aabb(&tree.nodes[left]), aabb(&tree.nodes[right])], child: [0; 2] });
                todo.push((right, Some((at, 1))));
                todo.push((left, Some((at, 0))));
                at as u32
            };
            match slot {
                Some((parent, side)) => out.nodes[parent].child[side] = word,
                None => out.root.1 = word,
            }
        }
        out
    }

    /// Bytes of nodes and leaves.
    pub fn bytes(&self) -> usize {
        self.nodes.len() * size_of::<Node>() + self.leaves.len() * 40
    }

    /// Number of primitives in the leaves.
    pub fn primitive_count(&self) -> usize {
        self.leaves.len()
    }
}

/// A stack that needs no allocation for ordinary trees and no limit for others.
struct Stack {
    entries: [(f32, u32); STACK],
    len: usize,
    spill: Vec<(f32, u32)>,
}

impl Stack {
    #[inline(always)]
    fn new() -> Self {
        Self { entries: [(0.0, 0); STACK], len: 0, spill: Vec::new() }
    }

    #[inline(always)]
    fn push(&mut self, entry: (f32, u32)) {
        if let Some(slot) = self.entries.get_mut(self.len) {
            *slot = entry;
            self.len += 1;
        } else {
            self.spill.push(entry);
        }
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<(f32, u32)> {
        if let Some(entry) = self.spill.pop() {
            return Some(entry);
        }
        self.len = self.len.checked_sub(1)?;
        self.entries.get(self.len).copied()
    }
}

impl Intersector for WalkTree {
    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        let prepared = PreparedRay::new(ray);
        let mut best: Option<Hit> = None;
        let mut t_max = ray.t_max;
        slab_entry(&prepared, self.root.0.lo, self.root.0.hi, t_max)?;
        let mut stack = Stack::new();
        let mut word = self.root.1;
        loop {
            if word & LEAF != 0 {
                let first = (word & ((1 << PLACE_BITS) - 1)) as usize;
                let count = ((word & !LEAF) >> PLACE_BITS) as usize + 1;
                for place in first..first + count {
                    if let Some(hit) = self.leaves.intersect(place, &prepared, t_max)
                        && best.is_none_or(|b| hit.before(&b))
                    {
                        best = Some(hit);
                        t_max = hit.t;
                    }
                }
            } else if let Some(node) = self.nodes.get(word as usize) {
                let [a, b] = node.boxes.map(|x| slab_entry(&prepared, x.lo, x.hi, t_max));
                match (a, b) {
                    (Some(a), Some(b)) => {
                        let near = usize::from(b < a);
                        stack.push((if near == 0 { b } else { a }, node.child[1 - near]));
                        word = node.child[near];
                        continue;
                    }
                    (Some(_), None) => {
                        word = node.child[0];
                        continue;
                    }
                    (None, Some(_)) => {
                        word = node.child[1];
                        continue;
                    }
                    (None, None) => {}
                }
            }
            loop {
                let Some((entry, next)) = stack.pop() else { return best };
                if entry <= t_max {
                    word = next;
                    break;
                }
            }
        }
    }

    fn occluded(&self, ray: &Ray) -> bool {
        let prepared = PreparedRay::new(ray);
        let t_max = ray.t_max;
        if slab_entry(&prepared, self.root.0.lo, self.root.0.hi, t_max).is_none() {
            return false;
        }
        let mut stack = Stack::new();
        let mut word = self.root.1;
        loop {
            if word & LEAF != 0 {
                let first = (word & ((1 << PLACE_BITS) - 1)) as usize;
                let count = ((word & !LEAF) >> PLACE_BITS) as usize + 1;
                for place in first..first + count {
                    if self.leaves.intersect(place, &prepared, t_max).is_some() {
                        return true;
                    }
                }
            } else if let Some(node) = self.nodes.get(word as usize) {
                let [a, b] = node.boxes.map(|x| slab_entry(&prepared, x.lo, x.hi, t_max));
                match (a, b) {
                    (Some(a), Some(b)) => {
                        let near = usize::from(b < a);
                        stack.push((0.0, node.child[1 - near]));
                        word = node.child[near];
                        continue;
                    }
                    (Some(_), None) => {
                        word = node.child[0];
                        continue;
                    }
                    (None, Some(_)) => {
                        word = node.child[1];
                        continue;
                    }
                    (None, None) => {}
                }
            }
            match stack.pop() {
                Some((_, next)) => word = next,
                None => return false,
            }
        }
    }
}
