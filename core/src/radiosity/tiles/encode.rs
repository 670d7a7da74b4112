//! Tiles of least error^2 + lambda x bits.

use super::{ENTRIES, Kind, SIDE, Tiles, half, kinds_start, tile_rows};
use crate::math;
use alloc::vec::Vec;

/// How kinds are chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rates {
    /// The least cost, where a bit is worth `lambda` of squared error of S. 0 takes 8 bits everywhere but where all is 0.
    Cheapest {
        /// Squared error of S.
        lambda: f64,
    },
    /// One kind for all tiles but empty ones.
    Uniform(Kind),
}

/// Scales that are tried for a tile, relative to its largest entry: clipping the largest makes the other steps finer.
const SCALES: [f32; 5] = [1.0, 0.93, 0.86, 0.78, 0.7];

/// A tile as it is stored.
#[derive(Clone, Copy)]
struct Coded {
    kind: Kind,
    /// Upper half of the scale's f32.
    scale: u16,
    codes: [u8; ENTRIES],
    error: f64,
}

/// Scale as it is stored: the upper half of an f32, rounded up so that the largest entry can be reached.
#[inline(always)]
fn stored(scale: f32) -> u16 {
    let bits = scale.to_bits();
    ((bits >> 16) + u32::from(bits & 0xffff != 0)).min(0x7f7f) as u16
}

/// The scale that is stored.
#[inline(always)]
pub(super) fn scale_of(stored: u16) -> f32 {
    f32::from_bits(u32::from(stored) << 16)
}

#[inline(always)]
fn squared(tile: &[f32; ENTRIES], value: impl Fn(usize) -> f32) -> f64 {
    let mut sum = 0.0;
    for (i, x) in tile.iter().enumerate() {
        let d = f64::from(*x) - f64::from(value(i));
        sum += d * d;
    }
    sum
}

#[inline(always)]
fn mean(tile: &[f32; ENTRIES]) -> Coded {
    let mean = tile.iter().map(|x| f64::from(*x)).sum::<f64>() / ENTRIES as f64;
    // To nearest: nothing need be reached.
    let bits = (mean as f32).to_bits();
    let scale = ((bits + 0x8000) >> 16).min(0x7f7f) as u16;
    let value = scale_of(scale);
    Coded { kind: Kind::Mean, scale, codes: [0; ENTRIES], error: squared(tile, |_| value) }
}

/// The code nearest to a value x = unit x q^2, from that of its root.
#[inline(always)]
fn code(x: f32, unit: f32, top: f32) -> f32 {
    if unit <= 0.0 {
        return 0.0;
    }
    let low = math::floor(math::sqrt_clamped(x / unit)).min(top);
    let high = (low + 1.0).min(top);
    let value = |q: f32| unit * (q * q);
    if (x - value(low)).abs() <= (value(high) - x).abs() { low } else { high }
}

#[inline(always)]
fn with_bits(tile: &[f32; ENTRIES], kind: Kind, largest: f32) -> Coded {
    let top = ((1_u32 << kind.bits()) - 1) as f32;
    let mut best: Option<Coded> = None;
    for share in SCALES {
        let scale = stored(largest * share);
        let unit = scale_of(scale) * (1.0 / (top * top));
        let mut codes = [0; ENTRIES];
        for (q, x) in codes.iter_mut().zip(tile) {
            *q = code(*x, unit, top) as u8;
        }
        let error = squared(tile, |i| {
            let q = f32::from(codes[i]);
            unit * (q * q)
        });
        if best.is_none_or(|b| error < b.error) {
            best = Some(Coded { kind, scale, codes, error });
        }
    }
    best.unwrap_or(Coded { kind: Kind::Empty, scale: 0, codes: [0; ENTRIES], error: 0.0 })
}

/// Squared errors of a tile in the kinds that rates choose from, from nothing to eight bits.
pub type Curve = [f32; CHOICES];
const CHOICES: usize = 8;

/// See [`Curve`].
#[inline(always)]
fn curve(tile: &[f32; ENTRIES]) -> Curve {
    let largest = largest(tile);
    if largest <= 0.0 {
        return [0.0; CHOICES];
    }
    core::array::from_fn(|k| coded(tile, Kind::ALL[k], largest).error as f32)
}

/// The kind of least error^2 + lambda x bits. `twice`: the tile stands for its mirror image as well.
fn cheapest(curve: &Curve, lambda: f64, twice: bool) -> Kind {
    let weight = if twice { 2.0 } else { 1.0 };
    let cost = |k: usize| weight * f64::from(curve[k]) + lambda * 8.0 * Kind::ALL[k].bytes() as f64;
    let best = (1..CHOICES).fold(0, |best, k| if cost(k) < cost(best) { k } else { best });
    Kind::ALL[best]
}

#[inline(always)]
fn largest(tile: &[f32; ENTRIES]) -> f32 {
    tile.iter().fold(0.0_f32, |m, x| math::max(m, *x))
}

/// A tile as it is stored in a kind; `largest` must be its largest entry, above 0.
#[inline(always)]
fn coded(tile: &[f32; ENTRIES], kind: Kind, largest: f32) -> Coded {
    match kind {
        Kind::Empty => Coded { kind, scale: 0, codes: [0; ENTRIES], error: squared(tile, |_| 0.0) },
        Kind::Mean => mean(tile),
        Kind::F16 | Kind::F32 => Coded { kind, scale: 0, codes: [0; ENTRIES], error: 0.0 },
        _ => with_bits(tile, kind, largest),
    }
}

/// Entries of a tile; beyond n they are 0.
#[inline(always)]
fn tile_at(n: usize, row: usize, column: usize, entry: &impl Fn(usize, usize) -> f32) -> [f32; ENTRIES] {
    let mut tile = [0.0; ENTRIES];
    for (k, x) in tile.iter_mut().enumerate() {
        let (i, j) = (SIDE * row + k / SIDE, SIDE * column + k % SIDE);
        if i < n && j < n {
            *x = entry(i.max(j), i.min(j));
        }
    }
    tile
}

/// Curves of a row of tiles; see [`encode_row`].
#[inline(always)]
pub fn curve_row(n: usize, row: usize, entry: impl Fn(usize, usize) -> f32) -> Vec<Curve> {
    (0..=row).map(|column| curve(&tile_at(n, row, column, &entry))).collect()
}

/// What each tile of a matrix loses in each kind: with it, tiles of any rates are found without trying.
#[derive(Clone, Debug, PartialEq)]
pub struct RateCurves {
    rows: Vec<Vec<Curve>>,
}

impl RateCurves {
    /// From the curves of all rows of tiles.
    pub fn new(rows: Vec<Vec<Curve>>) -> Self {
        Self { rows }
    }

    /// The kind of least error^2 + lambda x bits of a tile.
    pub fn kind(&self, row: usize, column: usize, lambda: f64) -> Kind {
        self.rows
            .get(row)
            .and_then(|r| r.get(column))
            .map_or(Kind::Empty, |c| cheapest(c, lambda, column < row))
    }
}

fn write(coded: &Coded, tile: &[f32; ENTRIES], payload: &mut Vec<u8>) {
    match coded.kind {
        Kind::Empty => return,
        Kind::F16 => {
            for x in tile {
                payload.extend(half::from_f32(*x).to_le_bytes());
            }
            return;
        }
        Kind::F32 => {
            for x in tile {
                payload.extend(x.to_le_bytes());
            }
            return;
        }
        _ => {}
    }
    payload.extend(coded.scale.to_le_bytes());
    let bits = coded.kind.bits();
    for (part, shift) in parts(bits) {
        for column in 0..SIDE {
            let mut word = 0_u32;
            for row in 0..SIDE {
                let q = u32::from(coded.codes[SIDE * row + column]) >> shift & ((1 << part) - 1);
                word |= q << (part * row as u32);
            }
            payload.extend(&word.to_le_bytes()[..part as usize]);
        }
    }
}

/// Parts of a code of so many bits, the highest first: bits of the part, and how far up it is.
pub(super) fn parts(bits: u32) -> impl Iterator<Item = (u32, u32)> {
    let list: &[(u32, u32)] = match bits {
        1 => &[(1, 0)],
        2 => &[(2, 0)],
        3 => &[(2, 1), (1, 0)],
        4 => &[(4, 0)],
        6 => &[(4, 2), (2, 0)],
        8 => &[(4, 4), (4, 0)],
        _ => &[],
    };
    list.iter().copied()
}

/// Kinds and payload of one row of tiles; `entry(i, j)` is S(i, j), not negative, asked for i >= j and mirrored on the diagonal. Entries beyond n are 0. `want` is the kind of
/// the tile in a column; tiles without anything are empty.
#[inline(always)]
pub fn encode_row(
    n: usize,
    row: usize,
    want: impl Fn(usize) -> Kind,
    entry: impl Fn(usize, usize) -> f32,
) -> (Vec<u8>, Vec<u8>) {
    let (mut kinds, mut payload) = (alloc::vec![0_u8; row / 2 + 1], Vec::new());
    for column in 0..=row {
        let kind = want(column);
        if kind == Kind::Empty {
            continue;
        }
        let tile = tile_at(n, row, column, &entry);
        let largest = largest(&tile);
        if largest > 0.0 {
            let coded = coded(&tile, kind, largest);
            kinds[column / 2] |= (coded.kind as u8) << (4 * (column % 2));
            write(&coded, &tile, &mut payload);
        }
    }
    (kinds, payload)
}

/// Tiles from their rows; see [`encode_row`].
///
/// # Errors
/// As [`Tiles::try_new`]: too many patches.
pub fn join_rows(
    n: usize,
    rows: impl IntoIterator<Item = (Vec<u8>, Vec<u8>)>,
) -> Result<Tiles, super::TileError> {
    let (mut kinds, mut payload) = (Vec::with_capacity(kinds_start(tile_rows(n))), Vec::new());
    for (k, p) in rows {
        kinds.extend(k);
        payload.extend(p);
    }
    Tiles::try_new(n, kinds, payload)
}

/// Tiles of a symmetric matrix of n patches; see [`encode_row`], of which this is one after another.
///
/// # Errors
/// As [`Tiles::try_new`]: too many patches.
pub fn encode(
    n: usize,
    rates: Rates,
    entry: impl Fn(usize, usize) -> f32,
) -> Result<Tiles, super::TileError> {
    let rows = (0..tile_rows(n)).map(|row| match rates {
        Rates::Uniform(kind) => encode_row(n, row, |_| kind, &entry),
        Rates::Cheapest { lambda } => {
            let curves = curve_row(n, row, &entry);
            encode_row(n, row, |column| cheapest(&curves[column], lambda, column < row), &entry)
        }
    });
    join_rows(n, rows)
}
