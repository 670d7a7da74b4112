//! Whole jobs of a session: an operator is uploaded where it is not on the device, and once more where the device was lost.

use super::{Prepared, RelightFailure};
use crate::gpu::Source;
use etendue_core::backend::BackendError;
use etendue_core::radiosity::blocks::{BlockError, BlockOperator};
use etendue_core::radiosity::relight::{RelightError, Relighter};

/// Direct irradiance and emission.
type Light<'a> = (&'a [[f32; 3]], &'a [[f32; 3]]);

/// Runs on the source's device; only what the device says is tried again.
fn run<T, E>(
    source: &Source,
    mut job: impl FnMut(&std::sync::Arc<crate::gpu::Gpu>) -> Result<T, RelightFailure<E>>,
) -> Result<T, RelightFailure<E>> {
    let done = source.run(|gpu| match job(gpu) {
        Err(RelightFailure::Device(e)) => Err(e),
        Err(RelightFailure::Numbers(e)) => Ok(Err(e)),
        Ok(value) => Ok(Ok(value)),
    });
    match done {
        Ok(Ok(value)) => Ok(value),
        Ok(Err(e)) => Err(RelightFailure::Numbers(e)),
        Err(e) => Err(RelightFailure::Device(e)),
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
    ) -> Result<(), RelightFailure<RelightError>> {
        run(source, |gpu| self.tiles(gpu, relighter)?.relight(relighter, light, indirect, passes))
    }

    /// [`Relighter::converge`] on the device.
    pub(crate) fn converge(
        &self,
        source: &Source,
        relighter: &Relighter,
        light: Light<'_>,
        indirect: &mut [[f32; 3]],
        until: (u32, f64),
    ) -> Result<u32, RelightFailure<RelightError>> {
        run(source, |gpu| self.tiles(gpu, relighter)?.converge(relighter, light, indirect, until))
    }

    /// [`BlockOperator::relight`] on the device.
    pub(crate) fn relight_blocks(
        &self,
        source: &Source,
        operator: &BlockOperator,
        light: Light<'_>,
        indirect: &mut [[f32; 3]],
    ) -> Result<(), RelightFailure<BlockError>> {
        run(source, |gpu| self.blocks(gpu, operator)?.relight(operator, light, indirect))
    }
}

/// What the device has no room for.
pub(crate) fn is_too_large<E>(failure: &RelightFailure<E>) -> bool {
    matches!(failure, RelightFailure::Device(BackendError::LimitExceeded { .. }))
}
