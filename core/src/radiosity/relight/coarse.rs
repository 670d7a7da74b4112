//! The second level: all bounces between clusters of eight patches.

use super::{Products, RelightError};
use crate::math;
use crate::radiosity::operator::{Dense, OperatorError};
use crate::radiosity::polynomial::{self, Multiply, SolveError};
use crate::radiosity::tiles::{Planes, Rates, SIDE, Scratch, TileError, Tiles, encode, tile_rows};
use alloc::vec::Vec;
use core::fmt;

/// Sums of rows are 1 at most, but for rounding.
const SPREAD_MOST: f32 = 2.0;

/// Why clusters have no inverse.
#[derive(Clone, Debug, PartialEq)]
pub enum CoarseError {
    /// Numbers that make no operator.
    Operator(OperatorError),
    /// No inverse.
    Solve(SolveError),
}

impl fmt::Display for CoarseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Operator(e) => e.fmt(f),
            Self::Solve(e) => write!(f, "clusters of patches: {e}"),
        }
    }
}

impl core::error::Error for CoarseError {}

/// Gc = Fc (I - Rc Fc)^-1 per channel, each in tiles of Ac^1/2 Gc Ac^-1/2, which is symmetric.
#[derive(Clone, Debug, PartialEq)]
pub struct Coarse {
    pub(super) tiles: [Tiles; 3],
    /// w: what a patch gets of its cluster's irradiance.
    pub(super) spread: Vec<[f32; SIDE]>,
    /// Share of each patch in its cluster's mean, a w / Ac.
    pub(super) shares: Vec<[f32; SIDE]>,
    /// Ac^1/2 and Ac^-1/2.
    pub(super) into: Vec<[f32; SIDE]>,
    pub(super) out: Vec<[f32; SIDE]>,
    rates: Rates,
}

/// Ac, the areas of the clusters: sums of a w^2 \[m^2\]. Of patches that see nothing, 1.
fn sums(areas: &[f32], spread: &[f32]) -> Vec<f64> {
    let square = |(a, w): (&f32, &f32)| f64::from(*a) * f64::from(*w) * f64::from(*w);
    areas
        .chunks(SIDE)
        .zip(spread.chunks(SIDE))
        .map(|(a, w)| a.iter().zip(w).map(square).sum::<f64>())
        .map(|sum| if sum > 0.0 { sum } else { 1.0 })
        .collect()
}

/// Share of each patch in its cluster.
fn shares(areas: &[f32], spread: &[f32], sums: &[f64]) -> Vec<[f32; SIDE]> {
    let share = |(k, (a, w)): (usize, (&f32, &f32))| (f64::from(*a) * f64::from(*w) / sums[k / SIDE]) as f32;
    super::blocks(areas.iter().zip(spread).enumerate().map(share))
}

/// What made a second level, as a file has it.
#[derive(Clone, Debug, PartialEq)]
pub struct CoarseParts {
    /// Tiles of Ac^1/2 Gc Ac^-1/2 per channel.
    pub tiles: [Tiles; 3],
    /// How they are stored: what a change of albedo makes them anew with.
    pub rates: Rates,
    /// What each patch gets of its cluster's irradiance.
    pub spread: Vec<f32>,
    /// What part of its change a pass makes.
    pub damping: f32,
}

/// Room for products.
#[derive(Clone, Debug, Default)]
pub(super) struct Room {
    x: Vec<Planes<1>>,
    y: Vec<Planes<1>>,
    sent: Vec<Planes<3>>,
    scratch: Scratch<1>,
}

impl Coarse {
    /// From w A F w between clusters \[m^2\] (lower half, packed), and areas, w and albedos of the patches.
    pub(super) fn new<M: Multiply + ?Sized>(
        multiply: &M,
        half: &[f64],
        (areas, spread): (&[f32], &[f32]),
        albedo: &[[f32; 3]],
        rates: Rates,
    ) -> Result<Self, RelightError> {
        let m = tile_rows(areas.len());
        let sums = sums(areas, spread);
        let shares = shares(areas, spread, &sums);
        let flux = |i: usize, j: usize| half[i.max(j) * (i.max(j) + 1) / 2 + i.min(j)];
        let entries: Vec<f32> = (0..m * m).map(|k| (flux(k / m, k % m) / sums[k / m]) as f32).collect();
        let form_factors = Dense::try_new(m, entries)?;
        let roots: Vec<f64> = sums.iter().map(|a| math::sqrt64(*a)).collect();
        let mut tiles = Vec::with_capacity(3);
        for c in 0..3 {
            let mean: Vec<f32> = albedo
                .chunks(SIDE)
                .zip(spread.chunks(SIDE).zip(&shares))
                .map(|(rho, (w, shares))| {
                    rho.iter().zip(w).zip(shares).map(|((rho, w), s)| rho[c] * w * s).sum()
                })
                .collect();
            let g = polynomial::gather::<f64, _>(multiply, &form_factors, &mean)
                .map_err(|e| RelightError::Coarse(CoarseError::Solve(e)))?;
            // Symmetric but for rounding.
            let symmetric = |i: usize, j: usize| {
                let both = roots[i] / roots[j] * f64::from(g.row(i)[j])
                    + roots[j] / roots[i] * f64::from(g.row(j)[i]);
                math::max((0.5 * both) as f32, 0.0)
            };
            tiles.push(encode(m, rates, symmetric)?);
        }
        let tiles: [Tiles; 3] = match tiles.try_into() {
            Ok(tiles) => tiles,
            Err(_) => return Err(RelightError::WrongLength { slice: "channels", found: 0, expected: 3 }),
        };
        Self::from_tiles(tiles, (areas, spread), rates)
    }

    /// From tiles of Ac^1/2 Gc Ac^-1/2 per channel, as a file has them, and areas and w of the patches.
    pub(super) fn from_tiles(
        tiles: [Tiles; 3],
        (areas, spread): (&[f32], &[f32]),
        rates: Rates,
    ) -> Result<Self, RelightError> {
        super::check_len("spread", spread.len(), areas.len())?;
        if let Some(patch) = spread.iter().position(|w| !(0.0..=SPREAD_MOST).contains(w)) {
            return Err(RelightError::BadValue { slice: "spread", patch, value: spread[patch] });
        }
        for tiles in &tiles {
            super::check_len("clusters", tiles.len(), tile_rows(areas.len()))?;
        }
        let sums = sums(areas, spread);
        let roots: Vec<f64> = sums.iter().map(|a| math::sqrt64(*a)).collect();
        let blocks = |f: &dyn Fn(f64) -> f64| super::blocks(roots.iter().map(|r| f(*r) as f32));
        let (into, out) = (blocks(&|r| r), blocks(&|r| 1.0 / r));
        let shares = shares(areas, spread, &sums);
        Ok(Self { tiles, spread: super::blocks(spread.iter().copied()), shares, into, out, rates })
    }

    /// The inverse of each channel, as a file has it.
    pub fn tiles(&self) -> &[Tiles; 3] {
        &self.tiles
    }

    /// What each patch gets of its cluster's irradiance; 0 beyond the last.
    pub(super) fn spread(&self) -> &[[f32; SIDE]] {
        &self.spread
    }

    /// The same in tiles of other rates.
    pub(super) fn encoded(&self, rates: Rates) -> Result<Self, TileError> {
        let mut tiles = self.tiles.clone();
        for tiles in &mut tiles {
            let m = tiles.len();
            let mut half = alloc::vec![0.0_f32; m * (m + 1) / 2];
            tiles.for_each(|i, j, value| half[i * (i + 1) / 2 + j] = value);
            *tiles = encode(m, rates, |i, j| half[i.max(j) * (i.max(j) + 1) / 2 + i.min(j)])?;
        }
        Ok(Self { tiles, rates, ..self.clone() })
    }

    /// How the inverse is stored.
    pub fn rates(&self) -> Rates {
        self.rates
    }

    /// Bytes of all of it.
    pub fn bytes(&self) -> usize {
        self.tiles.iter().map(Tiles::bytes).sum::<usize>()
            + 8 * SIDE * self.shares.len()
            + 8 * SIDE * self.into.len()
    }

    /// x - P Q x: what clusters cannot hold.
    pub(super) fn subtract_means(&self, values: &mut [Planes<3>]) {
        for (values, (shares, spread)) in values.iter_mut().zip(self.shares.iter().zip(&self.spread)) {
            for x in values {
                let mut mean = 0.0;
                for k in 0..SIDE {
                    mean += shares[k] * x[k];
                }
                for k in 0..SIDE {
                    x[k] -= spread[k] * mean;
                }
            }
        }
    }

    /// Gc Q r, in runs of eight clusters.
    pub(super) fn apply<'r, P: Products>(
        &self,
        products: &P,
        rest: &[Planes<3>],
        room: &'r mut Room,
    ) -> &'r [Planes<3>] {
        let rows = self.into.len();
        room.sent.resize(rows, Planes::default());
        room.x.resize(rows, Planes::default());
        room.y.resize(rows, Planes::default());
        for c in 0..3 {
            for (cluster, (rest, shares)) in rest.iter().zip(&self.shares).enumerate() {
                let mut sum = 0.0;
                for k in 0..SIDE {
                    sum += shares[k] * rest[c][k];
                }
                let (row, k) = (cluster / SIDE, cluster % SIDE);
                room.x[row][0][k] = sum * self.into[row][k];
            }
            products.apply(&self.tiles[c], &room.x, &mut room.y, &mut room.scratch);
            for (sent, (y, out)) in room.sent.iter_mut().zip(room.y.iter().zip(&self.out)) {
                for k in 0..SIDE {
                    sent[c][k] = y[0][k] * out[k];
                }
            }
        }
        &room.sent
    }
}
