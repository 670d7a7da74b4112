//! Grids of values: the binary `.vol` of Mitsuba (`gridvolume`), read and written.
//!
//! All little endian: the letters VOL, the byte 3, then 32-bit integers: encoding (1: 32-bit floats, the only one read), cells along x, y and z, channels (1 or 3); six floats: the lower and the
//! upper corner of the box; then the values, x fastest, then y, then z, channels together.

use std::path::Path;

use etendue_core::scene::GridDesc;

use super::atomic::write_whole;
use super::error::{LoadError, Problem, SaveError};
use super::source::{DiskSource, read_file};

/// Longer files are refused.
pub(crate) const MAX_FILE: u64 = 1 << 31;
/// More cells along an axis are refused.
const MAX_SIZE: i32 = 4096;
const HEADER: usize = 48;
const MAGIC: [u8; 4] = *b"VOL\x03";

/// Values on a grid and the box that they fill.
#[derive(Clone, Debug, PartialEq)]
pub struct Volume {
    /// Cells along x, y and z.
    pub size: [u32; 3],
    /// One value per cell, or three.
    pub channels: u32,
    /// Lower and upper corner of the box \[m\].
    pub bounds: [[f32; 3]; 2],
    /// The values: x runs fastest, then y, then z, channels together.
    pub values: Vec<f32>,
}

impl Volume {
    /// The grid in a box: the one given, else that of the file, else (where that one has no volume) the unit cube.
    pub fn into_grid(self, bounds: Option<[[f32; 3]; 2]>) -> GridDesc {
        let [low, high] = bounds.unwrap_or(self.bounds);
        let proper = (0..3).all(|k| low[k] < high[k]);
        let (low, high) = if proper || bounds.is_some() { (low, high) } else { ([0.0; 3], [1.0; 3]) };
        let mut to_world = [[0.0; 4]; 3];
        for k in 0..3 {
            to_world[k][k] = high[k] - low[k];
            to_world[k][3] = low[k];
        }
        GridDesc { size: self.size, channels: self.channels, values: self.values, to_world }
    }
}

/// Reads a `.vol` file. Values are checked when the scene is compiled.
pub fn read_vol(path: &Path) -> Result<Volume, LoadError> {
    parse_vol(&read_file(&DiskSource, path, MAX_FILE)?, path)
}

/// As [`read_vol`], from bytes. `file` appears in messages only.
pub fn parse_vol(bytes: &[u8], file: &Path) -> Result<Volume, LoadError> {
    let unexpected = |found: String, expected: &str| Err(LoadError::unexpected(file, found, expected));
    if bytes.len() < 4 || bytes[..3] != MAGIC[..3] {
        return unexpected("another beginning".into(), "the letters VOL: a grid of values");
    }
    if bytes[3] != MAGIC[3] {
        return unexpected(format!("version {}", bytes[3]), "version 3");
    }
    if bytes.len() < HEADER {
        let how = format!("{} bytes are less than the header's {HEADER}", bytes.len());
        return Err(LoadError::new(file, Problem::Damaged(how)));
    }
    let word = |i: usize| {
        let at = 4 + 4 * i;
        [bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]
    };
    let whole = |i: usize| i32::from_le_bytes(word(i));
    let float = |i: usize| f32::from_le_bytes(word(i));
    if whole(0) != 1 {
        return unexpected(format!("encoding {}", whole(0)), "encoding 1 (32-bit floats)");
    }
    let size = [whole(1), whole(2), whole(3)];
    if let Some(n) = size.iter().find(|n| **n < 1 || **n > MAX_SIZE) {
        return unexpected(format!("{n} cells along an axis"), "1 to 4096");
    }
    let channels = whole(4);
    if channels != 1 && channels != 3 {
        return unexpected(format!("{channels} channels"), "1 or 3");
    }
    // At most 3 * 2^36 values.
    let count = size.iter().fold(channels as u64, |n, k| n * *k as u64);
    let found = (bytes.len() - HEADER) as u64;
    if found != 4 * count {
        let how = format!("{found} bytes of values, where the header says {}", 4 * count);
        return Err(LoadError::new(file, Problem::Damaged(how)));
    }
    let values = bytes[HEADER..].chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    Ok(Volume {
        size: size.map(|n| n as u32),
        channels: channels as u32,
        bounds: [[float(5), float(6), float(7)], [float(8), float(9), float(10)]],
        values: values.collect(),
    })
}

/// The bytes of a `.vol` file.
///
/// # Errors
/// When the values do not fill the grid, or it has no or too many cells along an axis.
pub fn encode_vol(volume: &Volume, file: &Path) -> Result<Vec<u8>, SaveError> {
    let [x, y, z] = volume.size;
    let count = volume.size.iter().fold(u64::from(volume.channels), |n, k| n.saturating_mul(u64::from(*k)));
    let fits = volume.size.iter().all(|n| (1..=MAX_SIZE as u32).contains(n));
    if !fits || !matches!(volume.channels, 1 | 3) || volume.values.len() as u64 != count {
        let found = volume.values.len();
        let reason =
            format!("{found} values do not fill {x} x {y} x {z} cells of {} channels", volume.channels);
        return Err(SaveError::new(file, reason));
    }
    let mut bytes = Vec::with_capacity(HEADER + 4 * volume.values.len());
    bytes.extend(MAGIC);
    for n in [1, x, y, z, volume.channels] {
        bytes.extend(n.to_le_bytes());
    }
    for v in volume.bounds.as_flattened().iter().chain(&volume.values) {
        bytes.extend(v.to_le_bytes());
    }
    Ok(bytes)
}

/// Writes a `.vol` file.
///
/// # Errors
/// As for [`encode_vol`], and when the file cannot be written.
pub fn write_vol(path: &Path, volume: &Volume) -> Result<(), SaveError> {
    write_whole(path, &encode_vol(volume, path)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn small(channels: u32) -> Volume {
        let values = (0..24 * channels).map(|i| i as f32 * 0.5).collect();
        Volume { size: [2, 3, 4], channels, bounds: [[-1.0, 0.0, 2.0], [1.0, 0.5, 3.0]], values }
    }

    #[test]
    fn what_was_written_comes_back() {
        for channels in [1, 3] {
            let volume = small(channels);
            let bytes = encode_vol(&volume, Path::new("a.vol")).unwrap();
            assert_eq!(bytes.len(), 48 + 96 * channels as usize);
            assert_eq!(parse_vol(&bytes, Path::new("a.vol")).unwrap(), volume);
            for cut in 0..bytes.len() {
                assert!(parse_vol(&bytes[..cut], Path::new("a.vol")).is_err(), "{cut}");
            }
        }
        assert!(encode_vol(&Volume { size: [2, 3, 5], ..small(1) }, Path::new("a.vol")).is_err());
        assert!(encode_vol(&Volume { channels: 2, ..small(1) }, Path::new("a.vol")).is_err());
    }

    #[test]
    fn wrong_headers_are_named() {
        let bytes = encode_vol(&small(1), Path::new("a.vol")).unwrap();
        let with = |at: usize, word: i32| {
            let mut b = bytes.clone();
            b[at..at + 4].copy_from_slice(&word.to_le_bytes());
            parse_vol(&b, Path::new("a.vol")).unwrap_err().to_string()
        };
        for (at, word, said) in [
            (0, 7, "VOL"),
            (0, i32::from_le_bytes(*b"VOL\x02"), "version 3"),
            (4, 3, "encoding 1"),
            (8, 0, "1 to 4096"),
            (12, -1, "1 to 4096"),
            (16, i32::MAX, "1 to 4096"),
            (16, 4096, "where the header says 98304"),
            (20, 2, "1 or 3"),
            (20, 3, "bytes of values"),
        ] {
            let message = with(at, word);
            assert!(message.contains("a.vol") && message.contains(said), "{message}");
        }
    }

    #[test]
    fn a_box_comes_from_the_scene_the_file_or_nowhere() {
        let corner = |g: &GridDesc| (g.to_world.map(|r| r[3]), [0, 1, 2].map(|k| g.to_world[k][k]));
        assert_eq!(corner(&small(1).into_grid(None)), ([-1.0, 0.0, 2.0], [2.0, 0.5, 1.0]));
        let given = Some([[0.0; 3], [4.0, 5.0, 6.0]]);
        assert_eq!(corner(&small(1).into_grid(given)), ([0.0; 3], [4.0, 5.0, 6.0]));
        let flat = Volume { bounds: [[1.0; 3]; 2], ..small(1) };
        assert_eq!(corner(&flat.into_grid(None)), ([0.0; 3], [1.0; 3]));
    }
}
