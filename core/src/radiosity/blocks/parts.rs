//! What an operator is made of, and whether it fits together.

use super::decode::lookup;
use super::stripe::Quad;
use super::{BlockOperator, SIDE, block_rows};
use crate::backend::BackendError;
use crate::codec::log_offset::LogOffsetError;
use crate::radiosity::identity::Identity;
use crate::radiosity::operator::OperatorError;
use crate::radiosity::polynomial::SolveError;
use alloc::vec;
use alloc::vec::Vec;
use core::fmt;

/// Most patches: columns of 16 bits.
pub const PATCHES_MAX: usize = 1 << 16;

/// Which matrix is stored, A = R F.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Matrix {
    /// M_k = A + A^2 + ... + A^k, at least one bounce: from radiosity to indirect radiosity.
    Bounces(u32),
    /// (I - A)^-1 A, the same for all bounces.
    AllBounces,
    /// G = F (I - R F)^-1: from radiosity to indirect irradiance, all bounces.
    Gather,
    /// F, and so many bounces when it is run, at least one: from radiosity to indirect irradiance.
    FormFactors {
        /// Products of a relighting.
        bounces: u32,
    },
}

impl Matrix {
    /// Channels of an entry.
    pub const fn channels(self) -> usize {
        match self {
            Self::FormFactors { .. } => 1,
            _ => 3,
        }
    }

    /// Whether areas make it symmetric.
    pub const fn can_be_half(self) -> bool {
        matches!(self, Self::Gather | Self::FormFactors { .. })
    }
}

/// What a block is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Three channels, 8 bytes.
    Bc1,
    /// One channel, 8 bytes.
    Bc4,
}

impl Format {
    /// Channels of a texel.
    pub const fn channels(self) -> usize {
        match self {
            Self::Bc1 => 3,
            Self::Bc4 => 1,
        }
    }
}

/// Kept entries: columns, and as many values for each as there are channels.
#[derive(Clone, Debug, PartialEq)]
pub enum Entries {
    /// As published.
    Full {
        /// Columns, increasing in each row.
        columns: Vec<u32>,
        /// Values.
        values: Vec<f32>,
    },
    /// In half the bytes.
    Short {
        /// Columns, increasing in each row.
        columns: Vec<u16>,
        /// f16; values are `unit` times that.
        values: Vec<u16>,
        /// A power of two.
        unit: f32,
    },
}

impl Entries {
    /// How many entries there are.
    pub fn len(&self) -> usize {
        match self {
            Self::Full { columns, .. } => columns.len(),
            Self::Short { columns, .. } => columns.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn bytes(&self) -> usize {
        match self {
            Self::Full { columns, values } => 4 * (columns.len() + values.len()),
            Self::Short { columns, values, .. } => 2 * (columns.len() + values.len()) + 4,
        }
    }

    fn column(&self, entry: usize) -> usize {
        match self {
            Self::Full { columns, .. } => columns.get(entry).map_or(usize::MAX, |c| *c as usize),
            Self::Short { columns, .. } => columns.get(entry).map_or(usize::MAX, |c| usize::from(*c)),
        }
    }
}

/// All of an operator.
#[derive(Clone, Debug, PartialEq)]
pub struct Parts {
    /// The matrix.
    pub matrix: Matrix,
    /// BC1 for matrices of three channels, BC4 for one.
    pub format: Format,
    /// Whether only half is stored: blocks (I, J) with J <= I, those on the diagonal whole. Then the matrix is symmetric, X of y = out X (into x).
    pub half: bool,
    /// Row -> patch, a permutation. Empty: as patches are.
    pub order: Vec<u32>,
    /// In the order of patches, in \[0, 1\].
    pub albedo: Vec<[f32; 3]>,
    /// Factors before and after the product, for each row of the matrix, positive. Empty: none.
    pub scales: Vec<[f32; 2]>,
    /// What codes decode to, not negative. Code 0 is 0.
    pub values: Vec<f32>,
    /// Rows of blocks.
    pub blocks: Vec<[u8; 8]>,
    /// Where the kept entries of each row begin, and their number at last.
    pub starts: Vec<u32>,
    /// Kept entries, which are added to what blocks give. Of a half, those in blocks before the diagonal count for their column too.
    pub entries: Entries,
}

/// Why there is no operator, or no light of one.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum BlockError {
    /// Another number of things.
    WrongLength {
        /// Which.
        slice: &'static str,
        /// How many.
        found: usize,
        /// How many there should be.
        expected: usize,
    },
    /// More patches than [`PATCHES_MAX`].
    TooLarge {
        /// Their number.
        patches: usize,
    },
    /// A number out of its range.
    BadValue {
        /// Which.
        slice: &'static str,
        /// Where: a patch, a row, a code or an entry.
        index: usize,
        /// The number.
        value: f32,
    },
    /// An order with a patch twice, or one that is not there.
    NoPermutation {
        /// The row.
        row: usize,
        /// Its patch.
        patch: u32,
    },
    /// A row whose kept entries do not begin where the row before ends, or whose columns do not increase to at most the last.
    BadRow {
        /// The row.
        row: usize,
    },
    /// Another format than the matrix has channels.
    WrongFormat {
        /// The matrix.
        matrix: Matrix,
        /// The format.
        format: Format,
    },
    /// Half of a matrix that is not symmetric.
    NotSymmetric {
        /// The matrix.
        matrix: Matrix,
    },
    /// No bounces.
    NoBounces,
    /// Albedos are a part of the matrix.
    Baked {
        /// The matrix.
        matrix: Matrix,
    },
    /// Numbers that make no matrix.
    Operator(OperatorError),
    /// Light that does not die out.
    Solve(SolveError),
    /// Entries without a logarithm.
    Codes(LogOffsetError),
    /// A backend that has no room for it, or whose device failed.
    Backend(BackendError),
}

impl fmt::Display for BlockError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::WrongLength { slice, found, expected } => {
                write!(f, "{found} numbers of {slice}, expected {expected}")
            }
            Self::TooLarge { patches } => {
                write!(f, "{patches} patches, blocks hold {PATCHES_MAX} at most")
            }
            Self::BadValue { slice, index, value } => write!(f, "{slice} {index} is {value}"),
            Self::NoPermutation { row, patch } => {
                write!(f, "row {row} is of patch {patch}, which is not there or elsewhere")
            }
            Self::BadRow { row } => write!(f, "kept entries of row {row} are not in order"),
            Self::WrongFormat { matrix, format } => write!(f, "{format:?} does not hold {matrix:?}"),
            Self::NotSymmetric { matrix } => write!(f, "no half of {matrix:?}, which is not symmetric"),
            Self::NoBounces => write!(f, "no bounces"),
            Self::Baked { matrix } => write!(f, "albedos are a part of {matrix:?}"),
            Self::Operator(e) => e.fmt(f),
            Self::Solve(e) => e.fmt(f),
            Self::Codes(e) => e.fmt(f),
            Self::Backend(e) => e.fmt(f),
        }
    }
}

impl core::error::Error for BlockError {}

impl From<BackendError> for BlockError {
    fn from(e: BackendError) -> Self {
        Self::Backend(e)
    }
}

impl From<OperatorError> for BlockError {
    fn from(e: OperatorError) -> Self {
        Self::Operator(e)
    }
}

impl From<SolveError> for BlockError {
    fn from(e: SolveError) -> Self {
        Self::Solve(e)
    }
}

impl From<LogOffsetError> for BlockError {
    fn from(e: LogOffsetError) -> Self {
        Self::Codes(e)
    }
}

pub(super) fn check_len(slice: &'static str, found: usize, expected: usize) -> Result<(), BlockError> {
    if found == expected { Ok(()) } else { Err(BlockError::WrongLength { slice, found, expected }) }
}

/// `per`: values for each index.
pub(super) fn check_values(
    slice: &'static str,
    values: &[f32],
    per: usize,
    good: impl Fn(f32) -> bool,
) -> Result<(), BlockError> {
    match values.iter().position(|x| !good(*x)) {
        Some(at) => Err(BlockError::BadValue { slice, index: at / per, value: values[at] }),
        None => Ok(()),
    }
}

/// Where a row of blocks begins.
#[inline(always)]
pub(super) const fn row_start(half: bool, rows: usize, row: usize) -> usize {
    if half { row * (row + 1) / 2 } else { row * rows }
}

/// Whether it is a permutation of all patches, or empty.
pub(super) fn check_order(order: &[u32], n: usize) -> Result<(), BlockError> {
    if order.is_empty() {
        return Ok(());
    }
    check_len("order", order.len(), n)?;
    let mut seen = vec![false; n];
    for (row, &patch) in order.iter().enumerate() {
        match seen.get_mut(patch as usize) {
            Some(seen) if !*seen => *seen = true,
            _ => return Err(BlockError::NoPermutation { row, patch }),
        }
    }
    Ok(())
}

impl Parts {
    pub(super) fn bytes(&self) -> usize {
        8 * self.blocks.len()
            + 4 * (self.starts.len() + self.order.len() + self.values.len())
            + 12 * self.albedo.len()
            + 8 * self.scales.len()
            + self.entries.bytes()
    }

    fn check(&self) -> Result<(), BlockError> {
        let n = self.albedo.len();
        if n > PATCHES_MAX {
            return Err(BlockError::TooLarge { patches: n });
        }
        if matches!(self.matrix, Matrix::Bounces(0) | Matrix::FormFactors { bounces: 0 }) {
            return Err(BlockError::NoBounces);
        }
        if self.matrix.channels() != self.format.channels() {
            return Err(BlockError::WrongFormat { matrix: self.matrix, format: self.format });
        }
        if self.half && !self.matrix.can_be_half() {
            return Err(BlockError::NotSymmetric { matrix: self.matrix });
        }
        check_order(&self.order, n)?;
        check_values("albedo", self.albedo.as_flattened(), 3, |x| (0.0..=1.0).contains(&x))?;
        if !self.scales.is_empty() {
            check_len("scales", self.scales.len(), n)?;
        }
        check_values("scale", self.scales.as_flattened(), 2, |x| x > 0.0 && x.is_finite())?;
        check_len("values", self.values.len(), 256)?;
        check_values("value", &self.values[..1], 1, |x| x == 0.0)?;
        check_values("value", &self.values, 1, |x| x >= 0.0 && x.is_finite())?;
        let rows = block_rows(n);
        check_len("blocks", self.blocks.len(), row_start(self.half, rows, rows))?;
        self.check_entries()
    }

    fn check_entries(&self) -> Result<(), BlockError> {
        let n = self.albedo.len();
        check_len("starts", self.starts.len(), n + 1)?;
        let count = self.entries.len();
        let values = match &self.entries {
            Entries::Full { values, .. } => {
                check_values("kept value", values, self.format.channels(), f32::is_finite)?;
                values.len()
            }
            Entries::Short { values, unit, .. } => {
                // Times 2^112, which decoding does, it must be finite.
                check_values("unit", &[*unit], 1, |x| (1e-30..=16_384.0).contains(&x))?;
                if let Some(at) = values.iter().position(|x| x & 0x7c00 == 0x7c00) {
                    let index = at / self.format.channels();
                    return Err(BlockError::BadValue { slice: "kept value", index, value: f32::INFINITY });
                }
                values.len()
            }
        };
        check_len("kept values", values, count * self.format.channels())?;
        if self.starts[0] != 0 || self.starts[n] as usize != count {
            return Err(BlockError::BadRow { row: if self.starts[0] != 0 { 0 } else { n } });
        }
        for row in 0..n {
            let (start, end) = (self.starts[row] as usize, self.starts[row + 1] as usize);
            let limit = if self.half { n.min((row / SIDE + 1) * SIDE) } else { n };
            let mut least = 0;
            let good = start <= end && end <= count && {
                (start..end).all(|entry| {
                    let column = self.entries.column(entry);
                    let good = column >= least && column < limit;
                    least = column.saturating_add(1);
                    good
                })
            };
            if !good {
                return Err(BlockError::BadRow { row });
            }
        }
        Ok(())
    }
}

impl BlockOperator {
    /// From parts, as a file has them.
    ///
    /// # Errors
    /// Parts that do not fit together; the first that is met.
    pub fn from_parts(parts: Parts) -> Result<Self, BlockError> {
        parts.check()?;
        let n = parts.albedo.len();
        let rows = block_rows(n);
        let lookup = lookup(parts.format, &parts.values);
        let mut made = Self {
            parts,
            lookup,
            albedo: vec![Quad::default(); rows],
            into: vec![[0.0; SIDE]; rows],
            out: vec![[0.0; SIDE]; rows],
            identity: Identity::fresh(),
        };
        for row in 0..n {
            let albedo = made.parts.albedo[made.patch(row)];
            for c in 0..3 {
                made.albedo[row / SIDE][c][row % SIDE] = albedo[c];
            }
            let [into, out] = made.parts.scales.get(row).copied().unwrap_or([1.0; 2]);
            (made.into[row / SIDE][row % SIDE], made.out[row / SIDE][row % SIDE]) = (into, out);
        }
        Ok(made)
    }
}
