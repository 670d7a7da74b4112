//! A ray against eight boxes, and against eight triangles.
//!
//! The triangle test has the operations of core's scalar test in the same order ([`etendue_core::geometry::intersect_triangle`]), so
//! all give the same bits. The box test decides only what is looked at: it must accept what core's accepts
//! ([`etendue_core::geometry::slab_entry`]), and may accept more.

use super::floats::{Eight, Floats, Fused};
use super::layout::{Block, Node, WIDTH};
use etendue_core::geometry::PreparedRay;

/// Where a ray meets the triangles of a block; lanes that it misses hold anything.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BlockHits {
    /// Ray parameters.
    pub(super) t: Eight,
    /// Barycentrics of vertex 1.
    pub(super) b1: Eight,
    /// Barycentrics of vertex 2.
    pub(super) b2: Eight,
}

/// A box test.
pub(super) trait BoxTest<F: Floats>: Sized {
    /// Entries may be later than core's by up to this factor.
    const SLACK: f32;
    /// The ray, splatted.
    fn new(ray: &PreparedRay) -> Self;
    /// Entry at planes `b` of axis `k`.
    fn enter(&self, b: F, k: usize) -> F;
    /// Exit at planes `b` of axis `k`.
    fn leave(&self, b: F, k: usize) -> F;
    /// A bit for each lane whose entry, not negative, is not after its exit.
    fn meet(enter: F, leave: F) -> u32;
}

#[inline(always)]
fn splat<F: Floats>([x, y, z]: [f32; 3]) -> [F; 3] {
    [F::splat(x), F::splat(y), F::splat(z)]
}

/// Core's box test.
pub(super) struct Plain<F> {
    origin: [F; 3],
    near: [F; 3],
    far: [F; 3],
}

impl<F: Floats> BoxTest<F> for Plain<F> {
    const SLACK: f32 = 1.0;

    #[inline(always)]
    fn new(ray: &PreparedRay) -> Self {
        Self {
            origin: splat(ray.origin.to_array()),
            near: splat(ray.near.to_array()),
            far: splat(ray.far.to_array()),
        }
    }

    #[inline(always)]
    fn enter(&self, b: F, k: usize) -> F {
        b.sub(self.origin[k]).mul(self.near[k])
    }

    #[inline(always)]
    fn leave(&self, b: F, k: usize) -> F {
        b.sub(self.origin[k]).mul(self.far[k])
    }

    #[inline(always)]
    fn meet(enter: F, leave: F) -> u32 {
        F::bits(enter.le(leave))
    }
}

/// A box test of half the instructions: `b r - o r`, fused.
///
/// With u = 2^-24: the fused product is rounded once, and so is the constant `o r`. The second error is at most u |o| r: the
/// boxes are that much larger than what they hold ([`super::fit::Fit`]), so that what is left is a factor. Core's own
/// entry and exit are within 9 u of (b - o) r, these within u, so that 20 u between the two make up for both.
pub(super) struct Lean<F> {
    reciprocal: [F; 3],
    offset: [F; 3],
}

impl<F: Fused> BoxTest<F> for Lean<F> {
    const SLACK: f32 = 1.0 + 16.0 * f32::EPSILON;

    #[inline(always)]
    fn new(ray: &PreparedRay) -> Self {
        let r = ray.reciprocal();
        Self { reciprocal: splat(r.to_array()), offset: splat((-ray.origin * r).to_array()) }
    }

    #[inline(always)]
    fn enter(&self, b: F, k: usize) -> F {
        b.mul_add(self.reciprocal[k], self.offset[k])
    }

    #[inline(always)]
    fn leave(&self, b: F, k: usize) -> F {
        self.enter(b, k)
    }

    #[inline(always)]
    fn meet(enter: F, leave: F) -> u32 {
        // An ulp is u or more, of the number.
        enter.at_most_and_ulps::<32>(leave)
    }
}

/// A ray with what the tests need of it, splatted.
pub(super) struct Lanes<F: Floats, B> {
    boxes: B,
    origin: [F; 3],
    near: [F; 3],
    far: [F; 3],
    rotated: [F; 3],
    shear: [F; 3],
    /// Offset of the row with the plane where the ray enters, per axis, and where it leaves; floats from the start of a node.
    enter: [usize; 3],
    leave: [usize; 3],
    /// Offsets of the rows of vertex 0 after the axes are rotated, floats from the start of a block.
    axis: [usize; 3],
    /// Whether the ray enters at the lower plane, per axis.
    lower: [F::Mask; 3],
}

/// Row at `offset` floats from the start.
///
/// # Safety
/// The offset is that of a row: at most `WIDTH * (ROWS - 1)`.
#[inline(always)]
#[expect(
    unsafe_code,
    reason = "the offsets are chosen once per ray; checking them for every load costs a tenth of the time"
)]
unsafe fn row<F: Floats, const ROWS: usize>(rows: &[[f32; WIDTH]; ROWS], offset: usize) -> F {
    debug_assert!(offset <= WIDTH * (ROWS - 1));
    // SAFETY: so says the caller.
    F::load(unsafe { &*rows.as_ptr().cast::<f32>().add(offset).cast() })
}

impl<F: Floats, B: BoxTest<F>> Lanes<F, B> {
    /// Splats.
    #[inline(always)]
    pub(super) fn new(ray: &PreparedRay) -> Self {
        let near = ray.near.to_array();
        let lower = near.map(|x| x > 0.0);
        /// Offsets of the rows of a vertex after the rotation, for each dominant axis.
        const AXES: [[usize; 3]; 3] = [[WIDTH, 2 * WIDTH, 0], [2 * WIDTH, 0, WIDTH], [0, WIDTH, 2 * WIDTH]];
        let (x, y, z) = ray.rotate_once(ray.origin);
        let plane = |k: usize, low: bool| (2 * k + usize::from(!low)) * WIDTH;
        Self {
            boxes: B::new(ray),
            origin: splat(ray.origin.to_array()),
            near: splat(near),
            far: splat(ray.far.to_array()),
            rotated: splat([x, y, z]),
            shear: splat(ray.shear.to_array()),
            enter: [plane(0, lower[0]), plane(1, lower[1]), plane(2, lower[2])],
            leave: [plane(0, !lower[0]), plane(1, !lower[1]), plane(2, !lower[2])],
            axis: AXES[(ray.axis as usize).min(2)],
            lower: [F::all(lower[0]), F::all(lower[1]), F::all(lower[2])],
        }
    }

    /// Entries into the children's boxes, and a bit for each child that the ray may touch within `[0, t_max]`.
    #[inline(always)]
    pub(super) fn node(&self, node: &Node, t_max: f32) -> (F, u32) {
        macro_rules! row {
            ($offset:expr) => {{
                // SAFETY: `new` made the offset of one of six rows.
                #[expect(unsafe_code, reason = "see `row`")]
                let row: F = unsafe { row(&node.rows, $offset) };
                row
            }};
        }
        let nx = self.boxes.enter(row!(self.enter[0]), 0);
        let ny = self.boxes.enter(row!(self.enter[1]), 1);
        let nz = self.boxes.enter(row!(self.enter[2]), 2);
        let fx = self.boxes.leave(row!(self.leave[0]), 0);
        let fy = self.boxes.leave(row!(self.leave[1]), 1);
        let fz = self.boxes.leave(row!(self.leave[2]), 2);
        // In pairs, which are quicker than chains. Zero and t_max come second: they stand where the other is NaN.
        let enter = nx.max(ny).max(nz.max(F::splat(0.0)));
        let leave = fx.min(fy).min(fz.min(F::splat(t_max)));
        (enter, B::meet(enter, leave))
    }

    /// Vertex `vertex` relative to the origin, rotated and sheared.
    #[inline(always)]
    fn sheared(&self, block: &Block, vertex: usize) -> [F; 3] {
        macro_rules! moved {
            ($k:literal) => {{
                // SAFETY: `new` made the offset of one of the three rows of vertex 0, of which each vertex has as many.
                #[expect(unsafe_code, reason = "see `row`")]
                let row: F = unsafe { row(&block.rows, 3 * WIDTH * vertex + self.axis[$k]) };
                row.sub(self.rotated[$k])
            }};
        }
        let z = moved!(2);
        [moved!(0).sub(self.shear[0].mul(z)), moved!(1).sub(self.shear[1].mul(z)), z]
    }

    /// Entry into and exit from the slab of axis `k` of each triangle's own box.
    #[inline(always)]
    fn slab(&self, block: &Block, k: usize) -> [F; 2] {
        let [a, b, c] = [F::load(&block.rows[k]), F::load(&block.rows[3 + k]), F::load(&block.rows[6 + k])];
        let (lo, hi) = (a.min(b).min(c), a.max(b).max(c));
        let (near, far) = (F::pick(self.lower[k], lo, hi), F::pick(self.lower[k], hi, lo));
        [near.sub(self.origin[k]).mul(self.near[k]), far.sub(self.origin[k]).mul(self.far[k])]
    }

    /// A bit for each triangle hit within `[0, t_max]`; `hits` is written where there is one.
    #[inline(always)]
    pub(super) fn block(&self, block: &Block, t_max: f32, hits: &mut BlockHits) -> u32 {
        let [ax, ay, az] = self.sheared(block, 0);
        let [bx, by, bz] = self.sheared(block, 1);
        let [cx, cy, cz] = self.sheared(block, 2);
        let e0 = cx.mul(by).sub(cy.mul(bx));
        let e1 = ax.mul(cy).sub(ay.mul(cx));
        let e2 = bx.mul(ay).sub(by.mul(ax));
        let zero = F::splat(0.0);
        // Not both signs. Unused lanes, all NaN, end here; a NaN among numbers does at `sound`, as the sum is NaN then.
        let least = e0.min(e1).min(e2);
        let most = e0.max(e1).max(e2);
        let inside = F::either(zero.le(least), most.le(zero));
        if F::bits(inside) == 0 {
            return 0;
        }
        let det = e0.add(e1).add(e2);
        let size = det.abs();
        let infinity = F::splat(f32::INFINITY);
        let sound = F::both(zero.lt(size), size.lt(infinity));
        let sz = self.shear[2];
        let t = e0.mul(az.mul(sz)).add(e1.mul(bz.mul(sz))).add(e2.mul(cz.mul(sz)));
        let t = t.div(det);
        let [nx, fx] = self.slab(block, 0);
        let [ny, fy] = self.slab(block, 1);
        let [nz, fz] = self.slab(block, 2);
        let enter = nx.max(ny).max(nz);
        let leave = fx.min(fy).min(fz);
        // `if t > leave { leave } else { t }`, then the same below: a NaN stays.
        let t = enter.max(leave.min(t));
        let within =
            F::both(F::both(zero.le(t), t.le(F::splat(t_max))), F::both(t.lt(infinity), enter.le(leave)));
        let mask = F::bits(F::both(F::both(inside, sound), within));
        if mask != 0 {
            let b1 = e1.div(det);
            let b2 = e2.div(det).min(F::splat(1.0).sub(b1));
            t.add(zero).store(&mut hits.t);
            b1.add(zero).store(&mut hits.b1);
            b2.add(zero).store(&mut hits.b2);
        }
        mask
    }
}
