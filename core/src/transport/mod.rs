//! Estimators of light transport, written as small state machines between rays.
//!
//! `advance(answer) -> query`: a scalar loop, a stream of rays and a GPU wavefront drive the same code, and no
//! estimator knows how rays are traced.

mod back;
pub mod bidirectional;
pub mod first_shot;
pub mod gather;
pub mod mis;
pub mod path;
mod paths;
pub mod photon;
mod surface;
#[cfg(test)]
mod tests;
pub mod volume;

use crate::geometry::{Hit, Intersector, Ray};

pub use paths::{Paths, ProbeStart};
pub(crate) use surface::albedo_at;
pub use surface::{Surface, TransportCode, place_probe, resolve_probe, surface_at};

/// What an estimator wants to know next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Query {
    /// The nearest hit along a ray.
    Closest(Ray),
    /// Whether anything lies on a ray.
    Shadow(Ray),
    /// Nothing: the sample is complete.
    Done,
}

/// What the rays said.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Answer {
    /// Of [`Query::Closest`].
    Closest(Option<Hit>),
    /// Of [`Query::Shadow`]: something is in the way.
    Occluded(bool),
}

/// Asks an intersector. `Done` has no answer.
#[inline(always)]
pub fn ask<I: Intersector + ?Sized>(intersector: &I, query: &Query) -> Option<Answer> {
    match query {
        Query::Closest(ray) => Some(Answer::Closest(intersector.closest_hit(ray))),
        Query::Shadow(ray) => Some(Answer::Occluded(intersector.occluded(ray))),
        Query::Done => None,
    }
}
