//! Blocks and kept entries as the device reads them.

use etendue_core::backend::BackendError;
use etendue_core::radiosity::blocks::{Entries, Parts, SIDE, STRIPE_ROWS, block_rows};

/// Kept entries of some rows, by row; of a half by column too.
#[derive(Debug, Default)]
pub(super) struct Part {
    /// Rows of blocks.
    pub(super) first: usize,
    pub(super) count: usize,
    /// Where the kept entries of each row of the matrix begin.
    pub(super) row_starts: Vec<u32>,
    pub(super) kept: Vec<u32>,
    /// Where those of each column begin.
    pub(super) column_starts: Vec<u32>,
    /// Row and entry.
    pub(super) sent: Vec<[u32; 2]>,
}

/// Where a row of blocks begins.
pub(super) fn row_start(parts: &Parts, row: usize) -> usize {
    if parts.half { row * (row + 1) / 2 } else { row * block_rows(parts.albedo.len()) }
}

/// Words of a kept entry; of halves, channels are odd, and the column makes them even.
fn entry_words(parts: &Parts) -> usize {
    let channels = parts.format.channels();
    match &parts.entries {
        Entries::Full { .. } => 1 + channels,
        Entries::Short { .. } => channels.div_ceil(2),
    }
}

/// Adds the words of a kept entry: column, then values.
fn push(kept: &mut Vec<u32>, parts: &Parts, entry: usize) -> usize {
    let v = parts.format.channels();
    match &parts.entries {
        Entries::Full { columns, values } => {
            kept.push(columns[entry]);
            kept.extend(values[v * entry..][..v].iter().map(|x| x.to_bits()));
            columns[entry] as usize
        }
        Entries::Short { columns, values, .. } => {
            let mut halves = vec![columns[entry]];
            halves.extend(&values[v * entry..][..v]);
            kept.extend(halves.as_chunks::<2>().0.iter().map(|[a, b]| u32::from(*a) | u32::from(*b) << 16));
            usize::from(columns[entry])
        }
    }
}

/// Patches of some rows of blocks.
fn patches(parts: &Parts, first: usize, end: usize) -> std::ops::Range<usize> {
    let n = parts.albedo.len();
    n.min(SIDE * first)..n.min(SIDE * end)
}

fn part(parts: &Parts, (first, end): (usize, usize)) -> Part {
    let mut made = Part { first, count: end - first, ..Part::default() };
    // Column, row, entry.
    let mut sent: Vec<(usize, [u32; 2])> = Vec::new();
    let mut entry = 0;
    for row in patches(parts, first, end) {
        made.row_starts.push(entry);
        for at in parts.starts[row] as usize..parts.starts[row + 1] as usize {
            let column = push(&mut made.kept, parts, at);
            if parts.half && column / SIDE < row / SIDE {
                sent.push((column, [row as u32, entry]));
            }
            entry += 1;
        }
    }
    made.row_starts.push(entry);
    if parts.half {
        // Within a column they stay in order of rows.
        sent.sort_by_key(|(column, _)| *column);
        let mut at = 0;
        for column in 0..=SIDE * end {
            while sent.get(at).is_some_and(|(c, _)| *c < column) {
                at += 1;
            }
            made.column_starts.push(at as u32);
        }
        made.sent = sent.into_iter().map(|(_, s)| s).collect();
    }
    made
}

/// Cuts an operator into whole stripes of rows of which no list has more than `limit` bytes.
pub(super) fn cut(parts: &Parts, limit: u64) -> Result<Vec<Part>, BackendError> {
    let rows = block_rows(parts.albedo.len());
    // Blocks; kept entries, with as much for the list of columns.
    let bytes = |first: usize, end: usize| -> [u64; 2] {
        let range = patches(parts, first, end);
        let kept = u64::from(parts.starts[range.end] - parts.starts[range.start]);
        let words = entry_words(parts).max(if parts.half { 2 } else { 0 }) as u64;
        [8 * (row_start(parts, end) - row_start(parts, first)) as u64, 4 * words * kept]
    };
    let mut ranges: Vec<(usize, usize)> = Vec::new();
    for first in (0..rows).step_by(STRIPE_ROWS) {
        let end = rows.min(first + STRIPE_ROWS);
        for (what, asked) in [
            "bytes of a stripe of blocks in one buffer of the device",
            "bytes of kept entries of a stripe in one buffer of the device",
        ]
        .into_iter()
        .zip(bytes(first, end))
        {
            if asked > limit {
                return Err(BackendError::LimitExceeded { what, asked, allowed: limit });
            }
        }
        match ranges.last_mut() {
            Some(last) if bytes(last.0, end).iter().all(|b| *b <= limit) => last.1 = end,
            _ => ranges.push((first, end)),
        }
    }
    Ok(ranges.into_iter().map(|range| part(parts, range)).collect())
}
