//! One piece of a grid: eight values and what lies between them.

use super::Grid;
use crate::math::Vec3;
use core::ops::{Add, Mul, Sub};

/// A value of one channel or of three.
pub(super) trait Value:
    Copy + PartialEq + Add<Output = Self> + Sub<Output = Self> + Mul<f32, Output = Self>
{
    const ZERO: Self;
    /// Value `index` of a run of values.
    fn fetch(values: &[f32], index: usize) -> Self;
    fn channel(self, channel: usize) -> f32;
    fn wide(self) -> Vec3;
}

impl Value for f32 {
    const ZERO: Self = 0.0;
    #[inline(always)]
    fn fetch(values: &[f32], index: usize) -> Self {
        values[index]
    }
    #[inline(always)]
    fn channel(self, _: usize) -> f32 {
        self
    }
    #[inline(always)]
    fn wide(self) -> Vec3 {
        Vec3::splat(self)
    }
}

impl Value for Vec3 {
    const ZERO: Self = Self::ZERO;
    #[inline(always)]
    fn fetch(values: &[f32], index: usize) -> Self {
        let v = &values[3 * index..3 * index + 3];
        Self::new(v[0], v[1], v[2])
    }
    #[inline(always)]
    fn channel(self, channel: usize) -> f32 {
        self[channel]
    }
    #[inline(always)]
    fn wide(self) -> Vec3 {
        self
    }
}

/// The values at the corners of a piece: x runs fastest, then y, then z.
#[derive(Clone, Copy)]
pub(super) struct Cell<V> {
    corners: [V; 8],
    /// The lower corner.
    base: Vec3,
}

impl<V: Value> Cell<V> {
    /// Piece (x, y, z), each at most the size of the grid.
    #[inline(always)]
    pub(super) fn new(grid: &Grid<'_>, piece: [u32; 3]) -> Self {
        let size = grid.record.size;
        // In the outer halves of the outer cells both corners are the same cell.
        let low = |k: usize| piece[k].saturating_sub(1).min(size[k] - 1) as usize;
        let high = |k: usize| piece[k].min(size[k] - 1) as usize;
        let (nx, ny) = (size[0] as usize, size[1] as usize);
        let (x0, x1) = (low(0), high(0));
        let rows = [
            (low(2) * ny + low(1)) * nx,
            (low(2) * ny + high(1)) * nx,
            (high(2) * ny + low(1)) * nx,
            (high(2) * ny + high(1)) * nx,
        ];
        let mut corners = [V::ZERO; 8];
        for (pair, row) in corners.chunks_exact_mut(2).zip(rows) {
            pair[0] = V::fetch(grid.values, row + x0);
            pair[1] = V::fetch(grid.values, row + x1);
        }
        let [x, y, z] = piece;
        Self { corners, base: Vec3::new(x as f32, y as f32, z as f32) }
    }

    /// The value at a place; outside the piece that of its nearest point. Never below the least corner: weights that are not negative.
    #[inline(always)]
    pub(super) fn at(&self, q: Vec3) -> V {
        let f = (q - self.base).clamp(Vec3::ZERO, Vec3::ONE);
        let c = &self.corners;
        let mix = |a: V, b: V, t: f32| a * (1.0 - t) + b * t;
        let low = mix(mix(c[0], c[1], f.x), mix(c[2], c[3], f.x), f.y);
        let high = mix(mix(c[4], c[5], f.x), mix(c[6], c[7], f.x), f.y);
        mix(low, high, f.z)
    }
}
