//! First shot: photons that start on surfaces which lights without size light, instead of at those lights.
//!
//! Direct irradiance is known in closed form, so the first flight and the first absorption need not be gambled: each triangle is cut into pieces
//! over which a light's irradiance is nearly linear (in `pieces`), and a photon starts on a (piece, light) pair in proportion to the flux that the
//! pair sends on, at a place drawn from the linear density ([`crate::sampling::linear_triangle`]). Lights with size and the environment are entries by
//! themselves and emit as ever, and so are lights beyond the budget.
//!
//! Weights ([`Weights`]):
//! - `Density`: those of the source (E. Kopylov, "First Shot"): all starts on a pair carry the same irradiance flux. That is biased where irradiance is not
//!   linear over a piece (edges of shadows, mostly); the finer the pieces, the less.
//! - `Exact`: the true irradiance over the density with which the place was drawn, its shadow ray included, and a share of photons straight from
//!   the lights, combined by the balance heuristic (Veach 1997, section 9.2.2): unbiased whatever the pieces, each weight at most 1 / share of what a photon from the lights
//!   would carry.
//!
//! With random numbers the gain in photons is 1 / s, s the share of emitted flux that survives its first hit ([`FirstShot::survival`]).

mod density;
mod forecast;
mod pieces;
pub mod place;
mod plan;
pub mod weight;

pub use density::{FirstShot, FirstShotParts, Look, Start};
pub use forecast::{Forecast, forecast};
pub use pieces::{How, LitPiece, Pair};
pub use plan::StartPlan;

use crate::direct::subdivide::{Limits, Published, Robust};
use core::fmt;

/// How triangles are cut into pieces, per light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Subdivision {
    /// One piece a triangle.
    None,
    /// The source's rule.
    Published(Published, Limits),
    /// The mended rule, looking where it matters.
    Robust(Robust, Limits, Care),
}

/// What a (triangle, light) pair is worth, in shares of the flux of all lights without size: how much it is looked into.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Care {
    /// Pairs that could receive no more than this are sampled at one place, drawn at random, and stay whole.
    pub glance: f32,
    /// Pairs that could receive more than this are cut once in any case, so that a shadow cannot hide between the first probes.
    pub doubt: f32,
    /// A part is not cut where its error is less than this.
    pub error: f32,
}

impl Default for Care {
    fn default() -> Self {
        Self { glance: 2e-6, doubt: 2e-5, error: 2e-7 }
    }
}

impl Subdivision {
    /// The source's rule to 5 %, at most 256 pieces of a triangle.
    pub fn published() -> Self {
        Self::Published(
            Published { relative: 0.05, absolute: 0.0 },
            Limits { budget: 256, ..Limits::default() },
        )
    }

    /// The mended rule for these weights. Where the density is what photons carry: to 1 %, at most 4096 pieces of a triangle (to 5 % the light of a room of large
    /// triangles lost 1 %: the chords of a convex field all lie on one side). Where they are weighted exactly pieces only save noise: to 10 %, for less
    /// of the light, at most 256 pieces (a quarter of the time for 2 % more noise, measured on two scenes).
    pub fn robust(weights: Weights) -> Self {
        let (relative, budget, error) = match weights {
            Weights::Density => (0.01, 4096, 5e-7),
            Weights::Exact { .. } => (0.1, 256, 1e-6),
        };
        let limits = Limits { budget, ..Limits::default() };
        Self::Robust(Robust { relative, ..Robust::default() }, limits, Care { error, ..Care::default() })
    }
}

/// How photons that start on surfaces are weighted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Weights {
    /// As published: alike within a piece.
    Density,
    /// Without bias.
    Exact {
        /// Share of the photons that start at the lights which have pieces, in (0, 1).
        share: f32,
    },
}

impl Weights {
    /// Without bias, a tenth of the photons from the lights.
    pub const EXACT: Self = Self::Exact { share: 0.1 };
}

/// Why there is no first shot for a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FirstShotError {
    /// Spheres and disks have no pieces.
    RoundShapes {
        /// How many there are.
        count: usize,
    },
    /// Nothing in the scene emits, or nothing that is lit reflects.
    Dark,
    /// More pieces than an index can name, or a flux that is not finite.
    Table,
    /// A share of photons from the lights outside (0, 1).
    Share,
}

impl fmt::Display for FirstShotError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::RoundShapes { count } => {
                write!(
                    f,
                    "photons start on triangles only, and the scene has {count} round shapes: start at the lights"
                )
            }
            Self::Dark => write!(
                f,
                "nothing in the scene emits, or nothing that is lit reflects: no photon has where to start"
            ),
            Self::Table => write!(f, "too many lit pieces, or a flux that is not finite"),
            Self::Share => write!(f, "the share of photons from the lights must be above 0 and below 1"),
        }
    }
}

impl core::error::Error for FirstShotError {}
