//! Light of an operator.

use super::parts::{BlockError, Matrix, check_len, check_values};
use super::schedule::{Schedule, Scratch};
use super::stripe::{Quad, Sent};
use super::{BlockOperator, SIDE, block_rows};
use crate::radiosity::identity::Identity;
use alloc::vec::Vec;

/// What a relighting gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Indirect light that arrives \[W m^-2\].
    Irradiance,
    /// Indirect light that leaves \[W m^-2\]: irradiance times albedo.
    Radiosity,
}

/// Room for a relighting: none is asked for while it runs.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    start: Vec<Quad>,
    x: Vec<Quad>,
    flat: Vec<[f32; 4]>,
    y: Vec<Quad>,
    scratch: Scratch,
}

impl BlockOperator {
    /// What a relighting gives. The published matrix gives radiosity: its rows have albedos in them, and nothing is left of what arrives at a black surface.
    pub fn quantity(&self) -> Quantity {
        match self.parts.matrix {
            Matrix::Bounces(_) | Matrix::AllBounces => Quantity::Radiosity,
            Matrix::Gather | Matrix::FormFactors { .. } => Quantity::Irradiance,
        }
    }

    /// Other albedos, where they are no part of the matrix.
    ///
    /// # Errors
    /// [`BlockError::Baked`]; a wrong number, or an albedo that is not in \[0, 1\].
    pub fn set_albedo(&mut self, albedo: &[[f32; 3]]) -> Result<(), BlockError> {
        if !matches!(self.parts.matrix, Matrix::FormFactors { .. }) {
            return Err(BlockError::Baked { matrix: self.parts.matrix });
        }
        check_len("albedo", albedo.len(), self.len())?;
        check_values("albedo", albedo.as_flattened(), 3, |x| (0.0..=1.0).contains(&x))?;
        self.identity = Identity::fresh();
        for row in 0..self.len() {
            let rho = albedo[self.patch(row)];
            (0..3).for_each(|c| self.albedo[row / SIDE][c][row % SIDE] = rho[c]);
        }
        self.parts.albedo.copy_from_slice(albedo);
        Ok(())
    }

    /// Turns indirect radiosity into irradiance, B / rho; 0 on what is black, where it is not known. Leaves irradiance as it is.
    pub fn to_irradiance(&self, indirect: &mut [[f32; 3]]) {
        if self.quantity() == Quantity::Irradiance {
            return;
        }
        for (e, rho) in indirect.as_flattened_mut().iter_mut().zip(self.parts.albedo.as_flattened()) {
            *e = if *rho > 0.0 { *e / rho } else { 0.0 };
        }
    }

    /// Products of a relighting.
    pub fn products(&self) -> u32 {
        match self.parts.matrix {
            Matrix::FormFactors { bounces } => bounces.max(1),
            _ => 1,
        }
    }

    /// B0 = R E_direct + emission of light that [`Self::relight`] takes, in the order of rows: `start` has all of them, zeros beyond the last. `indirect` is how many numbers
    /// are wanted.
    ///
    /// # Errors
    /// As [`Self::relight`].
    pub fn start(
        &self,
        (direct, emission): (&[[f32; 3]], &[[f32; 3]]),
        indirect: usize,
        start: &mut [Quad],
    ) -> Result<(), BlockError> {
        let n = self.len();
        check_len("direct irradiance", direct.len(), n)?;
        check_len("indirect light", indirect, n)?;
        check_len("runs of rows", start.len(), block_rows(n))?;
        if !emission.is_empty() {
            check_len("emission", emission.len(), n)?;
        }
        check_values("direct irradiance", direct.as_flattened(), 3, f32::is_finite)?;
        check_values("emission", emission.as_flattened(), 3, f32::is_finite)?;
        for row in 0..n {
            let patch = self.patch(row);
            for c in 0..3 {
                let own = emission.get(patch).map_or(0.0, |e| e[c]);
                start[row / SIDE][c][row % SIDE] =
                    self.albedo[row / SIDE][c][row % SIDE] * direct[patch][c] + own;
            }
        }
        Ok(())
    }

    /// Indirect light ([`Self::quantity`]) per patch from direct irradiance \[W m^-2\] and the radiosity that patches emit themselves \[W m^-2\] (empty: nothing).
    ///
    /// What goes in is B0 = R E_direct + emission. One product, or for form factors as many as there are bounces. Nothing is allocated once the workspace has been used.
    ///
    /// # Errors
    /// A wrong length; light that is not finite.
    pub fn relight<S: Schedule + ?Sized>(
        &self,
        schedule: &S,
        (direct, emission): (&[[f32; 3]], &[[f32; 3]]),
        indirect: &mut [[f32; 3]],
        room: &mut Workspace,
    ) -> Result<(), BlockError> {
        let n = self.len();
        let rows = block_rows(n);
        for quads in [&mut room.start, &mut room.x, &mut room.y] {
            quads.clear();
            quads.resize(rows, Quad::default());
        }
        self.start((direct, emission), indirect.len(), &mut room.start)?;
        room.flat.clear();
        room.flat.resize(n, [0.0; 4]);
        for bounce in 0..self.products() {
            // B0 first, then B0 + R E.
            for (row, x) in room.x.iter_mut().enumerate() {
                for c in 0..3 {
                    for k in 0..SIDE {
                        let start = room.start[row][c][k];
                        let more = if bounce == 0 { 0.0 } else { self.albedo[row][c][k] * room.y[row][c][k] };
                        x[c][k] = self.into[row][k] * (start + more);
                    }
                }
            }
            for (row, flat) in room.flat.iter_mut().enumerate() {
                (0..3).for_each(|c| flat[c] = room.x[row / SIDE][c][row % SIDE]);
            }
            schedule.product(self, Sent { quads: &room.x, flat: &room.flat }, &mut room.y, &mut room.scratch);
            for (y, out) in room.y.iter_mut().zip(&self.out) {
                for y in y {
                    for k in 0..SIDE {
                        y[k] *= out[k];
                    }
                }
            }
        }
        for row in 0..n {
            indirect[self.patch(row)] = [0, 1, 2].map(|c| room.y[row / SIDE][c][row % SIDE]);
        }
        Ok(())
    }
}
