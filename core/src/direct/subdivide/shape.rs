//! The shape of a triangle, as far as a criterion looks at it.

use super::bary::Bary;
use crate::math::{self, Vec3};

/// Edges of a triangle up to a common power of two, and its share of the parent.
///
/// Edge i lies opposite corner i and runs from corner i+1 to corner i+2 (modulo 3).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    edges: [Vec3; 3],
    squares: [f32; 3],
    fraction: f32,
}

/// Dot product in a fixed order.
#[inline(always)]
fn dot(a: Vec3, b: Vec3) -> f32 {
    a.x * b.x + a.y * b.y + a.z * b.z
}

impl Shape {
    /// From the edges opposite the corners, running around the triangle.
    #[inline]
    pub(super) fn from_edges(edges: [Vec3; 3], fraction: f32) -> Self {
        Self { edges, squares: edges.map(|e| dot(e, e)), fraction }
    }

    /// From corner positions in any unit, and the triangle's share of the parent's area.
    ///
    /// Edges are scaled by a power of two, so that coordinates of any size will do. Corners that are not finite, or whose
    /// differences are not, give a triangle without extent: see [`Shape::is_degenerate`].
    #[must_use]
    pub fn new(corners: [Vec3; 3], fraction: f32) -> Self {
        Self::from_edges(scaled(edges(corners)).0, fraction)
    }

    /// Squared length of the edge opposite each corner, in the scaled unit.
    #[inline]
    #[must_use]
    pub fn squares(&self) -> [f32; 3] {
        self.squares
    }

    /// Area over the parent's area.
    #[inline]
    #[must_use]
    pub fn fraction(&self) -> f32 {
        self.fraction
    }

    /// The corner opposite the longest edge; of equal edges the first.
    #[inline]
    #[must_use]
    pub fn opposite_longest(&self) -> usize {
        let [a, b, c] = self.squares;
        if a >= b && a >= c {
            0
        } else if b >= c {
            1
        } else {
            2
        }
    }

    /// The corner whose angle exceeds 90 degrees, if there is one: the dot product of its two edges, as rounded, is negative.
    #[inline]
    #[must_use]
    pub fn obtuse_corner(&self) -> Option<usize> {
        let [a, b, c] = self.edges;
        // The edges run around the triangle, so that at the corner between two of them one points away and one toward it.
        if dot(b, c) > 0.0 {
            Some(0)
        } else if dot(c, a) > 0.0 {
            Some(1)
        } else if dot(a, b) > 0.0 {
            Some(2)
        } else {
            None
        }
    }

    /// Whether the longest edge is more than 2.5 times the shortest: cutting it makes better shapes than cutting all three.
    #[inline]
    #[must_use]
    pub fn is_elongated(&self) -> bool {
        let [a, b, c] = self.squares;
        let (long, short) = (math::max(a, math::max(b, c)), math::min(a, math::min(b, c)));
        long > 2.5 * short
    }

    /// Whether the longest edge is more than 4 times the shortest.
    #[inline]
    #[must_use]
    pub fn is_needle(&self) -> bool {
        let [a, b, c] = self.squares;
        let (long, short) = (math::max(a, math::max(b, c)), math::min(a, math::min(b, c)));
        long > 16.0 * short
    }

    /// Whether the triangle has no area, as far as f32 can tell: equal or collinear corners, or corners that are not finite.
    #[must_use]
    pub fn is_degenerate(&self) -> bool {
        let n = self.edges[2].cross(self.edges[0]);
        !(n.x != 0.0 || n.y != 0.0 || n.z != 0.0) || n.is_nan()
    }
}

/// The edges of a triangle opposite its corners; not finite where they overflow.
fn edges(corners: [Vec3; 3]) -> [Vec3; 3] {
    let [a, b, c] = corners;
    [c - b, a - c, b - a]
}

/// Edges times a power of two, the largest component in [1, 2), and the two factors of that power (one may lie beyond
/// f32). Edges that are all zero or not finite become zeros.
fn scaled(edges: [Vec3; 3]) -> ([Vec3; 3], [f32; 2]) {
    let largest = edges.iter().fold(0.0, |m, e| math::max(math::max_component(e.abs()), m));
    if largest <= 0.0 || !edges.iter().all(|e| e.is_finite()) {
        return ([Vec3::ZERO; 3], [1.0, 1.0]);
    }
    let k = -math::exponent(largest);
    let factors = [math::ldexp(1.0, k >> 1), math::ldexp(1.0, k - (k >> 1))];
    (edges.map(|e| e * factors[0] * factors[1]), factors)
}

/// The parent in a scaled unit, from which the edges of pieces come.
///
/// An edge is a sum of the parent's two shorter edges, so that it keeps its digits in a needle, where differences of positions
/// lose all of theirs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    /// The coordinates whose edges from the remaining corner are used.
    coordinates: [usize; 2],
    edges: [Vec3; 2],
    factors: [f32; 2],
    pub(super) degenerate: bool,
}

impl Frame {
    pub(super) fn new(corners: [Vec3; 3]) -> Self {
        let (edges, factors) = scaled(edges(corners));
        let shape = Shape::from_edges(edges, 1.0);
        let apex = shape.opposite_longest();
        let (next, last) = ((apex + 1) % 3, (apex + 2) % 3);
        Self {
            coordinates: [next, last],
            edges: [edges[last], -edges[next]],
            factors,
            degenerate: shape.is_degenerate(),
        }
    }

    /// The shape of the piece with these corners.
    #[inline]
    pub(super) fn shape(&self, corners: [Bary; 3], fraction: f32) -> Shape {
        let [a, b, c] = corners;
        let edge = |from: Bary, to: Bary| {
            let d = to.minus(from);
            self.edges[0] * d[self.coordinates[0]] + self.edges[1] * d[self.coordinates[1]]
        };
        Shape::from_edges([edge(b, c), edge(c, a), edge(a, b)], fraction)
    }

    /// A length in the scaled unit, squared; negative lengths and NaN count as 0.
    pub(super) fn square(&self, length: f32) -> f32 {
        let x = math::max(length, 0.0) * self.factors[0] * self.factors[1];
        x * x
    }
}
