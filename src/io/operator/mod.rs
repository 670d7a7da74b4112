//! Operator files (`.etd`): a baked operator without its scene.
//!
//! All numbers are little-endian. The file is a header, a table and sections:
//!
//! | bytes | header |
//! |---|---|
//! | 0..8 | `etendue\0` |
//! | 8..12 | u32 version, 1 |
//! | 12..16 | u32 number of sections |
//! | 16..24 | u64 length of the file |
//! | 24..32 | zeros |
//! | 32..64 | BLAKE3 of bytes 0..32 and the table |
//!
//! | bytes | entry of the table, from byte 64 on |
//! |---|---|
//! | 0..8 | name, padded with zeros |
//! | 8..16 | u64 where the section begins in the file |
//! | 16..24 | u64 its bytes |
//! | 24..28 | u32 flags: 1 = a reader that does not know the name must refuse the file; without, it skips the section |
//! | 28..32 | zeros |
//! | 32..64 | BLAKE3 of the section |
//!
//! Sections follow in the order of the table, each at the first multiple of 64 bytes, zeros before it; the last one ends the file. So a host can map the file and use the arrays
//! where they are. Sections of version 1, with n patches in the order of the tiles, m = ceil(n / 8) clusters:
//!
//! | name | what |
//! |---|---|
//! | `info` | JSON: how it was made ([`OperatorInfo`]), and the kind of transport |
//! | `patches` | n x 13 f32: area \[m^2\], position \[m\], normal, albedo, emission (radiosity, \[W/m^2\]) |
//! | `elements` | u32 per element of the scene: its patch, 0xffff_ffff for none |
//! | `escaped` | n f32: share of a patch's rays that see the sky |
//! | `seen` | n f32: share of a patch that is not covered |
//!
//! Transport in tiles ([`etendue_core::radiosity::tiles`] has the layout of kinds and payload):
//!
//! | name | what |
//! |---|---|
//! | `albedo` | n x 3 f32 that the clusters' inverses were made with |
//! | `factors` | n f32 |
//! | `weights` | f32 per pass, or none |
//! | `spread` | n f32: what a patch gets of its cluster's irradiance; absent without a second level |
//! | `kinds`, `tiles` | nibbles and payload of n patches |
//! | `kinds0`, `tiles0` to `kinds2`, `tiles2` | those of the inverse per channel, of m clusters; absent without a second level |
//!
//! Transport in texture blocks ([`etendue_core::radiosity::blocks`]):
//!
//! | name | what |
//! |---|---|
//! | `albedo` | n x 3 f32 |
//! | `order` | u32 per row, its patch; or nothing |
//! | `scales` | 2 f32 per row, or nothing |
//! | `values` | f32 per code |
//! | `blocks` | 8 bytes each |
//! | `starts` | u32 per row and one more |
//! | `columns`, `kept` | of kept entries: u32 and f32, or u16 and f16 |
//!
//! A reader refuses, with a reason, what is cut short, longer than it says, changed by a single bit, of a newer version, or made of numbers out of their range.

mod blocks;
mod container;
mod info;
#[cfg(test)]
mod tests;
mod tiles;

pub use info::OperatorInfo;

use super::atomic::write_whole;
use super::error::{LoadError, SaveError, quoted};
use super::source::{DiskSource, read_file};
use crate::driver::radiosity::Transport;
use container::{Section, Sections, tag};
use etendue_core::illumination::{Basis, Sides};
use etendue_core::radiosity::patches::{NO_PATCH, Patch};
use info::{Head, TransportHead};
use std::path::Path;

/// Longer files are refused.
const MAX_FILE: u64 = 1 << 34;
/// Numbers of a patch.
const PATCH: usize = 13;
/// How far from 1 the length of a normal may be; patches whose normals cancel have none.
const UNIT: f32 = 1e-3;

/// What an operator file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct OperatorFile {
    /// How it was made.
    pub info: OperatorInfo,
    /// The patches, in the order of the transport.
    pub patches: Vec<Patch>,
    /// Patch of each element of the scene, or [`NO_PATCH`].
    pub of: Vec<u32>,
    /// Share of each patch's rays that see the sky.
    pub escaped: Vec<f32>,
    /// Share of each patch that is not covered.
    pub seen: Vec<f32>,
    /// How light gets from patch to patch.
    pub transport: Transport,
}

/// A part of an operator that cannot be: which, what was found, what was expected.
type Wrong = (&'static str, String, String);

impl OperatorFile {
    /// What a reader would refuse.
    fn check(&self) -> Result<(), Wrong> {
        self.info.check()?;
        let n = self.patches.len();
        let settings = &self.info.elements;
        if settings.basis != Basis::Constant || settings.sides != Sides::Apart {
            let found = format!("elements {:?}, sides {:?}", settings.basis, settings.sides);
            return Err(("info", found, "constant elements, sides apart".into()));
        }
        check_patches(&self.patches)?;
        let mut used = vec![false; n];
        for (i, patch) in self.of.iter().enumerate() {
            match used.get_mut(*patch as usize) {
                Some(used) => *used = true,
                None if *patch == NO_PATCH => {}
                None => {
                    return Err((
                        "elements",
                        format!("patch {patch} of element {i}"),
                        format!("less than {n}"),
                    ));
                }
            }
        }
        if let Some(i) = used.iter().position(|used| !used) {
            return Err(("elements", format!("none of patch {i}"), "at least one".into()));
        }
        for (name, list, least) in [("escaped", &self.escaped, 0.0), ("seen", &self.seen, f32::MIN_POSITIVE)]
        {
            if list.len() != n {
                return Err((name, format!("{} numbers", list.len()), format!("{n}, one per patch")));
            }
            if let Some((i, x)) = list.iter().enumerate().find(|(_, x)| !(least..=1.0).contains(*x)) {
                return Err((name, format!("{x} at patch {i}"), "a number from 0 to 1".into()));
            }
        }
        match &self.transport {
            Transport::Tiles(relighter) => tiles::check(relighter, &seen_areas(&self.patches, &self.seen)),
            Transport::Blocks(operator) => blocks::check(operator, &self.patches),
        }
    }
}

fn check_patches(patches: &[Patch]) -> Result<(), Wrong> {
    for (i, p) in patches.iter().enumerate() {
        let wrong = |what: &str, values: &[f32], expected: &str| {
            Err(("patches", format!("{what} {values:?} of patch {i}"), expected.into()))
        };
        if !(p.area.is_finite() && p.area > 0.0) {
            return wrong("area", &[p.area], "a positive number");
        }
        if !p.position.iter().all(|x| x.is_finite()) {
            return wrong("position", &p.position, "finite numbers");
        }
        let squared: f32 = p.normal.iter().map(|x| x * x).sum();
        if !(squared == 0.0 || (squared - 1.0).abs() <= 2.0 * UNIT) {
            return wrong("normal", &p.normal, "a unit vector or zero");
        }
        if !p.albedo.iter().all(|x| (0.0..=1.0).contains(x)) {
            return wrong("albedo", &p.albedo, "numbers from 0 to 1");
        }
        if !p.emission.iter().all(|x| x.is_finite() && *x >= 0.0) {
            return wrong("emission", &p.emission, "finite numbers of at least 0");
        }
    }
    Ok(())
}

/// The bytes of an operator file; `file` is only named in errors. The same operator gives the same bytes.
///
/// # Errors
/// When the parts of the operator do not fit together, or hold numbers that a reader would refuse.
pub fn encode_operator(operator: &OperatorFile, file: &Path) -> Result<Vec<u8>, SaveError> {
    let wrong = |(part, found, expected): Wrong| {
        SaveError::new(file, format!("cannot be written: {part}: found {found}, expected {expected}"))
    };
    operator.check().map_err(wrong)?;
    let mut sections = vec![
        Section::new(tag("patches"), container::floats(&flat(&operator.patches))),
        Section::new(tag("elements"), container::words(operator.of.iter().copied())),
        Section::new(tag("escaped"), container::floats(&operator.escaped)),
        Section::new(tag("seen"), container::floats(&operator.seen)),
    ];
    let transport = match &operator.transport {
        Transport::Tiles(relighter) => TransportHead::Tiles(tiles::write(relighter, &mut sections)),
        Transport::Blocks(operator) => TransportHead::Blocks(blocks::write(operator, &mut sections)),
    };
    let head = Head { info: operator.info.clone(), transport };
    let json = serde_json::to_vec(&head).map_err(|e| SaveError::new(file, e))?;
    sections.insert(0, Section::new(tag("info"), json));
    Ok(container::assemble(&sections))
}

/// Writes an operator file.
///
/// # Errors
/// As [`encode_operator`], and when the disk refuses.
pub fn write_operator(path: &Path, operator: &OperatorFile) -> Result<(), SaveError> {
    write_whole(path, &encode_operator(operator, path)?)
}

/// Reads an operator file.
///
/// # Errors
/// As [`parse_operator`].
pub fn read_operator(path: &Path) -> Result<OperatorFile, LoadError> {
    parse_operator(&read_file(&DiskSource, path, MAX_FILE)?, path)
}

/// Reads an operator file from its bytes; `file` is only named in errors.
///
/// # Errors
/// When it is no operator file, damaged, newer than this program, or holds numbers out of their range.
pub fn parse_operator(bytes: &[u8], file: &Path) -> Result<OperatorFile, LoadError> {
    let mut sections = Sections::read(bytes, file)?;
    let head = sections.take(tag("info"))?;
    let head: Head =
        serde_json::from_slice(head).map_err(|e| LoadError::decode(file, "JSON", e).field("info"))?;
    let patches = patches(&sections.take_floats(tag("patches"))?)
        .map_err(|found| LoadError::unexpected(file, found, "13 for each patch").field("patches"))?;
    let wrong = |(part, found, expected): Wrong| LoadError::unexpected(file, found, expected).field(part);
    // Before what is made of them.
    check_patches(&patches).map_err(wrong)?;
    let of = sections.take_words(tag("elements"))?;
    let escaped = sections.take_floats(tag("escaped"))?;
    let seen = sections.take_floats(tag("seen"))?;
    if seen.len() != patches.len() {
        let (found, expected) = (format!("{} numbers", seen.len()), format!("{}", patches.len()));
        return Err(LoadError::unexpected(file, found, expected).field("seen"));
    }
    let transport = match head.transport {
        TransportHead::Tiles(head) => {
            Transport::Tiles(Box::new(tiles::read(&head, &mut sections, seen_areas(&patches, &seen))?))
        }
        TransportHead::Blocks(head) => Transport::Blocks(Box::new(blocks::read(&head, &mut sections)?)),
    };
    sections.finish()?;
    let operator = OperatorFile { info: head.info, patches, of, escaped, seen, transport };
    operator.check().map_err(wrong)?;
    Ok(operator)
}

/// Areas of what is not covered.
fn seen_areas(patches: &[Patch], seen: &[f32]) -> Vec<f32> {
    patches.iter().zip(seen).map(|(p, seen)| p.area * seen).collect()
}

/// Patches as numbers.
fn flat(patches: &[Patch]) -> Vec<f32> {
    let mut out = Vec::with_capacity(PATCH * patches.len());
    for p in patches {
        out.push(p.area);
        for vector in [p.position, p.normal, p.albedo, p.emission] {
            out.extend(vector);
        }
    }
    out
}

/// Numbers as patches.
fn patches(numbers: &[f32]) -> Result<Vec<Patch>, String> {
    let (rows, rest) = numbers.as_chunks::<PATCH>();
    if !rest.is_empty() {
        return Err(format!("{} numbers", numbers.len()));
    }
    let vector = |row: &[f32; PATCH], at: usize| [row[at], row[at + 1], row[at + 2]];
    Ok(rows
        .iter()
        .map(|row| Patch {
            area: row[0],
            position: vector(row, 1),
            normal: vector(row, 4),
            albedo: vector(row, 7),
            emission: vector(row, 10),
        })
        .collect())
}
