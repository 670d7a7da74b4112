//! The sampler over slices, in lanes.

use super::{LinearTriangle, Robust};

/// Samples per block: enough for the loop to be worth a vector form, and few enough to stay in the first cache.
const BLOCK: usize = 64;

/// [`super::sample`] of each pair, with the same bits; returns how many: the length of the shortest slice.
///
/// A loop over lanes without branches, which compilers turn into vector instructions of whatever width they may use; `etendue-cpu` has it
/// for AVX2 where the processor has that.
#[inline(always)]
pub fn sample_slice(weights: &[[f32; 3]], u: &[[f32; 2]], out: &mut [[f32; 3]]) -> usize {
    let count = weights.len().min(u.len()).min(out.len());
    let (weights, u, out) = (&weights[..count], &u[..count], &mut out[..count]);
    let mut w0 = [1.0; BLOCK];
    let mut w1 = [1.0; BLOCK];
    let mut w2 = [1.0; BLOCK];
    let mut u0 = [0.0; BLOCK];
    let mut u1 = [0.0; BLOCK];
    let (mut b0, mut b1, mut b2) = ([0.0; BLOCK], [0.0; BLOCK], [0.0; BLOCK]);
    for ((w, u), out) in weights.chunks(BLOCK).zip(u.chunks(BLOCK)).zip(out.chunks_mut(BLOCK)) {
        for (i, (w, u)) in w.iter().zip(u).enumerate() {
            [w0[i], w1[i], w2[i]] = *w;
            [u0[i], u1[i]] = *u;
        }
        for i in 0..BLOCK {
            [b0[i], b1[i], b2[i]] = Robust::sample([w0[i], w1[i], w2[i]], [u0[i], u1[i]]);
        }
        for (i, out) in out.iter_mut().enumerate() {
            *out = [b0[i], b1[i], b2[i]];
        }
    }
    count
}
