//! The table of the source: what the order does to the error of the compressed matrix.

use super::BlockOperator;
use super::encode::{Kept, Order, Settings, code, ordered};
use super::matrix::Planes;
use super::order::neighbour_distance;
use super::parts::BlockError;
use super::schedule::Schedule;
use crate::radiosity::form_factors::FormFactors;
use crate::radiosity::polynomial::Multiply;
use alloc::vec::Vec;

/// Errors of one order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrderErrors {
    /// Passes of the greedy order; 0: the order of patches.
    pub passes: u32,
    /// Mean of |decoded - M| over all entries and channels. M is from radiosity to radiosity and has no unit; an entry is a share of what one patch sends, not of what a light does.
    pub mean: f64,
    /// The largest.
    pub max: f64,
    /// The sum.
    pub total: f64,
    /// Root of the sum of squares, relative to that of M.
    pub relative_l2: f64,
    /// Sum of the L1 distances between the codes of neighbouring rows, in steps of codes. The first pass makes it small; the second does so for columns, and rows are less alike again.
    pub neighbour_distance: u64,
    /// Bytes of the operator, all counted ([`BlockOperator::bytes`]).
    pub bytes: usize,
}

/// The table.
#[derive(Clone, Debug, PartialEq)]
pub struct PublishedTable {
    /// n.
    pub patches: usize,
    /// k.
    pub bounces: u32,
    /// Share of entries kept.
    pub keep: f32,
    /// Sum of all entries of M, all channels: what `total` is a part of.
    pub matrix_total: f64,
    /// The largest entry of M.
    pub matrix_max: f64,
    /// Bytes of M, three channels in f32.
    pub matrix_bytes: usize,
    /// Bytes of F, one channel in f32.
    pub form_factor_bytes: usize,
    /// No passes, one, two.
    pub orders: Vec<OrderErrors>,
}

impl PublishedTable {
    /// How many times smaller than M in f32 an order's operator is.
    pub fn ratio_to_matrix(&self, order: &OrderErrors) -> f64 {
        self.matrix_bytes as f64 / order.bytes as f64
    }

    /// The same for F in f32: the source's claim is 3.
    pub fn ratio_to_form_factors(&self, order: &OrderErrors) -> f64 {
        self.form_factor_bytes as f64 / order.bytes as f64
    }
}

/// The published codec with no order, after one pass and after two.
///
/// Errors are of the entries as they are multiplied with, blocks and kept entries together; where an entry is kept, what its block gives instead of 0 is the error.
///
/// # Errors
/// As [`BlockOperator::encode`].
pub fn published_table<S: Multiply + Schedule + ?Sized>(
    schedule: &S,
    form_factors: &FormFactors,
    albedo: &[[f32; 3]],
    bounces: u32,
    keep: f32,
) -> Result<PublishedTable, BlockError> {
    let n = form_factors.len();
    let settings = Settings { keep, ..Settings::published(bounces) };
    debug_assert!(settings.kept == Kept::Full);
    let planes = Planes::new(schedule, form_factors, albedo, &settings)?;
    let coded = code(&planes, n, &settings)?;
    let width = 3 * n;
    let mut orders = Vec::with_capacity(3);
    for passes in 0..3 {
        let order = ordered(schedule, &coded.codes, n, Order::Greedy { passes })?;
        let rows: Vec<u32> = if order.is_empty() { (0..n as u32).collect() } else { order.clone() };
        let neighbours = neighbour_distance(&coded.codes, width, &rows);
        let made = BlockOperator::encode_coded(schedule, &planes, &coded, order, (albedo, &settings))?;
        orders.push(errors(&made, &planes, (passes, neighbours)));
    }
    let sum = |x: &Vec<f32>| x.iter().map(|x| f64::from(*x)).sum::<f64>();
    let max = planes.channels.iter().flatten().fold(0.0_f64, |m, x| m.max(f64::from(*x)));
    Ok(PublishedTable {
        patches: n,
        bounces,
        keep,
        matrix_total: planes.channels.iter().map(sum).sum(),
        matrix_max: max,
        matrix_bytes: 12 * n * n,
        form_factor_bytes: 4 * n * n,
        orders,
    })
}

fn errors(made: &BlockOperator, planes: &Planes, (passes, neighbour_distance): (u32, u64)) -> OrderErrors {
    let n = made.len();
    let (mut total, mut max, mut squares, mut all) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
    for row in 0..n {
        for column in 0..n {
            let at = made.patch(row) * n + made.patch(column);
            for (found, channel) in made.at(row, column).iter().zip(&planes.channels) {
                let x = f64::from(channel[at]);
                let error = (f64::from(*found) - x).abs();
                total += error;
                max = max.max(error);
                squares += error * error;
                all += x * x;
            }
        }
    }
    let entries = (3 * n * n).max(1) as f64;
    OrderErrors {
        passes,
        mean: total / entries,
        max,
        total,
        relative_l2: if all > 0.0 { crate::math::sqrt64(squares / all) } else { 0.0 },
        neighbour_distance,
        bytes: made.bytes(),
    }
}
