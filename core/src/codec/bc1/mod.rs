//! Blocks of 4x4 RGB texels in 8 bytes: the format BC1, also known as DXT1.
//!
//! A block holds two endpoints of 5, 6 and 5 bits (red high, first endpoint in bytes 0 and 1, little-endian) and 16
//! indices of 2 bits (texel 0 in the lowest bits of byte 4), row by row. Where the first endpoint is the larger word, the
//! palette is the endpoints and the colours at 1/3 and 2/3 between them; else the endpoints, their mean, and black (alpha
//! 0). All 2^64 blocks are legal. [`decode`] rounds as [`Rule::Nearest`] says; others differ from it by at
//! most 1 (truncated, Mesa), 2 (AMD) and 5 (NVIDIA, green) in a value.
//!
//! Encoding minimises sum_i w_i |x_i - y_i|^2 over the texels: x as given, y as [`decode`] gives it, red, green and blue
//! alike, in units of 1/255 squared. How hard it tries is the [`Quality`]:
//!
//! | quality | method | source |
//! |---|---|---|
//! | `RangeFit` | outermost texels along the diagonal of their box; integers only | van Waveren 2006 |
//! | `LeastSquares` | principal axis, regression on the position along it; one block per lane | after Brown 2006, Castaño 2007 |
//! | `Cluster` | all splits of the order along the axis into runs, both modes, black | after Brown 2006 ("cluster fit") |
//! | `Refined` | several splits and axes, descent among the neighbouring codes | |
//! | `Exhaustive` | every run start, more axes, then branch and bound over the endpoints | |
//!
//! Every choice compares exact integers (where all texels count alike) or f32 sums of fixed order, so that the same
//! texels give the same block on every machine. No quality from `Cluster` on is worse than the ones before it among
//! `RangeFit`, `Cluster`, `Refined`, `Exhaustive`, block by block (where weights differ, within the rounding of f32 sums).

#![allow(clippy::needless_range_loop, reason = "an index is a channel or a lane of several arrays at once")]

mod branch;
mod cluster;
mod lanes;
mod least_squares;
mod palette;
mod range_fit;
mod score;
mod search;
mod single;
#[cfg(test)]
mod tests;

pub use branch::{Proof, encode_proved};
pub use lanes::{Eight, Vector};
pub use palette::{Rule, decode, decode_rgba, decode_with};
pub use range_fit::encode_range_fit;

use core::fmt;
use lanes::Lanes;
use score::Target;
use search::Plan;

pub(super) use lanes::Lanes as PortableLanes;
pub(crate) use palette::{codes, widen, words};

/// 16 texels, row by row; red, green, blue.
pub type Texels = [[u8; 3]; 16];
/// 8 bytes.
pub type Block = [u8; 8];

/// All texels count alike.
pub const ALIKE: [f32; 16] = [1.0; 16];

/// How much an encoder tries; each takes longer than the one before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Quality {
    /// [`encode_range_fit`]: a weight only says whether a texel counts.
    RangeFit,
    /// Regression along the principal axis, then the nearest entry along the line: no error is measured, one mode, never
    /// black. Where weights differ, the fit of `Cluster` without black.
    LeastSquares,
    /// The best split along the principal axis in each mode (and with the dark texels black), endpoints and indices
    /// fitted to each other until nothing is gained.
    Cluster,
    /// Two splits per mode along up to two axes; from each a descent to endpoints of which no channel's codes, nor the
    /// pair of them, can move by one to gain.
    Refined,
    /// Up to sixteen splits per mode along up to eight axes, then branch and bound over all endpoints, cut off after
    /// [`EXHAUSTIVE_NODES`]. [`encode_proved`] takes the limit and says whether the block is proved best.
    Exhaustive,
}

/// Boxes of endpoints that [`Quality::Exhaustive`] looks into, for each block.
pub const EXHAUSTIVE_NODES: u32 = 2_000;

impl Quality {
    /// All of them, the quickest first.
    pub const ALL: [Self; 5] =
        [Self::RangeFit, Self::LeastSquares, Self::Cluster, Self::Refined, Self::Exhaustive];
}

/// Whether an encoder may use the black entry, whose alpha decodes to 0, for dark texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Black {
    /// Where it lowers the error: only colours are read.
    Allowed,
    /// Never: alpha is read and must be 255.
    Avoided,
}

/// Something that makes blocks of texels.
pub trait Encode {
    /// Encodes one block; a weight of 0 means "don't care".
    fn encode(&self, texels: &Texels, weights: &[f32; 16]) -> Block;
}

impl Encode for Quality {
    fn encode(&self, texels: &Texels, weights: &[f32; 16]) -> Block {
        encode(texels, weights, *self)
    }
}

/// Slices that do not fit together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LengthError {
    /// Blocks of texels given.
    pub texels: usize,
    /// Places for blocks given.
    pub blocks: usize,
}

impl fmt::Display for LengthError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} blocks of texels for {} blocks", self.texels, self.blocks)
    }
}

impl core::error::Error for LengthError {}

/// Encodes a block, black allowed.
///
/// Only the ratios of the weights matter. 0 means "don't care"; a negative weight or NaN counts as 0, infinity as the
/// largest float. With no texel that counts the block is all zeros, which is black.
#[must_use]
pub fn encode(texels: &Texels, weights: &[f32; 16], quality: Quality) -> Block {
    encode_with(texels, weights, quality, Black::Allowed)
}

/// Encodes a block: as [`encode`], with a say over black.
///
/// With [`Black::Avoided`] every texel that counts decodes with alpha 255, and the others do too, unless none counts.
#[must_use]
pub fn encode_with(texels: &Texels, weights: &[f32; 16], quality: Quality, black: Black) -> Block {
    encode_as::<Lanes<8>>(texels, weights, quality, black)
}

/// [`encode_with`] in the vectors of a backend: the same bits.
#[inline(always)]
#[must_use]
pub fn encode_as<V: Eight>(texels: &Texels, weights: &[f32; 16], quality: Quality, black: Black) -> Block {
    let Some(t) = Target::new(texels, weights) else { return [0; 8] };
    let plan = match quality {
        Quality::RangeFit => return encode_range_fit(texels, t.counts()),
        Quality::LeastSquares if t.alike => {
            let [ends, indices] = least_squares::fit::<Lanes<1>>(&[*texels]);
            return palette::bytes([ends[0], indices[0]]);
        }
        Quality::LeastSquares => Plan { tries: 1, axes: 1, descend: false, black: Black::Avoided, nodes: 0 },
        Quality::Cluster => Plan { tries: 1, axes: 1, descend: false, black, nodes: 0 },
        Quality::Refined => Plan { black, ..search::REFINED },
        Quality::Exhaustive => Plan { tries: 16, axes: 8, descend: true, black, nodes: EXHAUSTIVE_NODES },
    };
    let (best, _) = search::search::<V>(&t, texels, &plan);
    score::block::<V>(&t, &best)
}

/// Encodes blocks one after the other, all texels counting alike: each as [`encode_with`] does, to the bit.
///
/// # Errors
/// When the slices differ in length; then nothing is written.
pub fn encode_blocks(
    texels: &[Texels],
    quality: Quality,
    black: Black,
    out: &mut [Block],
) -> Result<(), LengthError> {
    encode_blocks_as::<Lanes<8>>(texels, quality, black, out)
}

/// [`encode_blocks`] in the vectors of a backend: the same bits.
///
/// # Errors
/// As [`encode_blocks`].
#[inline(always)]
pub fn encode_blocks_as<V: Eight>(
    texels: &[Texels],
    quality: Quality,
    black: Black,
    out: &mut [Block],
) -> Result<(), LengthError> {
    if texels.len() != out.len() {
        return Err(LengthError { texels: texels.len(), blocks: out.len() });
    }
    if quality != Quality::LeastSquares {
        for (texels, out) in texels.iter().zip(out) {
            *out = encode_as::<V>(texels, &ALIKE, quality, black);
        }
        return Ok(());
    }
    let (groups, rest) = texels.as_chunks::<8>();
    let (out_groups, out_rest) = out.as_chunks_mut::<8>();
    for (texels, out) in groups.iter().zip(out_groups) {
        *out = V::blocks(least_squares::fit::<V>(texels));
    }
    for (texels, out) in rest.iter().zip(out_rest) {
        let [ends, indices] = least_squares::fit::<Lanes<1>>(&[*texels]);
        *out = palette::bytes([ends[0], indices[0]]);
    }
    Ok(())
}

/// What encoding minimises, sum_i w_i |x_i - y_i|^2, for any block, decoded by the reference rule; in units of (1/255)^2.
///
/// Weights as in [`encode`], but taken as they are, not their ratios. In f64, texel by texel: exact where they are
/// integers below 2^33.
#[must_use]
pub fn error(texels: &Texels, weights: &[f32; 16], block: Block) -> f64 {
    let mut sum = 0.0;
    for ((x, y), w) in texels.iter().zip(decode(block)).zip(weights) {
        let w = if *w > 0.0 { f64::from(crate::math::min(*w, f32::MAX)) } else { 0.0 };
        sum += w * f64::from(range_fit::distance(*x, y));
    }
    sum
}
