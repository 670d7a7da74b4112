//! Where the albedo of a texel comes from.

use super::frame::MAX_SIDE;
use crate::scene::{SRGB_CODES, TextureRecord};
use core::fmt;

/// A grid of albedos, repeating both ways; row 0 on top.
pub trait Texels {
    /// Width and height in texels, each in 1..=[`MAX_SIDE`].
    fn size(&self) -> [u32; 2];
    /// Albedo per channel of the texel at column `x` and row `y`, both inside.
    fn texel(&self, x: u32, y: u32) -> [f32; 3];
}

/// Why a bitmap cannot be integrated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BitmapError {
    /// A side is 0 or more than [`MAX_SIDE`] texels.
    Side {
        /// Width in texels.
        width: u32,
        /// Height in texels.
        height: u32,
    },
    /// The arena ends before the bitmap does.
    Short {
        /// Texels that there are.
        found: usize,
        /// Texels that the bitmap's end asks for.
        expected: u64,
    },
    /// The table of decoded codes is not one of 256 albedos, finite and in \[0, 1\].
    Decode {
        /// Its length.
        len: usize,
    },
}

impl fmt::Display for BitmapError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Side { width, height } => {
                write!(f, "{width} x {height} texels: each side must be in 1..={MAX_SIDE}")
            }
            Self::Short { found, expected } => write!(f, "{found} texels where there must be {expected}"),
            Self::Decode { len } => {
                write!(f, "a table of {len} decoded codes, not of {SRGB_CODES} in [0, 1]")
            }
        }
    }
}

impl core::error::Error for BitmapError {}

/// A bitmap of the compiled scene: 8-bit sRGB texels 0x00BBGGRR with their decoded values.
#[derive(Clone, Copy, Debug)]
pub struct Bitmap<'a> {
    size: [u32; 2],
    texels: &'a [u32],
    decode: &'a [f32],
}

impl<'a> Bitmap<'a> {
    /// A view of `texture` in the arena `texels`; `decode` as [`sample_bitmap`](crate::scene::sample_bitmap) takes it.
    ///
    /// # Errors
    /// [`BitmapError`], with what is wrong.
    pub fn try_new(
        texture: &TextureRecord,
        texels: &'a [u32],
        decode: &'a [f32],
    ) -> Result<Self, BitmapError> {
        let TextureRecord { width, height, first_texel, .. } = *texture;
        if !(1..=MAX_SIDE).contains(&width) || !(1..=MAX_SIDE).contains(&height) {
            return Err(BitmapError::Side { width, height });
        }
        let expected = u64::from(first_texel) + u64::from(width) * u64::from(height);
        if (texels.len() as u64) < expected {
            return Err(BitmapError::Short { found: texels.len(), expected });
        }
        if decode.len() != SRGB_CODES || !decode.iter().all(|x| (0.0..=1.0).contains(x)) {
            return Err(BitmapError::Decode { len: decode.len() });
        }
        let texels = &texels[first_texel as usize..expected as usize];
        Ok(Self { size: [width, height], texels, decode })
    }

    /// For the kernels, which refuse nothing: a bitmap that cannot be is one of its first texel alone.
    pub(crate) fn lenient(size: [u32; 2], texels: &'a [u32], decode: &'a [f32]) -> Self {
        let record = TextureRecord { width: size[0], height: size[1], first_texel: 0, pad: 0 };
        Self::try_new(&record, texels, decode).unwrap_or(Self { size: [1, 1], texels, decode })
    }
}

impl Texels for Bitmap<'_> {
    #[inline(always)]
    fn size(&self) -> [u32; 2] {
        self.size
    }

    #[inline(always)]
    fn texel(&self, x: u32, y: u32) -> [f32; 3] {
        let code = self.texels.get(y as usize * self.size[0] as usize + x as usize).copied().unwrap_or(0);
        [0, 8, 16].map(|shift: u32| self.decode.get(((code >> shift) & 255) as usize).copied().unwrap_or(0.0))
    }
}
