//! Products with half of a symmetric matrix, by stripes of rows over threads.

use crate::linear::Linear;
use rayon::prelude::*;

/// Each stripe of rows sums its rows in y, and in `columns`, which hold anything when it begins, what it gives to the columns up to its end; `add` adds columns to y, stripe
/// after stripe, so that the sums are the same however stripes were shared out. `y` is all rows; `columns` is room.
pub(crate) fn half<T: Copy + Send + Sync>(
    linear: &Linear,
    (stripe_rows, anything): (usize, T),
    (y, columns): (&mut [T], &mut Vec<T>),
    stripe: impl Fn(usize, &mut [T], &mut [T]) + Sync,
    add: impl Fn(&mut [T], &[T]),
) {
    let rows = y.len();
    if linear.threads() <= 1 || rows <= stripe_rows {
        columns.resize(rows, anything);
        for first in (0..rows).step_by(stripe_rows) {
            let end = rows.min(first + stripe_rows);
            stripe(first, &mut y[first..end], &mut columns[..end]);
            add(y, &columns[..end]);
        }
        return;
    }
    // Each stripe has columns of its own.
    columns.resize(rows * rows.div_ceil(stripe_rows), anything);
    linear.install(|| {
        columns.par_chunks_mut(rows).zip(y.par_chunks_mut(stripe_rows)).enumerate().rev().for_each(
            |(k, (columns, y))| {
                let first = k * stripe_rows;
                stripe(first, y, &mut columns[..first + y.len()]);
            },
        );
    });
    for (k, columns) in columns.chunks(rows).enumerate() {
        add(y, &columns[..rows.min((k + 1) * stripe_rows)]);
    }
}
