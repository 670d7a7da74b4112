//! From form factors to blocks.

use super::matrix::Planes;
use super::parts::{BlockError, Entries, Format, Matrix, Parts, check_order, check_values, row_start};
use super::schedule::Schedule;
use super::source::Source;
use super::split::largest;
use super::stripe::{F16_SCALE, small_f16};
use super::{BlockOperator, SIDE, block_rows};
use crate::codec::log_offset::{LogOffset, Quantiser};
use crate::codec::{bc1, bc4};
use crate::math;
use crate::radiosity::form_factors::FormFactors;
use crate::radiosity::polynomial::Multiply;
use alloc::vec;
use alloc::vec::Vec;

/// The order of rows and columns, one for both.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order<'a> {
    /// As patches are. They may have been put in order before, together with all that belongs to them ([`crate::radiosity::order::kd`]): that costs nothing here.
    Patches,
    /// The published one ([`super::greedy`]): one pass over rows, or another over columns after it. Since an order of columns does not change distances of rows, nor the reverse, the second
    /// pass keeps of the first only where it begins and which of equals comes first.
    Greedy {
        /// Passes, 1 or 2; 0 is the order of patches.
        passes: u32,
    },
    /// Row -> patch.
    Given(&'a [u32]),
}

/// What codes stand for, and what range they cover.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// 25 below the largest entry.
    Published,
    /// What entries there are, but for the least, which add up to this share of all at most.
    Fitted {
        /// Share that becomes 0.
        lose: f32,
    },
    /// No logarithms: codes of roots, x = max (code / 255)^2.
    Roots,
}

/// What blocks have in the place of a kept entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filling {
    /// Zero, as published: a block must hold the largest codes and 0.
    Zero,
    /// What suits the others.
    Any,
}

/// How entries are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kept {
    /// As published: f32, the entry itself; what a block gives in its place is added to it.
    Full,
    /// f16, and what is left of the entry after its block.
    Short,
}

/// How to encode: see the table of the module above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings<'a> {
    /// What is stored.
    pub matrix: Matrix,
    /// Only half of it, where it is symmetric.
    pub half: bool,
    /// Share of the entries that are kept, the largest by the sum of their channels.
    pub keep: f32,
    /// The order.
    pub order: Order<'a>,
    /// The range.
    pub range: Range,
    /// In the place of kept entries.
    pub filling: Filling,
    /// How these are stored.
    pub kept: Kept,
    /// Whether a code decodes to the mean of the entries whose blocks decode to it. Sums of the matrix are kept then, but for rounding.
    pub measured: bool,
    /// How blocks of three channels are searched.
    pub bc1: bc1::Quality,
    /// How blocks of one channel are.
    pub bc4: bc4::Quality,
}

/// Entries that the fitted range may lose: the module [`crate::codec::log_offset`] says what that does.
const LOSE: f32 = 1e-4;

impl Settings<'static> {
    /// As published, for k bounces.
    pub const fn published(bounces: u32) -> Self {
        Self {
            matrix: Matrix::Bounces(bounces),
            half: false,
            keep: 0.04,
            order: Order::Greedy { passes: 2 },
            range: Range::Published,
            filling: Filling::Zero,
            kept: Kept::Full,
            measured: false,
            bc1: bc1::Quality::RangeFit,
            bc4: bc4::Quality::RangeFit,
        }
    }

    /// All bounces, colours outside, and a mend for each loss. Patches are taken to be in order already.
    pub const fn mended() -> Self {
        Self {
            matrix: Matrix::Gather,
            half: false,
            keep: 0.04,
            order: Order::Patches,
            range: Range::Fitted { lose: LOSE },
            filling: Filling::Any,
            kept: Kept::Short,
            measured: true,
            bc1: bc1::Quality::Cluster,
            bc4: bc4::Quality::Refined,
        }
    }

    /// Form factors alone, bounced so many times when it is run.
    pub const fn bounced(bounces: u32) -> Self {
        Self { matrix: Matrix::FormFactors { bounces }, half: true, range: Range::Roots, ..Self::mended() }
    }
}

/// Everything between the matrix and the blocks, for one setting.
pub(super) struct Coded {
    pub(super) codes: Vec<u8>,
    pub(super) kept: Vec<bool>,
    /// What codes decode to.
    values: Vec<f32>,
}

/// Splits and quantises.
pub(super) fn code(planes: &Planes, n: usize, settings: &Settings<'_>) -> Result<Coded, BlockError> {
    let v = planes.channels.len();
    let mut keys = planes.channels[0].clone();
    for channel in &planes.channels[1..] {
        keys.iter_mut().zip(channel).for_each(|(key, x)| *key += x);
    }
    let mut kept = largest(&keys, settings.keep);
    if settings.half {
        // A pair of equals may have been parted.
        for i in 0..n {
            for j in 0..i {
                let either = kept[i * n + j] || kept[j * n + i];
                (kept[i * n + j], kept[j * n + i]) = (either, either);
            }
        }
    }
    drop(keys);
    let mut rest = vec![0.0_f32; v * n * n];
    for (c, channel) in planes.channels.iter().enumerate() {
        for ((to, x), kept) in rest.iter_mut().skip(c).step_by(v).zip(channel).zip(&kept) {
            *to = if *kept { 0.0 } else { *x };
        }
    }
    let max = rest.iter().fold(0.0_f32, |m, x| if *x > m { *x } else { m });
    let mut codes = vec![0; rest.len()];
    let map = match settings.range {
        Range::Published => LogOffset::published(max)?,
        Range::Fitted { lose } => LogOffset::fitted_losing(&rest, lose)?,
        Range::Roots => {
            check_values("entry", &[max], 1, f32::is_finite)?;
            for (code, x) in codes.iter_mut().zip(&rest) {
                // Half up; entries are not above the largest.
                *code = if max > 0.0 { (255.0 * math::sqrt(x / max) + 0.5) as u8 } else { 0 };
            }
            let value = |code: u16| max * (f32::from(code) / 255.0) * (f32::from(code) / 255.0);
            return Ok(Coded { codes, kept, values: (0..256).map(value).collect() });
        }
    };
    map.encode_slice(&rest, &mut codes)?;
    Ok(Coded { codes, kept, values: map.values().to_vec() })
}

/// The matrix of codes with rows and columns exchanged.
fn transposed(codes: &[u8], n: usize, v: usize) -> Vec<u8> {
    let mut out = Vec::with_capacity(codes.len());
    for j in 0..n {
        for i in 0..n {
            out.extend_from_slice(&codes[(i * n + j) * v..][..v]);
        }
    }
    out
}

pub(super) fn ordered<S: Schedule + ?Sized>(
    schedule: &S,
    codes: &[u8],
    n: usize,
    order: Order<'_>,
) -> Result<Vec<u32>, BlockError> {
    match order {
        Order::Patches | Order::Greedy { passes: 0 } => Ok(Vec::new()),
        Order::Given(order) => check_order(order, n).map(|()| order.to_vec()),
        Order::Greedy { passes } => {
            let v = codes.len() / (n * n).max(1);
            let mut order: Vec<u32> = (0..n as u32).collect();
            schedule.greedy(codes, n * v, &mut order);
            if passes > 1 {
                schedule.greedy(&transposed(codes, n, v), n * v, &mut order);
            }
            Ok(order)
        }
    }
}

impl BlockOperator {
    /// Encodes a matrix of form factors and albedos in \[0, 1\].
    ///
    /// n^2 numbers in f32 and bytes per channel, and what elimination takes where all bounces are wanted.
    ///
    /// # Errors
    /// [`BlockError`]; all bounces of a closed scene with an albedo of 1 are [`BlockError::Solve`].
    pub fn encode<S: Multiply + Schedule + ?Sized>(
        schedule: &S,
        form_factors: &FormFactors,
        albedo: &[[f32; 3]],
        settings: &Settings<'_>,
    ) -> Result<Self, BlockError> {
        let planes = Planes::new(schedule, form_factors, albedo, settings)?;
        Self::encode_planes(schedule, &planes, albedo, settings)
    }

    pub(super) fn encode_planes<S: Schedule + ?Sized>(
        schedule: &S,
        planes: &Planes,
        albedo: &[[f32; 3]],
        settings: &Settings<'_>,
    ) -> Result<Self, BlockError> {
        let coded = code(planes, albedo.len(), settings)?;
        let order = ordered(schedule, &coded.codes, albedo.len(), settings.order)?;
        Self::encode_coded(schedule, planes, &coded, order, (albedo, settings))
    }

    /// `order` may be empty.
    pub(super) fn encode_coded<S: Schedule + ?Sized>(
        schedule: &S,
        planes: &Planes,
        coded: &Coded,
        order: Vec<u32>,
        (albedo, settings): (&[[f32; 3]], &Settings<'_>),
    ) -> Result<Self, BlockError> {
        let n = albedo.len();
        let format = if planes.channels.len() == 3 { Format::Bc1 } else { Format::Bc4 };
        let all: Vec<u32> = if order.is_empty() { (0..n as u32).collect() } else { order.clone() };
        let source = Source {
            n,
            format,
            half: settings.half,
            order: &all,
            codes: &coded.codes,
            kept: (settings.filling == Filling::Any).then_some(&coded.kept[..]),
            bc1: settings.bc1,
            bc4: settings.bc4,
        };
        let rows = block_rows(n);
        let mut blocks = vec![[0; 8]; row_start(settings.half, rows, rows)];
        schedule.encode(&source, &mut blocks);
        let mut values = coded.values.clone();
        if settings.measured {
            measure(&source, planes, &coded.kept, &blocks, &mut values);
        }
        let scales = if planes.scales.is_empty() {
            Vec::new()
        } else {
            all.iter().map(|patch| planes.scales[*patch as usize]).collect()
        };
        let parts = Parts {
            matrix: settings.matrix,
            format,
            half: settings.half,
            order,
            albedo: albedo.to_vec(),
            scales,
            values,
            blocks,
            starts: vec![0; n + 1],
            entries: Entries::Full { columns: Vec::new(), values: Vec::new() },
        };
        let without = Self::from_parts(parts)?;
        let (starts, entries) = keep(&without, planes, (&coded.kept, &all), settings.kept)?;
        Self::from_parts(Parts { starts, entries, ..without.parts })
    }
}

/// Sets the values of codes to the means of what blocks decode to them.
fn measure(source: &Source<'_>, planes: &Planes, kept: &[bool], blocks: &[[u8; 8]], values: &mut [f32]) {
    let mut sums = vec![(0.0_f64, 0_u64); 256];
    let rows = source.rows();
    for row in 0..rows {
        let start = row_start(source.half, rows, row);
        for (column, block) in blocks[start..start + source.row_len(row)].iter().enumerate() {
            let texels = match source.format {
                Format::Bc1 => bc1::decode(*block),
                Format::Bc4 => bc4::decode(*block).map(|x| [x; 3]),
            };
            for (k, texel) in texels.iter().enumerate() {
                let (i, j) = (SIDE * row + k / SIDE, SIDE * column + k % SIDE);
                let (Some(i), Some(j)) = (source.order.get(i), source.order.get(j)) else { continue };
                let at = *i as usize * source.n + *j as usize;
                if kept[at] {
                    continue;
                }
                for (channel, code) in planes.channels.iter().zip(texel) {
                    let (sum, count) = &mut sums[usize::from(*code)];
                    *sum += f64::from(channel[at]);
                    *count += 1;
                }
            }
        }
    }
    for (value, (sum, count)) in values.iter_mut().zip(sums).skip(1) {
        if count > 0 {
            *value = (sum / count as f64) as f32;
        }
    }
}

/// Kept entries of an operator that has none yet.
fn keep(
    without: &BlockOperator,
    planes: &Planes,
    (kept, order): (&[bool], &[u32]),
    how: Kept,
) -> Result<(Vec<u32>, Entries), BlockError> {
    let (n, half) = (order.len(), without.parts.half);
    let (mut starts, mut columns, mut values) = (vec![0_u32], Vec::<u32>::new(), Vec::<f32>::new());
    for (row, i) in order.iter().enumerate() {
        let end = if half { n.min((row / SIDE + 1) * SIDE) } else { n };
        for (column, j) in order[..end].iter().enumerate() {
            let at = *i as usize * n + *j as usize;
            if !kept[at] {
                continue;
            }
            columns.push(column as u32);
            let given = if how == Kept::Short { without.block_entry(row, column) } else { [0.0; 3] };
            values.extend(planes.channels.iter().zip(given).map(|(channel, given)| channel[at] - given));
        }
        starts.push(u32::try_from(columns.len()).map_err(|_| BlockError::TooLarge { patches: n })?);
    }
    if how == Kept::Full {
        return Ok((starts, Entries::Full { columns, values }));
    }
    // The largest value is between 2^14 and 2^15 units: the least step that all have is 2^-38 of it.
    let largest = values.iter().fold(0.0_f32, |m, x| if x.abs() > m { x.abs() } else { m });
    check_values("entry", &[largest], 1, f32::is_finite)?;
    let exponent = (largest.to_bits() >> 23).clamp(64, 154);
    let unit = f32::from_bits((exponent - 14) << 23);
    let short: Vec<u16> = values.iter().map(|x| half::f16::from_f32(x / unit).to_bits()).collect();
    debug_assert!(short.iter().all(|s| small_f16(*s) * (F16_SCALE * unit) <= 2.0 * largest));
    let columns = columns.into_iter().map(|c| c as u16).collect();
    Ok((starts, Entries::Short { columns, values: short, unit }))
}
