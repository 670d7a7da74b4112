//! Bitmaps: 8-bit sRGB texels, decoded to linear reflectance and filtered bilinearly, repeating.
//!
//! Quantity: linear reflectance in \[0, 1\], no unit. Texel (0, 0) is the top left one; v = 0 is the bottom edge of
//! the image. Texel centres lie at half-integers. Source of the curve: IEC 61966-2-1:1999.

use super::compiled::{CheckerRecord, TextureRecord};
use crate::math::{self, Vec3};

/// Number of codes of one sRGB channel.
pub const SRGB_CODES: usize = 256;

/// Linear value in \[0, 1\] of an 8-bit sRGB code (IEC 61966-2-1). Accuracy: that of [`math::pow`].
pub fn srgb_to_linear(code: u8) -> f32 {
    let s = f32::from(code) / 255.0;
    if s <= 0.04045 { s / 12.92 } else { math::pow((s + 0.055) / 1.055, 2.4) }
}

/// One texel as linear reflectance; coordinates must be inside the bitmap.
#[inline]
fn texel(texture: &TextureRecord, texels: &[u32], decode: &[f32], x: u32, y: u32) -> Vec3 {
    let i = texture.first_texel as usize + y as usize * texture.width as usize + x as usize;
    let code = texels.get(i).copied().unwrap_or(0);
    let channel = |shift: u32| decode.get(((code >> shift) & 255) as usize).copied().unwrap_or(0.0);
    Vec3::new(channel(0), channel(8), channel(16))
}

/// The cell and the fraction within it of coordinate `x` on a repeating axis of `n` texels: (lower, upper, weight of
/// upper). Coordinates that are not finite count as 0.
#[inline]
fn repeat(x: f32, n: u32) -> (u32, u32, f32) {
    let x = if x.is_finite() { x } else { 0.0 };
    let wrapped = x - math::floor(x);
    let s = wrapped * n as f32 - 0.5;
    let cell = math::floor(s);
    let fraction = s - cell;
    // cell lies in [-1, n - 1]; both neighbours are taken modulo n.
    let lower = if cell < 0.0 { n - 1 } else { (cell as u32).min(n - 1) };
    let upper = if lower + 1 >= n { 0 } else { lower + 1 };
    (lower, upper, fraction)
}

/// Bilinear sample of a bitmap at texture coordinates `uv` (repeat), as linear reflectance.
///
/// `decode` is the table of [`srgb_to_linear`] over all codes; filtering happens after decoding.
#[inline]
pub fn sample_bitmap(texture: &TextureRecord, texels: &[u32], decode: &[f32], uv: [f32; 2]) -> Vec3 {
    let (x0, x1, fx) = repeat(uv[0], texture.width);
    let (y0, y1, fy) = repeat(-uv[1], texture.height);
    let top =
        texel(texture, texels, decode, x0, y0) * (1.0 - fx) + texel(texture, texels, decode, x1, y0) * fx;
    let low =
        texel(texture, texels, decode, x0, y1) * (1.0 - fx) + texel(texture, texels, decode, x1, y1) * fx;
    top * (1.0 - fy) + low * fy
}

impl CheckerRecord {
    /// Colour at texture coordinates `uv`: the first where floor(2 u') + floor(2 v') is even, (u', v') = uv times `repeat`.
    #[inline]
    pub fn color(&self, uv: [f32; 2]) -> Vec3 {
        let upper = |k: usize| {
            let x = uv[k] * self.repeat[k];
            // The half of the unit cell, so that large coordinates do not overflow.
            math::fract(x) >= 0.5
        };
        Vec3::from_array(self.colors[usize::from(upper(0) != upper(1))])
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::disallowed_methods, reason = "truth in f64")]
    use super::*;
    use alloc::vec::Vec;

    fn table() -> Vec<f32> {
        (0..=255).map(srgb_to_linear).collect()
    }

    #[test]
    fn decoding_follows_the_standard_curve() {
        for code in 0..=255u8 {
            let s = f64::from(code) / 255.0;
            let truth = if s <= 0.04045 { s / 12.92 } else { ((s + 0.055) / 1.055).powf(2.4) };
            let err = (f64::from(srgb_to_linear(code)) - truth).abs();
            assert!(err <= 4e-7 * truth.max(1e-3), "code {code}: error {err}");
        }
        assert_eq!(srgb_to_linear(0), 0.0);
        assert_eq!(srgb_to_linear(255), 1.0);
    }

    #[test]
    fn texel_centres_return_texels_and_edges_repeat() {
        // 2 x 2: red, green / blue, white.
        let texels = [0x0000ff, 0x00ff00, 0xff0000, 0xffffff];
        let t = TextureRecord { width: 2, height: 2, first_texel: 0, pad: 0 };
        let at = |u, v| sample_bitmap(&t, &texels, &table(), [u, v]);
        assert_eq!(at(0.25, 0.75), Vec3::new(1.0, 0.0, 0.0));
        assert_eq!(at(0.75, 0.75), Vec3::new(0.0, 1.0, 0.0));
        assert_eq!(at(0.25, 0.25), Vec3::new(0.0, 0.0, 1.0));
        assert_eq!(at(0.75, 0.25), Vec3::new(1.0, 1.0, 1.0));
        // Repeats with period 1 and mixes across the seam.
        assert_eq!(at(3.25, -1.25), at(0.25, 0.75));
        assert_eq!(at(0.0, 0.75), Vec3::new(0.5, 0.5, 0.0));
        // The centre is the mean of all four.
        assert_eq!(at(0.5, 0.5), Vec3::new(0.5, 0.5, 0.5));
        for bad in [f32::NAN, f32::INFINITY, 1e38, -1e-40] {
            assert!(at(bad, bad).is_finite());
        }
    }
}
