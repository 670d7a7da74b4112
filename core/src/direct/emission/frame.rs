//! A piece in the coordinates of a bitmap's texels, near the origin.

use crate::math::{self, two_prod};

/// Largest side of a bitmap in texels.
pub const MAX_SIDE: u32 = 1 << 16;
/// Widest span of a piece, in texels, that is followed cell by cell.
pub const MAX_SPAN: f32 = 1_048_576.0;

/// A piece over a grid of unit cells: column of a point = `base[0] + points[..][0]`, row = `base[1] + points[..][1]`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    /// The vertices, relative to the corner of the cell `base`; not below 0.
    pub points: [[f32; 2]; 3],
    /// Column and row of the first cell, within one period of the bitmap.
    pub base: [u32; 2],
}

/// Coordinates as the sampler of bitmaps sees them: one that is not finite makes every interpolated one so, and those
/// count as 0.
#[inline]
fn seen(u: [f32; 3]) -> [f32; 3] {
    if u.iter().all(|x| x.is_finite()) { u } else { [0.0; 3] }
}

/// `u * n` for the three vertices in two parts, with whole periods taken off; `None` for a span above [`MAX_SPAN`].
#[inline]
fn texel_coordinates(u: [f32; 3], n: u32) -> Option<[(f32, f32); 3]> {
    let u = seen(u);
    // The whole periods of the vertex nearest to 0: subtracting them is exact for all vertices on its side of 0.
    let mut near = u[0];
    for x in [u[1], u[2]] {
        near = if x.abs() < near.abs() { x } else { near };
    }
    let periods = math::trunc(near);
    let n = n as f32;
    let u = u.map(|x| x - periods);
    if !u.iter().all(|x| (x * n).abs() <= MAX_SPAN) {
        return None;
    }
    Some(u.map(|x| two_prod(x, n)))
}

/// Local coordinates on one axis and the first cell.
#[inline]
fn axis(u: [f32; 3], n: u32, shift: f32) -> Option<([f32; 3], u32)> {
    let x = texel_coordinates(u, n)?;
    let least = math::min(x[0].0, math::min(x[1].0, x[2].0));
    let base = math::floor(least - shift);
    let local = x.map(|(high, low)| math::max(((high - base) - shift) + low, 0.0));
    Some((local, (base as i32).rem_euclid(n as i32) as u32))
}

impl Frame {
    /// The piece with texture coordinates `uv` over a bitmap of `size`; cells are texels for `shift` = 0 and squares
    /// between texel centres for `shift` = 1/2. `None` where it is too wide ([`MAX_SPAN`]).
    #[inline]
    pub(super) fn new(size: [u32; 2], uv: [[f32; 2]; 3], shift: f32) -> Option<Self> {
        let (x, column) = axis([uv[0][0], uv[1][0], uv[2][0]], size[0], shift)?;
        // Rows run downwards.
        let (y, row) = axis([-uv[0][1], -uv[1][1], -uv[2][1]], size[1], shift)?;
        Some(Self { points: [[x[0], y[0]], [x[1], y[1]], [x[2], y[2]]], base: [column, row] })
    }

    /// Twice the area over the grid, with its sign: positive where columns turn toward rows.
    #[inline]
    pub(super) fn twice_area(&self) -> f32 {
        let [a, b, c] = self.points;
        let (p, q) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
        p[0] * q[1] - p[1] * q[0]
    }

    /// Grid lines that the three edges cross, and one cell per edge: no fewer cells meet an edge.
    #[inline]
    pub(super) fn edge_cells(&self) -> f32 {
        let [a, b, c] = self.points;
        let cells = |p: [f32; 2], q: [f32; 2]| (p[0] - q[0]).abs() + (p[1] - q[1]).abs() + 3.0;
        cells(a, b) + cells(b, c) + cells(c, a)
    }

    /// Cells that the piece meets, at most: those on its edges and its area in cells.
    #[inline]
    pub(super) fn cells(&self) -> f32 {
        0.5 * self.twice_area().abs() + self.edge_cells()
    }
}

/// Texels that the piece `uv` meets, at most, on a bitmap of `size`; infinite for one too wide to follow.
#[inline]
pub fn covered_estimate(size: [u32; 2], uv: [[f32; 2]; 3]) -> f32 {
    let size = size.map(|n| n.clamp(1, MAX_SIDE));
    Frame::new(size, uv, 0.0).map_or(f32::INFINITY, |f| f.cells())
}

/// Texels of one axis: the first and how many, repeating; not more than `n`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Touched {
    pub first: u32,
    pub count: u32,
}

/// The texels of an axis that the renderer's filter can read for a point of the piece: those of the exact filter, and
/// those that rounding may lead to (2^-20 of a coordinate's size, in texels).
#[inline]
pub(super) fn touched(u: [f32; 3], n: u32) -> Touched {
    let all = Touched { first: 0, count: n };
    if u.iter().any(|x| !x.is_finite()) {
        // Points count as 0, vertices need not: take no chances.
        return all;
    }
    let Some(x) = texel_coordinates(u, n) else { return all };
    let largest = math::max(u[0].abs(), math::max(u[1].abs(), u[2].abs()));
    let margin = (1.0 + largest) * n as f32 * (1.0 / 1_048_576.0);
    let (low, high) = x.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), x| {
        (math::min(low, x.0), math::max(high, x.0))
    });
    let first = math::floor(low - margin - 0.5);
    let last = math::floor(high + margin - 0.5) + 1.0;
    let count = last - first + 1.0;
    if count >= n as f32 {
        return all;
    }
    Touched { first: (first as i32).rem_euclid(n as i32) as u32, count: count as u32 }
}
