//! Form factors in few bits: 8 x 8 tiles of a symmetric matrix, each with the bits that it is worth.
//!
//! The matrix is S = A^1/2 F A^-1/2, S(i, j) = A_i F(i, j) / sqrt(A_i A_j): symmetric, and the square of what a tile's error costs the light on all surfaces is the sum of
//! the squares of its entries' errors. Half of it is stored: tiles (I, J) with I >= J, those on the diagonal whole.
//!
//! A tile has one of ten [`Kind`]s: nothing, one mean, codes q of 1, 2, 3, 4, 6 or 8 bits with the value s (q / (2^b - 1))^2 (squares put their steps where form factors
//! are), or f16 or f32 as they are. Which, is chosen by rate and distortion: the least error^2 + lambda x bits ([`encode`]). In order of [`crate::radiosity::order`] half of the tiles are empty.
//!
//! A code of b bits is stored as parts of 4, 2 and 1 bits; a part has one word per column, in which row r is r parts up: eight columns make a register, twice eight a wider one with two rows.

mod apply;
mod decode;
mod encode;
mod half;
mod lists;
#[cfg(test)]
mod tests;

pub use apply::{STRIPE_ROWS, Scratch, add_columns};
pub use decode::decode;
pub use encode::{Curve, RateCurves, Rates, curve_row, encode, encode_row, join_rows};

use alloc::vec::Vec;
use core::fmt;

/// Side of a tile.
pub const SIDE: usize = 8;
/// Entries of a tile.
pub const ENTRIES: usize = SIDE * SIDE;
/// C channels of a run of eight patches.
pub type Planes<const C: usize> = [[f32; SIDE]; C];

/// What a tile stores.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Kind {
    /// All entries 0.
    Empty = 0,
    /// One mean.
    Mean = 1,
    /// Codes of so many bits.
    Bits1 = 2,
    /// As the name says.
    Bits2 = 3,
    /// As the name says.
    Bits3 = 4,
    /// As the name says.
    Bits4 = 5,
    /// As the name says.
    Bits6 = 6,
    /// As the name says.
    Bits8 = 7,
    /// f16, subnormals included.
    F16 = 8,
    /// f32.
    F32 = 9,
}

impl Kind {
    /// All, from nothing to the most bits.
    pub const ALL: [Self; 10] = [
        Self::Empty,
        Self::Mean,
        Self::Bits1,
        Self::Bits2,
        Self::Bits3,
        Self::Bits4,
        Self::Bits6,
        Self::Bits8,
        Self::F16,
        Self::F32,
    ];

    /// The kind of a number.
    pub const fn from_number(number: u8) -> Option<Self> {
        if (number as usize) < Self::ALL.len() { Some(Self::ALL[number as usize]) } else { None }
    }

    /// Bits of a code.
    pub const fn bits(self) -> u32 {
        match self {
            Self::Empty | Self::Mean => 0,
            Self::Bits1 => 1,
            Self::Bits2 => 2,
            Self::Bits3 => 3,
            Self::Bits4 => 4,
            Self::Bits6 => 6,
            Self::Bits8 => 8,
            Self::F16 => 16,
            Self::F32 => 32,
        }
    }

    /// Bytes of a tile, its scale of two bytes included.
    pub const fn bytes(self) -> usize {
        match self {
            Self::Empty => 0,
            Self::F16 | Self::F32 => 8 * self.bits() as usize,
            _ => 2 + 8 * self.bits() as usize,
        }
    }
}

/// Tiles that do not fit their number of patches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TileError {
    /// Another number of kinds than of tiles.
    Kinds {
        /// Bytes found.
        found: usize,
        /// Bytes expected.
        expected: usize,
    },
    /// Another number of bytes than the kinds ask for.
    Payload {
        /// Bytes found.
        found: usize,
        /// Bytes expected.
        expected: usize,
    },
    /// A kind that is none.
    UnknownKind {
        /// Row of tiles.
        row: usize,
        /// Column of tiles.
        column: usize,
    },
    /// A number that is not finite and at least 0.
    BadValue {
        /// Row of tiles.
        row: usize,
        /// Column of tiles.
        column: usize,
    },
    /// More patches than there can be.
    TooLarge {
        /// Their number.
        patches: usize,
    },
}

impl fmt::Display for TileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Kinds { found, expected } => {
                write!(f, "{found} bytes of kinds of tiles, expected {expected}")
            }
            Self::Payload { found, expected } => write!(f, "{found} bytes of tiles, expected {expected}"),
            Self::UnknownKind { row, column } => write!(f, "tile ({row}, {column}) is of no known kind"),
            Self::BadValue { row, column } => {
                write!(f, "tile ({row}, {column}) has numbers that are not finite and at least 0")
            }
            Self::TooLarge { patches } => write!(f, "{patches} patches are more than tiles can hold"),
        }
    }
}

impl core::error::Error for TileError {}

/// Most patches.
pub const PATCHES_MAX: usize = 1 << 20;

/// A symmetric matrix in tiles.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tiles {
    n: usize,
    /// A nibble for each tile of the half, tile rows 0, 1, ... of 1, 2, ... tiles, each row beginning a byte.
    kinds: Vec<u8>,
    payload: Vec<u8>,
    /// Where the payload of each row of tiles begins.
    rows: Vec<u32>,
}

/// Rows of tiles.
pub const fn tile_rows(n: usize) -> usize {
    n.div_ceil(SIDE)
}

/// Where the nibbles of a row of tiles begin \[bytes\].
const fn kinds_start(row: usize) -> usize {
    // Rows of 1, 2, 3, 4 ... nibbles are 1, 1, 2, 2, ... bytes.
    let pairs = row / 2;
    pairs * (pairs + 1) + if row % 2 == 1 { pairs + 1 } else { 0 }
}

impl Tiles {
    /// From kinds and payload, as a file has them.
    ///
    /// # Errors
    /// [`TileError`].
    pub fn try_new(n: usize, kinds: Vec<u8>, payload: Vec<u8>) -> Result<Self, TileError> {
        if n > PATCHES_MAX {
            return Err(TileError::TooLarge { patches: n });
        }
        let expected = kinds_start(tile_rows(n));
        if kinds.len() != expected {
            return Err(TileError::Kinds { found: kinds.len(), expected });
        }
        let mut made = Self { n, kinds, payload, rows: Vec::with_capacity(tile_rows(n) + 1) };
        let mut bytes = 0_usize;
        for row in 0..tile_rows(n) {
            made.rows.push(bytes as u32);
            for column in 0..=row {
                let kind = made.number(row, column).and_then(Kind::from_number);
                bytes += kind.ok_or(TileError::UnknownKind { row, column })?.bytes();
            }
            if bytes > u32::MAX as usize {
                return Err(TileError::TooLarge { patches: n });
            }
        }
        made.rows.push(bytes as u32);
        if made.payload.len() != bytes {
            return Err(TileError::Payload { found: made.payload.len(), expected: bytes });
        }
        made.check_values()?;
        Ok(made)
    }

    /// How many patches there are.
    pub fn len(&self) -> usize {
        self.n
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.n == 0
    }

    /// Kinds of all tiles, as a file has them.
    pub fn kinds(&self) -> &[u8] {
        &self.kinds
    }

    /// Scales and codes of all tiles, as a file has them.
    pub fn payload(&self) -> &[u8] {
        &self.payload
    }

    /// Bytes of all of it.
    pub fn bytes(&self) -> usize {
        self.kinds.len() + self.payload.len() + 4 * self.rows.len()
    }

    /// Kind of the tile in a row and a column, column <= row; empty elsewhere.
    #[inline(always)]
    pub fn kind(&self, row: usize, column: usize) -> Kind {
        self.number(row, column).and_then(Kind::from_number).unwrap_or(Kind::Empty)
    }

    #[inline(always)]
    fn number(&self, row: usize, column: usize) -> Option<u8> {
        let byte = *self.kinds.get(kinds_start(row) + column / 2)?;
        (column <= row).then_some(byte >> (4 * (column % 2)) & 15)
    }

    fn check_values(&self) -> Result<(), TileError> {
        for row in 0..tile_rows(self.n) {
            let mut payload = &self.payload[self.rows[row] as usize..];
            for column in 0..=row {
                let kind = self.kind(row, column);
                let (bytes, rest) = payload.split_at(kind.bytes());
                payload = rest;
                let bad = |x: &f32| !x.is_finite() || x.is_sign_negative();
                if decode(kind, bytes).as_flattened().iter().any(bad) {
                    return Err(TileError::BadValue { row, column });
                }
            }
        }
        Ok(())
    }

    /// How many tiles are of each kind.
    pub fn census(&self) -> [u64; 10] {
        let mut counts = [0; 10];
        for row in 0..tile_rows(self.n) {
            for column in 0..=row {
                counts[self.kind(row, column) as usize] += 1;
            }
        }
        counts
    }
}
