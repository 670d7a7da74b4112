//! Who does the work: one thread here, a backend elsewhere. The bits are the same.

use super::stripe::{Quad, Sent};
use super::{BlockOperator, SIDE, Source, block_rows, order};
use crate::codec::bc1::Block;
use alloc::vec::Vec;

/// Rows of blocks of a stripe, the part of a product that one thread does.
pub const STRIPE_ROWS: usize = 64;

/// Room for products: none is asked for while they run.
#[derive(Clone, Debug, Default)]
pub struct Scratch {
    /// What stripes add to columns, one after the other or each by itself.
    pub columns: Vec<Quad>,
}

/// Does the work of encoding and of running.
pub trait Schedule {
    /// y = X x: [`BlockOperator::stripe`] for all stripes, and their columns in order.
    fn product(&self, operator: &BlockOperator, sent: Sent<'_>, y: &mut [Quad], scratch: &mut Scratch);

    /// Encodes all blocks: [`Source::encode_row`] for each row of them.
    fn encode(&self, source: &Source<'_>, blocks: &mut [Block]);

    /// [`greedy`](super::greedy).
    fn greedy(&self, codes: &[u8], width: usize, order: &mut [u32]);
}

pub use crate::radiosity::polynomial::Portable;

impl Schedule for Portable {
    fn product(&self, operator: &BlockOperator, sent: Sent<'_>, y: &mut [Quad], scratch: &mut Scratch) {
        let rows = block_rows(operator.len()).min(y.len());
        let half = operator.parts().half;
        scratch.columns.resize(if half { rows } else { 0 }, Quad::default());
        for first in (0..rows).step_by(STRIPE_ROWS) {
            let end = rows.min(first + STRIPE_ROWS);
            let columns = &mut scratch.columns[..if half { end } else { 0 }];
            columns.fill(Quad::default());
            operator.stripe(first, sent, &mut y[first..end], columns);
            add_columns(y, columns);
        }
    }

    fn encode(&self, source: &Source<'_>, blocks: &mut [Block]) {
        let mut rest = blocks;
        for row in 0..source.rows() {
            let (blocks, after) = rest.split_at_mut(source.row_len(row).min(rest.len()));
            source.encode_row_portable(row, blocks);
            rest = after;
        }
    }

    fn greedy(&self, codes: &[u8], width: usize, order: &mut [u32]) {
        order::greedy(codes, width, order);
    }
}

/// Adds what a stripe gave to columns to the sums so far.
#[inline(always)]
pub fn add_columns(y: &mut [Quad], columns: &[Quad]) {
    for (y, add) in y.iter_mut().zip(columns) {
        for c in 0..3 {
            for k in 0..SIDE {
                y[c][k] += add[c][k];
            }
        }
    }
}
