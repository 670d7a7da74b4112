//! Media whose density varies from place to place: values on a grid, linear between the centres of its cells.
//!
//! Quantity: density d(x), a number per channel that scales extinction, sigma_t(x) = d(x) sigma_t; or a single-scattering albedo. Values lie at the centres of size_x x size_y x size_z equal
//! cells of a box; between centres they are trilinear, in the outer half cells they stay what they are at the nearest centres, and beyond the box they are 0.
//!
//! A field that is trilinear is a cubic polynomial along a ray between two planes of centres. Gauss' rule of two points integrates cubics exactly, so the optical length of a ray is exact up to
//! rounding, and so is its transmittance; and where it reaches a drawn value is found by Newton's method within the piece where it must be ("regular tracking", module `regular`). Both are functions of the
//! ray alone, without random numbers: densities of flights are known, which balances the channels against each other and techniques of a path. Null collisions ([`null`]) need fewer evaluations
//! in thin media, and know no density; they are here as the independent second opinion. Source: J. Novak, I. Georgiev, J. Hanika, W. Jarosz, "Monte Carlo methods for volumetric light transport
//! simulation", 2018, sections 3 and 4.

mod cell;
pub mod null;
pub(crate) mod regular;
#[cfg(test)]
mod tests;
mod walk;

use crate::math::Vec3;
use crate::scene::{CompiledScene, GridRecord};
use cell::Value;

/// Cells of the majorant grid are blocks of this many pieces along each axis, as a power of two.
const BLOCK_BITS: u32 = 3;
/// How far beyond its box a grid still counts, in cells: places found by rounded arithmetic lie in it.
const SLACK: f32 = 1.0 / 1024.0;

/// A grid in a compiled scene.
///
/// Coordinates: a point has coordinate i + 1 along an axis at the centre of cell i (counted from 0), so that *piece* k, from k to k + 1, lies between the centres of cells k - 1 and k;
/// the box is from 1/2 to size + 1/2, and the first and the last piece are half as long.
#[derive(Clone, Copy, Debug)]
pub struct Grid<'a> {
    record: &'a GridRecord,
    values: &'a [f32],
    majorants: &'a [f32],
}

/// A straight way through the coordinates of a grid, by metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Line {
    pub(crate) origin: Vec3,
    pub(crate) direction: Vec3,
}

/// Blocks along each axis of a grid of this size: it has a piece more than cells.
pub(crate) fn blocks(size: [u32; 3]) -> [usize; 3] {
    size.map(|n| (n as usize + 1).div_ceil(1 << BLOCK_BITS))
}

/// The largest value of each block, over all channels.
pub(crate) fn majorants(size: [u32; 3], channels: usize, values: &[f32]) -> alloc::vec::Vec<f32> {
    let [bx, by, bz] = blocks(size);
    let mut out = alloc::vec![0.0_f32; bx * by * bz];
    // Cell i is a corner of the pieces i and i + 1.
    let reach = |i: usize| (i >> BLOCK_BITS)..=((i + 1) >> BLOCK_BITS);
    let [nx, ny, nz] = size.map(|n| n as usize);
    for z in 0..nz {
        for y in 0..ny {
            for x in 0..nx {
                let at = ((z * ny + y) * nx + x) * channels;
                let value = values[at..at + channels].iter().fold(0.0_f32, |m, v| m.max(*v));
                for k in reach(z) {
                    for j in reach(y) {
                        for i in reach(x) {
                            let slot = &mut out[(k * by + j) * bx + i];
                            *slot = slot.max(value);
                        }
                    }
                }
            }
        }
    }
    out
}

impl<'a> Grid<'a> {
    /// Grid `index` of a scene; `None` where there is none.
    #[inline]
    pub fn new(scene: &'a CompiledScene, index: u32) -> Option<Self> {
        let record = scene.grids.get(index as usize)?;
        let [nx, ny, nz] = record.size.map(|n| n as usize);
        let [bx, by, bz] = blocks(record.size);
        let count = nx * ny * nz * record.channels as usize;
        let values = scene.grid_values.get(record.first_value as usize..)?.get(..count)?;
        let majorants = scene.grid_values.get(record.first_majorant as usize..)?.get(..bx * by * bz)?;
        Some(Self::of(record, values, majorants))
    }

    /// Of its parts: as many values as the record says, and the largest of each block ([`majorants`]).
    #[inline]
    pub(crate) fn of(record: &'a GridRecord, values: &'a [f32], majorants: &'a [f32]) -> Self {
        Self { record, values, majorants }
    }

    /// Whether each channel has values of its own.
    #[inline]
    pub fn is_coloured(&self) -> bool {
        self.record.channels == 3
    }

    /// The value at a point \[m\]; 0 beyond the box. The same in all channels where the grid has one.
    #[inline]
    pub fn at(&self, point: Vec3) -> Vec3 {
        let q = self.point(point);
        if self.is_coloured() { self.value::<Vec3>(q) } else { Vec3::splat(self.value::<f32>(q)) }
    }

    fn value<V: Value>(&self, q: Vec3) -> V {
        let size = self.record.size;
        let inside = |q: f32, n: u32| q >= 0.5 - SLACK && q <= n as f32 + (0.5 + SLACK);
        if !(inside(q.x, size[0]) && inside(q.y, size[1]) && inside(q.z, size[2])) {
            return V::ZERO;
        }
        let piece = [q.x, q.y, q.z].map(|q| q as u32);
        cell::Cell::<V>::new(self, piece).at(q)
    }

    /// The coordinates of a point.
    #[inline]
    fn point(&self, point: Vec3) -> Vec3 {
        let [x, y, z] = self.record.to_cells;
        let p = point - Vec3::new(x[3], y[3], z[3]);
        self.vector(p) + Vec3::splat(0.5)
    }

    #[inline]
    fn vector(&self, v: Vec3) -> Vec3 {
        let [x, y, z] = self.record.to_cells;
        Vec3::new(
            x[0] * v.x + x[1] * v.y + x[2] * v.z,
            y[0] * v.x + y[1] * v.y + y[2] * v.z,
            z[0] * v.x + z[1] * v.y + z[2] * v.z,
        )
    }

    /// The line from a point \[m\] along a unit direction.
    #[inline]
    pub(crate) fn line(&self, origin: Vec3, direction: Vec3) -> Line {
        Line { origin: self.point(origin), direction: self.vector(direction) }
    }
}
