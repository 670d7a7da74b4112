//! Points of the parent triangle on a grid, so that pieces tile it exactly.

/// Grid steps along an edge of the parent: 2^24, the finest grid on which every barycentric coordinate is an f32.
pub const GRID: u32 = 1 << 24;
/// One step as a number.
const STEP: f32 = 1.0 / 16_777_216.0;

/// Barycentric coordinates on the parent triangle: three multiples of 2^-24, none negative, that sum to exactly 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Bary {
    b1: u32,
    b2: u32,
}

impl Bary {
    /// The three corners of the parent.
    pub const CORNERS: [Self; 3] =
        [Self { b1: 0, b2: 0 }, Self { b1: GRID, b2: 0 }, Self { b1: 0, b2: GRID }];

    /// The point with these second and third coordinates in grid steps; none where they leave the parent.
    #[inline]
    #[must_use]
    pub const fn try_new(b1: u32, b2: u32) -> Option<Self> {
        if b1 <= GRID && b2 <= GRID - b1 { Some(Self { b1, b2 }) } else { None }
    }

    /// The coordinates in grid steps; they sum to [`GRID`].
    #[inline]
    #[must_use]
    pub const fn steps(self) -> [u32; 3] {
        [GRID - self.b1 - self.b2, self.b1, self.b2]
    }

    /// The coordinates. Exact, and their sum in any order is exactly 1.
    #[inline]
    #[must_use]
    pub fn to_f32(self) -> [f32; 3] {
        self.steps().map(|x| x as f32 * STEP)
    }

    /// The point halfway to `other`, and whether it is on the grid. Off the grid the second and third coordinates are
    /// rounded down, by half a step.
    #[inline]
    #[must_use]
    pub const fn midpoint(self, other: Self) -> (Self, bool) {
        let (s1, s2) = (self.b1 + other.b1, self.b2 + other.b2);
        (Self { b1: s1 / 2, b2: s2 / 2 }, (s1 | s2) & 1 == 0)
    }

    /// The centroid of three points, the second and third coordinates rounded down by at most 2/3 of a step.
    #[inline]
    #[must_use]
    pub const fn centroid(corners: [Self; 3]) -> Self {
        let [a, b, c] = corners;
        Self { b1: (a.b1 + b.b1 + c.b1) / 3, b2: (a.b2 + b.b2 + c.b2) / 3 }
    }

    /// `self - origin` as three numbers. Exact: at most 2^24 steps each.
    #[inline]
    pub(super) fn minus(self, origin: Self) -> [f32; 3] {
        let (p, q) = (self.steps(), origin.steps());
        [0, 1, 2].map(|i| (p[i] as i32 - q[i] as i32) as f32 * STEP)
    }
}

/// Area of a triangle over that of the parent, in units of 2^-48, exact; negative where its corners run the other way.
#[must_use]
pub const fn signed_area(corners: [Bary; 3]) -> i64 {
    let [a, b, c] = corners;
    let (u1, u2) = (b.b1 as i64 - a.b1 as i64, b.b2 as i64 - a.b2 as i64);
    let (v1, v2) = (c.b1 as i64 - a.b1 as i64, c.b2 as i64 - a.b2 as i64);
    u1 * v2 - v1 * u2
}

/// [`signed_area`] of the parent: 2^48.
pub const WHOLE_AREA: i64 = 1 << 48;
