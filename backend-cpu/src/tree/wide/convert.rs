//! From obvhs's binary tree to eight-wide nodes and leaf blocks, by dynamic programming.
//!
//! For each binary node n and each number j of slots, C(n, j) is the least cost of a subtree that takes at most j slots of
//! its parent: a leaf, one wide node of eight slots, or the two children sharing the slots. A wide node costs its area, a leaf
//! [`BLOCK_COST`] of its area a block. So leaves and nodes are made together (after Ylitie, Karras and Laine 2017, section 4).

use super::layout::{Block, KIND_SHIFT, LANES, LEAF, Node, SHAPE, WIDTH};
use etendue_core::geometry::{Aabb, Primitives};
use etendue_core::math::Vec3;
use obvhs::bvh2::Bvh2;

/// Price of a block of four triangles, in node tests (measured: flat between 0.6 and 2).
const BLOCK_COST: f32 = 0.8;
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
}

const NO_CHOICE: Choice = Choice { cost: [0.0; WIDTH], left: [0; WIDTH], count: 0 };

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

/// Converts; `ids` are the scene's numbers of obvhs's primitives.
pub(super) fn convert(tree: &Bvh2, ids: &[u32], primitives: &Primitives<'_>) -> Converted {
    let mut this = Converter {
        tree,
        ids,
        primitives,
        choices: vec![NO_CHOICE; tree.nodes.len()],
        out: Converted::default(),
    };
    if tree.nodes.is_empty() {
        return this.out;
    }
    for node in this.children_first() {
        this.choose(node);
    }
    this.emit();
    this.out
}

struct Converter<'a> {
    tree: &'a Bvh2,
    ids: &'a [u32],
    primitives: &'a Primitives<'a>,
    choices: Vec<Choice>,
    out: Converted,
}

impl Converter<'_> {
    fn children(&self, node: usize) -> Option<[usize; 2]> {
        let n = &self.tree.nodes[node];
        (!n.is_leaf()).then_some([n.first_index as usize, n.first_index as usize + 1])
    }

    /// The scene's number of a binary leaf's only primitive.
    fn id(&self, node: usize) -> u32 {
        self.ids[self.tree.primitive_indices[self.tree.nodes[node].first_index as usize] as usize]
    }

    fn children_first(&self) -> Vec<usize> {
        let mut order = vec![0];
        let mut at = 0;
        while at < order.len() {
            if let Some(children) = self.children(order[at]) {
                order.extend(children);
            }
            at += 1;
        }
        order.reverse();
        order
    }

    fn choose(&mut self, node: usize) {
        let area = area(&bounds(self.tree, node));
        let Some([l, r]) = self.children(node) else {
            let shape = self.primitives.shape(self.id(node)).is_some();
            // A shape never shares a leaf.
            let count = if shape { LEAF_MAX + 1 } else { 1 };
            self.choices[node] = Choice { cost: [area * BLOCK_COST; WIDTH], count, ..NO_CHOICE };
            return;
        };
        let (l, r) = (self.choices[l], self.choices[r]);
        let mut c = Choice { count: (l.count + r.count).min(LEAF_MAX + 1), ..NO_CHOICE };
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
        self.choices[node] = c;
    }

    /// The binary nodes that become the children of a wide node: `node` given `slots` of them.
    fn gather(&self, node: usize, slots: usize, out: &mut Vec<usize>) {
        let mut todo = vec![(node, slots, true)];
        while let Some((node, slots, top)) = todo.pop() {
            // The top node is opened with all eight slots, as C(n, 1) has it.
            let mut j = slots;
            let choice = &self.choices[node];
            let left = if top {
                choice.left[0]
            } else {
                while j > 1 && choice.left[j - 1] == 0 {
                    j -= 1;
                }
                if j == 1 { 0 } else { choice.left[j - 1] }
            };
            match (self.children(node), left) {
                (Some([l, r]), left) if left > 0 => {
                    let left = usize::from(left);
                    todo.push((r, j - left, false));
                    todo.push((l, left, false));
                }
                _ => out.push(node),
            }
        }
    }

    fn is_leaf(&self, node: usize) -> bool {
        self.children(node).is_none() || self.choices[node].left[0] == 0
    }

    fn leaf_word(&mut self, node: usize) -> u32 {
        if self.children(node).is_none()
            && let Some(shape) = self.primitives.shape(self.id(node)).map(|_| self.id(node))
        {
            return LEAF | SHAPE << KIND_SHIFT | (shape - self.primitives.triangles.len() as u32);
        }
        let mut ids = Vec::with_capacity(LEAF_MAX as usize);
        let mut todo = vec![node];
        while let Some(node) = todo.pop() {
            match self.children(node) {
                Some([l, r]) => todo.extend([r, l]),
                None => ids.push(self.id(node)),
            }
        }
        let first = self.out.blocks.len() as u32;
        for four in ids.chunks(LANES) {
            let mut block = Block::EMPTY;
            for (lane, id) in four.iter().enumerate() {
                block.set(lane, *id, self.primitives.vertices(*id).unwrap_or([Vec3::NAN; 3]));
            }
            self.out.blocks.push(block);
        }
        LEAF | (self.out.blocks.len() as u32 - first - 1) << KIND_SHIFT | first
    }

    fn emit(&mut self) {
        if self.is_leaf(0) {
            self.out.root = self.leaf_word(0);
            return;
        }
        // (binary node, where its word goes, depth): depth first, so that a subtree lies together.
        let mut todo: Vec<(usize, Option<(usize, usize)>, usize)> = vec![(0, None, 1)];
        let mut children = Vec::with_capacity(WIDTH);
        while let Some((node, slot, depth)) = todo.pop() {
            let at = self.out.nodes.len();
            self.out.depth = self.out.depth.max(depth);
            match slot {
                Some((parent, slot)) => self.out.nodes[parent].child[slot] = at as u32,
                None => self.out.root = at as u32,
            }
            children.clear();
            self.gather(node, WIDTH, &mut children);
            // Leaves first, then by falling area: the any-hit walk takes slots in order.
            let key = |n: &usize| (!self.is_leaf(*n), -area(&bounds(self.tree, *n)));
            children.sort_by(|a, b| {
                let (x, y) = (key(a), key(b));
                x.0.cmp(&y.0).then(x.1.total_cmp(&y.1))
            });
            let mut wide = Node::EMPTY;
            let pending = todo.len();
            for (slot, child) in children.iter().enumerate() {
                wide.set_box(slot, &bounds(self.tree, *child));
                if self.is_leaf(*child) {
                    wide.child[slot] = self.leaf_word(*child);
                } else {
                    todo.push((*child, Some((at, slot)), depth + 1));
                }
            }
            // The first one is walked down first.
            todo[pending..].reverse();
            self.out.nodes.push(wide);
        }
    }
}
