//! Blocks of 4x4 RGB texels in 8 bytes.
mod cluster;
mod lanes;
mod least_squares;
mod palette;
mod range_fit;
mod score;
mod search;
mod single;

pub use lanes::Vector;
pub use least_squares::fit;
pub use palette::{Rule, decode, decode_rgba, decode_with};
pub use range_fit::encode_range_fit;

use lanes::Lanes;
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
pub fn encode_with(texels: &Texels, weights: &[f32; 16], quality: Quality, black: Black) -> Block {
    let Some(t) = Target::new(texels, weights) else { return [0; 8] };
    let best = match quality {
        Quality::RangeFit => return encode_range_fit(texels, t.counts()),
        Quality::LeastSquares if t.alike => {
            let [ends, indices] = fit::<Lanes<1>>(&[*texels]);
            return palette::bytes([ends[0], indices[0]]);
        }
        Quality::LeastSquares => search::cluster(&t, texels, Black::Avoided),
        Quality::Cluster => search::cluster(&t, texels, black),
        Quality::Refined => search::refine(&t, texels, black, 2, 2),
        Quality::Exhaustive => search::refine(&t, texels, black, 16, 8),
    };
    score::block(&t, best)
}

/// x
#[inline(always)]
pub fn encode_blocks(texels: &[Texels], quality: Quality, black: Black, out: &mut [Block]) {
    for (t, o) in texels.iter().zip(out) {
        *o = encode_with(t, &[1.0; 16], quality, black);
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
