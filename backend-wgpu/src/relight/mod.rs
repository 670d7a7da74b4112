//! Relighting on the device: operators that are uploaded once and used many times.
//!
//! [`Operator`] is core's [`Relighter`](etendue_core::radiosity::relight::Relighter), [`BlocksOperator`] its
//! [`BlockOperator`]. Both decode in the shader, sum in core's order, and give core's bits where the device's arithmetic
//! is exact. What does not fit one binding is cut where a stripe of rows ends, so that the order of sums stays.

mod blocks;
mod blocks_layout;
mod lists;
mod operator;
mod prepared;
mod product;

pub use blocks::BlocksOperator;
pub use operator::Operator;
pub(crate) use prepared::Prepared;

use crate::gpu::Gpu;
use etendue_core::backend::BackendError;
use std::fmt;

/// Why there is no light: numbers that core refuses too (`E`), or the device.
#[derive(Clone, Debug, PartialEq)]
pub enum RelightFailure<E> {
    /// As core.
    Numbers(E),
    /// The device, or what it has too little of.
    Device(BackendError),
}

impl<E: fmt::Display> fmt::Display for RelightFailure<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Numbers(e) => e.fmt(f),
            Self::Device(e) => e.fmt(f),
        }
    }
}

impl<E: std::error::Error> std::error::Error for RelightFailure<E> {}

impl<E> From<BackendError> for RelightFailure<E> {
    fn from(e: BackendError) -> Self {
        Self::Device(e)
    }
}

/// Another operator than the one on the device.
fn another<E>() -> RelightFailure<E> {
    RelightFailure::Device(BackendError::BadJob { reason: "another operator than the one that was prepared" })
}

/// Bytes that are read before what is sent so far is handed to the device: long jobs in one piece are taken for hung ones.
const SUBMIT_BYTES: u64 = 1 << 28;

/// Workgroups along x and y, at least `count` of them.
fn spread(gpu: &Gpu, count: u32) -> [u32; 2] {
    let x = count.clamp(1, gpu.limits.max_compute_workgroups_per_dimension.max(1));
    [x, count.div_ceil(x)]
}

/// Floats as the words that they are.
fn words(floats: &[f32]) -> &[u32] {
    bytemuck::cast_slice(floats)
}
