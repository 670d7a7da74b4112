//! Entries of a tile from its bytes: pairs of rows, in units that need no root and no division.

use super::encode::scale_of;
use super::{Kind, SIDE, half};

/// Two rows of a tile, one after the other.
pub(super) const PAIR: usize = 2 * SIDE;
/// A decoded tile, row by row.
pub(super) type Tile = [[f32; SIDE]; SIDE];
/// Pairs of rows.
pub(super) const PAIRS: usize = SIDE / 2;

/// The bytes of a kind of tile.
pub(super) trait Codes: Sized {
    /// From all bytes of a tile; none if they are too few.
    fn open(bytes: &[u8]) -> Option<Self>;
    /// Rows 2p and 2p + 1, in units of [`Self::unit`].
    fn pair(&self, p: usize) -> [f32; PAIR];
    /// What the entries are multiples of.
    fn unit(&self) -> f32;
}

/// The same in both rows.
#[inline(always)]
pub(super) fn twice<T: Copy>(row: [T; SIDE]) -> [T; PAIR] {
    core::array::from_fn(|k| row[k % SIDE])
}

/// Words of a part of a code: one per column, of as many bytes as the part has bits.
#[inline(always)]
fn words<const BITS: usize>(part: &[u8]) -> [u32; SIDE] {
    let mut words = [0; SIDE];
    if let Some(bytes) = part.first_chunk::<32>()
        && BITS == 4
    {
        for (k, w) in words.iter_mut().enumerate() {
            *w = u32::from_le_bytes([bytes[4 * k], bytes[4 * k + 1], bytes[4 * k + 2], bytes[4 * k + 3]]);
        }
    } else if let Some(bytes) = part.first_chunk::<16>()
        && BITS == 2
    {
        for (k, w) in words.iter_mut().enumerate() {
            *w = u32::from(u16::from_le_bytes([bytes[2 * k], bytes[2 * k + 1]]));
        }
    } else if let Some(bytes) = part.first_chunk::<8>()
        && BITS == 1
    {
        for (k, w) in words.iter_mut().enumerate() {
            *w = u32::from(bytes[k]);
        }
    }
    words
}

/// Codes in a part of A bits and one of B below it (0: none). The value is unit x q^2, and q^2 is exact.
pub(super) struct Bits<const A: usize, const B: usize> {
    high: [u32; PAIR],
    low: [u32; PAIR],
    unit: f32,
}

impl<const A: usize, const B: usize> Codes for Bits<A, B> {
    #[inline(always)]
    fn open(bytes: &[u8]) -> Option<Self> {
        let (scale, parts) = bytes.split_first_chunk::<2>()?;
        let (high, low) = parts.split_at_checked(SIDE * A)?;
        let top = ((1_u32 << (A + B)) - 1) as f32;
        Some(Self {
            high: twice(words::<A>(high)),
            low: if B > 0 { twice(words::<B>(low)) } else { [0; PAIR] },
            unit: scale_of(u16::from_le_bytes(*scale)) * (1.0 / (top * top)),
        })
    }

    #[inline(always)]
    fn pair(&self, p: usize) -> [f32; PAIR] {
        let masks = [(1_u32 << A) - 1, (1_u32 << B) - 1];
        core::array::from_fn(|k| {
            let row = 2 * p + k / SIDE;
            let mut q = self.high[k] >> (A * row) as u32 & masks[0];
            if B > 0 {
                q = q << B as u32 | self.low[k] >> (B * row) as u32 & masks[1];
            }
            let q = q as i32 as f32;
            q * q
        })
    }

    #[inline(always)]
    fn unit(&self) -> f32 {
        self.unit
    }
}

/// Numbers as they are.
pub(super) struct Plain<const BYTES: usize>([f32; SIDE * SIDE]);

/// f16 as they are.
pub(super) type Halves = Plain<2>;
/// f32 as they are.
pub(super) type Floats = Plain<4>;

impl<const BYTES: usize> Codes for Plain<BYTES> {
    #[inline(always)]
    fn open(bytes: &[u8]) -> Option<Self> {
        let mut all = [0.0; SIDE * SIDE];
        if BYTES == 2 {
            let (halves, _) = bytes.first_chunk::<128>()?.as_chunks::<2>();
            for (x, bytes) in all.iter_mut().zip(halves) {
                *x = half::to_f32(u16::from_le_bytes(*bytes));
            }
        } else {
            let (floats, _) = bytes.first_chunk::<256>()?.as_chunks::<4>();
            for (x, bytes) in all.iter_mut().zip(floats) {
                *x = f32::from_le_bytes(*bytes);
            }
        }
        Some(Self(all))
    }

    #[inline(always)]
    fn pair(&self, p: usize) -> [f32; PAIR] {
        core::array::from_fn(|k| self.0[PAIR * p + k])
    }

    #[inline(always)]
    fn unit(&self) -> f32 {
        1.0
    }
}

/// Runs code for the way in which a kind stores its entries, and other code for kinds that have none.
macro_rules! for_codes {
    ($kind:expr, $codes:ident => $run:expr, $else:expr) => {
        match $kind {
            Kind::Empty | Kind::Mean => $else,
            Kind::Bits1 => {
                type $codes = $crate::radiosity::tiles::decode::Bits<1, 0>;
                $run
            }
            Kind::Bits2 => {
                type $codes = $crate::radiosity::tiles::decode::Bits<2, 0>;
                $run
            }
            Kind::Bits3 => {
                type $codes = $crate::radiosity::tiles::decode::Bits<2, 1>;
                $run
            }
            Kind::Bits4 => {
                type $codes = $crate::radiosity::tiles::decode::Bits<4, 0>;
                $run
            }
            Kind::Bits6 => {
                type $codes = $crate::radiosity::tiles::decode::Bits<4, 2>;
                $run
            }
            Kind::Bits8 => {
                type $codes = $crate::radiosity::tiles::decode::Bits<4, 4>;
                $run
            }
            Kind::F16 => {
                type $codes = $crate::radiosity::tiles::decode::Halves;
                $run
            }
            Kind::F32 => {
                type $codes = $crate::radiosity::tiles::decode::Floats;
                $run
            }
        }
    };
}
pub(super) use for_codes;

/// The mean of a tile that is one.
#[inline(always)]
pub(super) fn mean_of(bytes: &[u8]) -> f32 {
    bytes.first_chunk::<2>().map_or(0.0, |scale| scale_of(u16::from_le_bytes(*scale)))
}

#[inline(always)]
fn entries<K: Codes>(bytes: &[u8]) -> Tile {
    let mut tile = Tile::default();
    let Some(codes) = K::open(bytes) else { return tile };
    for (p, rows) in tile.as_chunks_mut::<2>().0.iter_mut().enumerate() {
        for (x, q) in rows.as_flattened_mut().iter_mut().zip(codes.pair(p)) {
            *x = codes.unit() * q;
        }
    }
    tile
}

/// The entries of a tile, from its bytes.
#[inline(always)]
pub fn decode(kind: Kind, bytes: &[u8]) -> Tile {
    let flat = match kind {
        Kind::Mean => mean_of(bytes),
        _ => 0.0,
    };
    for_codes!(kind, Found => entries::<Found>(bytes), [[flat; SIDE]; SIDE])
}
