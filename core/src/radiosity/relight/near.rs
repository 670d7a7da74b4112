//! Pairs of patches that see much of each other: what clusters cannot hold of their light is sent on within the pass.
//!
//! They are found in the tiles, so that a file need not have them: 0.2 to 1 a patch.

use super::Relighter;
use crate::radiosity::tiles::{Planes, SIDE};
use alloc::vec::Vec;

/// The least root of F(i, j) F(j, i) that is much.
const MUCH: f32 = 0.05;

/// A pair of patches i >= j.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// i and j.
    pub patches: [u32; 2],
    /// F(i, j) and F(j, i).
    pub factors: [f32; 2],
}

/// All of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Near(Vec<Pair>);

impl Near {
    pub(super) fn of(relighter: &Relighter) -> Self {
        let mut pairs = Vec::new();
        let at = |list: &[[f32; SIDE]], i: usize| list[i / SIDE][i % SIDE];
        relighter.tiles.for_each(|i, j, s| {
            if s * relighter.factors[i] * relighter.factors[j] > MUCH {
                let factors = [
                    at(&relighter.out, i) * s * at(&relighter.into, j),
                    at(&relighter.out, j) * s * at(&relighter.into, i),
                ];
                pairs.push(Pair { patches: [i as u32, j as u32], factors });
            }
        });
        Self(pairs)
    }

    pub(super) fn pairs(&self) -> &[Pair] {
        &self.0
    }

    /// Bytes of all of it.
    pub(super) fn bytes(&self) -> usize {
        core::mem::size_of_val(&self.0[..])
    }

    /// Adds F x of these pairs.
    pub(super) fn add(&self, x: &[Planes<3>], y: &mut [Planes<3>]) {
        for Pair { patches, factors } in &self.0 {
            let [i, j] = patches.map(|p| (p as usize / SIDE, p as usize % SIDE));
            for c in 0..3 {
                y[i.0][c][i.1] += factors[0] * x[j.0][c][j.1];
                if i != j {
                    y[j.0][c][j.1] += factors[1] * x[i.0][c][i.1];
                }
            }
        }
    }
}
