//! The sampler over slices, in lanes.

use super::robust;

/// Samples per block of [`sample_lanes`]: enough for a loop of vectors, and few enough to stay in the first cache.
pub const LANES: usize = 64;

/// [`super::sample`] of [`LANES`] samples whose numbers lie apart: coordinate first, sample second. The bits are those of the scalar form.
///
/// Every choice in the scalar form is a selection, so that this loop becomes vector code on every target that has vectors.
#[inline(always)]
pub fn sample_lanes(weights: &[[f32; LANES]; 3], u: &[[f32; LANES]; 2], bary: &mut [[f32; LANES]; 3]) {
    let ([w0, w1, w2], [u0, u1], [b0, b1, b2]) = (weights, u, bary);
    // In two loops: one needs more registers than there are.
    let (mut s, mut c) = ([0.0; LANES], [0.0; LANES]);
    for i in 0..LANES {
        [s[i], c[i]] = robust::first_half([w0[i], w1[i], w2[i]], u0[i]);
    }
    for i in 0..LANES {
        [b0[i], b1[i], b2[i]] = robust::second_half([w0[i], w1[i], w2[i]], [s[i], c[i]], u1[i]);
    }
}

/// [`super::sample`] of each element, with the same bits; how many were done: as many as the shortest slice has.
///
/// Blocks of [`LANES`] are taken apart into one array per coordinate and put together again.
#[inline(always)]
pub fn sample_slice(weights: &[[f32; 3]], u: &[[f32; 2]], bary: &mut [[f32; 3]]) -> usize {
    let count = weights.len().min(u.len()).min(bary.len());
    let (weights, u, bary) = (&weights[..count], &u[..count], &mut bary[..count]);
    let (mut w_block, mut u_block, mut b_block) = ([[1.0; LANES]; 3], [[0.0; LANES]; 2], [[0.0; LANES]; 3]);
    for ((w, u), bary) in weights.chunks(LANES).zip(u.chunks(LANES)).zip(bary.chunks_mut(LANES)) {
        for (i, (w, u)) in w.iter().zip(u).enumerate() {
            [w_block[0][i], w_block[1][i], w_block[2][i]] = *w;
            [u_block[0][i], u_block[1][i]] = *u;
        }
        sample_lanes(&w_block, &u_block, &mut b_block);
        for (i, bary) in bary.iter_mut().enumerate() {
            *bary = [b_block[0][i], b_block[1][i], b_block[2][i]];
        }
    }
    count
}
