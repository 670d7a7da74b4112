//! A triangle cut into n^2 equal ones by lines parallel to its sides, and the points where these lines meet.
//!
//! Rows run along the edge from vertex 0 to vertex 1 (barycentric of vertex 1 grows), row after row towards vertex 2.

/// A small triangle of the lattice, and where in it a point lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cell {
    /// Its number, below n^2.
    pub index: u32,
    /// The numbers of its corners among the lattice's points.
    pub corners: [u32; 3],
    /// Barycentrics of the point in it, each in [0, 1].
    pub bary: [f32; 3],
}

/// Points of a lattice of `n` divisions.
#[cfg(test)]
const fn points(n: u32) -> u32 {
    (n + 1) * (n + 2) / 2
}

/// The number of the point at `i` steps towards vertex 1 and `j` towards vertex 2.
const fn point(n: u32, i: u32, j: u32) -> u32 {
    // Row k has n + 1 - k points.
    j * (2 * n + 3 - j) / 2 + i
}

/// Barycentrics of vertices 1 and 2 at the points, in the order of their numbers.
pub(super) fn point_barys(n: u32) -> impl Iterator<Item = [f32; 2]> {
    let step = move |k: u32| if k == n { 1.0 } else { k as f32 / n as f32 };
    (0..=n).flat_map(move |j| (0..=n - j).map(move |i| [step(i), step(j)]))
}

/// Corners of the cells, in the order of their numbers.
pub(super) fn cells(n: u32) -> impl Iterator<Item = [u32; 3]> {
    (0..n).flat_map(move |j| (0..2 * (n - j) - 1).map(move |k| corners(n, k / 2, j, k % 2 == 1)))
}

const fn corners(n: u32, i: u32, j: u32, upper: bool) -> [u32; 3] {
    if upper {
        [point(n, i + 1, j + 1), point(n, i, j + 1), point(n, i + 1, j)]
    } else {
        [point(n, i, j), point(n, i + 1, j), point(n, i, j + 1)]
    }
}

/// The cell in which the point with barycentrics `b1`, `b2` lies; any numbers lead to a cell of the lattice.
#[inline]
pub(super) fn cell(n: u32, b1: f32, b2: f32) -> Cell {
    let (x, y) = (b1 * n as f32, b2 * n as f32);
    // `as` clamps, and NaN becomes 0.
    let j = (y as u32).min(n - 1);
    let i = (x as u32).min(n - 1 - j);
    let (fx, fy) = ((x - i as f32).clamp(0.0, 1.0), (y - j as f32).clamp(0.0, 1.0));
    let upper = fx + fy > 1.0 && i + j + 1 < n;
    let bary = if upper { [fx + fy - 1.0, 1.0 - fx, 1.0 - fy] } else { [(1.0 - fx - fy).max(0.0), fx, fy] };
    Cell { index: j * (2 * n - j) + 2 * i + u32::from(upper), corners: corners(n, i, j, upper), bary }
}

/// Barycentrics of vertices 1 and 2 of a point of a cell, from those in the cell.
pub(super) fn in_cell(n: u32, index: u32, [l1, l2]: [f32; 2]) -> [f32; 2] {
    // Row j begins at j (2 n - j).
    let mut j = 0;
    while (j + 1) * (2 * n - j - 1) <= index {
        j += 1;
    }
    let within = index - j * (2 * n - j);
    let (i, upper) = (within / 2, within % 2 == 1);
    // An upper cell's corners are (1, 1), (0, 1) and (1, 0) of its square.
    let (x, y) = if upper { (1.0 - l1, 1.0 - l2) } else { (l1, l2) };
    [(i as f32 + x) / n as f32, (j as f32 + y) / n as f32]
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    #[test]
    fn cells_and_points_are_numbered_without_gaps() {
        for n in 1..9 {
            let places: Vec<[f32; 2]> = point_barys(n).collect();
            assert_eq!(places.len(), points(n) as usize);
            let all: Vec<[u32; 3]> = cells(n).collect();
            assert_eq!(all.len(), (n * n) as usize);
            for (index, corners) in all.iter().enumerate() {
                let at = corners.map(|c| places[c as usize]);
                let centre = [0, 1].map(|k| (at[0][k] + at[1][k] + at[2][k]) / 3.0);
                let found = cell(n, centre[0], centre[1]);
                assert_eq!((found.index as usize, found.corners), (index, *corners), "{n} {centre:?}");
                let (local, back) = ([0.2, 0.3], in_cell(n, index as u32, [0.2, 0.3]));
                let again = cell(n, back[0], back[1]);
                assert_eq!(again.index as usize, index);
                assert!((0..2).all(|k| (again.bary[k + 1] - local[k]).abs() < 1e-4), "{n} {again:?}");
                // Same way around as the whole.
                let cross = (at[1][0] - at[0][0]) * (at[2][1] - at[0][1])
                    - (at[1][1] - at[0][1]) * (at[2][0] - at[0][0]);
                assert!((cross * (n * n) as f32 - 1.0).abs() < 1e-5);
            }
        }
    }

    #[test]
    fn any_point_has_a_cell() {
        for n in [1, 2, 7, 255] {
            for b in
                [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.5], [-1.0, 2.0], [f32::NAN, 0.3], [9.0, 9.0]]
            {
                let c = cell(n, b[0], b[1]);
                assert!(c.index < n * n && c.corners.iter().all(|p| *p < points(n)), "{n} {b:?} {c:?}");
                assert!(b[0].is_nan() || c.bary.iter().all(|x| (0.0..=1.0).contains(x)), "{n} {b:?} {c:?}");
            }
        }
    }
}
