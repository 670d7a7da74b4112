//! Eight rays at once: for rays that run alike, such as those of neighbouring pixels, or from one patch to another.
//!
//! A node's children are tested in turn, each against all eight rays. Rays of a packet must have the same dominant axis and the same
//! signs of direction; others are walked singly. Each ray's hit has the bits that it has alone.

use super::floats::{Eight, Fused};
use super::lanes::{BoxTest, Lean};
use super::layout::{Block, KIND_SHIFT, LANES, LEAF, NOTHING, Node, SHAPE, WIDTH};
use super::walk::{Room, Stack, View, blocks_of, entry, shape_hit};
use etendue_core::geometry::{Hit, PreparedRay, Ray};

/// Rays of a packet.
pub(super) const RAYS: usize = WIDTH;

/// Eight rays of one kind, lane by lane.
struct Packet<F: Fused> {
    reciprocal: [F; 3],
    offset: [F; 3],
    origin: [F; 3],
    near: [F; 3],
    far: [F; 3],
    rotated: [F; 3],
    shear: [F; 3],
    lower: [F::Mask; 3],
    /// Rows of the planes where the rays enter and leave, per axis.
    rows: [[usize; 2]; 3],
    /// Axes after the rotation.
    axes: [usize; 3],
}

/// Whether rays can be walked together.
#[inline(always)]
pub(super) fn alike(view: &View<'_>, rays: &[PreparedRay; RAYS]) -> bool {
    let first = &rays[0];
    let same = |r: &PreparedRay| {
        r.axis == first.axis
            && (r.near.x > 0.0) == (first.near.x > 0.0)
            && (r.near.y > 0.0) == (first.near.y > 0.0)
            && (r.near.z > 0.0) == (first.near.z > 0.0)
            && view.fit.holds(r)
    };
    rays.iter().all(same)
}

/// Prepares eight rays.
#[inline(always)]
pub(super) fn prepare(rays: &[Ray; RAYS]) -> ([PreparedRay; RAYS], [f32; RAYS]) {
    let mut prepared = [PreparedRay::new(&rays[0]); RAYS];
    let mut t_max = [0.0; RAYS];
    for ((prepared, t_max), ray) in prepared.iter_mut().zip(&mut t_max).zip(rays) {
        *prepared = PreparedRay::new(ray);
        *t_max = ray.t_max;
    }
    (prepared, t_max)
}

/// A number of each ray.
#[inline(always)]
fn each<F: Fused>(rays: &[PreparedRay; RAYS], of: impl Fn(&PreparedRay) -> f32) -> F {
    let mut all = Eight::default();
    for (x, ray) in all.0.iter_mut().zip(rays) {
        *x = of(ray);
    }
    F::load(&all.0)
}

impl<F: Fused> Packet<F> {
    /// Precondition: [`alike`].
    #[inline(always)]
    fn new(rays: &[PreparedRay; RAYS]) -> Self {
        let axes = match rays[0].axis {
            0 => [1, 2, 0],
            1 => [2, 0, 1],
            _ => [0, 1, 2],
        };
        let near = rays[0].near;
        let lower = [near.x > 0.0, near.y > 0.0, near.z > 0.0];
        let rows = [0, 1, 2].map(|k: usize| [2 * k + usize::from(!lower[k]), 2 * k + usize::from(lower[k])]);
        Self {
            reciprocal: [
                each(rays, |r| r.reciprocal().x),
                each(rays, |r| r.reciprocal().y),
                each(rays, |r| r.reciprocal().z),
            ],
            offset: [
                each(rays, |r| -r.origin.x * r.reciprocal().x),
                each(rays, |r| -r.origin.y * r.reciprocal().y),
                each(rays, |r| -r.origin.z * r.reciprocal().z),
            ],
            origin: [each(rays, |r| r.origin.x), each(rays, |r| r.origin.y), each(rays, |r| r.origin.z)],
            near: [each(rays, |r| r.near.x), each(rays, |r| r.near.y), each(rays, |r| r.near.z)],
            far: [each(rays, |r| r.far.x), each(rays, |r| r.far.y), each(rays, |r| r.far.z)],
            rotated: [
                each(rays, |r| r.rotate(r.origin).0),
                each(rays, |r| r.rotate(r.origin).1),
                each(rays, |r| r.rotate(r.origin).2),
            ],
            shear: [each(rays, |r| r.shear.x), each(rays, |r| r.shear.y), each(rays, |r| r.shear.z)],
            lower: [F::all(lower[0]), F::all(lower[1]), F::all(lower[2])],
            rows,
            axes,
        }
    }

    /// Entries into a child's box, and a bit for each ray that may touch it within `[0, t_max]`.
    #[inline(always)]
    fn child(&self, node: &Node, slot: usize, t_max: F) -> (F, u32) {
        let [[nx, fx], [ny, fy], [nz, fz]] = self.rows;
        let [rx, ry, rz] = self.reciprocal;
        let [ox, oy, oz] = self.offset;
        macro_rules! plane {
            ($row:expr) => {
                F::splat(node.rows[$row % 6][slot % WIDTH])
            };
        }
        let (ex, lx) = (plane!(nx).mul_add(rx, ox), plane!(fx).mul_add(rx, ox));
        let (ey, ly) = (plane!(ny).mul_add(ry, oy), plane!(fy).mul_add(ry, oy));
        let (ez, lz) = (plane!(nz).mul_add(rz, oz), plane!(fz).mul_add(rz, oz));
        let enter = ex.max(ey).max(ez.max(F::splat(0.0)));
        let leave = lx.min(ly).min(lz.min(t_max));
        (enter, Lean::<F>::meet(enter, leave))
    }

    /// Vertex `vertex` of the triangle in a lane, relative to the rays' origins, rotated and sheared.
    #[inline(always)]
    fn sheared(&self, block: &Block, lane: usize, vertex: usize) -> [F; 3] {
        macro_rules! moved {
            ($k:literal) => {
                F::splat(block.rows[(3 * vertex + self.axes[$k]) % 9][lane % LANES]).sub(self.rotated[$k])
            };
        }
        let z = moved!(2);
        [moved!(0).sub(self.shear[0].mul(z)), moved!(1).sub(self.shear[1].mul(z)), z]
    }

    /// As [`super::lanes::Lanes::slab`], of one triangle's own box.
    #[inline(always)]
    fn slab(&self, block: &Block, lane: usize, k: usize) -> [F; 2] {
        macro_rules! vertex {
            ($v:literal) => {
                F::splat(block.rows[3 * $v + k][lane % LANES])
            };
        }
        let (a, b, c) = (vertex!(0), vertex!(1), vertex!(2));
        let (lo, hi) = (a.min(b).min(c), a.max(b).max(c));
        let (near, far) = (F::pick(self.lower[k], lo, hi), F::pick(self.lower[k], hi, lo));
        [near.sub(self.origin[k]).mul(self.near[k]), far.sub(self.origin[k]).mul(self.far[k])]
    }

    /// One triangle: which rays hit it within `[0, t_max]`, with t, b1 and b2. The operations of core's test in the same order.
    #[inline(always)]
    fn triangle(&self, block: &Block, lane: usize, t_max: F) -> Option<(F::Mask, [F; 3])> {
        let [ax, ay, az] = self.sheared(block, lane, 0);
        let [bx, by, bz] = self.sheared(block, lane, 1);
        let [cx, cy, cz] = self.sheared(block, lane, 2);
        let e0 = cx.mul(by).sub(cy.mul(bx));
        let e1 = ax.mul(cy).sub(ay.mul(cx));
        let e2 = bx.mul(ay).sub(by.mul(ax));
        let zero = F::splat(0.0);
        let inside = F::either(zero.le(e0.min(e1).min(e2)), e0.max(e1).max(e2).le(zero));
        if F::bits(inside) == 0 {
            return None;
        }
        let det = e0.add(e1).add(e2);
        let size = det.abs();
        let infinity = F::splat(f32::INFINITY);
        let sound = F::both(zero.lt(size), size.lt(infinity));
        let sz = self.shear[2];
        let t = e0.mul(az.mul(sz)).add(e1.mul(bz.mul(sz))).add(e2.mul(cz.mul(sz))).div(det);
        let [nx, fx] = self.slab(block, lane, 0);
        let [ny, fy] = self.slab(block, lane, 1);
        let [nz, fz] = self.slab(block, lane, 2);
        let enter = nx.max(ny).max(nz);
        let leave = fx.min(fy).min(fz);
        let t = enter.max(leave.min(t));
        let within = F::both(F::both(zero.le(t), t.le(t_max)), F::both(t.lt(infinity), enter.le(leave)));
        let hit = F::both(F::both(inside, sound), within);
        if F::bits(hit) == 0 {
            return None;
        }
        let b1 = e1.div(det);
        let b2 = e2.div(det).min(F::splat(1.0).sub(b1));
        Some((hit, [t.add(zero), b1.add(zero), b2.add(zero)]))
    }
}

/// The rays' best hits so far.
struct Best {
    hits: [Option<Hit>; RAYS],
    t_max: Eight,
}

impl Best {
    /// Takes a hit where it is the better one.
    #[inline(always)]
    fn offer(&mut self, ray: usize, hit: Hit) {
        if self.hits[ray].is_none_or(|b| hit.before(&b)) {
            self.hits[ray] = Some(hit);
            self.t_max.0[ray] = hit.t;
        }
    }
}

/// The closest hits. Precondition: [`alike`]; a `t_max` that is NaN or negative hits nothing.
#[inline(always)]
pub(super) fn closest<F: Fused>(
    view: &View<'_>,
    rays: &[PreparedRay; RAYS],
    t_max: [f32; RAYS],
) -> [Option<Hit>; RAYS] {
    let packet = Packet::<F>::new(rays);
    // NaN and negative limits fail every comparison with what is not negative.
    let mut best = Best { hits: [None; RAYS], t_max: Eight(t_max) };
    let mut limit = F::load(&best.t_max.0);
    let mut room = Room::new();
    let mut stack = Stack::new(&mut room);
    stack.push(entry(0.0, view.root));
    while let Some(e) = stack.pop() {
        let word = e as u32;
        // Entries hold the earliest one of the rays; skipped when it is later than all of them look.
        let start = F::splat(f32::from_bits((e >> 32) as u32));
        if F::bits(start.le(limit.mul(F::splat(Lean::<F>::SLACK)))) == 0 {
            continue;
        }
        if word & LEAF == 0 {
            let Some(node) = view.nodes.get(word as usize) else { continue };
            let mut found = [0_u64; WIDTH];
            let mut count = 0;
            for slot in 0..WIDTH {
                if node.child[slot] == NOTHING {
                    break;
                }
                let (enter, mask) = packet.child(node, slot, limit);
                if mask != 0 {
                    // Farthest first, so that the nearest is on top.
                    let e = entry(enter.least_of(mask), node.child[slot]);
                    let mut at = count;
                    while at > 0 && found[at - 1] < e {
                        found[at] = found[at - 1];
                        at -= 1;
                    }
                    found[at] = e;
                    count += 1;
                }
            }
            for e in &found[..count.min(WIDTH)] {
                stack.push(*e);
            }
            continue;
        }
        if word >> KIND_SHIFT & 7 == SHAPE {
            for (ray, prepared) in rays.iter().enumerate() {
                if let Some(hit) = shape_hit(*view, word, prepared, best.t_max.0[ray]) {
                    best.offer(ray, hit);
                }
            }
        } else {
            let (first, count) = blocks_of(word);
            for block in view.blocks.get(first..first + count).unwrap_or(&[]) {
                for lane in 0..LANES {
                    if block.id[lane] == NOTHING {
                        break;
                    }
                    if let Some((hit, [t, b1, b2])) = packet.triangle(block, lane, limit) {
                        let mut all = [Eight::default(); 3];
                        t.store(&mut all[0]);
                        b1.store(&mut all[1]);
                        b2.store(&mut all[2]);
                        let mut mask = F::bits(hit);
                        while mask != 0 {
                            let ray = mask.trailing_zeros() as usize % RAYS;
                            mask &= mask - 1;
                            let [t, b1, b2] = [all[0].0[ray], all[1].0[ray], all[2].0[ray]];
                            best.offer(ray, Hit { t, primitive: block.id[lane], b1, b2 });
                        }
                        limit = F::load(&best.t_max.0);
                    }
                }
            }
        }
        limit = F::load(&best.t_max.0);
    }
    best.hits
}

/// A bit for each ray that hits anything. Precondition as for [`closest`].
#[inline(always)]
pub(super) fn any<F: Fused>(view: &View<'_>, rays: &[PreparedRay; RAYS], t_max: [f32; RAYS]) -> u32 {
    let packet = Packet::<F>::new(rays);
    let mut left = Eight(t_max);
    let mut limit = F::load(&left.0);
    let mut found = 0;
    let mut room = Room::new();
    let mut stack = Stack::new(&mut room);
    stack.push(view.root);
    while let Some(word) = stack.pop() {
        if word & LEAF == 0 {
            let Some(node) = view.nodes.get(word as usize) else { continue };
            // The last one first, so that leaves are on top.
            for slot in (0..WIDTH).rev() {
                if node.child[slot] != NOTHING && packet.child(node, slot, limit).1 != 0 {
                    stack.push(node.child[slot]);
                }
            }
            continue;
        }
        let mut hit = 0;
        if word >> KIND_SHIFT & 7 == SHAPE {
            for (ray, prepared) in rays.iter().enumerate() {
                hit |= u32::from(shape_hit(*view, word, prepared, left.0[ray]).is_some()) << ray;
            }
        } else {
            let (first, count) = blocks_of(word);
            for block in view.blocks.get(first..first + count).unwrap_or(&[]) {
                for lane in 0..LANES {
                    if block.id[lane] == NOTHING {
                        break;
                    }
                    hit |= packet.triangle(block, lane, limit).map_or(0, |(mask, _)| F::bits(mask));
                }
            }
        }
        if hit != 0 {
            found |= hit;
            if found == (1 << RAYS) - 1 {
                break;
            }
            // What has hit looks no further.
            for (ray, t) in left.0.iter_mut().enumerate() {
                if hit >> ray & 1 != 0 {
                    *t = -1.0;
                }
            }
            limit = F::load(&left.0);
        }
    }
    found
}
