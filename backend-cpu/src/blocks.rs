//! Operators in texture blocks: encoded and run over threads, in wide registers.

use crate::linear::Linear;
use crate::simd::widest;
use etendue_core::codec::bc1::Block;
use etendue_core::radiosity::blocks::{
    BlockOperator, Quad, STRIPE_ROWS, Schedule, Scratch, Sent, Source, add_columns, block_rows, greedy,
};
use rayon::prelude::*;

widest! {
    fn stripe(operator: &BlockOperator, first: usize, sent: Sent<'_>, y: &mut [Quad], columns: &mut [Quad]) {
        operator.stripe(first, sent, y, columns);
    }
}

widest! {
    fn in_order(codes: &[u8], width: usize, order: &mut [u32]) {
        greedy(codes, width, order);
    }
}

impl Schedule for Linear {
    fn product(&self, operator: &BlockOperator, sent: Sent<'_>, y: &mut [Quad], scratch: &mut Scratch) {
        let rows = block_rows(operator.len()).min(y.len());
        let half = operator.parts().half;
        let zero = Quad::default();
        if self.threads() <= 1 || rows <= STRIPE_ROWS {
            scratch.columns.resize(if half { rows } else { 0 }, zero);
            for first in (0..rows).step_by(STRIPE_ROWS) {
                let end = rows.min(first + STRIPE_ROWS);
                let columns = &mut scratch.columns[..if half { end } else { 0 }];
                columns.fill(zero);
                stripe(operator, first, sent, &mut y[first..end], columns);
                add_columns(y, columns);
            }
            return;
        }
        if !half {
            self.install(|| {
                y[..rows].par_chunks_mut(STRIPE_ROWS).enumerate().for_each(|(k, y)| {
                    stripe(operator, k * STRIPE_ROWS, sent, y, &mut []);
                });
            });
            return;
        }
        // Each stripe has columns of its own; they are added in the order of stripes.
        scratch.columns.clear();
        scratch.columns.resize(rows * rows.div_ceil(STRIPE_ROWS), zero);
        self.install(|| {
            scratch
                .columns
                .par_chunks_mut(rows)
                .zip(y[..rows].par_chunks_mut(STRIPE_ROWS))
                .enumerate()
                .rev()
                .for_each(|(k, (columns, y))| {
                    let first = k * STRIPE_ROWS;
                    stripe(operator, first, sent, y, &mut columns[..first + y.len()]);
                });
        });
        for (k, columns) in scratch.columns.chunks(rows).enumerate() {
            add_columns(y, &columns[..rows.min((k + 1) * STRIPE_ROWS)]);
        }
    }

    fn encode(&self, source: &Source<'_>, blocks: &mut [Block]) {
        let mut rest = blocks;
        let mut rows = Vec::with_capacity(source.rows());
        for row in 0..source.rows() {
            let (blocks, after) = rest.split_at_mut(source.row_len(row).min(rest.len()));
            rows.push((row, blocks));
            rest = after;
        }
        // Rows of a half are of any length: one at a time.
        self.install(|| {
            rows.into_par_iter()
                .with_max_len(1)
                .for_each(|(row, blocks)| crate::bc1::encode_row(source, row, blocks));
        });
    }

    fn greedy(&self, codes: &[u8], width: usize, order: &mut [u32]) {
        in_order(codes, width, order);
    }
}
