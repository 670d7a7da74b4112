//! What can be wrong with a scene, with the place and the numbers; and what was mended.

use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;

/// Why a scene cannot be compiled. Each variant says where, what was found and what was expected.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum SceneError {
    /// A number is NaN or infinite.
    NotFinite {
        /// What holds it, e.g. ``light 2 (point)``.
        place: String,
        /// The field.
        field: &'static str,
    },
    /// A number lies outside its domain.
    OutOfRange {
        /// What holds it.
        place: String,
        /// The field.
        field: &'static str,
        /// The value found.
        value: f32,
        /// The domain, in words.
        expected: &'static str,
    },
    /// A name refers to nothing.
    UnknownName {
        /// What refers to it.
        place: String,
        /// `material`, `medium` or `texture`.
        kind: &'static str,
        /// The name.
        name: String,
    },
    /// Two things of one kind share a name.
    DuplicateName {
        /// `material`, `medium` or `texture`.
        kind: &'static str,
        /// The name.
        name: String,
    },
    /// A surface would reflect more than it receives.
    EnergyAboveOne {
        /// The material.
        material: String,
        /// 0 red, 1 green, 2 blue.
        channel: usize,
        /// The reflected fraction found.
        value: f32,
    },
    /// An index points past the end of its array.
    IndexOutOfRange {
        /// The mesh.
        place: String,
        /// `vertex`, `material` or another array.
        kind: &'static str,
        /// The triangle that holds it.
        triangle: usize,
        /// The index.
        index: u32,
        /// The length of the array.
        length: usize,
    },
    /// An array has the wrong length.
    WrongLength {
        /// What holds it.
        place: String,
        /// The array.
        field: &'static str,
        /// Its length.
        found: usize,
        /// The length expected.
        expected: usize,
    },
    /// More than one picture of the environment.
    SecondImage {
        /// What holds the second.
        place: String,
    },
    /// The scene has no surface at all.
    Empty,
    /// More elements than 32-bit indices can count.
    TooLarge {
        /// What there is too much of.
        what: &'static str,
        /// How many.
        found: usize,
    },
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite { place, field } => {
                write!(f, "{place}: {field} is not a finite number")
            }
            Self::OutOfRange { place, field, value, expected } => {
                write!(f, "{place}: {field} is {value}, expected {expected}")
            }
            Self::UnknownName { place, kind, name } => {
                write!(f, "{place}: there is no {kind} named \"{name}\"")
            }
            Self::DuplicateName { kind, name } => {
                write!(f, "two of kind {kind} are named \"{name}\"; names must differ")
            }
            Self::EnergyAboveOne { material, channel, value } => write!(
                f,
                "material \"{material}\": channel {} reflects {value} of the light it receives, expected at most 1",
                ["red", "green", "blue"][(*channel).min(2)]
            ),
            Self::IndexOutOfRange { place, kind, triangle, index, length } => write!(
                f,
                "{place}: triangle {triangle} refers to {kind} {index}, but there are only {length}"
            ),
            Self::WrongLength { place, field, found, expected } => {
                write!(f, "{place}: {field} has {found} entries, expected {expected}")
            }
            Self::SecondImage { place } => {
                write!(
                    f,
                    "{place}: a second picture of the environment, expected at most one (constant ones are added to it)"
                )
            }
            Self::Empty => write!(f, "the scene has no surfaces: expected a mesh or a shape"),
            Self::TooLarge { what, found } => {
                write!(f, "{found} {what} are more than 32-bit indices can count")
            }
        }
    }
}

impl core::error::Error for SceneError {}

/// A kind of defect that compilation mends by itself, and counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Cleanup {
    /// Triangles without area (or so thin that f32 gives them no normal) were dropped.
    DegenerateTriangles,
    /// Triangles with the very same three vertices and material as an earlier one were dropped.
    DuplicateTriangles,
    /// Shading normals of zero length were replaced by the geometric normal.
    ZeroNormals,
    /// Lights without power were dropped.
    DarkLights,
}

impl fmt::Display for Cleanup {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::DegenerateTriangles => "triangles without area were dropped",
            Self::DuplicateTriangles => "triangles that repeat an earlier one were dropped",
            Self::ZeroNormals => "shading normals of zero length were replaced by the geometric normal",
            Self::DarkLights => "lights without power were dropped",
        })
    }
}

/// What compilation mended: how many of each kind.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CompileReport {
    /// Kind and count, each kind at most once, in the order of [`Cleanup`].
    pub cleanups: Vec<(Cleanup, u64)>,
}

impl CompileReport {
    pub(super) fn count(&mut self, kind: Cleanup, n: u64) {
        if n == 0 {
            return;
        }
        match self.cleanups.binary_search_by_key(&kind, |e| e.0) {
            Ok(i) => self.cleanups[i].1 += n,
            Err(i) => self.cleanups.insert(i, (kind, n)),
        }
    }
}
