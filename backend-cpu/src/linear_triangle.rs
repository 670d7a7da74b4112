//! Points of linear density over triangles, in the widest registers there are.

use crate::simd::widest;
use etendue_core::sampling::linear_triangle;

widest! {
    /// As `linear_triangle::sample_slice` of core, with the same bits.
    pub fn sample_slice(weights: &[[f32; 3]], u: &[[f32; 2]], out: &mut [[f32; 3]]) -> usize {
        linear_triangle::sample_slice(weights, u, out)
    }
}
