//! Adaptive subdivision of a lit triangle: pieces over which direct irradiance is nearly linear.
//!
//! Quantity: irradiance l [W m^-2] of one light, known by samples (each a shadow ray); the pieces with their corners' irradiance are the
//! piecewise-linear density from which first-shot photons start. Hanging nodes are harmless: the pieces are a density, not a
//! finite-element space.
//!
//! A [`Criterion`] says whether a triangle is cut and how, as a pure function of its shape and of samples at its corners, midpoints and centroid:
//! - [`Published`]: algorithm 1 of source A (E. Kopylov, "An effective method of computing illumination with a distribution for generating
//!   rays"), to the letter;
//! - [`Robust`]: the same idea with what the letter lacks. See the table of pieces against error in `tests/subdivide_error.rs`.
//!
//! Two orders of walking:
//! - [`Workspace::subdivide`]: depth first, a fixed stack, pieces handed out one after the other; a budget is shared among the parts of a cut;
//! - [`refine`]: the part with the largest expected share of the squared error first, in a buffer of the caller. Takes the fewest pieces for an
//!   error, and a budget means what it should.
//!
//! Pieces tile the parent. Their corners are exact barycentric coordinates, multiples of 2^-24 ([`Bary`]): pieces cut at midpoints alone tile
//! it exactly, those cut at centroids to 1e-6 of its area. All pieces run the same way around as the parent.
//!
//! Total: irradiance that is negative or NaN counts as 0, above [`LARGEST`] as that; a triangle without area, or with corners that are not finite,
//! is one piece. Nothing depends on threads or on what was subdivided before.

mod bary;
mod best_first;
mod cache;
mod criterion;
mod published;
mod robust;
mod shape;
mod walk;

use crate::math::Vec3;
pub use bary::{Bary, GRID, WHOLE_AREA, signed_area};
pub use best_first::{Node, refine};
use cache::Cache;
pub use criterion::{
    CENTROID, Criterion, Irradiance, LARGEST, MIDPOINT, POINTS, Probes, Samples, Split, Verdict,
};
pub use published::Published;
pub use robust::Robust;
use shape::Frame;
pub use shape::Shape;
use walk::{Job, Look, Part};

/// How far a subdivision may go. Sizes are longest edges in the unit of the corners (metres).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// A part this small or smaller is a piece, and is not looked into. 0, negative or NaN: no such limit.
    pub size: f32,
    /// A part larger than this is always cut, so that a shadow or a spot cannot hide between probes. Infinite or NaN: no such limit.
    pub largest: f32,
    /// Parts with fewer cuts above them are always cut.
    pub least_depth: u8,
    /// A part with so many cuts above it is a piece. At most 48 have an effect: each cut halves the area or more.
    pub depth: u8,
    /// Most pieces per triangle; 0 counts as 1. It bounds the time too: at most two parts are looked into per piece, seven samples each.
    pub budget: u32,
}

impl Default for Limits {
    fn default() -> Self {
        Self { size: 0.0, largest: f32::INFINITY, least_depth: 0, depth: 48, budget: 1024 }
    }
}

/// Why a piece was not cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum End {
    /// The criterion accepted it by its samples.
    Linear,
    /// The criterion accepted it by what the part above had let expect, without samples of its own.
    Settled,
    /// [`Limits::size`].
    Size,
    /// [`Limits::depth`], or the stack's, of 48 cuts.
    Depth,
    /// [`Limits::budget`], or the buffer is full.
    Budget,
    /// Its cut would need points between those of the barycentric grid.
    Grid,
    /// The parent has no area, or corners that are not finite.
    Degenerate,
}

impl End {
    /// Whether samples say that irradiance is linear enough on the piece.
    #[must_use]
    pub const fn is_sure(self) -> bool {
        matches!(self, Self::Linear | Self::Settled)
    }
}

/// A piece of a triangle, with irradiance linear between its corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece<S> {
    /// Its corners on the parent.
    pub corners: [Bary; 3],
    /// Irradiance at its corners, W m^-2.
    pub irradiance: [S; 3],
    /// Its area over the parent's. Exact for cuts at midpoints, else within 2^-20 of it.
    pub fraction: f32,
    /// How many cuts made it.
    pub depth: u8,
    /// Why it was not cut further.
    pub end: End,
}

impl<S> Piece<S> {
    fn new(part: Part<S>, end: End) -> Self {
        Self {
            corners: part.corners,
            irradiance: part.irradiance,
            fraction: part.fraction,
            depth: part.depth,
            end,
        }
    }
}

/// What a subdivision took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Summary {
    /// Pieces made.
    pub pieces: u32,
    /// Samples of irradiance taken, the corners' included.
    pub samples: u32,
}

/// Most parts that wait. A cut into n leaves n - 1 waiting and divides the area by n or more (but for rounding): from 2^48 units of area
/// down to one that is 3 per factor of 4, or 72.
const STACK: usize = 96;

#[derive(Clone, Copy, Debug)]
struct Waiting<S> {
    part: Part<S>,
    /// Pieces that it may become.
    budget: u32,
}

/// The fixed stack and the remembered samples of subdivisions, to be used for one triangle after the other (about 18 KiB for three channels; making it
/// costs more than a small triangle's subdivision). What it held before has no influence.
pub struct Workspace<S> {
    stack: [Waiting<S>; STACK],
    cache: Cache<S>,
}

impl<S: Irradiance> Default for Workspace<S> {
    fn default() -> Self {
        Self::new()
    }
}

impl<S: Irradiance> Workspace<S> {
    /// An empty one.
    #[must_use]
    pub fn new() -> Self {
        let none = Waiting { part: root([S::DARK; 3]), budget: 0 };
        Self { stack: [none; STACK], cache: Cache::new() }
    }

    /// Cuts a triangle depth first and hands out its pieces: of each cut first the part whose corners differ most, then the others in its order.
    ///
    /// `irradiance` gives W m^-2 at barycentric coordinates of the triangle; it must be a pure function, and is asked once per place but for
    /// places that were pushed out of a small memory. The budget is divided at each cut by how much irradiance differs between the corners of each
    /// part, and what one part does not use goes to the next. It is a guard, not a goal: parts may meet it while others
    /// have pieces to spare, so that a tolerance should end most of them; [`refine`] spends a budget well.
    pub fn subdivide<C: Criterion>(
        &mut self,
        corners: [Vec3; 3],
        criterion: &C,
        limits: &Limits,
        mut irradiance: impl FnMut([f32; 3]) -> S,
        mut emit: impl FnMut(Piece<S>),
    ) -> Summary {
        self.cache.begin();
        let whole = whole(&mut self.cache, &mut irradiance);
        let mut pieces = 0;
        let frame = Frame::new(corners);
        if frame.degenerate {
            emit(Piece::new(whole, End::Degenerate));
            return Summary { pieces: 1, samples: self.cache.taken };
        }
        let job = Job::new(frame, criterion, limits);
        let budget = limits.budget.max(1);
        self.stack[0] = Waiting { part: whole, budget };
        let (mut waiting, mut spare) = (1, 0);
        while waiting > 0 {
            waiting -= 1;
            let Waiting { part, budget } = self.stack[waiting];
            let budget = budget + spare;
            spare = 0;
            let look = if budget < 2 {
                Look::Done(End::Budget)
            } else {
                job.look(&part, &mut self.cache, &mut irradiance)
            };
            let end = match look {
                Look::Cut { cut, .. } if cut.split.count() as u32 > budget => End::Budget,
                Look::Cut { cut, .. } if waiting + cut.split.count() > STACK => End::Depth,
                Look::Done(end) => end,
                Look::Cut { cut, .. } => {
                    let parts = job.pieces(&part, cut, &mut self.cache, &mut irradiance);
                    let parts = &parts[..cut.split.count()];
                    let (shares, first) = shares(parts, budget);
                    // A stack: what is pushed first comes last.
                    for i in (0..parts.len()).rev().filter(|i| *i != first).chain([first]) {
                        self.stack[waiting] = Waiting { part: parts[i], budget: shares[i] };
                        waiting += 1;
                    }
                    continue;
                }
            };
            spare = budget - 1;
            pieces += 1;
            emit(Piece::new(part, end));
        }
        Summary { pieces, samples: self.cache.taken }
    }
}

/// Divides a budget among the parts of a cut: one piece each, and the rest by how much irradiance differs between a part's corners, a 16th of all
/// the differences being added to each, since light may hide between corners. Also the part with the largest difference, which
/// should come first so that the others get what it leaves. `budget` is at least the number of parts.
fn shares<S: Irradiance>(parts: &[Part<S>], budget: u32) -> ([u32; 4], usize) {
    let n = parts.len().min(4);
    let mut spreads = [0.0_f32; 4];
    let mut first = 0;
    for i in 0..n {
        spreads[i] = walk::spread(parts[i].irradiance);
        if spreads[i] > spreads[first] {
            first = i;
        }
    }
    // Scaled, so that the sum is finite.
    let largest = spreads[first];
    let scaled = spreads.map(|x| if largest > 0.0 { x / largest } else { 1.0 });
    let total: f32 = scaled[..n].iter().sum();
    let weight = scaled.map(|x| x + total / 16.0);
    let all: f32 = weight[..n].iter().sum();
    let free = budget.saturating_sub(n as u32);
    let (mut left, mut out) = (free, [1; 4]);
    for i in (0..n).filter(|i| *i != first) {
        // Rounding may ask for more than there is.
        let share = ((free as f32 * (weight[i] / all)) as u32).min(left);
        out[i] += share;
        left -= share;
    }
    out[first] += left;
    (out, first)
}

fn root<S>(irradiance: [S; 3]) -> Part<S> {
    Part {
        corners: Bary::CORNERS,
        irradiance,
        fraction: 1.0,
        rest: f32::INFINITY,
        bend: f32::INFINITY,
        depth: 0,
        rounded: false,
    }
}

fn whole<S: Irradiance>(cache: &mut Cache<S>, irradiance: &mut impl FnMut([f32; 3]) -> S) -> Part<S> {
    root(Bary::CORNERS.map(|corner| cache.sample(corner, irradiance)))
}
