//! The pieces of a grid that a line crosses, one after the other.
//!
//! Planes are met where (plane - origin) / direction says, each computed by itself, so that errors do not add up; the number of the piece changes by whole steps in one direction along each axis,
//! so that every walk ends. Blocks whose majorant is 0 are left in one step.

use super::{BLOCK_BITS, Grid, Line, blocks};
use crate::math::{self, Vec3};

/// Slower lines are parallel to a plane \[cells/m\]: it is nowhere near on any way that scenes have.
const PARALLEL: f32 = 1e-18;
/// Pieces of a block but one.
const BLOCK_MASK: i32 = (1 << BLOCK_BITS) - 1;

/// A stretch within one piece, or of a block where there is nothing to walk by pieces.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stretch {
    pub(super) piece: [u32; 3],
    /// Where it begins and ends on the walk's own scale \[m\].
    pub(super) from: f32,
    pub(super) to: f32,
    /// No value of the block is larger.
    pub(super) majorant: f32,
}

pub(super) struct Walk<'a> {
    majorants: &'a [f32],
    blocks: [usize; 3],
    last: [i32; 3],
    /// The line from where it enters the grid.
    origin: [f32; 3],
    direction: [f32; 3],
    inverse: [f32; 3],
    /// Metres of the line before the walk.
    pub(super) before: f32,
    t: f32,
    /// Where the walk ends on its own scale \[m\].
    pub(super) end: f32,
    piece: [i32; 3],
    next: [f32; 3],
    block: usize,
    majorant: f32,
    /// By blocks instead of pieces.
    coarse: bool,
}

impl<'a> Walk<'a> {
    /// The part of the line from 0 to `limit` \[m\] that lies in the box; `None` where none does.
    pub(super) fn new(grid: &Grid<'a>, line: &Line, limit: f32, coarse: bool) -> Option<Self> {
        let size = grid.record.size;
        let (origin, direction) = (line.origin.to_array(), line.direction.to_array());
        let (mut enter, mut leave) = (0.0_f32, limit);
        let mut inverse = [0.0; 3];
        for k in 0..3 {
            let (lo, hi) = (0.5 - origin[k], size[k] as f32 + 0.5 - origin[k]);
            if math::abs(direction[k]) > PARALLEL {
                inverse[k] = 1.0 / direction[k];
                let (a, b) = (lo * inverse[k], hi * inverse[k]);
                enter = enter.max(a.min(b));
                leave = leave.min(a.max(b));
            } else if !(lo <= 0.0 && hi >= 0.0) {
                return None;
            }
        }
        if !(line.origin.is_finite() && enter < leave && leave < f32::INFINITY) {
            return None;
        }
        let start = line.origin + line.direction * enter;
        let start = [0, 1, 2].map(|k| start[k].clamp(0.5, size[k] as f32 + 0.5));
        let mut walk = Self {
            majorants: grid.majorants,
            blocks: blocks(size),
            last: size.map(|n| n as i32),
            origin: start,
            direction: [0, 1, 2].map(|k| if inverse[k] == 0.0 { 0.0 } else { direction[k] }),
            inverse,
            before: enter,
            t: 0.0,
            end: leave - enter,
            piece: [0, 1, 2].map(|k| (start[k] as i32).min(size[k] as i32)),
            next: [0.0; 3],
            block: usize::MAX,
            majorant: 0.0,
            coarse,
        };
        walk.next = [0, 1, 2].map(|k| walk.plane(k, walk.piece[k] + i32::from(walk.direction[k] > 0.0)));
        Some(walk)
    }

    /// Where a plane is met.
    #[inline(always)]
    fn plane(&self, axis: usize, plane: i32) -> f32 {
        if self.inverse[axis] == 0.0 {
            f32::INFINITY
        } else {
            (plane as f32 - self.origin[axis]) * self.inverse[axis]
        }
    }

    /// The coordinates at a place of the walk.
    #[inline(always)]
    pub(super) fn at(&self, t: f32) -> Vec3 {
        Vec3::from_array(self.origin) + Vec3::from_array(self.direction) * t
    }

    #[inline(always)]
    fn least(next: [f32; 3]) -> usize {
        if next[0] <= next[1] {
            if next[0] <= next[2] { 0 } else { 2 }
        } else if next[1] <= next[2] {
            1
        } else {
            2
        }
    }

    /// Goes on into the neighbour along an axis, or ends.
    #[inline(always)]
    fn cross(&mut self, axis: usize, piece: i32) {
        if piece < 0 || piece > self.last[axis] {
            self.t = self.end;
            return;
        }
        self.piece[axis] = piece;
        self.next[axis] = self.plane(axis, piece + i32::from(self.direction[axis] > 0.0));
    }

    /// Leaves a block in one step. Returns where it ends.
    #[cold]
    fn leave_block(&mut self) -> f32 {
        let forward = self.direction.map(|d| d > 0.0);
        let first = self.piece.map(|p| p & !BLOCK_MASK);
        let beyond = |k: usize| if forward[k] { first[k] + BLOCK_MASK + 1 } else { first[k] - 1 };
        let planes = [0, 1, 2].map(|k| self.plane(k, if forward[k] { beyond(k) } else { first[k] }));
        let axis = Self::least(planes);
        if planes[axis] >= self.end {
            self.t = self.end;
            return self.end;
        }
        self.t = self.t.max(planes[axis]);
        let q = self.at(self.t);
        for k in 0..3 {
            if k != axis && self.inverse[k] != 0.0 {
                // On the way that it goes, and no further than the block.
                let (from, to) = if forward[k] {
                    (self.piece[k], first[k] + BLOCK_MASK)
                } else {
                    (first[k], self.piece[k])
                };
                self.cross(k, (q[k] as i32).clamp(from, to).min(self.last[k]));
            }
        }
        let t = self.t;
        self.cross(axis, beyond(axis));
        t
    }

    /// The next stretch that is not empty and where the density is not known to be 0.
    #[inline(always)]
    pub(super) fn next(&mut self) -> Option<Stretch> {
        while self.t < self.end {
            let [x, y, z] = self.piece.map(|p| (p >> BLOCK_BITS) as usize);
            let block = (z * self.blocks[1] + y) * self.blocks[0] + x;
            if block != self.block {
                self.block = block;
                self.majorant = self.majorants[block];
            }
            let from = self.t;
            let piece = self.piece.map(|p| p as u32);
            let majorant = self.majorant;
            if majorant == 0.0 || self.coarse {
                let to = self.leave_block();
                if majorant > 0.0 && to > from {
                    return Some(Stretch { piece, from, to, majorant });
                }
                continue;
            }
            let axis = Self::least(self.next);
            let to = self.next[axis];
            if to >= self.end {
                self.t = self.end;
                return Some(Stretch { piece, from, to: self.end, majorant });
            }
            self.t = to.max(from);
            let step = if self.direction[axis] > 0.0 { 1 } else { -1 };
            self.cross(axis, self.piece[axis] + step);
            if to > from {
                return Some(Stretch { piece, from, to, majorant });
            }
        }
        None
    }
}
