//! Transport matrices in texture blocks: the published codec of a precomputed operator, and what it becomes when mended.
//!
//! The published operator is M_k = A + A^2 + ... + A^k, A = R F, from radiosity B0 = R E_direct + emission \[W m^-2\] to the indirect radiosity of k bounces \[W m^-2\], three channels. It is compressed
//! in five steps ([`BlockOperator::encode`]): the largest 4 % of the entries are kept as they are; the rest becomes 8-bit codes of logarithms ([`crate::codec::log_offset`]); rows and columns are put in an order
//! in which neighbours are alike ([`greedy`], or [`crate::radiosity::order::kd`]); blocks of 4 x 4 codes become BC1 textures of 8 bytes ([`crate::codec::bc1`]); what was kept is a sparse matrix. A light is relit by one product.
//!
//! [`Settings::published`] is that, with nothing added. [`Settings::mended`] differs in each step, and [`Settings::bounced`] stores form factors alone, in one channel, and bounces when it is run:
//!
//! | | published | mended | bounced |
//! |---|---|---|---|
//! | matrix ([`Matrix`]) | M_k, colours inside | G = F (I - R F)^-1, which gives irradiance | F, albedo may change |
//! | stored | all of it | all, or by symmetry half of A^1/2 G A^-1/2 | half of A^1/2 F A^-1/2 |
//! | blocks | BC1, range fit, kept entries are zeros | BC1, searched, kept entries do not count | BC4, searched, the same |
//! | codes are of | logarithms, 25 below the largest | logarithms, as far as the entries go | square roots |
//! | a code decodes to | the middle of its cell | the mean of the entries that decode by it | the same |
//! | kept entries | f32 values and u32 columns | f16 of what the blocks miss, u16 columns | the same |
//!
//! **Errors** are those of the codec alone, relative to the same matrix in f32: the truncation after k bounces comes on top. Where the blocks err, they err by steps of the logarithm, so by a share of each entry;
//! sums over many entries are better than that.
//!
//! A closed box of 1944 patches, albedos 0.2 to 0.7, relative L2 of indirect light over six lights, two of them single patches, in per cent (the worst light), against all bounces in f32:
//!
//! | | bytes per pair | error |
//! |---|---|---|
//! | published, k = 3 | 1.15 | 28.7 (35.5), most of it bounces that are missing |
//! | published, all bounces: no order, one pass, two, kd | 1.15 | 15.2 (22), 13.5 (27), 14.0 (25), 14.7 (29) |
//! | mended | 0.83 | 2.5 (4.9) |
//! | mended, half | 0.43 | 2.6 (4.5) |
//! | mended, 1 % kept | 0.59 | 2.8 (5.3) |
//! | bounced, 12 times and 40 times | 0.35 | 1.3 (1.5), of it 1.2 bounces that are missing; 0.36 (0.75) |
//! | the same with logarithms, 40 times | 0.35 | 0.39 (0.81) |
//!
//! What is left of the mended error is BC1's: endpoints of 5 bits are steps of 8 codes. Values measured after the fact and a longer search change it by a few hundredths. In one channel there is BC4, whose endpoints have 8 bits;
//! there, roots beat logarithms and plain steps (1.0, 1.1 and 1.1 % in a small shadowed box), so that is what [`Settings::bounced`] has.
//!
//! Decoding is bound by computing: with AVX2, on one thread, about 18 ns for a block of BC1, and 27 where it counts for its mirror image too, of which there are half as many.
//!
//! **Order of sums.** A row of blocks has sixteen lanes per channel, one for each entry of a block; blocks are added from left to right; then lanes of a row are folded, (0 + 2) + (1 + 3); then come the row's kept
//! entries, in two sums of every other one. Where half is stored, each stripe of [`STRIPE_ROWS`] rows of blocks gives sums of columns too, added stripe after stripe. So the bits are the same for any
//! number of threads.

#![allow(clippy::needless_range_loop, reason = "an index is a channel or a lane of several arrays at once")]

mod decode;
mod encode;
mod matrix;
mod order;
mod parts;
mod relight;
mod schedule;
mod source;
mod split;
mod stripe;
mod table;
#[cfg(test)]
mod tests;

pub use encode::{Filling, Kept, Order, Range, Settings};
pub use order::{distance, greedy, neighbour_distance};
pub use parts::{BlockError, Entries, Format, Matrix, PATCHES_MAX, Parts};
pub use relight::{Quantity, Workspace};
pub use schedule::{Portable, STRIPE_ROWS, Schedule, Scratch, add_columns};
pub use source::Source;
pub use stripe::{Quad, Sent};
pub use table::{OrderErrors, PublishedTable, published_table};

use alloc::boxed::Box;
use alloc::vec::Vec;
use decode::LOOKUP;

use super::identity::Identity;

/// Side of a block.
pub const SIDE: usize = 4;

/// Rows of blocks.
pub const fn block_rows(n: usize) -> usize {
    n.div_ceil(SIDE)
}

/// A transport matrix in blocks, ready to run: see the module.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockOperator {
    parts: Parts,
    /// Value of each palette entry that endpoints can make.
    lookup: Box<[f32; LOOKUP]>,
    /// In the order of rows; zeros beyond the last.
    albedo: Vec<Quad>,
    into: Vec<[f32; SIDE]>,
    out: Vec<[f32; SIDE]>,
    identity: Identity,
}

/// What a backend reads that forms products by itself, beside [`Parts`]; runs of four rows of the matrix, zeros beyond the last.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    /// Values of the palette entries that endpoints make: see the module `decode`.
    pub lookup: &'a [f32],
    /// Albedos.
    pub albedo: &'a [Quad],
    /// Factors before the product.
    pub into: &'a [[f32; SIDE]],
    /// Factors after it.
    pub out: &'a [[f32; SIDE]],
}

impl BlockOperator {
    /// All that a file needs to have.
    pub fn parts(&self) -> &Parts {
        &self.parts
    }

    /// What products read.
    pub fn view(&self) -> View<'_> {
        View { lookup: &self.lookup[..], albedo: &self.albedo, into: &self.into, out: &self.out }
    }

    /// By what a backend knows this operator again.
    pub fn identity(&self) -> &Identity {
        &self.identity
    }

    /// The same without a copy.
    pub fn into_parts(self) -> Parts {
        self.parts
    }

    /// How many patches there are.
    pub fn len(&self) -> usize {
        self.parts.albedo.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.parts.albedo.is_empty()
    }

    /// What is stored.
    pub fn matrix(&self) -> Matrix {
        self.parts.matrix
    }

    /// Bytes of all that a relighting reads: blocks, kept entries, the order, albedos, scales of patches, and the values of codes.
    pub fn bytes(&self) -> usize {
        self.parts.bytes()
    }

    /// [`Self::bytes`] per pair of patches, for all channels together.
    pub fn bytes_per_pair(&self) -> f64 {
        self.bytes() as f64 / (self.len() as f64 * self.len() as f64)
    }

    /// The patch in a row of the matrix.
    #[inline(always)]
    pub fn patch(&self, row: usize) -> usize {
        self.parts.order.get(row).map_or(row, |patch| *patch as usize)
    }
}
