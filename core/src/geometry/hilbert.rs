//! Order along Hilbert's space-filling curve: neighbours on the curve are neighbours in space.
//!
//! The curve is walked from the coarsest octant down by a table of 24 states (Hamilton and Rau-Chaplin, "Compact Hilbert indices", 2008: entry corner
//! and direction of each octant), ten levels deep.

use super::ray::Aabb;
use crate::math::Vec3;

/// Levels of the curve: 2^10 cells along each axis.
const LEVELS: u32 = 10;
/// Cells along each axis.
const CELLS: f32 = 1024.0;

/// Place on the curve within the octant's eight (low 3 bits), and the next state.
type Step = u8;

const fn rotate_right(x: u32, by: u32) -> u32 {
    ((x >> by) | (x << (3 - by))) & 7
}

const fn rotate_left(x: u32, by: u32) -> u32 {
    ((x << by) | (x >> (3 - by))) & 7
}

const fn gray(x: u32) -> u32 {
    x ^ (x >> 1)
}

const fn gray_inverse(x: u32) -> u32 {
    x ^ (x >> 1) ^ (x >> 2)
}

/// Corner through which the curve enters the `w`-th octant.
const fn entry(w: u32) -> u32 {
    if w == 0 { 0 } else { gray(2 * ((w - 1) / 2)) }
}

/// Axis along which it crosses it.
const fn direction(w: u32) -> u32 {
    match w {
        0 => 0,
        w if w % 2 == 0 => (w - 1).trailing_ones() % 3,
        w => w.trailing_ones() % 3,
    }
}

/// By state (entry corner times 3 plus direction) and octant.
const STEPS: [[(Step, u8); 8]; 24] = {
    let mut table = [[(0, 0); 8]; 24];
    let mut state = 0;
    while state < 24 {
        let (e, d) = (state / 3, state % 3);
        let mut octant = 0;
        while octant < 8 {
            let turn = (d + 1) % 3;
            let w = gray_inverse(rotate_right(octant ^ e, turn));
            let next_e = e ^ rotate_left(entry(w), turn);
            let next_d = (d + direction(w) + 1) % 3;
            table[state as usize][octant as usize] = (w as u8, (next_e * 3 + next_d) as u8);
            octant += 1;
        }
        state += 1;
    }
    table
};

/// The place on the curve of a cell with coordinates below 2^10; higher bits are not looked at.
#[inline]
pub const fn hilbert_index([x, y, z]: [u32; 3]) -> u32 {
    let (mut index, mut state, mut level) = (0, 0_u8, LEVELS);
    while level > 0 {
        level -= 1;
        let octant = (x >> level & 1) | (y >> level & 1) << 1 | (z >> level & 1) << 2;
        let (w, next) = STEPS[state as usize][octant as usize];
        index = index << 3 | w as u32;
        state = next;
    }
    index
}

/// A cube of 1024^3 cells around a box.
#[derive(Clone, Copy, Debug)]
pub struct HilbertGrid {
    low: Vec3,
    scale: f32,
}

impl HilbertGrid {
    /// The grid of a box; an empty one or one that is not finite makes one cell of everything.
    pub fn new(bounds: &Aabb) -> Self {
        let size = (bounds.hi - bounds.lo).max_element();
        let scale = CELLS / size;
        let usable = size > 0.0 && scale.is_finite() && bounds.lo.is_finite();
        Self { low: if usable { bounds.lo } else { Vec3::ZERO }, scale: if usable { scale } else { 0.0 } }
    }

    /// Its lower corner, and cells a metre: for a device.
    pub fn parts(&self) -> (Vec3, f32) {
        (self.low, self.scale)
    }

    /// Place on the curve of the cell at `p`, below 2^30; what lies outside counts for the nearest cell, NaN for the lowest.
    #[inline]
    pub fn index(&self, p: Vec3) -> u32 {
        let cell = ((p - self.low) * self.scale).min(Vec3::splat(CELLS - 1.0));
        // `as` clamps at 0.
        hilbert_index(cell.to_array().map(|x| x as u32))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;

    #[test]
    fn the_curve_visits_each_cell_once_and_moves_by_one() {
        // Of the finest level the first 2^15 places fill a cube of 32^3.
        let mut at = vec![None; 1 << 15];
        for x in 0..32 {
            for y in 0..32 {
                for z in 0..32 {
                    let i = hilbert_index([x, y, z]) as usize;
                    assert!(i < at.len() && at[i].is_none(), "{x} {y} {z}");
                    at[i] = Some([x, y, z]);
                }
            }
        }
        for pair in at.windows(2) {
            let (a, b) = (pair[0].unwrap(), pair[1].unwrap());
            let apart: u32 = (0..3).map(|k| a[k].abs_diff(b[k])).sum();
            assert_eq!(apart, 1, "{a:?} {b:?}");
        }
    }

    #[test]
    fn any_place_has_an_index() {
        let grid = HilbertGrid::new(&Aabb { lo: Vec3::splat(-1.0), hi: Vec3::splat(3.0) });
        for p in
            [Vec3::splat(9.0), Vec3::splat(-9.0), Vec3::splat(f32::NAN), Vec3::new(0.0, 3.0, f32::INFINITY)]
        {
            assert!(grid.index(p) < 1 << 30);
        }
        assert_eq!(grid.index(Vec3::splat(-1.0)), 0);
        assert_eq!(HilbertGrid::new(&Aabb::EMPTY).index(Vec3::ONE), 0);
    }
}
