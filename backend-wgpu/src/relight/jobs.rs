//! Whole jobs of a session: an operator is uploaded where it is not on the device, and once more where the device was lost.

use super::Prepared;
use crate::gpu::{Gpu, Source};
use etendue_core::backend::BackendError;
use etendue_core::radiosity::blocks::{BlockError, BlockOperator};
use etendue_core::radiosity::relight::{RelightError, Relighter};
use std::sync::Arc;

/// Direct irradiance and emission.
type Light<'a> = (&'a [[f32; 3]], &'a [[f32; 3]]);

/// Runs a job on the source's device, where `of_device` tells what the device said from what was wrong with the numbers.
fn run<T, E: From<BackendError>>(
    source: &Source,
    mut job: impl FnMut(&Arc<Gpu>) -> Result<T, E>,
    of_device: impl Fn(E) -> Result<BackendError, E>,
) -> Result<T, E> {
    source.run(|gpu| match job(gpu) {
        Ok(value) => Ok(Ok(value)),
        Err(e) => match of_device(e) {
            Ok(of_device) => Err(of_device),
            Err(e) => Ok(Err(e)),
        },
    })?
}

fn of_tiles(e: RelightError) -> Result<BackendError, RelightError> {
    match e {
        RelightError::Backend(e) => Ok(e),
        e => Err(e),
    }
}

fn of_blocks(e: BlockError) -> Result<BackendError, BlockError> {
    match e {
        BlockError::Backend(e) => Ok(e),
        e => Err(e),
    }
}

impl Prepared {
    /// [`Relighter::relight`] on the device.
    pub(crate) fn relight(
        &self,
        source: &Source,
        relighter: &Relighter,
        light: Light<'_>,
        indirect: &mut [[f32; 3]],
        passes: u32,
    ) -> Result<(), RelightError> {
        let job = |gpu: &Arc<Gpu>| self.tiles(gpu, relighter)?.relight(relighter, light, indirect, passes);
        run(source, job, of_tiles)
    }

    /// [`Relighter::converge`] on the device.
    pub(crate) fn converge(
        &self,
        source: &Source,
        relighter: &Relighter,
        light: Light<'_>,
        indirect: &mut [[f32; 3]],
        until: (u32, f64),
    ) -> Result<u32, RelightError> {
        let job = |gpu: &Arc<Gpu>| self.tiles(gpu, relighter)?.converge(relighter, light, indirect, until);
        run(source, job, of_tiles)
    }

    /// [`BlockOperator::relight`] on the device.
    pub(crate) fn relight_blocks(
        &self,
        source: &Source,
        operator: &BlockOperator,
        light: Light<'_>,
        indirect: &mut [[f32; 3]],
    ) -> Result<(), BlockError> {
        let job = |gpu: &Arc<Gpu>| self.blocks(gpu, operator)?.relight(operator, light, indirect);
        run(source, job, of_blocks)
    }
}
