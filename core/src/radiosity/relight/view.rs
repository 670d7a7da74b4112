//! What a backend reads that makes passes by itself.

use super::near::Pair;
use super::{Coarse, Relighter};
use crate::radiosity::Identity;
use crate::radiosity::tiles::{Planes, SIDE, Tiles};

/// All that a pass reads; runs of eight patches, zeros beyond the last. [`Relighter::relight`] says what is done with it.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    /// S.
    pub tiles: &'a Tiles,
    /// d A^1/2.
    pub into: &'a [[f32; SIDE]],
    /// d A^-1/2.
    pub out: &'a [[f32; SIDE]],
    /// R.
    pub albedo: &'a [Planes<3>],
    /// The second level, if there is one.
    pub coarse: Option<CoarseView<'a>>,
    /// Pairs of patches that see much of each other, in the order in which they are summed.
    pub near: &'a [Pair],
    /// What part of its change a pass makes.
    pub damping: f32,
    /// Weights of as many passes.
    pub weights: &'a [f32],
}

/// The second level.
#[derive(Clone, Copy, Debug)]
pub struct CoarseView<'a> {
    /// Ac^1/2 Gc Ac^-1/2 per channel.
    pub tiles: &'a [Tiles; 3],
    /// P: what a patch gets of its cluster's irradiance.
    pub spread: &'a [[f32; SIDE]],
    /// Q: share of a patch in its cluster's mean.
    pub shares: &'a [[f32; SIDE]],
    /// Ac^1/2, in runs of eight clusters.
    pub into: &'a [[f32; SIDE]],
    /// Ac^-1/2.
    pub out: &'a [[f32; SIDE]],
}

impl Coarse {
    fn view(&self) -> CoarseView<'_> {
        CoarseView {
            tiles: &self.tiles,
            spread: &self.spread,
            shares: &self.shares,
            into: &self.into,
            out: &self.out,
        }
    }
}

impl Relighter {
    /// What its passes read.
    pub fn view(&self) -> View<'_> {
        View {
            tiles: &self.tiles,
            into: &self.into,
            out: &self.out,
            albedo: &self.albedo,
            coarse: self.coarse.as_ref().map(Coarse::view),
            near: self.near.pairs(),
            damping: self.damping,
            weights: &self.weights,
        }
    }

    /// By what a backend knows this operator again.
    pub fn identity(&self) -> &Identity {
        &self.identity
    }
}
