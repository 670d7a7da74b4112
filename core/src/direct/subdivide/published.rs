//! Algorithm 1 as it was published.

use super::criterion::{CENTROID, Criterion, LARGEST, MIDPOINT, Probes, Samples, Split, Verdict};
use super::shape::Shape;
use crate::math;

/// E. Kopylov's algorithm 1: the centroid decides whether a triangle is cut, the obtuse angle how.
///
/// With D the centroid, ld, la, lb, lc the irradiance at D and the corners, lm = (la + lb + lc)/3:
/// - ld = lm: accepted;
/// - no obtuse angle: in three, ABD, BCD, CAD;
/// - obtuse at A, E the midpoint of BC: in four, AFG, BEF, CGE, FEG (F, G the midpoints of AB, AC) if both
///   |le - (lb + lc)/2| > |ld - lm| and |ld - (la + le)/2| > |ld - lm|; else in two, ABE, AEC.
///
/// Where the text is loose, and what is chosen:
/// - "equal" has no tolerance in the text. Here |ld - lm| <= `relative` max(la, lb, lc, ld) + `absolute`; both zero is the text to the
///   letter, which in floats accepts little but constant irradiance.
/// - The "size" below which a triangle is left alone is not said: it is the longest edge, in
///   [`Limits::size`](super::Limits::size), asked before any sample is taken.
/// - The centre of three points is taken to be the centroid.
/// - A right angle is not obtuse. The sign of the dot product of the two edges, as rounded, decides.
/// - (la + le)/2 is kept as printed, although D divides the median from A to E 2:1 and a linear field has (la + 2 le)/3 there;
///   [`Robust`](super::Robust) has the right weights.
/// - The text has no minimum depth, and neither has this rule; a cut that limits demand is the one that an unequal centroid would
///   have got (in two where obtuse).
///
/// Cut in three again and again, an equilateral triangle ends at angles of 11 degrees and below, and 150 and above: each cut halves
/// the angles at the corners. Use [`Limits::depth`](super::Limits::depth) or sizes to bound it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Published {
    /// Tolerance as a share of the largest of the four samples; negative and NaN count as 0.
    pub relative: f32,
    /// Tolerance in W m^-2; negative and NaN count as 0.
    pub absolute: f32,
}

impl Criterion for Published {
    fn examine(&self, shape: &Shape, samples: &Samples, _rest: f32) -> Verdict {
        let known = samples.known();
        if !known.has(CENTROID) {
            return Verdict::Probe(Probes::CENTROID);
        }
        let [la, lb, lc] = [0, 1, 2].map(|i| samples.get(i));
        let ld = samples.get(CENTROID);
        let off = (ld - samples.linear_centroid()).abs();
        let largest = math::max(math::max(la, lb), math::max(lc, ld));
        if off <= math::max(self.relative, 0.0) * largest + math::max(self.absolute, 0.0) {
            return Verdict::Accept;
        }
        let Some(a) = shape.obtuse_corner() else {
            return Verdict::Cut { split: Split::Three, error: off, rest: off, bend: LARGEST };
        };
        if !known.has(MIDPOINT + a) {
            return Verdict::Probe(Probes::midpoint(a));
        }
        let (la, le) = (samples.get(a), samples.get(MIDPOINT + a));
        let edge = (le - samples.linear_midpoint(a)).abs();
        let median = (ld - (0.5 * la + 0.5 * le)).abs();
        let corner = a as u8;
        let split = if edge > off && median > off { Split::Four { corner } } else { Split::Two { corner } };
        Verdict::Cut { split, error: off, rest: off, bend: LARGEST }
    }

    fn demanded(&self, shape: &Shape) -> Split {
        match shape.obtuse_corner() {
            Some(a) => Split::Two { corner: a as u8 },
            None => Split::Three,
        }
    }
}
