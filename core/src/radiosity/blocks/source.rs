//! What blocks are made from.

use super::parts::Format;
use super::{SIDE, block_rows};
use crate::codec::bc1::{self, Block};
use crate::codec::bc4;

/// Codes of a matrix, to be encoded in an order.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    pub(super) n: usize,
    pub(super) format: Format,
    pub(super) half: bool,
    /// Row -> patch.
    pub(super) order: &'a [u32],
    /// Patch by patch, channels together.
    pub(super) codes: &'a [u8],
    /// Which entries are kept elsewhere and do not count.
    pub(super) kept: Option<&'a [bool]>,
    pub(super) bc1: bc1::Quality,
    pub(super) bc4: bc4::Quality,
}

impl Source<'_> {
    /// Rows of blocks.
    pub fn rows(&self) -> usize {
        block_rows(self.n)
    }

    /// Blocks of a row of them.
    pub fn row_len(&self, row: usize) -> usize {
        if self.half { row + 1 } else { self.rows() }
    }

    /// Encodes a row of blocks by what encodes one of three channels and one of one: [`bc1::encode`] and [`bc4::encode`], or a backend's form of them.
    #[inline(always)]
    pub fn encode_row(
        &self,
        row: usize,
        out: &mut [Block],
        three: impl Fn(&bc1::Texels, &[f32; 16], bc1::Quality) -> Block,
        one: impl Fn(&bc4::Texels, &[f32; 16], bc4::Quality) -> Block,
    ) {
        for (column, out) in out.iter_mut().enumerate() {
            *out = match self.format {
                Format::Bc1 => {
                    let (texels, weights) = self.texels::<3>(row, column);
                    if empty(&texels, &weights) { [0; 8] } else { three(&texels, &weights, self.bc1) }
                }
                Format::Bc4 => {
                    let (texels, weights) = self.texels::<1>(row, column);
                    if empty(&texels, &weights) {
                        [0; 8]
                    } else {
                        one(&texels.map(|[x]| x), &weights, self.bc4)
                    }
                }
            };
        }
    }

    /// [`Self::encode_row`] by core's own forms.
    pub fn encode_row_portable(&self, row: usize, out: &mut [Block]) {
        self.encode_row(row, out, bc1::encode, bc4::encode);
    }

    /// Codes of a block, and whether they count.
    #[inline(always)]
    fn texels<const V: usize>(&self, row: usize, column: usize) -> ([[u8; V]; 16], [f32; 16]) {
        let (mut texels, mut weights) = ([[0; V]; 16], [0.0; 16]);
        for r in 0..SIDE {
            let Some(i) = self.order.get(SIDE * row + r) else { continue };
            for k in 0..SIDE {
                let Some(j) = self.order.get(SIDE * column + k) else { continue };
                let at = *i as usize * self.n + *j as usize;
                texels[SIDE * r + k] = self.codes.as_chunks::<V>().0.get(at).copied().unwrap_or([0; V]);
                let counts = !self.kept.and_then(|kept| kept.get(at)).copied().unwrap_or(false);
                weights[SIDE * r + k] = if counts { 1.0 } else { 0.0 };
            }
        }
        (texels, weights)
    }
}

/// Whether nothing that counts is above 0: all zeros decode to that, and are skipped when run.
#[inline(always)]
fn empty<const V: usize>(texels: &[[u8; V]; 16], weights: &[f32; 16]) -> bool {
    texels.iter().zip(weights).all(|(texel, weight)| *weight == 0.0 || *texel == [0; V])
}
