//! A plain binary tree of boxes: the reference for walking one.

use super::primitives::{Hit, Intersector, PrimitiveId, Primitives};
use super::ray::{Aabb, PreparedRay, Ray, slab_entry};
use alloc::vec::Vec;

/// Most primitives in a leaf.
const LEAF: usize = 4;
/// Halving 2^32 primitives takes at most 32 levels, and each level leaves at most one entry on the stack.
const STACK: usize = 34;

/// One box and what is in it.
#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Aabb,
    /// Leaf: first entry of `order`. Inner node: the right child (the left one follows the node itself).
    first: u32,
    /// Primitives of a leaf; 0 for an inner node.
    count: u32,
}

/// A binary tree of boxes, split at the median of their centres along the longest axis; what is in the boxes is not its own.
#[derive(Clone, Debug, Default)]
pub struct BoxTree {
    nodes: Vec<Node>,
    order: Vec<PrimitiveId>,
}

/// Binary tree over borrowed primitives.
///
/// Agrees bit for bit with [`super::BruteForce`]. Built in O(n log^2 n); primitives with an empty box are left out.
#[derive(Clone, Debug)]
pub struct Bvh2<'a> {
    primitives: Primitives<'a>,
    tree: BoxTree,
}

impl<'a> Bvh2<'a> {
    /// Builds the tree. The same primitives give the same tree.
    pub fn new(primitives: Primitives<'a>) -> Self {
        let all = (0..primitives.count() as PrimitiveId).map(|id| (primitives.bounds(id), id));
        Self { primitives, tree: BoxTree::new(all) }
    }

    /// The primitives the tree was built over.
    pub fn primitives(&self) -> Primitives<'a> {
        self.primitives
    }
}

impl BoxTree {
    /// Builds the tree; empty boxes are left out. The same boxes give the same tree.
    pub fn new(items: impl IntoIterator<Item = (Aabb, PrimitiveId)>) -> Self {
        let mut items: Vec<_> = items.into_iter().filter(|(bounds, _)| !bounds.is_empty()).collect();
        let mut tree = Self { nodes: Vec::new(), order: Vec::with_capacity(items.len()) };
        if !items.is_empty() {
            tree.build(&mut items);
        }
        tree
    }

    /// Whether it has no box.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Its nodes as words, for walkers elsewhere: the lower corner, a leaf's first entry or an inner node's right child (the left one follows it), the upper corner, and how many entries a leaf
    /// has, 0 for an inner node.
    pub fn node_words(&self) -> impl Iterator<Item = [u32; 8]> {
        self.nodes.iter().map(|node| {
            let [lo, hi] = [node.bounds.lo, node.bounds.hi].map(|v| v.to_array().map(f32::to_bits));
            [lo[0], lo[1], lo[2], node.first, hi[0], hi[1], hi[2], node.count]
        })
    }

    /// The entries of all leaves: numbers of primitives.
    pub fn order(&self) -> &[PrimitiveId] {
        &self.order
    }

    /// Whether a box touches the box of any leaf's: no less than it should, and rarely more.
    pub fn touches(&self, bounds: &Aabb) -> bool {
        let apart = |b: &Aabb| b.lo.cmpgt(bounds.hi).any() || b.hi.cmplt(bounds.lo).any();
        let mut todo: Vec<u32> = (0..u32::from(!self.nodes.is_empty())).collect();
        while let Some(index) = todo.pop() {
            let node = &self.nodes[index as usize];
            if apart(&node.bounds) {
                continue;
            }
            if node.count > 0 {
                return true;
            }
            todo.extend([index + 1, node.first]);
        }
        false
    }

    /// All hits of primitives of these numbers within `[0, t_max]`, in no order.
    pub fn all_hits(&self, primitives: &Primitives<'_>, ray: &Ray, mut hit: impl FnMut(Hit)) {
        let prepared = PreparedRay::new(ray);
        self.walk(&prepared, ray.t_max, |ids, t| {
            ids.iter().filter_map(|id| primitives.intersect(*id, &prepared, t)).for_each(&mut hit);
            Some(t)
        });
    }

    fn build(&mut self, items: &mut [(Aabb, PrimitiveId)]) {
        let bounds = items.iter().fold(Aabb::EMPTY, |sum, (b, _)| sum.union(*b));
        let index = self.nodes.len();
        self.nodes.push(Node { bounds, first: self.order.len() as u32, count: items.len() as u32 });
        if items.len() <= LEAF {
            self.order.extend(items.iter().map(|(_, id)| *id));
            return;
        }
        // Halved before adding, so that huge boxes do not overflow.
        let center = |b: &Aabb| b.lo * 0.5 + b.hi * 0.5;
        let mut centers = Aabb::EMPTY;
        for (b, _) in items.iter() {
            let c = center(b);
            centers = centers.union(Aabb { lo: c, hi: c });
        }
        let size = centers.hi * 0.5 - centers.lo * 0.5;
        let axis = if size.x >= size.y && size.x >= size.z {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        };
        let half = items.len() / 2;
        items.select_nth_unstable_by(half, |a, b| {
            center(&a.0)[axis].total_cmp(&center(&b.0)[axis]).then(a.1.cmp(&b.1))
        });
        let (left, right) = items.split_at_mut(half);
        self.build(left);
        self.nodes[index].first = self.nodes.len() as u32;
        self.nodes[index].count = 0;
        self.build(right);
    }

    /// Visits leaves in order of entry while their boxes are entered at or before `t`; `leaf` returns the new `t`,
    /// or `None` to stop.
    #[inline(always)]
    fn walk(&self, ray: &PreparedRay, t_max: f32, mut leaf: impl FnMut(&[PrimitiveId], f32) -> Option<f32>) {
        let mut t = t_max;
        let mut stack = [(0u32, 0.0f32); STACK];
        let mut depth = 0;
        let Some(root) = self.nodes.first() else { return };
        let mut next = slab_entry(ray, root.bounds.lo, root.bounds.hi, t).map(|_| 0u32);
        loop {
            let Some(index) = next else {
                if depth == 0 {
                    return;
                }
                depth -= 1;
                let (index, entry) = stack[depth];
                // Equal entries are visited: the box may hold a hit at the same t with a lower number.
                next = (entry <= t).then_some(index);
                continue;
            };
            let node = &self.nodes[index as usize];
            if node.count > 0 {
                match leaf(&self.order[node.first as usize..][..node.count as usize], t) {
                    Some(shorter) => t = shorter,
                    None => return,
                }
                next = None;
                continue;
            }
            let (l, r) = (index + 1, node.first);
            let (lb, rb) = (&self.nodes[l as usize].bounds, &self.nodes[r as usize].bounds);
            next = match (slab_entry(ray, lb.lo, lb.hi, t), slab_entry(ray, rb.lo, rb.hi, t)) {
                (Some(le), Some(re)) => {
                    let (near, far, entry) = if le <= re { (l, r, re) } else { (r, l, le) };
                    stack[depth] = (far, entry);
                    depth += 1;
                    Some(near)
                }
                (Some(_), None) => Some(l),
                (None, Some(_)) => Some(r),
                (None, None) => None,
            };
        }
    }
}

impl Intersector for Bvh2<'_> {
    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        let prepared = PreparedRay::new(ray);
        let mut best: Option<Hit> = None;
        self.tree.walk(&prepared, ray.t_max, |ids, mut t| {
            for &id in ids {
                if let Some(hit) = self.primitives.intersect(id, &prepared, t)
                    && best.is_none_or(|b| hit.before(&b))
                {
                    t = hit.t;
                    best = Some(hit);
                }
            }
            Some(t)
        });
        best
    }

    fn occluded(&self, ray: &Ray) -> bool {
        let prepared = PreparedRay::new(ray);
        let mut found = false;
        self.tree.walk(&prepared, ray.t_max, |ids, t| {
            found = ids.iter().any(|&id| self.primitives.intersect(id, &prepared, t).is_some());
            if found { None } else { Some(t) }
        });
        found
    }
}
