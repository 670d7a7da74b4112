//! KTX 2.0 textures of one image in compressed blocks (Khronos KTX specification 2.0; data format specification 1.3).
//!
//! A file is: identifier and header, an index of what follows, the place of the one level, a description of the format, keys with values, the blocks.

use super::atomic::write_whole;
use super::error::SaveError;
use std::collections::BTreeMap;
use std::path::Path;

/// Formats of blocks of 4 x 4 texels in 8 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlockFormat {
    /// Three channels, linear; `VK_FORMAT_BC1_RGB_UNORM_BLOCK`.
    Bc1RgbUnorm,
    /// One channel; `VK_FORMAT_BC4_UNORM_BLOCK`.
    Bc4Unorm,
}

/// Side of a block \[texels\].
const SIDE: u32 = 4;
/// Bytes of a block; the level begins at a multiple of it.
const BLOCK: usize = 8;
const IDENTIFIER: [u8; 12] = *b"\xabKTX 20\xbb\r\n\x1a\n";
/// Identifier, nine words of header, index, and one level's entry.
const HEADER: usize = 12 + 9 * 4 + (4 * 4 + 2 * 8) + 3 * 8;
/// The key under which the writing program is named.
const WRITER: &str = "KTXwriter";

impl BlockFormat {
    /// Number of the format in Vulkan.
    const fn vulkan(self) -> u32 {
        match self {
            Self::Bc1RgbUnorm => 131,
            Self::Bc4Unorm => 139,
        }
    }

    /// Number of its colour model (`KHR_DF_MODEL_BC1A`, `KHR_DF_MODEL_BC4`).
    const fn model(self) -> u32 {
        match self {
            Self::Bc1RgbUnorm => 128,
            Self::Bc4Unorm => 131,
        }
    }

    /// The data format descriptor: one basic block with one sample.
    fn descriptor(self) -> [u32; 11] {
        const PRIMARIES_BT709: u32 = 1;
        const TRANSFER_LINEAR: u32 = 1;
        const VERSION_1_3: u32 = 2;
        let (block, side) = (24 + 16, SIDE - 1);
        [
            4 + block,
            // Khronos, basic format.
            0,
            VERSION_1_3 | block << 16,
            self.model() | PRIMARIES_BT709 << 8 | TRANSFER_LINEAR << 16,
            side | side << 8,
            BLOCK as u32,
            0,
            // Channel 0 (colour, or data) in bits 0 to 63.
            (8 * BLOCK as u32 - 1) << 16,
            0,
            0,
            u32::MAX,
        ]
    }
}

/// The bytes of a texture; `file` is only named in errors. Blocks come row by row from the top left; `values` are keys and texts for whoever reads the file.
///
/// # Errors
/// When there is no texel, the blocks are not as many as the size asks for, or a key is empty, holds a zero, or is one that KTX reserves.
pub fn encode_ktx2(
    (width, height): (u32, u32),
    format: BlockFormat,
    blocks: &[u8],
    values: &BTreeMap<String, String>,
    file: &Path,
) -> Result<Vec<u8>, SaveError> {
    let refused = |reason: String| Err(SaveError::new(file, format!("cannot be written: {reason}")));
    let expected = u128::from(width.div_ceil(SIDE)) * u128::from(height.div_ceil(SIDE)) * BLOCK as u128;
    if expected == 0 || blocks.len() as u128 != expected {
        return refused(format!(
            "{} bytes of blocks do not fill {width} x {height} texels, which take {expected}",
            blocks.len()
        ));
    }
    if let Some(key) = values.keys().find(|k| k.is_empty() || k.contains('\0') || k.starts_with("KTX")) {
        return refused(format!("{key:?} cannot be a key"));
    }
    let mut pairs = BTreeMap::from([(WRITER, concat!("etendue ", env!("CARGO_PKG_VERSION")))]);
    pairs.extend(values.iter().map(|(k, v)| (k.as_str(), v.as_str())));
    let mut data = Vec::new();
    for (key, value) in pairs {
        // Both end with a zero: the value is a text.
        data.extend((key.len() as u32 + value.len() as u32 + 2).to_le_bytes());
        for text in [key, value] {
            data.extend(text.as_bytes());
            data.push(0);
        }
        data.resize(data.len().next_multiple_of(4), 0);
    }
    let descriptor = format.descriptor();
    let described = HEADER + 4 * descriptor.len();
    let start = (described + data.len()).next_multiple_of(BLOCK);

    let mut out = Vec::with_capacity(start + blocks.len());
    out.extend(IDENTIFIER);
    // Format, bytes of a word to swap, width, height, depth, layers, faces, levels, supercompression.
    let header = [format.vulkan(), 1, width, height, 0, 0, 1, 1, 0];
    let index = [HEADER, 4 * descriptor.len(), described, data.len()].map(|x| x as u32);
    for word in header.into_iter().chain(index) {
        out.extend(word.to_le_bytes());
    }
    // No global data of a supercompression; the level's place, bytes, and bytes uncompressed.
    for word in [0, 0, start as u64, blocks.len() as u64, blocks.len() as u64] {
        out.extend(word.to_le_bytes());
    }
    for word in descriptor {
        out.extend(word.to_le_bytes());
    }
    out.extend(data);
    out.resize(start, 0);
    out.extend(blocks);
    Ok(out)
}

/// Writes a texture.
///
/// # Errors
/// As [`encode_ktx2`], and when the disk refuses.
pub fn write_ktx2(
    path: &Path,
    size: (u32, u32),
    format: BlockFormat,
    blocks: &[u8],
    values: &BTreeMap<String, String>,
) -> Result<(), SaveError> {
    write_whole(path, &encode_ktx2(size, format, blocks, values, path)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ktx2::dfd::{Basic, Block};
    use ktx2::{Format, Reader};

    fn blocks(width: u32, height: u32) -> Vec<u8> {
        let n = width.div_ceil(4) * height.div_ceil(4) * 8;
        (0..n).map(|i| (i * 37 % 251) as u8).collect()
    }

    #[test]
    fn another_reader_finds_what_was_written() {
        let values = BTreeMap::from([("etendue.scale".into(), "0.5".into()), ("A".into(), String::new())]);
        for (format, vulkan) in [
            (BlockFormat::Bc1RgbUnorm, Format::BC1_RGB_UNORM_BLOCK),
            (BlockFormat::Bc4Unorm, Format::BC4_UNORM_BLOCK),
        ] {
            for (width, height) in [(1, 1), (4, 4), (13, 22), (64, 32)] {
                let data = blocks(width, height);
                let bytes =
                    encode_ktx2((width, height), format, &data, &values, Path::new("a.ktx2")).unwrap();
                let reader = Reader::new(&bytes).unwrap();
                let header = reader.header();
                assert_eq!(header.format, Some(vulkan));
                assert_eq!((header.pixel_width, header.pixel_height, header.pixel_depth), (width, height, 0));
                assert_eq!((header.type_size, header.layer_count, header.face_count), (1, 0, 1));
                assert_eq!((header.level_count, header.supercompression_scheme), (1, None));
                let levels: Vec<_> = reader.levels().collect();
                assert_eq!(levels.len(), 1);
                assert_eq!(levels[0].data, data);
                assert_eq!(levels[0].uncompressed_byte_length, data.len() as u64);
                assert_eq!(bytes.len() % 8, 0, "the level is aligned and ends the file");
                let pairs: Vec<_> = reader.key_value_data().collect();
                assert_eq!(
                    pairs.iter().map(|p| p.0).collect::<Vec<_>>(),
                    ["A", "KTXwriter", "etendue.scale"]
                );
                assert_eq!((pairs[0].1, pairs[2].1), (&b"\0"[..], &b"0.5\0"[..]));
                let (expected, _) = Basic::from_format(vulkan).unwrap();
                assert_eq!(reader.dfd_blocks(), [Block::Basic(expected)]);
            }
        }
    }

    #[test]
    fn what_makes_no_texture_is_refused() {
        let none = BTreeMap::new();
        let try_one = |size, blocks: &[u8], values: &BTreeMap<String, String>| {
            encode_ktx2(size, BlockFormat::Bc4Unorm, blocks, values, Path::new("a.ktx2"))
                .map_err(|e| e.to_string())
        };
        for (size, bytes) in [((0, 4), 0), ((4, 4), 7), ((5, 4), 8), ((u32::MAX, u32::MAX), 8)] {
            assert!(try_one(size, &vec![0; bytes], &none).unwrap_err().contains("do not fill"));
        }
        for key in ["", "a\0b", "KTXwriter"] {
            let values = BTreeMap::from([(key.into(), "x".into())]);
            assert!(try_one((4, 4), &[0; 8], &values).unwrap_err().contains("cannot be a key"));
        }
        assert!(try_one((4, 4), &[0; 8], &none).is_ok());
    }
}
