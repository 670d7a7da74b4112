//! Blocks of 4x4 RGB texels in 8 bytes.
mod cluster;
mod lanes;
mod least_squares;
mod palette;
mod range_fit;
mod score;
mod search;
mod single;

pub use lanes::{Eight, Vector};
pub use least_squares::fit;
pub use palette::{Rule, decode, decode_rgba, decode_with};
pub use range_fit::encode_range_fit;

use lanes::Lanes;
use search::Plan;
use score::Target;

/// 16 texels, row by row; red, green, blue.
pub type Texels = [[u8; 3]; 16];
/// 8 bytes.
pub type Block = [u8; 8];

/// How much is tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Quality {
    /// The outermost texels.
    RangeFit,
    /// Principal axis and least squares
    LeastSquares,
    /// x
    Cluster,
    /// x
    Refined,
    /// x
    Exhaustive,
}

/// Black
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Black {
    /// y
    Allowed,
    /// n
    Avoided,
}

/// x
#[inline(always)]
pub fn encode_as<V: Eight>(texels: &Texels, weights: &[f32; 16], quality: Quality, black: Black) -> Block {
    let Some(t) = Target::new(texels, weights) else { return [0; 8] };
    let plan = match quality {
        Quality::RangeFit => return encode_range_fit(texels, t.counts()),
        Quality::LeastSquares if t.alike => {
            let [ends, indices] = fit::<Lanes<1>>(&[*texels]);
            return palette::bytes([ends[0], indices[0]]);
        }
        Quality::LeastSquares => Plan { tries: 1, axes: 1, descend: false, black: Black::Avoided },
        Quality::Cluster => Plan { tries: 1, axes: 1, descend: false, black },
        Quality::Refined => Plan { tries: 2, axes: 2, descend: true, black },
        Quality::Exhaustive => Plan { tries: 16, axes: 8, descend: true, black },
    };
    score::block::<V>(&t, &search::search::<V>(&t, texels, &plan))
}

/// x
#[inline(always)]
pub fn encode_blocks<V: Eight>(texels: &[Texels], quality: Quality, black: Black, out: &mut [Block]) {
    for (t, o) in texels.iter().zip(out) {
        *o = encode_as::<V>(t, &[1.0; 16], quality, black);
    }
}

/// try
#[inline(always)]
pub fn ls_blocks(texels: &[Texels], out: &mut [Block]) {
    let (groups, rest) = texels.as_chunks::<8>();
    let (og, or) = out.as_chunks_mut::<8>();
    for (t, o) in groups.iter().zip(og) {
        let w = least_squares::fit::<lanes::Lanes<8>>(t);
        for l in 0..8 {
            o[l] = palette::bytes([w[0][l], w[1][l]]);
        }
    }
    for (t, o) in rest.iter().zip(or) {
        let w = least_squares::fit::<lanes::Lanes<1>>(&[*t]);
        *o = palette::bytes([w[0][0], w[1][0]]);
    }
}

/// x
pub fn encode_blocks_portable(texels: &[Texels], quality: Quality, black: Black, out: &mut [Block]) {
    encode_blocks::<Lanes<8>>(texels, quality, black, out);
}
