//! One step of a subdivision, shared by both orders of walking.

use super::bary::{Bary, signed_area};
use super::cache::Cache;
use super::criterion::{Criterion, Irradiance, MIDPOINT, POINTS, Samples, Split, Verdict};
use super::shape::Frame;
use super::{End, Limits};
use crate::math;

/// Most cuts above a piece: halving 2^48 units of area so often leaves one.
const MOST_CUTS: u8 = 48;

/// Share of the expected error for a part whose corners differ by less than that error: an edge of a shadow seldom passes between them.
const DOUBT: f32 = 0.7;

/// A triangle on its way to be cut.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part<S> {
    pub(super) corners: [Bary; 3],
    pub(super) irradiance: [S; 3],
    /// Share of the parent's area.
    pub(super) fraction: f32,
    /// Root mean square error that is expected; infinite where nothing is known.
    pub(super) rest: f32,
    /// Largest deviation that is expected; infinite where nothing is known.
    pub(super) bend: f32,
    pub(super) depth: u8,
    /// Whether a cut at a centroid lies above it, so that its corners are not where they would be without a grid.
    pub(super) rounded: bool,
}

/// What a look at a part tells.
pub(super) enum Look {
    /// It is a piece.
    Done(End),
    /// It is cut so; `error` as in [`Verdict::Cut`], infinite where limits demand the cut.
    Cut { error: f32, cut: Cut },
}

/// How a part is cut, and what is expected of the worst of its parts, as in [`Verdict::Cut`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Cut {
    pub(super) split: Split,
    rest: f32,
    bend: f32,
}

/// All that does not change while a triangle is cut.
pub(super) struct Job<'a, C> {
    frame: Frame,
    criterion: &'a C,
    limits: &'a Limits,
    small: f32,
    large: f32,
}

impl<'a, C: Criterion> Job<'a, C> {
    pub(super) fn new(frame: Frame, criterion: &'a C, limits: &'a Limits) -> Self {
        // No upper size is an infinite one, whose square must not meet a factor of 0.
        let large = if limits.largest < f32::INFINITY { frame.square(limits.largest) } else { f32::INFINITY };
        Self { frame, criterion, limits, small: frame.square(limits.size), large }
    }

    /// Ends or cuts a part; takes the samples that this needs.
    pub(super) fn look<S: Irradiance>(
        &self,
        part: &Part<S>,
        cache: &mut Cache<S>,
        irradiance: &mut impl FnMut([f32; 3]) -> S,
    ) -> Look {
        let shape = self.frame.shape(part.corners, part.fraction);
        let longest = shape.squares()[shape.opposite_longest()];
        if longest <= self.small {
            return Look::Done(End::Size);
        }
        if part.depth >= self.limits.depth.min(MOST_CUTS) {
            return Look::Done(End::Depth);
        }
        let demanded = longest > self.large || part.depth < self.limits.least_depth;
        let mut samples = Samples::corners(part.irradiance.map(S::importance));
        if !demanded && self.criterion.settles(&shape, part.rest, part.bend, samples.largest()) {
            return Look::Done(End::Settled);
        }
        let points = points(part.corners);
        // Every round adds a point, so that seven rounds are enough for any criterion.
        for _ in 0..POINTS {
            match self.criterion.examine(&shape, &samples, part.rest) {
                Verdict::Probe(wanted) if !wanted.without(samples.known()).is_empty() => {
                    let wanted = wanted.without(samples.known());
                    for i in (0..POINTS).filter(|i| wanted.has(*i)) {
                        samples.set(i, cache.sample(points[i], irradiance).importance());
                    }
                }
                Verdict::Cut { split, error, rest, bend } => {
                    return self.cut(part, Cut { split, rest, bend }, error);
                }
                Verdict::Probe(_) | Verdict::Accept => break,
            }
        }
        if demanded {
            let split = self.criterion.demanded(&shape);
            return self.cut(part, Cut { split, rest: f32::INFINITY, bend: f32::INFINITY }, f32::INFINITY);
        }
        Look::Done(End::Linear)
    }

    fn cut<S>(&self, part: &Part<S>, cut: Cut, error: f32) -> Look {
        if can_cut(part.corners, cut.split, part.rounded) {
            Look::Cut { error, cut }
        } else {
            Look::Done(End::Grid)
        }
    }

    /// The pieces of a cut, in its order.
    pub(super) fn pieces<S: Irradiance>(
        &self,
        part: &Part<S>,
        cut: Cut,
        cache: &mut Cache<S>,
        irradiance: &mut impl FnMut([f32; 3]) -> S,
    ) -> [Part<S>; 4] {
        let Cut { split, rest, bend } = cut;
        let points = points(part.corners);
        let mut values = [S::DARK; POINTS];
        values[..3].copy_from_slice(&part.irradiance);
        for i in (MIDPOINT..POINTS).filter(|i| split.needs().has(*i)) {
            values[i] = cache.sample(points[i], irradiance);
        }
        split.pieces().map(|piece| Part {
            corners: piece.map(|i| points[i]),
            irradiance: piece.map(|i| values[i]),
            fraction: part.fraction * split.share(),
            rest: if spread(piece.map(|i| values[i])) >= rest { rest } else { DOUBT * rest },
            bend,
            depth: part.depth + 1,
            rounded: part.rounded || split == Split::Three,
        })
    }
}

/// The largest difference of importance between the corners of a part.
pub(super) fn spread<S: Irradiance>(irradiance: [S; 3]) -> f32 {
    let [a, b, c] = irradiance.map(S::importance);
    math::max(a, math::max(b, c)) - math::min(a, math::min(b, c))
}

/// The seven points of a triangle.
fn points(corners: [Bary; 3]) -> [Bary; POINTS] {
    let [a, b, c] = corners;
    [a, b, c, b.midpoint(c).0, c.midpoint(a).0, a.midpoint(b).0, Bary::centroid(corners)]
}

/// Whether a cut keeps the tiling.
///
/// Every piece must have an area: between the corners of the smallest triangles the grid has nothing. And corners must lie
/// exactly on the edges that they halve, or a neighbour that is not cut there would overlap by half a step; below a centroid, which is on no grid, that
/// cannot be had and is let pass (`rounded`).
fn can_cut(corners: [Bary; 3], split: Split, rounded: bool) -> bool {
    let [a, b, c] = corners;
    let exact = [b.midpoint(c).1, c.midpoint(a).1, a.midpoint(b).1];
    let needs = split.needs();
    let points = points(corners);
    (rounded || (0..3).all(|i| exact[i] || !needs.has(MIDPOINT + i)))
        && split.pieces()[..split.count()].iter().all(|piece| signed_area(piece.map(|i| points[i])) > 0)
}
