//! The mended rule: edge probes, a tolerance, bounded angles.

use super::criterion::{CENTROID, Criterion, MIDPOINT, Probes, Samples, Split, Verdict};
use super::shape::Shape;
use crate::math;

/// Largest residual of the quadratic through six samples at the seventh, over the largest deviation, for a field that counts as smooth.
const SMOOTH: f32 = 0.125;
/// Root mean square error of a linear interpolation across a step, over the deviation of a midpoint, which is half the step.
const JUMP: f32 = 0.75;
/// Deviation of a midpoint over the step between the ends of its edge, from which it counts as a jump; 1/2 where it is one.
const STEEP: f32 = 0.4;
/// Largest deviation over the brightest sample for a field that counts as smooth.
const GENTLE: f32 = 0.25;
/// Share of the longest edge's deviation below which the other edges count as straight.
const STRAIGHT: f32 = 0.25;

/// Compares samples at the centroid and at the three midpoints with the plane through the corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Robust {
    /// Tolerance as a share of the largest sample; negative and NaN count as 0.
    pub relative: f32,
    /// Tolerance in W m^-2; negative and NaN count as 0.
    pub absolute: f32,
    /// Tolerance in W m^-2 of a piece's part in the root mean square error over the parent, error sqrt(area / parent's area); negative and NaN
    /// count as 0. It lets small pieces at the edge of a shadow be where large ones would not.
    pub share: f32,
}

impl Default for Robust {
    fn default() -> Self {
        Self { relative: 0.05, absolute: 0.0, share: 0.0 }
    }
}

/// Root mean square over a triangle of 4 (d0 l1 l2 + d1 l2 l0 + d2 l0 l1) (the quadratic that is 0 at the corners and d at the midpoints)
/// and of the cubic that is 0 on the edges and `r` at the centroid, taken as independent:
/// sqrt((4/45) (d0^2 + d1^2 + d2^2 + (d0 + d1 + d2)^2) + (81/280) r^2).
#[inline]
fn mean_error(d: [f32; 3], r: f32) -> f32 {
    // Scaled, as squares of irradiance may overflow or vanish.
    let largest = math::max(largest_of(d), r.abs());
    if largest <= 0.0 {
        return 0.0;
    }
    let [a, b, c] = d.map(|x| x / largest);
    let (r, sum) = (r / largest, (a + b) + c);
    let squares = (a * a + b * b) + c * c;
    largest * math::sqrt((4.0 / 45.0) * (squares + sum * sum) + (81.0 / 280.0) * (r * r))
}

#[inline]
fn largest_of(d: [f32; 3]) -> f32 {
    math::max(math::max(d[0].abs(), d[1].abs()), d[2].abs())
}

/// The longest edge with one end lit and one dark, as the corner opposite; of equal ones the first.
fn longest_crossed(shape: &Shape, samples: &Samples) -> Option<usize> {
    let lit = [0, 1, 2].map(|i| samples.get(i) > 0.0);
    let squares = shape.squares();
    let mut found: Option<usize> = None;
    for i in 0..3 {
        if lit[(i + 1) % 3] != lit[(i + 2) % 3] && found.is_none_or(|f| squares[i] > squares[f]) {
            found = Some(i);
        }
    }
    found
}

impl Robust {
    /// Largest deviation allowed where the largest sample is `largest`, W m^-2.
    #[inline]
    fn tolerance(&self, largest: f32) -> f32 {
        math::max(self.relative, 0.0) * largest + math::max(self.absolute, 0.0)
    }

    /// Whether an error of a piece is too small a part of the parent's.
    #[inline]
    fn is_small(&self, shape: &Shape, error: f32) -> bool {
        error * math::sqrt_clamped(shape.fraction()) <= math::max(self.share, 0.0)
    }
}

impl Criterion for Robust {
    fn examine(&self, shape: &Shape, samples: &Samples) -> Verdict {
        let known = samples.known();
        let a = shape.opposite_longest();
        let halves = Split::Two { corner: a as u8 };
        // One end lit, one dark, and a midpoint that is not between: a shadow's edge runs through, and no other sample can
        // tell more. The longest such edge is asked, which the cut needs most often.
        if let Some(e) = longest_crossed(shape, samples) {
            if !known.has(MIDPOINT + e) {
                return Verdict::Probe(Probes::midpoint(e));
            }
            // One of the ends is 0.
            let jump = samples.get((e + 1) % 3) + samples.get((e + 2) % 3);
            let off = (samples.get(MIDPOINT + e) - samples.linear_midpoint(e)).abs();
            let brightest = math::max(jump, samples.get(MIDPOINT + e));
            let error = JUMP * off;
            if off >= STEEP * jump && off > self.tolerance(brightest) && !self.is_small(shape, error) {
                return Verdict::Cut { split: halves, error, rest: error };
            }
        }
        let missing = Probes::MIDPOINTS.without(known);
        if !missing.is_empty() {
            return Verdict::Probe(missing);
        }
        // How far the midpoints are from the lines through the ends of their edges.
        let d = [0, 1, 2].map(|i| samples.get(MIDPOINT + i) - samples.linear_midpoint(i));
        let bend = largest_of(d);
        let brightest = (0..CENTROID).fold(0.0, |m, i| math::max(samples.get(i), m));
        let dark = (0..CENTROID).any(|i| samples.get(i) <= 0.0);
        if !known.has(CENTROID) {
            return Verdict::Probe(Probes::CENTROID);
        }
        let lift = samples.get(CENTROID) - samples.linear_centroid();
        // What the quadratic through the six other samples leaves at the centroid.
        let r = lift - (4.0 / 9.0) * ((d[0] + d[1]) + d[2]);
        let error = mean_error(d, r);
        let off = math::max(bend, lift.abs());
        if off <= self.tolerance(math::max(brightest, samples.get(CENTROID))) || self.is_small(shape, error) {
            return Verdict::Accept;
        }
        if dark || r.abs() > SMOOTH * bend || bend > GENTLE * brightest {
            return Verdict::Cut { split: halves, error, rest: error };
        }
        let (b, c) = ((a + 1) % 3, (a + 2) % 3);
        // The median from A to E: a field that bends along BC alone is linear on both halves, and D divides it 2:1.
        let (la, le) = (samples.get(a), samples.get(MIDPOINT + a));
        let median = samples.get(CENTROID) - (la + (2.0 / 3.0) * (le - la));
        let straight = STRAIGHT * d[a].abs();
        let along = d[b].abs() <= straight && d[c].abs() <= straight && median.abs() <= straight;
        let split = if along { halves } else { self.demanded(shape) };
        let rest = match split {
            Split::Two { .. } => {
                // Deviations go with the square of the edge in the metric of the second derivatives, so that the
                // parallelogram law gives that of the median.
                let new = 0.5 * (d[b] + d[c]) - 0.25 * d[a];
                let half = 0.25 * d[a];
                math::max(mean_error([half, d[b], new], 0.5 * r), mean_error([half, d[c], new], 0.5 * r))
            }
            _ => 0.25 * error,
        };
        Verdict::Cut { split, error, rest }
    }

    fn demanded(&self, shape: &Shape) -> Split {
        let corner = shape.opposite_longest() as u8;
        let slim = shape.is_elongated() || shape.obtuse_corner().is_some();
        if slim { Split::Two { corner } } else { Split::Four { corner } }
    }

    fn settles(&self, shape: &Shape, rest: f32, largest: f32) -> bool {
        rest <= self.tolerance(largest) || self.is_small(shape, rest)
    }
}
