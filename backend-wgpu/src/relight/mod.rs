//! Relighting on the device: operators that are uploaded once and used many times.
//!
//! [`Operator`] is core's [`Relighter`](etendue_core::radiosity::relight::Relighter), [`BlocksOperator`] its
//! [`BlockOperator`]. Both decode in the shader, sum in core's order, and give core's bits where the device's arithmetic
//! is exact. What does not fit one binding is cut where a stripe of rows ends, so that the order of sums stays.

mod blocks;
mod blocks_layout;
mod jobs;
mod lists;
mod operator;
mod prepared;
mod product;

pub use blocks::BlocksOperator;
pub(crate) use blocks::Decoder;
pub use operator::Operator;
pub(crate) use prepared::Prepared;

use crate::gpu::Gpu;
use etendue_core::backend::BackendError;

/// The operator on the device is another one.
const ANOTHER: BackendError =
    BackendError::BadJob { reason: "another operator than the one that was prepared" };

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
