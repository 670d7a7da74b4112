//! Faces with any number of corners, cut into triangles.
//!
//! Triangles pass through; convex faces become a fan about their first corner, as everywhere;
//! concave ones are cut by ear clipping after projection along the Newell normal (Sutherland, Sproull and
//! Schumacker 1974: half the sum of the cross products of successive corners, which is the area vector
//! also of a polygon that is not planar). Triangles keep the orientation of the face.

use earcut::Earcut;

use super::error::Problem;

/// Ear clipping is quadratic at worst (on outlines that cross themselves everywhere), so that a small file
/// could keep it busy for minutes. This bounds the sum over one file of squared corner counts of concave
/// faces: one face of 5000 corners, a few tenths of a second.
const MAX_WORK: u64 = 25_000_000;
/// Concave faces of no more corners than this are cheap and do not count.
const SMALL: usize = 64;

/// Cuts the faces of one file; keeps its buffers between them.
pub(crate) struct Triangulator {
    earcut: Earcut<f64>,
    flat: Vec<[f64; 2]>,
    cut: Vec<u32>,
    work: u64,
    /// The last face crosses itself: no set of triangles is the right one.
    pub(crate) crossing: bool,
}

impl Triangulator {
    pub(crate) fn new() -> Self {
        Self { earcut: Earcut::new(), flat: Vec::new(), cut: Vec::new(), work: 0, crossing: false }
    }

    /// Calls `emit` with three corner numbers per triangle; `corners` are positions, all finite.
    /// Says false, and emits nothing, when the face has no area.
    pub(crate) fn cut(
        &mut self,
        corners: &[[f32; 3]],
        mut emit: impl FnMut([usize; 3]),
    ) -> Result<bool, Problem> {
        self.crossing = false;
        if corners.len() < 3 {
            return Ok(false);
        }
        if corners.len() == 3 {
            // Whether so thin a triangle is worth keeping is the compiler's decision, for all sources alike.
            let [a, b, c] = [corners[0], corners[1], corners[2]];
            let distinct = a != b && b != c && c != a;
            if distinct {
                emit([0, 1, 2]);
            }
            return Ok(distinct);
        }
        let normal = newell(corners);
        // The two axes that the normal leans on least span the projection; their order keeps the sense.
        let axis = (0..3).fold(0, |best, i| if normal[i].abs() > normal[best].abs() { i } else { best });
        let size = normal[axis];
        if size == 0.0 || !size.is_finite() {
            return Ok(false);
        }
        let (x, y) = ((axis + 1) % 3, (axis + 2) % 3);
        let sign = if size > 0.0 { 1.0 } else { -1.0 };
        self.flat.clear();
        self.flat.extend(corners.iter().map(|c| [f64::from(c[x]), f64::from(c[y]) * sign]));
        if is_convex(&self.flat) {
            for i in 1..corners.len() - 1 {
                emit([0, i, i + 1]);
            }
            return Ok(true);
        }
        if corners.len() > SMALL {
            self.work += (corners.len() as u64).pow(2);
            if self.work > MAX_WORK {
                let what = "squared corners of large concave faces";
                return Err(Problem::TooLarge { what, found: self.work, limit: MAX_WORK });
            }
        }
        self.earcut.earcut_slice(&self.flat, &[] as &[u32], &mut self.cut);
        let mut covered = 0.0;
        for t in self.cut.chunks_exact(3) {
            let [i, j, k] = [t[0] as usize, t[1] as usize, t[2] as usize];
            let twice_area = cross(self.flat[i], self.flat[j], self.flat[k]);
            covered += twice_area.abs();
            let flip = twice_area < 0.0;
            emit(if flip { [i, k, j] } else { [i, j, k] });
        }
        self.crossing = (covered - size.abs()).abs() > 1e-6 * size.abs();
        Ok(!self.cut.is_empty())
    }
}

/// Twice the area vector, relative to the first corner so that distance from the origin costs no digits.
fn newell(corners: &[[f32; 3]]) -> [f64; 3] {
    let relative = |i: usize| {
        let (c, o) = (corners[i], corners[0]);
        [0, 1, 2].map(|k| f64::from(c[k]) - f64::from(o[k]))
    };
    (1..corners.len() - 1).fold([0.0; 3], |sum, i| {
        let (a, b) = (relative(i), relative(i + 1));
        [0, 1, 2].map(|k| {
            let (u, v) = ((k + 1) % 3, (k + 2) % 3);
            sum[k] + (a[u] * b[v] - a[v] * b[u])
        })
    })
}

fn cross(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Strictly convex and counter-clockwise: turns left at every corner, and goes round once.
fn is_convex(flat: &[[f64; 2]]) -> bool {
    let n = flat.len();
    // Going round once means that the x direction of the edges changes sign exactly twice.
    let mut changes = 0;
    let mut last = 0.0;
    let mut first = 0.0;
    for i in 0..n {
        let (a, b, c) = (flat[i], flat[(i + 1) % n], flat[(i + 2) % n]);
        if cross(a, b, c) <= 0.0 {
            return false;
        }
        let dx = b[0] - a[0];
        if dx != 0.0 {
            if last == 0.0 {
                first = dx;
            } else if (dx > 0.0) != (last > 0.0) {
                changes += 1;
            }
            last = dx;
        }
    }
    if (first > 0.0) != (last > 0.0) {
        changes += 1;
    }
    changes == 2
}

#[cfg(test)]
mod tests {
    #![allow(clippy::disallowed_methods, reason = "truth in f64")]
    use super::*;

    fn area(corners: &[[f32; 3]], t: [usize; 3]) -> f64 {
        newell(&[corners[t[0]], corners[t[1]], corners[t[2]]])[2] / 2.0
    }

    fn cut(corners: &[[f32; 3]]) -> Vec<[usize; 3]> {
        let mut out = Vec::new();
        Triangulator::new().cut(corners, |t| out.push(t)).unwrap();
        out
    }

    #[test]
    fn an_arrow_head_is_not_fanned_across_its_notch() {
        // The fan about corner 0 would cover the notch at corner 2.
        let arrow = [[0.0, 0.0, 0.0], [4.0, -2.0, 0.0], [1.0, 0.0, 0.0], [4.0, 2.0, 0.0]];
        for turned in 0..4 {
            let mut a = arrow;
            a.rotate_left(turned);
            let t = cut(&a);
            assert_eq!(t.len(), 2, "turned by {turned}");
            let total: f64 = t.iter().map(|t| area(&a, *t)).sum();
            assert_eq!(total, 2.0);
            assert!(t.iter().all(|t| area(&a, *t) > 0.0), "orientation is kept");
        }
    }

    #[test]
    fn a_reversed_face_keeps_its_reversed_front() {
        let mut l = [
            [0.0, 0.0, 0.0],
            [2.0, 0.0, 0.0],
            [2.0, 1.0, 0.0],
            [1.0, 1.0, 0.0],
            [1.0, 2.0, 0.0],
            [0.0, 2.0, 0.0],
        ];
        l.reverse();
        let t = cut(&l);
        assert_eq!(t.iter().map(|t| area(&l, *t)).sum::<f64>(), -3.0);
        assert!(t.iter().all(|t| area(&l, *t) <= 0.0));
    }

    #[test]
    fn a_pentagram_is_not_taken_for_convex() {
        let star: Vec<[f32; 3]> = (0..5)
            .map(|i| {
                let a = f32::from(i as u8 * 2) * std::f32::consts::TAU / 5.0;
                [a.cos(), a.sin(), 0.0]
            })
            .collect();
        let flat: Vec<[f64; 2]> = star.iter().map(|c| [f64::from(c[0]), f64::from(c[1])]).collect();
        assert!(!is_convex(&flat));
    }

    #[test]
    fn only_faces_that_cross_themselves_are_called_crossing() {
        let mut cutter = Triangulator::new();
        let mut crossing = |corners: &[[f32; 3]]| {
            cutter.cut(corners, |_| {}).unwrap();
            cutter.crossing
        };
        let (a, b, c, d) = ([0.0, 0.0, 0.0], [4.0, 1.0, 0.0], [4.0, 4.0, 0.5], [0.5, 3.0, 0.0]);
        assert!(crossing(&[a, [4.0, 4.0, 0.0], [4.0, 0.0, 0.0], [0.0, 2.0, 0.0]]), "a bow tie");
        assert!(!crossing(&[a, b, c, d]));
        assert!(!crossing(&[a, b, [1.0, 1.0, 0.0], d]), "an arrow head");
    }

    #[test]
    fn faces_without_area_emit_nothing() {
        assert!(cut(&[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [3.0, 0.0, 0.0]]).is_empty());
        assert!(cut(&[[0.0; 3], [0.0; 3], [2.0, 0.0, 0.0]]).is_empty());
        assert!(cut(&[[f32::MAX; 3], [-f32::MAX; 3], [f32::MAX, 0.0, 0.0], [0.0; 3]]).len() <= 2);
    }
}
