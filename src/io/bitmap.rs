//! 8-bit bitmaps: textures in, pictures out, masks in.

use std::io::Cursor;
use std::path::Path;

use etendue_core::scene::{TextureDesc, Wrap};
use image::{ImageEncoder as _, ImageFormat, ImageReader, Limits};

use super::atomic::write_whole;
use super::error::{LoadError, Problem, SaveError};
use super::source::{DiskSource, read_file};

/// Wider or higher bitmaps are refused.
const MAX_SIDE: u32 = 16_384;
/// More texels are refused (a small file can claim any size).
const MAX_TEXELS: u64 = 1 << 26;
/// Longer files are refused.
pub(crate) const MAX_FILE: u64 = 1 << 28;

fn decode(bytes: &[u8], file: &Path) -> Result<image::DynamicImage, LoadError> {
    let open = || {
        let mut reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format().ok()?;
        let mut limits = Limits::default();
        limits.max_image_width = Some(MAX_SIDE);
        limits.max_image_height = Some(MAX_SIDE);
        limits.max_alloc = Some(1 << 29);
        reader.limits(limits);
        matches!(reader.format(), Some(ImageFormat::Png | ImageFormat::Jpeg)).then_some(reader)
    };
    let unknown = || LoadError::unexpected(file, "an unknown format", "PNG or JPEG");
    let failed = |e: image::ImageError| LoadError::decode(file, "PNG or JPEG", e);
    let (width, height) = open().ok_or_else(unknown)?.into_dimensions().map_err(failed)?;
    let texels = u64::from(width) * u64::from(height);
    if texels > MAX_TEXELS {
        return Err(LoadError::new(
            file,
            Problem::TooLarge { what: "texels", found: texels, limit: MAX_TEXELS },
        ));
    }
    if texels == 0 {
        return Err(LoadError::unexpected(file, "no texels", "at least one"));
    }
    open().ok_or_else(unknown)?.decode().map_err(failed)
}

/// Decodes a PNG or JPEG into a texture: 8-bit sRGB as it stands, 16-bit rounded, grey spread over the three
/// channels, opacity left out. Colour profiles and gamma chunks are not applied.
pub fn parse_texture(bytes: &[u8], name: &str, file: &Path) -> Result<TextureDesc, LoadError> {
    let image = decode(bytes, file)?.into_rgb8();
    let (width, height) = image.dimensions();
    let texels = image.pixels().map(|p| p.0).collect();
    Ok(TextureDesc { name: name.to_owned(), width, height, texels, wrap: Wrap::Repeat })
}

/// Which pixels of an image count.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mask {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// For each pixel, top row first: false where the mask is black.
    pub keep: Vec<bool>,
}

/// Reads a mask: black pixels of a PNG or JPEG are left out of a comparison.
pub fn read_mask(path: &Path) -> Result<Mask, LoadError> {
    let image = decode(&read_file(&DiskSource, path, MAX_FILE)?, path)?.into_rgb16();
    let (width, height) = image.dimensions();
    Ok(Mask { width, height, keep: image.pixels().map(|p| p.0 != [0; 3]).collect() })
}

/// Reads a PNG or JPEG as bytes in sRGB: width, height, pixels with the top row first.
pub fn read_png(path: &Path) -> Result<(u32, u32, Vec<[u8; 3]>), LoadError> {
    let texture = parse_texture(&read_file(&DiskSource, path, MAX_FILE)?, "", path)?;
    Ok((texture.width, texture.height, texture.texels))
}

/// Writes an 8-bit RGB PNG of bytes that are sRGB already (tone mapping happened before), top row first.
/// The same pixels give the same bytes.
pub fn write_png(path: &Path, width: u32, height: u32, pixels: &[[u8; 3]]) -> Result<(), SaveError> {
    let expected = u64::from(width) * u64::from(height);
    if pixels.len() as u64 != expected || expected == 0 {
        let reason = format!("{} pixels do not fill {width} x {height}", pixels.len());
        return Err(SaveError::new(path, reason));
    }
    let mut bytes = Vec::new();
    image::codecs::png::PngEncoder::new(&mut bytes)
        .write_image(pixels.as_flattened(), width, height, image::ExtendedColorType::Rgb8)
        .map_err(|e| SaveError::new(path, e))?;
    write_whole(path, &bytes)
}
