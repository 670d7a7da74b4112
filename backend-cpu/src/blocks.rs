//! Operators in texture blocks: encoded and run over threads, in wide registers.

use crate::linear::Linear;
use crate::simd::widest;
use crate::stripes;
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
        let y = &mut y[..rows];
        if operator.parts().half {
            let work = |first: usize, y: &mut [Quad], columns: &mut [Quad]| {
                columns.fill(Quad::default());
                stripe(operator, first, sent, y, columns);
            };
            let room = (y, &mut scratch.columns);
            stripes::half(self, (STRIPE_ROWS, Quad::default()), room, work, add_columns);
            return;
        }
        self.install(|| {
            y.par_chunks_mut(STRIPE_ROWS).enumerate().for_each(|(k, y)| {
                stripe(operator, k * STRIPE_ROWS, sent, y, &mut []);
            });
        });
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
