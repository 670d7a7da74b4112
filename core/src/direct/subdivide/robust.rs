//! The mended rule: edge probes, a tolerance, bounded angles.

use super::criterion::{CENTROID, Criterion, LARGEST, MIDPOINT, Probes, Samples, Split, Verdict};
use super::shape::Shape;
use crate::math;

/// Largest residual of the quadratic through six samples at the seventh, over the largest deviation, for a field that counts as smooth.
const SMOOTH: f32 = 0.125;
/// Deviation of a midpoint over the brightest of it and the ends of its edge, from which it counts as a leap: at the edge of a shadow it is a half.
const LEAP: f32 = 0.25;
/// Root mean square error of a linear interpolation across a leap, over that deviation: about 3/8 of the leap (sqrt(1/6) on a line).
const LEAP_ERROR: f32 = 0.75;
/// Share of the expected error that a leap must have for no other sample to be taken.
const ENOUGH: f32 = 0.5;
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

/// Error and largest deviation of a triangle whose midpoints deviate by `d` and whose centroid by `r` from the quadratic through the others.
#[inline]
fn expected(d: [f32; 3], r: f32) -> (f32, f32) {
    let lift = (4.0 / 9.0) * ((d[0] + d[1]) + d[2]) + r;
    (mean_error(d, r), math::max(largest_of(d), lift.abs()))
}

#[inline]
fn worst(a: (f32, f32), b: (f32, f32)) -> (f32, f32) {
    (math::max(a.0, b.0), math::max(a.1, b.1))
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
    fn examine(&self, shape: &Shape, samples: &Samples, rest: f32) -> Verdict {
        let known = samples.known();
        let a = shape.opposite_longest();
        let halves = Split::Two { corner: a as u8 };
        // Where one midpoint shows a leap no other sample can tell more, and a cut needs that of the longest edge in any case.
        if !known.has(MIDPOINT + a) {
            return Verdict::Probe(Probes::midpoint(a));
        }
        let crossed = longest_crossed(shape, samples);
        for e in [Some(a), crossed].into_iter().flatten() {
            if !known.has(MIDPOINT + e) {
                return Verdict::Probe(Probes::midpoint(e));
            }
            let (p, q) = (samples.get((e + 1) % 3), samples.get((e + 2) % 3));
            let l = samples.get(MIDPOINT + e);
            let off = (l - samples.linear_midpoint(e)).abs();
            let brightest = math::max(l, math::max(p, q));
            let error = LEAP_ERROR * off;
            // A leap much smaller than what is expected is not what was expected: look at everything then.
            let leap = off > LEAP * brightest && error >= ENOUGH * rest;
            if leap && off > self.tolerance(brightest) && !self.is_small(shape, error) {
                return Verdict::Cut { split: halves, error, rest: error, bend: LARGEST };
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
            return Verdict::Cut { split: halves, error, rest: error, bend: LARGEST };
        }
        let (b, c) = ((a + 1) % 3, (a + 2) % 3);
        // The median from A to E: a field that bends along BC alone is linear on both halves, and D divides it 2:1.
        let (la, le) = (samples.get(a), samples.get(MIDPOINT + a));
        let median = samples.get(CENTROID) - (la + (2.0 / 3.0) * (le - la));
        let straight = STRAIGHT * d[a].abs();
        let along = d[b].abs() <= straight && d[c].abs() <= straight && median.abs() <= straight;
        let split = if along { halves } else { self.demanded(shape) };
        // Deviations of the quadratic go with the square of the edge in the metric of its second derivatives: half an edge
        // has a quarter, and the parallelogram law gives that of the median.
        let [half, p, q] = [a, b, c].map(|i| 0.25 * d[i]);
        let median = 0.5 * (d[b] + d[c]) - half;
        let (next, bend) = match split {
            Split::Two { .. } => {
                worst(expected([half, d[b], median], 0.5 * r), expected([half, d[c], median], 0.5 * r))
            }
            Split::Fan { .. } => worst((0.25 * error, 0.25 * off), expected([median, p, q], 0.25 * r)),
            _ => (0.25 * error, 0.25 * off),
        };
        Verdict::Cut { split, error, rest: next, bend }
    }

    fn demanded(&self, shape: &Shape) -> Split {
        let corner = shape.opposite_longest() as u8;
        if shape.is_needle() {
            Split::Two { corner }
        } else if shape.is_elongated() || shape.obtuse_corner().is_some() {
            Split::Fan { corner }
        } else {
            Split::Four { corner }
        }
    }

    fn settles(&self, shape: &Shape, rest: f32, bend: f32, largest: f32) -> bool {
        bend <= self.tolerance(largest) || self.is_small(shape, rest)
    }
}
