//! Cutting a piece along the lines of a grid, and integrals over the parts.
//!
//! The piece is cut in its own barycentric coordinates: each corner of a part carries the coordinates in the grid and
//! the barycentric ones. Areas are shares of the piece, so that a piece that a texture's map squeezes to a line or a
//! point needs no case of its own.

use crate::math;

/// Corner of a part: column, row, and the three barycentric coordinates.
pub(super) type Corner = [f32; 5];
/// A triangle cut twice by two parallel lines has at most seven corners.
const CORNERS: usize = 8;

/// A convex part of a piece.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    len: usize,
    corners: [Corner; CORNERS],
}

impl Part {
    const EMPTY: Self = Self { len: 0, corners: [[0.0; 5]; CORNERS] };

    /// The whole piece.
    #[inline]
    pub(super) fn whole(points: [[f32; 2]; 3]) -> Self {
        let mut part = Self::EMPTY;
        for (i, p) in points.iter().enumerate() {
            let mut corner = [p[0], p[1], 0.0, 0.0, 0.0];
            corner[2 + i] = 1.0;
            part.push(corner);
        }
        part
    }

    #[inline(always)]
    fn push(&mut self, corner: Corner) {
        // There is always room; were there not, a corner less is a smaller part.
        if self.len < CORNERS {
            self.corners[self.len] = corner;
            self.len += 1;
        }
    }

    #[inline(always)]
    pub(super) fn corners(&self) -> &[Corner] {
        &self.corners[..self.len.min(CORNERS)]
    }

    /// Least and greatest coordinate on `AXIS`.
    #[inline(always)]
    pub(super) fn range<const AXIS: usize>(&self) -> (f32, f32) {
        self.corners().iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), c| {
            (math::min(low, c[AXIS]), math::max(high, c[AXIS]))
        })
    }

    /// The part up to the line `at` on `AXIS`, and the part beyond it. Both share the corners on the line, to the bit.
    #[inline(always)]
    pub(super) fn split<const AXIS: usize>(&self, at: f32) -> (Self, Self) {
        let (mut below, mut above) = (Self::EMPTY, Self::EMPTY);
        let corners = self.corners();
        for (i, corner) in corners.iter().enumerate() {
            let next = &corners[if i + 1 < corners.len() { i + 1 } else { 0 }];
            let (d, e) = (corner[AXIS] - at, next[AXIS] - at);
            if d <= 0.0 {
                below.push(*corner);
            }
            if d >= 0.0 {
                above.push(*corner);
            }
            if (d < 0.0 && e > 0.0) || (d > 0.0 && e < 0.0) {
                let crossing = between::<AXIS>(corner, d, next, e, at);
                below.push(crossing);
                above.push(crossing);
            }
        }
        (below, above)
    }

    /// Share of the piece's area of the triangle of corners 0, i, i + 1.
    #[inline(always)]
    fn share(&self, i: usize) -> f32 {
        let (a, b, c) = (&self.corners[0], &self.corners[i], &self.corners[i + 1]);
        let area = (b[3] - a[3]) * (c[4] - a[4]) - (b[4] - a[4]) * (c[3] - a[3]);
        math::max(area, 0.0)
    }

    /// The integrals of b_0, b_1, b_2 over the part, in units of the piece's area; they sum to its share of it.
    #[inline]
    pub(super) fn constant(&self) -> [f32; 3] {
        let mut out = [0.0; 3];
        for i in 1..self.len.max(2) - 1 {
            let share = self.share(i) * (1.0 / 3.0);
            let (a, b, c) = (&self.corners[0], &self.corners[i], &self.corners[i + 1]);
            for k in 0..3 {
                out[k] += share * (a[2 + k] + b[2 + k] + c[2 + k]);
            }
        }
        out
    }

    /// The integrals of w b_k over the part, in units of the piece's area: for each of the weights w of a bilinear
    /// filter over the cell whose corner is `cell`, that is (1-x)(1-y), x(1-y), (1-x)y, xy, and each barycentric b_k.
    ///
    /// Products of three linear functions over triangles, in closed form; every term is positive, so that each
    /// integral has its digits however small it is.
    #[inline]
    pub(super) fn bilinear(&self, cell: [f32; 2]) -> [[f32; 3]; 4] {
        let mut out = [[0.0; 3]; 4];
        let mut local = [[0.0_f32; 7]; CORNERS];
        for (to, c) in local.iter_mut().zip(self.corners()) {
            let x = math::clamp(c[0] - cell[0], 0.0, 1.0);
            let y = math::clamp(c[1] - cell[1], 0.0, 1.0);
            *to = [1.0 - x, x, 1.0 - y, y, c[2], c[3], c[4]];
        }
        for i in 1..self.len.max(2) - 1 {
            let share = self.share(i) * (1.0 / 60.0);
            let (a, b, c) = (&local[0], &local[i], &local[i + 1]);
            let sum = |k: usize| a[k] + b[k] + c[k];
            let pair = |k: usize, l: usize| a[k] * a[l] + b[k] * b[l] + c[k] * c[l];
            for (corner, out) in out.iter_mut().enumerate() {
                let (x, y) = (corner & 1, 2 + (corner >> 1));
                let (sx, sy) = (sum(x), sum(y));
                let sxy = pair(x, y);
                for (k, out) in out.iter_mut().enumerate() {
                    let r = 4 + k;
                    let triple = a[x] * a[y] * a[r] + b[x] * b[y] * b[r] + c[x] * c[y] * c[r];
                    let whole = sum(r) * (sx * sy + sxy) + sx * pair(y, r) + sy * pair(x, r) + 2.0 * triple;
                    *out += share * whole;
                }
            }
        }
        out
    }
}

/// The point between two corners at `at`, d and e being their signed distances from it.
#[inline(always)]
fn between<const AXIS: usize>(p: &Corner, d: f32, q: &Corner, e: f32, at: f32) -> Corner {
    // From the lower side to the upper, whatever the order of the corners: neighbours find the same point.
    let (low, high, t) = if d < 0.0 { (p, q, d / (d - e)) } else { (q, p, e / (e - d)) };
    let mut out = [0.0; 5];
    for k in 0..5 {
        let x = low[k] + t * (high[k] - low[k]);
        // Rounding must not leave the range between the two, or a coordinate would turn around.
        out[k] = math::clamp(x, math::min(low[k], high[k]), math::max(low[k], high[k]));
    }
    out[AXIS] = at;
    out
}

/// Visits every cell of the grid that the piece meets: column, row, and the part of the piece in it.
#[inline(always)]
pub(super) fn cells(points: [[f32; 2]; 3], mut visit: impl FnMut(u32, u32, &Part)) {
    let mut rest = Part::whole(points);
    let (low, high) = rest.range::<1>();
    let mut row = math::floor(low);
    loop {
        let last = high <= row + 1.0;
        let mut strip;
        if last {
            strip = rest;
        } else {
            (strip, rest) = rest.split::<1>(row + 1.0);
        }
        let (left, right) = strip.range::<0>();
        if left <= right {
            let mut column = math::floor(left);
            while right > column + 1.0 {
                let (part, beyond) = strip.split::<0>(column + 1.0);
                visit(column as u32, row as u32, &part);
                strip = beyond;
                column += 1.0;
            }
            visit(column as u32, row as u32, &strip);
        }
        if last {
            break;
        }
        row += 1.0;
    }
}

/// What a triangle and a cell have in common.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Overlap {
    /// Share of the triangle's area that lies in the cell, in \[0, 1\].
    pub share: f32,
    /// Means of the triangle's barycentric coordinates over the part: its centroid. Zeros where the share is zero.
    pub bary: [f32; 3],
}

/// Overlap of a triangle with the unit cell \[0, 1\] x \[0, 1\].
///
/// Exact clipping, by four cuts; the share is within 2^-22 plus the roundings of the crossings (2^-24 of an edge's
/// length over its width across the line). The coordinates must be finite; others give no overlap. A triangle
/// squeezed to a line or a point has the share of its barycentric area.
pub fn overlap_unit(points: [[f32; 2]; 3]) -> Overlap {
    const LIMIT: f32 = 1e18;
    if !points.iter().flatten().all(|x| x.abs() <= LIMIT) {
        return Overlap::default();
    }
    let (_, part) = Part::whole(points).split::<1>(0.0);
    let (part, _) = part.split::<1>(1.0);
    let (_, part) = part.split::<0>(0.0);
    let (part, _) = part.split::<0>(1.0);
    let integrals = part.constant();
    let share = integrals[0] + integrals[1] + integrals[2];
    if share > 0.0 {
        Overlap { share: math::min(share, 1.0), bary: integrals.map(|x| math::min(x / share, 1.0)) }
    } else {
        Overlap::default()
    }
}
