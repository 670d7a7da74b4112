//! Tiles as the device reads them: for each row of tiles, and for each column, a list of those that are not empty.
//!
//! A list has its tiles in the order in which they are summed. A tile is a head of two words and, but for means, words of
//! codes; `radiosity/tiles.wgsl` says what is in them.

use etendue_core::backend::BackendError;
use etendue_core::radiosity::tiles::{Kind, STRIPE_ROWS, Tiles, tile_rows};

/// Columns that are summed before others; in them, kind after kind. As `Tiles::stripe` says.
const CHUNK: usize = 256;
/// Words of codes that a head can point to.
const CODES_MAX: u64 = 1 << 29;

/// One list after the other, and where each begins.
#[derive(Debug, Default)]
pub(super) struct List {
    pub(super) starts: Vec<u32>,
    pub(super) heads: Vec<[u32; 2]>,
}

/// Whole stripes of rows, of one or more matrices.
#[derive(Debug, Default)]
pub(super) struct Part {
    pub(super) first: usize,
    pub(super) count: usize,
    pub(super) codes: Vec<u32>,
    pub(super) rows: List,
    /// Columns up to the last row; the diagonal is only in its row.
    pub(super) columns: List,
}

/// Bytes that a stripe takes: of codes, and of the longest list.
#[derive(Clone, Copy, Debug, Default)]
struct Sizes {
    codes: u64,
    heads: u64,
}

/// Words of a tile's codes.
fn code_words(kind: Kind) -> usize {
    match kind {
        Kind::Empty | Kind::Mean => 0,
        _ => 2 * kind.bits() as usize,
    }
}

/// Tiles of a row that are not empty: column, kind, and where their bytes begin. `start` is where those of the row do.
fn row_tiles(tiles: &Tiles, row: usize, start: usize) -> impl Iterator<Item = (usize, Kind, usize)> {
    let mut next = start;
    (0..=row).filter_map(move |column| {
        let kind = tiles.kind(row, column);
        let at = next;
        next += kind.bytes();
        (kind != Kind::Empty).then_some((column, kind, at))
    })
}

/// Where the bytes of each row begin, and end.
fn row_starts(tiles: &Tiles) -> Vec<usize> {
    let mut next = 0;
    let mut starts = vec![0];
    for row in 0..tile_rows(tiles.len()) {
        next += (0..=row).map(|column| tiles.kind(row, column).bytes()).sum::<usize>();
        starts.push(next);
    }
    starts
}

/// Head of a tile, but for the place of its codes.
fn head(payload: &[u8], (other, kind, at): (usize, Kind, usize)) -> [u32; 2] {
    let scale = match kind {
        Kind::F16 | Kind::F32 => 0,
        _ => payload.get(at..).and_then(|b| b.first_chunk::<2>()).map_or(0, |b| u16::from_le_bytes(*b)),
    };
    [other as u32 | u32::from(scale) << 17, kind as u32]
}

/// The codes, without the scale.
fn push_codes(codes: &mut Vec<u32>, payload: &[u8], (_, kind, at): (usize, Kind, usize)) {
    let skip = if matches!(kind, Kind::F16 | Kind::F32) { 0 } else { 2 };
    let bytes = payload.get(at + skip..).unwrap_or(&[]);
    let (four, _) = bytes.as_chunks::<4>();
    codes.extend(four.iter().take(code_words(kind)).map(|b| u32::from_le_bytes(*b)));
}

impl Part {
    /// Adds the rows of one matrix.
    fn add(&mut self, tiles: &Tiles, starts: &[usize]) {
        let (first, end) = (self.first, self.first + self.count);
        // Column, head.
        let mut sent: Vec<(u32, [u32; 2])> = Vec::new();
        let mut lengths = vec![0_u32; end];
        for (row, start) in (first..end).zip(&starts[first..end]) {
            self.rows.starts.push(self.rows.heads.len() as u32);
            let mut list: Vec<_> = row_tiles(tiles, row, *start).collect();
            list.sort_by_key(
                |(column, kind, _)| {
                    if *column == row { (usize::MAX, 0) } else { (column / CHUNK, *kind as usize) }
                },
            );
            for tile in list {
                let place = (self.codes.len() as u32 / 2) << 4;
                push_codes(&mut self.codes, tiles.payload(), tile);
                let [other, kind] = head(tiles.payload(), tile);
                self.rows.heads.push([other, kind | place]);
                if tile.0 < row {
                    let [other, _] = head(tiles.payload(), (row, tile.1, tile.2));
                    sent.push((tile.0 as u32, [other, kind | place]));
                    lengths[tile.0] += 1;
                }
            }
        }
        self.rows.starts.push(self.rows.heads.len() as u32);
        // Rows come in their order, so that within a column they stay in it.
        let base = self.columns.heads.len();
        let mut next = base as u32;
        let mut places: Vec<u32> = Vec::with_capacity(end + 1);
        for length in lengths {
            places.push(next);
            next += length;
        }
        places.push(next);
        self.columns.starts.extend(&places);
        self.columns.heads.resize(next as usize, [0; 2]);
        for (column, head) in sent {
            let place = &mut places[column as usize];
            self.columns.heads[*place as usize] = head;
            *place += 1;
        }
    }
}

/// Cuts matrices, all of as many rows, into parts of which no list has more than `limit` bytes.
pub(super) fn parts(matrices: &[&Tiles], limit: u64) -> Result<Vec<Part>, BackendError> {
    let rows = matrices.first().map_or(0, |t| tile_rows(t.len()));
    let starts: Vec<Vec<usize>> = matrices.iter().map(|t| row_starts(t)).collect();
    let limits = Sizes { codes: limit.min(4 * CODES_MAX), heads: limit };
    let mut ranges: Vec<(usize, usize)> = Vec::new();
    let mut so_far = Sizes::default();
    for first in (0..rows).step_by(STRIPE_ROWS) {
        let end = rows.min(first + STRIPE_ROWS);
        let mut own = Sizes::default();
        for (tiles, starts) in matrices.iter().zip(&starts) {
            for (row, start) in (first..end).zip(&starts[first..end]) {
                for (_, kind, _) in row_tiles(tiles, row, *start) {
                    own.codes += 4 * code_words(kind) as u64;
                    own.heads += 8;
                }
            }
        }
        for (what, asked, allowed) in [
            ("bytes of codes of a stripe of tiles in one buffer of the device", own.codes, limits.codes),
            ("bytes of heads of a stripe of tiles in one buffer of the device", own.heads, limits.heads),
        ] {
            if asked > allowed {
                return Err(BackendError::LimitExceeded { what, asked, allowed });
            }
        }
        let both = Sizes { codes: so_far.codes + own.codes, heads: so_far.heads + own.heads };
        match ranges.last_mut() {
            Some(last) if both.codes <= limits.codes && both.heads <= limits.heads => {
                (last.1, so_far) = (end, both);
            }
            _ => {
                ranges.push((first, end));
                so_far = own;
            }
        }
    }
    let part = |(first, end): (usize, usize)| {
        let mut part = Part { first, count: end - first, ..Part::default() };
        for (tiles, starts) in matrices.iter().zip(&starts) {
            part.add(tiles, starts);
        }
        part
    };
    Ok(ranges.into_iter().map(part).collect())
}
