//! What a criterion sees and what it says.

use super::shape::Shape;
use crate::math::{self, Vec3};

/// Irradiance above this counts as this, in W m^-2: 2^126, so that sums of a few samples stay finite.
pub const LARGEST: f32 = 8.507_059e37;

/// Negative numbers and NaN count as 0 (dark), what is above [`LARGEST`] as that.
#[inline]
fn bounded(x: f32) -> f32 {
    math::min(math::max(x, 0.0), LARGEST)
}

/// Irradiance at a point: one number, or three channels.
pub trait Irradiance: Copy {
    /// No light.
    const DARK: Self;

    /// The number that criteria compare: the mean of the channels.
    fn importance(self) -> f32;

    /// With each channel in [0, [`LARGEST`]]: negative and NaN become 0, anything larger becomes [`LARGEST`].
    #[must_use]
    fn bounded(self) -> Self;
}

impl Irradiance for f32 {
    const DARK: Self = 0.0;

    #[inline]
    fn importance(self) -> f32 {
        self
    }

    #[inline]
    fn bounded(self) -> Self {
        bounded(self)
    }
}

impl Irradiance for Vec3 {
    const DARK: Self = Vec3::ZERO;

    #[inline]
    fn importance(self) -> f32 {
        math::mean(self)
    }

    #[inline]
    fn bounded(self) -> Self {
        Vec3::new(bounded(self.x), bounded(self.y), bounded(self.z))
    }
}

/// Places in a triangle where irradiance may be sampled: a set of points 0 to 2, the corners; 3 to 5, the midpoints of
/// the edges opposite corners 0 to 2; 6, the centroid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Probes(u8);

/// Index of the midpoint of the edge opposite corner 0; the next two follow.
pub const MIDPOINT: usize = 3;
/// Index of the centroid.
pub const CENTROID: usize = 6;
/// How many points there are.
pub const POINTS: usize = 7;

impl Probes {
    /// The corners.
    pub const CORNERS: Self = Self(0b000_0111);
    /// The three midpoints.
    pub const MIDPOINTS: Self = Self(0b011_1000);
    /// The centroid.
    pub const CENTROID: Self = Self(0b100_0000);

    /// The midpoint of the edge opposite `corner`.
    #[inline]
    #[must_use]
    pub const fn midpoint(corner: usize) -> Self {
        Self(1 << (MIDPOINT + corner % 3))
    }

    /// Points of either set.
    #[inline]
    #[must_use]
    pub const fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Points of `self` that are not in `other`.
    #[inline]
    #[must_use]
    pub const fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// Whether there is no point.
    #[inline]
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Whether the set has this point.
    #[inline]
    #[must_use]
    pub const fn has(self, point: usize) -> bool {
        self.0 >> point & 1 == 1
    }
}

/// What is known of irradiance in a triangle, W m^-2: the importance at some of its seven points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Samples {
    values: [f32; POINTS],
    known: Probes,
}

impl Samples {
    /// All seven points known. Negative values and NaN count as 0, anything above [`LARGEST`] as that.
    #[inline]
    #[must_use]
    pub fn all(values: [f32; POINTS]) -> Self {
        let known = Probes::CORNERS.with(Probes::MIDPOINTS).with(Probes::CENTROID);
        Self { values: values.map(bounded), known }
    }

    /// The corners known; values are bounded as in [`Samples::all`].
    #[inline]
    #[must_use]
    pub fn corners(values: [f32; 3]) -> Self {
        let mut samples = Self { values: [0.0; POINTS], known: Probes::CORNERS };
        samples.values[..3].copy_from_slice(&values.map(bounded));
        samples
    }

    /// Adds a point; one beyond the seven is ignored.
    #[inline]
    pub fn set(&mut self, point: usize, value: f32) {
        if let Some(slot) = self.values.get_mut(point) {
            *slot = bounded(value);
            self.known.0 |= 1 << point;
        }
    }

    /// The points known.
    #[inline]
    #[must_use]
    pub fn known(&self) -> Probes {
        self.known
    }

    /// The value at a point: 0 where it is not known.
    #[inline]
    #[must_use]
    pub fn get(&self, point: usize) -> f32 {
        self.values.get(point).copied().unwrap_or(0.0)
    }

    /// The largest value known.
    #[inline]
    #[must_use]
    pub fn largest(&self) -> f32 {
        // Unknown points are 0.
        self.values.iter().fold(0.0, |m, x| math::max(*x, m))
    }

    /// Value at the centroid of the plane through the corners, (la + lb + lc)/3, as la + ((lb - la) + (lc - la))/3:
    /// equal corners give exactly their value, which (la + lb + lc)/3 rounds away from for 1 f32 in 8.
    #[inline]
    #[must_use]
    pub fn linear_centroid(&self) -> f32 {
        let [a, b, c, ..] = self.values;
        a + ((b - a) + (c - a)) / 3.0
    }

    /// Value at the midpoint opposite `corner` of the line through the ends of that edge.
    #[inline]
    #[must_use]
    pub fn linear_midpoint(&self, corner: usize) -> f32 {
        let (b, c) = (self.values[(corner + 1) % 3], self.values[(corner + 2) % 3]);
        0.5 * b + 0.5 * c
    }
}

/// How a triangle is cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Split {
    /// In two, from `corner` to the midpoint of the opposite edge.
    Two {
        /// The corner, 0 to 2.
        corner: u8,
    },
    /// In three, from the corners to the centroid.
    Three,
    /// In four, between the midpoints of the edges; `corner` names the first of the pieces.
    Four {
        /// The corner, 0 to 2.
        corner: u8,
    },
    /// In four: in two as above, and each half from the midpoint of the opposite edge to those of the others.
    Fan {
        /// The corner, 0 to 2.
        corner: u8,
    },
}

impl Split {
    /// How many pieces it makes.
    #[inline]
    #[must_use]
    pub const fn count(self) -> usize {
        match self {
            Self::Two { .. } => 2,
            Self::Three => 3,
            Self::Four { .. } | Self::Fan { .. } => 4,
        }
    }

    /// The pieces' corners, as indices of the triangle's seven points, in the order of source A with A the split's corner:
    /// ABE, AEC; or ABD, BCD, CAD; or AFG, BEF, CGE, FEG (E, F, G the midpoints of BC, AB, AC; D the centroid); a fan is AFE, FBE, AEG, ECG.
    /// Only the first [`Split::count`] count. All run the same way around as the triangle.
    #[inline]
    #[must_use]
    pub const fn pieces(self) -> [[usize; 3]; 4] {
        match self {
            Self::Two { corner } => {
                let (a, b, c) = around(corner);
                let e = MIDPOINT + a;
                [[a, b, e], [a, e, c], [0; 3], [0; 3]]
            }
            Self::Three => [[0, 1, CENTROID], [1, 2, CENTROID], [2, 0, CENTROID], [0; 3]],
            Self::Four { corner } => {
                let (a, b, c) = around(corner);
                let (e, f, g) = (MIDPOINT + a, MIDPOINT + c, MIDPOINT + b);
                [[a, f, g], [b, e, f], [c, g, e], [f, e, g]]
            }
            Self::Fan { corner } => {
                let (a, b, c) = around(corner);
                let (e, f, g) = (MIDPOINT + a, MIDPOINT + c, MIDPOINT + b);
                [[a, f, e], [f, b, e], [a, e, g], [e, c, g]]
            }
        }
    }

    /// Points that become corners of pieces.
    #[inline]
    #[must_use]
    pub const fn needs(self) -> Probes {
        match self {
            Self::Two { corner } => Probes::midpoint(corner as usize),
            Self::Three => Probes::CENTROID,
            Self::Four { .. } | Self::Fan { .. } => Probes::MIDPOINTS,
        }
    }

    /// Each piece's share of the triangle's area.
    #[inline]
    #[must_use]
    pub fn share(self) -> f32 {
        match self {
            Self::Two { .. } => 0.5,
            Self::Three => 1.0 / 3.0,
            Self::Four { .. } | Self::Fan { .. } => 0.25,
        }
    }
}

const fn around(corner: u8) -> (usize, usize, usize) {
    let a = corner as usize % 3;
    (a, (a + 1) % 3, (a + 2) % 3)
}

/// What a criterion says of a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// More must be known first.
    Probe(Probes),
    /// Irradiance is linear enough.
    Accept,
    /// It is not.
    Cut {
        /// How.
        split: Split,
        /// Root mean square of irradiance minus its linear interpolation over the triangle, W m^-2, as the samples tell.
        error: f32,
        /// The same for the worst piece after the cut, as the samples let expect.
        rest: f32,
        /// Largest deviation from linear at a probe of the worst piece, W m^-2, as the samples let expect; [`LARGEST`] where the field is not
        /// smooth enough to tell.
        bend: f32,
    },
}

/// When a lit triangle is cut, and how: a pure function of its shape and of samples.
pub trait Criterion {
    /// Says what to do. `rest` is the error that the triangle above let expect of this one (as in [`Verdict::Cut`]), infinite where
    /// nothing is known. With all seven points known it never asks for more; the driver takes a repeated question for [`Verdict::Accept`].
    fn examine(&self, shape: &Shape, samples: &Samples, rest: f32) -> Verdict;

    /// The cut where limits demand one of a triangle that [`Criterion::examine`] accepts.
    fn demanded(&self, shape: &Shape) -> Split;

    /// Whether a piece is accepted unseen: its triangle let expect a root mean square error of `rest` and a largest deviation of `bend`
    /// (W m^-2, as in [`Verdict::Cut`]), and the brightest of its corners has `largest` W m^-2.
    fn settles(&self, shape: &Shape, rest: f32, bend: f32, largest: f32) -> bool {
        let _ = (shape, rest, bend, largest);
        false
    }
}
