//! The tests in AVX2: eight boxes in one register, four triangles in one half.
//!
//! Every function here is inlined into an entry point that is compiled for AVX2 and entered only where the processor has it
//! ([`super::isa`]). No fused products: core's scalar tests round them, and so must we.
#![expect(unsafe_code, reason = "vector instructions, and loads at offsets chosen once per ray")]

use super::lanes::{BlockHits, Lanes};
use super::layout::{Block, Node, WIDTH};
use core::arch::x86_64::*;
use etendue_core::geometry::PreparedRay;

/// Bytes of a row of a node, and of a block.
const NODE_ROW: usize = 32;
const BLOCK_ROW: usize = 16;

/// The ray, splatted.
pub(super) struct Avx2 {
    origin: [__m256; 3],
    near: [__m256; 3],
    far: [__m256; 3],
    /// Offset of the row with the plane where the ray enters, per axis; the other one is `NODE_ROW` away, see `leave`.
    enter: [usize; 3],
    leave: [usize; 3],
    /// Offsets of the rows of vertex 0 after the axes are rotated.
    axis: [usize; 3],
    rotated: [__m128; 3],
    shear: [__m128; 3],
    /// Whether the ray enters at the lower plane, per axis.
    lower: [bool; 3],
}

impl Lanes for Avx2 {
    #[inline(always)]
    fn new(ray: &PreparedRay) -> Self {
        let splat = |v: [f32; 3]| {
            // SAFETY: no memory is touched; the caller is compiled for AVX2.
            v.map(|x| unsafe { _mm256_set1_ps(x) })
        };
        let splat4 = |v: [f32; 3]| {
            // SAFETY: as above.
            v.map(|x| unsafe { _mm_set1_ps(x) })
        };
        let near = ray.near.to_array();
        let lower = near.map(|x| x > 0.0);
        let o = ray.origin.to_array();
        let axis = match ray.axis {
            0 => [1, 2, 0],
            1 => [2, 0, 1],
            _ => [0, 1, 2],
        };
        let row = |k: usize, low: bool| (2 * k + usize::from(!low)) * NODE_ROW;
        Self {
            origin: splat(o),
            near: splat(near),
            far: splat(ray.far.to_array()),
            enter: [row(0, lower[0]), row(1, lower[1]), row(2, lower[2])],
            leave: [row(0, !lower[0]), row(1, !lower[1]), row(2, !lower[2])],
            axis: axis.map(|k| k * BLOCK_ROW),
            rotated: splat4(axis.map(|k| o[k])),
            shear: splat4(ray.shear.to_array()),
            lower,
        }
    }

    #[inline(always)]
    fn node(&self, node: &Node, t_max: f32, entries: &mut [f32; WIDTH]) -> u32 {
        let base = (&raw const *node).cast::<u8>();
        // SAFETY: the offsets are those of rows 0 to 5, within the node, and 32-byte aligned as the node is aligned to 64;
        // the caller is compiled for AVX2.
        unsafe {
            let load = |offset: usize| _mm256_load_ps(base.add(offset).cast());
            let plane = |offset: usize, k: usize, r: &[__m256; 3]| {
                _mm256_mul_ps(_mm256_sub_ps(load(offset), self.origin[k]), r[k])
            };
            let nx = plane(self.enter[0], 0, &self.near);
            let ny = plane(self.enter[1], 1, &self.near);
            let nz = plane(self.enter[2], 2, &self.near);
            let fx = plane(self.leave[0], 0, &self.far);
            let fy = plane(self.leave[1], 1, &self.far);
            let fz = plane(self.leave[2], 2, &self.far);
            // The second operand where either is NaN: core's own maximum and minimum.
            let enter = _mm256_max_ps(_mm256_max_ps(nx, ny), nz);
            let leave = _mm256_min_ps(_mm256_min_ps(fx, fy), fz);
            let enter = _mm256_max_ps(enter, _mm256_setzero_ps());
            let leave = _mm256_min_ps(leave, _mm256_set1_ps(t_max));
            _mm256_storeu_ps(entries.as_mut_ptr(), enter);
            _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(enter, leave)) as u32
        }
    }

    #[inline(always)]
    fn block(&self, block: &Block, t_max: f32, hits: &mut BlockHits) -> u32 {
        let base = (&raw const *block).cast::<u8>();
        // SAFETY: the offsets are those of rows 0 to 8, within the block, and 16-byte aligned as the block is aligned to
        // 32; the caller is compiled for AVX2.
        unsafe {
            let load = |offset: usize| _mm_load_ps(base.add(offset).cast());
            let moved = |vertex: usize, k: usize| {
                _mm_sub_ps(load(3 * BLOCK_ROW * vertex + self.axis[k]), self.rotated[k])
            };
            let [sx, sy, sz] = self.shear;
            let sheared = |vertex: usize| {
                let z = moved(vertex, 2);
                let x = _mm_sub_ps(moved(vertex, 0), _mm_mul_ps(sx, z));
                let y = _mm_sub_ps(moved(vertex, 1), _mm_mul_ps(sy, z));
                (x, y, z)
            };
            let (ax, ay, az) = sheared(0);
            let (bx, by, bz) = sheared(1);
            let (cx, cy, cz) = sheared(2);
            let edge = |px, py, qx, qy| _mm_sub_ps(_mm_mul_ps(px, py), _mm_mul_ps(qx, qy));
            let e0 = edge(cx, by, cy, bx);
            let e1 = edge(ax, cy, ay, cx);
            let e2 = edge(bx, ay, by, ax);
            let zero = _mm_setzero_ps();
            let any = |a, b, c| _mm_or_ps(_mm_or_ps(a, b), c);
            let negative = any(_mm_cmplt_ps(e0, zero), _mm_cmplt_ps(e1, zero), _mm_cmplt_ps(e2, zero));
            let positive = any(_mm_cmpgt_ps(e0, zero), _mm_cmpgt_ps(e1, zero), _mm_cmpgt_ps(e2, zero));
            let det = _mm_add_ps(_mm_add_ps(e0, e1), e2);
            let size = _mm_andnot_ps(_mm_set1_ps(-0.0), det);
            let sound = _mm_and_ps(_mm_cmpgt_ps(size, zero), _mm_cmplt_ps(size, _mm_set1_ps(f32::INFINITY)));
            let inside = _mm_andnot_ps(_mm_and_ps(negative, positive), sound);
            if _mm_movemask_ps(inside) == 0 {
                return 0;
            }
            let term = |e, z| _mm_mul_ps(e, _mm_mul_ps(z, sz));
            let t = _mm_add_ps(_mm_add_ps(term(e0, az), term(e1, bz)), term(e2, cz));
            let t = _mm_div_ps(t, det);
            // The interval within the triangle's own box, axis by axis as core has it.
            let planes = |k: usize| {
                let row = |vertex: usize| load(BLOCK_ROW * (3 * vertex + k));
                let (a, b, c) = (row(0), row(1), row(2));
                let (lo, hi) = (_mm_min_ps(_mm_min_ps(a, b), c), _mm_max_ps(_mm_max_ps(a, b), c));
                let (near, far) = if self.lower[k] { (lo, hi) } else { (hi, lo) };
                let o = _mm256_castps256_ps128(self.origin[k]);
                let (n, f) = (_mm256_castps256_ps128(self.near[k]), _mm256_castps256_ps128(self.far[k]));
                (_mm_mul_ps(_mm_sub_ps(near, o), n), _mm_mul_ps(_mm_sub_ps(far, o), f))
            };
            let ((nx, fx), (ny, fy), (nz, fz)) = (planes(0), planes(1), planes(2));
            let enter = _mm_max_ps(_mm_max_ps(nx, ny), nz);
            let leave = _mm_min_ps(_mm_min_ps(fx, fy), fz);
            // `if t > leave { leave } else { t }`, then the same below: a NaN stays.
            let t = _mm_min_ps(leave, t);
            let t = _mm_max_ps(enter, t);
            let within = _mm_and_ps(
                _mm_and_ps(_mm_cmpge_ps(t, zero), _mm_cmple_ps(t, _mm_set1_ps(t_max))),
                _mm_and_ps(_mm_cmplt_ps(t, _mm_set1_ps(f32::INFINITY)), _mm_cmple_ps(enter, leave)),
            );
            let mask = _mm_movemask_ps(_mm_and_ps(inside, within)) as u32;
            if mask != 0 {
                let b1 = _mm_div_ps(e1, det);
                let b2 = _mm_min_ps(_mm_div_ps(e2, det), _mm_sub_ps(_mm_set1_ps(1.0), b1));
                _mm_storeu_ps(hits.t.as_mut_ptr(), _mm_add_ps(t, zero));
                _mm_storeu_ps(hits.b1.as_mut_ptr(), _mm_add_ps(b1, zero));
                _mm_storeu_ps(hits.b2.as_mut_ptr(), _mm_add_ps(b2, zero));
            }
            mask
        }
    }
}
