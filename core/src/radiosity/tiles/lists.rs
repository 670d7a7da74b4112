//! Tiles of a row by kind: what is decoded alike is done in one loop, without a branch between one tile and the next.

use super::Kind;

/// Columns that are listed at a time.
pub(super) const CHUNK: usize = 256;
/// Nibbles of a word.
const NIBBLES: usize = 16;

/// Bytes of a tile by the number of its kind; numbers beyond the last kind are none.
const BYTES: [u32; NIBBLES] = {
    let mut bytes = [0; NIBBLES];
    let mut k = 0;
    while k < Kind::ALL.len() {
        bytes[k] = Kind::ALL[k].bytes() as u32;
        k += 1;
    }
    bytes
};

/// A tile of a row.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Place {
    /// Its column.
    pub column: u32,
    /// Where its bytes begin.
    pub start: u32,
}

/// The tiles of some columns of a row that are not empty, a list for each kind in order of columns.
pub(super) struct Lists {
    len: [usize; NIBBLES],
    places: [[Place; CHUNK]; Kind::ALL.len()],
}

impl Lists {
    pub(super) fn new() -> Self {
        Self { len: [0; NIBBLES], places: [[Place::default(); CHUNK]; Kind::ALL.len()] }
    }

    /// Lists columns `first..end`, at most [`CHUNK`] of them, `first` even; `kinds` are the nibbles of the whole row, and the bytes of the first tile begin at `start`. Where
    /// the bytes after the last begin.
    #[inline(always)]
    pub(super) fn fill(&mut self, kinds: &[u8], (first, end): (usize, usize), start: u32) -> u32 {
        self.len = [0; NIBBLES];
        let mut start = start;
        let end = end.min(first + CHUNK);
        for from in (first..end).step_by(NIBBLES) {
            let bytes = kinds.get(from / 2..).unwrap_or(&[]);
            let mut word = match bytes.first_chunk::<8>() {
                Some(bytes) => u64::from_le_bytes(*bytes),
                None => bytes.iter().rev().fold(0, |word, byte| word << 8 | u64::from(*byte)),
            };
            if end - from < NIBBLES {
                word &= (1 << (4 * (end - from))) - 1;
            }
            // Most tiles are empty: only the others are stepped to.
            while word != 0 {
                let k = word.trailing_zeros() / 4;
                let number = (word >> (4 * k)) as usize % NIBBLES;
                word &= !(15 << (4 * k));
                let at = self.len[number];
                if let Some(places) = self.places.get_mut(number) {
                    places[at % CHUNK] = Place { column: from as u32 + k, start };
                }
                self.len[number] = at + 1;
                start = start.saturating_add(BYTES[number]);
            }
        }
        start
    }

    /// Those of a kind.
    #[inline(always)]
    pub(super) fn of(&self, kind: Kind) -> &[Place] {
        let places = &self.places[kind as usize];
        &places[..self.len[kind as usize].min(CHUNK)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::counter::Counter;
    use alloc::vec::Vec;

    #[test]
    fn lists_have_each_tile_once_and_where_it_is() {
        let numbers = Counter::new(3);
        for end in [0, 1, 2, 15, 16, 17, 255, 256, 257, 700] {
            let number = |i: usize| {
                let u = numbers.unit(end as u32, i as u32, 0);
                if u < 0.5 { 0 } else { (20.0 * (u - 0.5)) as usize }
            };
            let mut kinds = alloc::vec![0_u8; end / 2 + 1];
            for i in 0..end {
                kinds[i / 2] |= (number(i) as u8) << (4 * (i % 2));
            }
            // What comes after the last column is another tile's.
            kinds[end / 2] |= 3 << (4 * (end % 2));
            let (mut lists, mut start) = (Lists::new(), 5);
            for first in (0..end).step_by(CHUNK) {
                let (mut expected, mut at): ([Vec<Place>; 10], u32) = (Default::default(), start);
                for i in first..end.min(first + CHUNK) {
                    expected[number(i)].push(Place { column: i as u32, start: at });
                    at += Kind::ALL[number(i)].bytes() as u32;
                }
                start = lists.fill(&kinds, (first, end), start);
                assert_eq!(start, at);
                for kind in &Kind::ALL[1..] {
                    assert_eq!(lists.of(*kind), expected[*kind as usize], "{end} {first} {kind:?}");
                }
            }
        }
    }
}
