//! Volumes on grids: `.vol` files.
//!
//! Little-endian: "VOL", a version byte 3, then 32-bit integers: encoding (1: 32-bit floats), cells along x, y
//! and z, channels; six floats of bounds (lower corner, upper corner); then the values, x fastest, channels
//! together.

use std::path::Path;

use crate::io::error::{LoadError, Problem};

/// Longer files are refused.
pub(super) const MAX_FILE: u64 = 1 << 32;
/// Length of what stands before the values.
const HEADER: usize = 48;

/// A grid of values and the box it was made for.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Volume {
    pub(super) size: [u32; 3],
    pub(super) channels: u32,
    pub(super) values: Vec<f32>,
    /// Lower and upper corner.
    pub(super) bounds: [[f32; 3]; 2],
}

/// Reads the bytes of a `.vol` file. `file` appears in messages only.
pub(super) fn parse_vol(bytes: &[u8], file: &Path) -> Result<Volume, LoadError> {
    let Some((header, data)) = bytes.split_at_checked(HEADER) else {
        let problem = Problem::Damaged(format!("{} bytes, and the header alone has {HEADER}", bytes.len()));
        return Err(LoadError::new(file, problem));
    };
    if &header[..3] != b"VOL" {
        return Err(LoadError::unexpected(file, "other bytes", "\"VOL\" at the start"));
    }
    if header[3] != 3 {
        return Err(LoadError::unexpected(file, format!("version {}", header[3]), "version 3"));
    }
    let word = |at: usize| [header[at], header[at + 1], header[at + 2], header[at + 3]];
    let whole = |at: usize| i32::from_le_bytes(word(at));
    if whole(4) != 1 {
        let problem = Problem::Unsupported(format!("encoding {} (expected 1: 32-bit floats)", whole(4)));
        return Err(LoadError::new(file, problem));
    }
    let channels = whole(20);
    if channels != 1 && channels != 3 {
        return Err(LoadError::unexpected(file, format!("{channels} channels"), "1 or 3 channels"));
    }
    let mut size = [0; 3];
    let mut count = channels as u64;
    for (k, cells) in size.iter_mut().enumerate() {
        let found = whole(8 + 4 * k);
        if found < 1 {
            return Err(LoadError::unexpected(file, format!("{found} cells along an axis"), "at least 1"));
        }
        *cells = found as u32;
        count = count.saturating_mul(found as u64);
    }
    if count.saturating_mul(4) != data.len() as u64 {
        let problem = Problem::Damaged(format!(
            "{} x {} x {} cells of {channels} channels need {} bytes of values, and there are {}",
            size[0],
            size[1],
            size[2],
            count.saturating_mul(4),
            data.len()
        ));
        return Err(LoadError::new(file, problem));
    }
    let values: Vec<f32> =
        data.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
    if let Some(bad) = values.iter().find(|v| !(v.is_finite() && **v >= 0.0)) {
        return Err(LoadError::unexpected(file, format!("the value {bad}"), "finite values, none below 0"));
    }
    let float = |at: usize| f32::from_le_bytes(word(at));
    let corner = |at: usize| [float(at), float(at + 4), float(at + 8)];
    let bounds = [corner(24), corner(36)];
    if !bounds.as_flattened().iter().all(|b| b.is_finite()) {
        return Err(LoadError::unexpected(file, format!("the bounds {bounds:?}"), "finite bounds"));
    }
    Ok(Volume { size, channels: channels as u32, values, bounds })
}
