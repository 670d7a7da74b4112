//! From obvhs's binary tree to eight-wide nodes and leaf blocks, by dynamic programming.
//!
//! For each binary node n and each number j of slots, C(n, j) is the least cost of a subtree that takes at most j slots of
//! its parent: a leaf, one wide node of eight slots, or the two children sharing the slots. A wide node costs its area, a leaf
//! [`BLOCK_COST`] of its area a block. So leaves and nodes are made together (after Ylitie, Karras and Laine 2017, section 4).

use super::layout::{Block, KIND_SHIFT, LANES, LEAF, NOTHING, Node, SHAPE, WIDTH};
use etendue_core::geometry::{Aabb, Primitives};
use etendue_core::math::Vec3;
use obvhs::bvh2::Bvh2;
use rayon::prelude::*;

/// Price of a block of triangles, in node tests (measured: flat between 0.4 and 1.6).
pub(super) const BLOCK_COST: f32 = 0.6;
/// Most triangles in a leaf: two blocks.
const LEAF_MAX: u32 = 2 * LANES as u32;
/// Stands in for areas that f32 cannot hold.
const HUGE: f32 = 1e30;

/// The tree, ready to be walked.
#[derive(Clone, Debug, Default)]
pub(super) struct Converted {
    pub(super) nodes: Vec<Node>,
    pub(super) blocks: Vec<Block>,
    /// Child word of the root.
    pub(super) root: u32,
    /// Nodes on the longest way down.
    pub(super) depth: usize,
}

/// What the costs of a binary node were reached by.
#[derive(Clone, Copy)]
struct Choice {
    /// C(n, j + 1).
    cost: [f32; WIDTH],
    /// For j = 1: 0 a leaf, else the slots of the left child in a wide node. For larger j: 0 as with one slot fewer, else
    /// the slots of the left child.
    left: [u8; WIDTH],
    /// Primitives below; more than a leaf holds counts as that and one more. A shape counts as that too, but for itself.
    count: u32,
    /// Binary nodes of the subtree.
    below: u32,
}

const NO_CHOICE: Choice = Choice { cost: [0.0; WIDTH], left: [0; WIDTH], count: 0, below: 0 };

fn bounds(tree: &Bvh2, node: usize) -> Aabb {
    let b = tree.nodes[node].aabb();
    Aabb { lo: b.min.into(), hi: b.max.into() }
}

fn area(b: &Aabb) -> f32 {
    let d = b.hi - b.lo;
    let a = d.x * d.y + d.y * d.z + d.z * d.x;
    // NaN and infinity alike.
    if a < HUGE { a } else { HUGE }
}

/// Binary nodes in a subtree that one task converts, about.
const TASK: usize = 1 << 13;
/// Nodes of one depth that are worth sharing among threads.
const WORTH_SHARING: usize = 1 << 10;

/// Converts; `ids` are the scene's numbers of obvhs's primitives, and a node's boxes become larger than their contents by `margin`
/// metres on each side. The result depends on the tree alone, not on threads. Parents come before their children.
pub(super) fn convert(tree: &Bvh2, ids: &[u32], primitives: &Primitives<'_>, margin: f32) -> Converted {
    if tree.nodes.is_empty() {
        return Converted::default();
    }
    let mut choices = vec![NO_CHOICE; tree.nodes.len()];
    let source = Source { tree, ids, primitives };
    for level in source.levels().iter().rev() {
        if level.len() < WORTH_SHARING {
            for node in level {
                choices[*node as usize] = source.choose(*node as usize, &choices);
            }
        } else {
            let chosen: Vec<Choice> =
                level.par_iter().with_min_len(256).map(|n| source.choose(*n as usize, &choices)).collect();
            for (node, choice) in level.iter().zip(chosen) {
                choices[*node as usize] = choice;
            }
        }
    }
    Plan { source, choices: &choices, margin }.emit()
}

/// The binary tree with what its primitives are.
#[derive(Clone, Copy)]
struct Source<'a> {
    tree: &'a Bvh2,
    ids: &'a [u32],
    primitives: &'a Primitives<'a>,
}

impl Source<'_> {
    fn children(&self, node: usize) -> Option<[usize; 2]> {
        let n = &self.tree.nodes[node];
        (!n.is_leaf()).then_some([n.first_index as usize, n.first_index as usize + 1])
    }

    /// The scene's number of a binary leaf's only primitive.
    fn id(&self, node: usize) -> u32 {
        self.ids[self.tree.primitive_indices[self.tree.nodes[node].first_index as usize] as usize]
    }

    /// The nodes of each depth, the root's first.
    fn levels(&self) -> Vec<Vec<u32>> {
        let mut levels = vec![vec![0_u32]];
        while let Some(last) = levels.last() {
            let next: Vec<u32> = last
                .iter()
                .filter_map(|n| self.children(*n as usize))
                .flat_map(|[l, r]| [l as u32, r as u32])
                .collect();
            if next.is_empty() {
                break;
            }
            levels.push(next);
        }
        levels
    }

    /// The costs of a node, its children's being known.
    fn choose(&self, node: usize, choices: &[Choice]) -> Choice {
        let area = area(&bounds(self.tree, node));
        let Some([l, r]) = self.children(node) else {
            let shape = self.primitives.shape(self.id(node)).is_some();
            // A shape never shares a leaf.
            let count = if shape { LEAF_MAX + 1 } else { 1 };
            return Choice { cost: [area * BLOCK_COST; WIDTH], count, below: 1, ..NO_CHOICE };
        };
        let (l, r) = (&choices[l], &choices[r]);
        let mut c = Choice {
            count: (l.count + r.count).min(LEAF_MAX + 1),
            below: 1 + l.below + r.below,
            ..NO_CHOICE
        };
        // The best way to share j slots.
        let share = |j: usize| {
            let mut best = (f32::INFINITY, 0_u8);
            for k in 1..j {
                let cost = l.cost[k - 1] + r.cost[j - k - 1];
                if cost < best.0 {
                    best = (cost, k as u8);
                }
            }
            // Costs that are all infinite still need a way down.
            if best.1 == 0 { (f32::MAX, 1) } else { best }
        };
        let (inner, slots) = share(WIDTH);
        (c.cost[0], c.left[0]) = (area + inner, slots);
        if c.count <= LEAF_MAX {
            let leaf = area * BLOCK_COST * c.count.div_ceil(LANES as u32) as f32;
            if leaf <= c.cost[0] {
                (c.cost[0], c.left[0]) = (leaf, 0);
            }
        }
        for j in 2..=WIDTH {
            let (cost, slots) = share(j);
            (c.cost[j - 1], c.left[j - 1]) =
                if cost < c.cost[j - 2] { (cost, slots) } else { (c.cost[j - 2], 0) };
        }
        c
    }
}

/// The binary tree with the decisions made.
#[derive(Clone, Copy)]
struct Plan<'a> {
    source: Source<'a>,
    choices: &'a [Choice],
    /// See [`convert`].
    margin: f32,
}

/// A subtree that still has to be emitted: its binary node, where its word goes, and the depth of its first wide node.
#[derive(Clone, Copy)]
struct Pending {
    node: usize,
    slot: Option<(usize, usize)>,
    depth: usize,
}

/// Lists that every emission needs again and again.
#[derive(Default)]
struct Scratch {
    children: Vec<(bool, f32, usize)>,
    open: Vec<(usize, usize)>,
    ids: Vec<u32>,
}

impl Plan<'_> {
    /// The binary nodes that become the children of the wide node made of `node`: leaves first, then by falling area, since
    /// the any-hit walk takes slots in order.
    fn gather(&self, node: usize, scratch: &mut Scratch) {
        let Scratch { children, open, .. } = scratch;
        children.clear();
        open.clear();
        let share = |node: usize, slots: usize, left: u8, open: &mut Vec<(usize, usize)>| {
            if let (Some([l, r]), 1..) = (self.source.children(node), left) {
                open.push((r, slots - usize::from(left)));
                open.push((l, usize::from(left)));
                return true;
            }
            false
        };
        share(node, WIDTH, self.choices[node].left[0], open);
        while let Some((node, mut slots)) = open.pop() {
            let choice = &self.choices[node];
            while slots > 1 && choice.left[slots - 1] == 0 {
                slots -= 1;
            }
            let left = if slots == 1 { 0 } else { choice.left[slots - 1] };
            if !share(node, slots, left, open) {
                children.push((!self.is_leaf(node), -area(&bounds(self.source.tree, node)), node));
            }
        }
        children.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    }

    fn is_leaf(&self, node: usize) -> bool {
        self.source.children(node).is_none() || self.choices[node].left[0] == 0
    }

    fn leaf_word(&self, node: usize, scratch: &mut Scratch, blocks: &mut Vec<Block>) -> u32 {
        let Scratch { open, ids, .. } = scratch;
        ids.clear();
        open.clear();
        open.push((node, 0));
        while let Some((node, _)) = open.pop() {
            match self.source.children(node) {
                Some([l, r]) => open.extend([(r, 0), (l, 0)]),
                None => ids.push(self.source.id(node)),
            }
        }
        let triangles = self.source.primitives.triangles.len() as u32;
        if let [only] = ids[..]
            && only >= triangles
        {
            return LEAF | SHAPE << KIND_SHIFT | (only - triangles);
        }
        let first = blocks.len() as u32;
        for four in ids.chunks(LANES) {
            let mut block = Block::EMPTY;
            for (lane, id) in four.iter().enumerate() {
                let vertices = self.source.primitives.vertices(*id);
                block.set(lane, *id, vertices.unwrap_or([Vec3::NAN; 3]));
            }
            blocks.push(block);
        }
        LEAF | (blocks.len() as u32 - first - 1) << KIND_SHIFT | first
    }

    /// Emits depth first from `start`; subtrees of at most `small` binary nodes are left to the caller, in order.
    fn emit_down_to(&self, start: usize, small: usize) -> (Converted, Vec<Pending>) {
        let mut out = Converted::default();
        let mut left = Vec::new();
        let mut scratch = Scratch::default();
        if self.is_leaf(start) {
            out.root = self.leaf_word(start, &mut scratch, &mut out.blocks);
            return (out, left);
        }
        let mut todo = vec![Pending { node: start, slot: None, depth: 1 }];
        while let Some(p) = todo.pop() {
            if (self.choices[p.node].below as usize) <= small && p.slot.is_some() {
                left.push(p);
                continue;
            }
            let at = out.nodes.len();
            out.depth = out.depth.max(p.depth);
            match p.slot {
                Some((parent, slot)) => out.nodes[parent].child[slot] = at as u32,
                None => out.root = at as u32,
            }
            self.gather(p.node, &mut scratch);
            let mut wide = Node::EMPTY;
            let pending = todo.len();
            let children = core::mem::take(&mut scratch.children);
            for (slot, (inner, _, child)) in children.iter().enumerate() {
                wide.set_box(slot, &bounds(self.source.tree, *child), self.margin);
                if *inner {
                    todo.push(Pending { node: *child, slot: Some((at, slot)), depth: p.depth + 1 });
                } else {
                    wide.child[slot] = self.leaf_word(*child, &mut scratch, &mut out.blocks);
                }
            }
            scratch.children = children;
            // The first one is walked down first.
            todo[pending..].reverse();
            out.nodes.push(wide);
        }
        (out, left)
    }

    /// The top by itself, subtrees by many threads, joined in the order of the top.
    fn emit(&self) -> Converted {
        let (mut out, left) = self.emit_down_to(0, TASK);
        let parts: Vec<(Pending, Converted)> =
            left.into_par_iter().map(|p| (p, self.emit_down_to(p.node, 0).0)).collect();
        for (p, part) in parts {
            let (nodes, blocks) = (out.nodes.len() as u32, out.blocks.len() as u32);
            let moved = |word: u32| match word {
                NOTHING => NOTHING,
                leaf if leaf & LEAF == 0 => leaf + nodes,
                leaf if leaf >> KIND_SHIFT & 7 == SHAPE => leaf,
                leaf => leaf + blocks,
            };
            if let Some((parent, slot)) = p.slot {
                out.nodes[parent].child[slot] = moved(part.root);
            }
            out.depth = out.depth.max(p.depth - 1 + part.depth);
            out.blocks.extend(part.blocks);
            out.nodes.extend(part.nodes.into_iter().map(|n| Node { child: n.child.map(moved), ..n }));
        }
        out
    }
}
