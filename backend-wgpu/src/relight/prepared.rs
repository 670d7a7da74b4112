//! The operators that were used last: they stay on the device.

use super::blocks::Decoder;
use super::{BlocksOperator, Operator};
use crate::gpu::Gpu;
use etendue_core::backend::BackendError;
use etendue_core::radiosity::blocks::BlockOperator;
use etendue_core::radiosity::relight::Relighter;
use std::sync::{Arc, Mutex, PoisonError};

/// One operator of each sort.
#[derive(Debug, Default)]
pub(crate) struct Prepared {
    tiles: Mutex<Option<Arc<Operator>>>,
    blocks: Mutex<Option<Arc<BlocksOperator>>>,
}

impl Prepared {
    /// The relighter on the device; uploaded where it is not there yet, in place of the one before.
    pub(crate) fn tiles(&self, gpu: &Arc<Gpu>, relighter: &Relighter) -> Result<Arc<Operator>, BackendError> {
        let mut kept = self.tiles.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(operator) = kept.as_ref().filter(|o| o.is_on(gpu) && o.is_of(relighter)) {
            return Ok(operator.clone());
        }
        // Room for one, not for two.
        *kept = None;
        let made = Arc::new(Operator::new(gpu, relighter)?);
        Ok(kept.insert(made).clone())
    }

    /// The same for blocks.
    pub(crate) fn blocks(
        &self,
        gpu: &Arc<Gpu>,
        operator: &BlockOperator,
    ) -> Result<Arc<BlocksOperator>, BackendError> {
        let mut kept = self.blocks.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(operator) = kept.as_ref().filter(|o| o.is_on(gpu) && o.is_of(operator)) {
            return Ok(operator.clone());
        }
        *kept = None;
        let made = Arc::new(BlocksOperator::new(gpu, operator, Decoder::of(gpu, operator)?)?);
        Ok(kept.insert(made).clone())
    }
}
