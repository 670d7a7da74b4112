//! A device with its queue: pipelines that are made once, buffers, and answers that come back.

mod arithmetic;
mod bc1;
mod buffers;
mod exact;
mod pipelines;
mod request;
mod source;

pub use bc1::Bc1Texture;
pub(crate) use bc1::BlockTexture;
pub(crate) use buffers::{Buffer, Pending};
pub(crate) use pipelines::{Binding, Pipeline, PipelineKey};
use request::request;
pub use request::{AdapterName, adapters};
pub(crate) use source::Source;

use crate::shaders::Mutation;
use etendue_core::backend::{Arithmetic, BackendError};
use pipelines::Pipelines;
use std::sync::{Mutex, OnceLock};

/// A device that computes. What it cannot give is an error, never a panic: everything that is asked of it is asked within error scopes.
#[derive(Debug)]
pub(crate) struct Gpu {
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    pub(crate) name: String,
    pub(crate) limits: wgpu::Limits,
    pipelines: Mutex<Pipelines>,
    /// How textures of BC1 decode, once somebody asked.
    bc1: OnceLock<Bc1Texture>,
    mutations: Vec<Mutation>,
    arithmetic: OnceLock<Arithmetic>,
}

impl Gpu {
    /// Wraps a device; `limits` may be smaller than its own, which then are what is used.
    pub(crate) fn new(
        (device, queue): (wgpu::Device, wgpu::Queue),
        limits: Option<wgpu::Limits>,
        mutations: Vec<Mutation>,
    ) -> Self {
        let own = device.limits();
        let limits = limits.map_or_else(|| own.clone(), |l| l.or_worse_values_from(&own));
        let name = request::describe(&device.adapter_info());
        Self {
            device,
            queue,
            name,
            limits,
            pipelines: Mutex::default(),
            bc1: OnceLock::new(),
            mutations,
            arithmetic: OnceLock::new(),
        }
    }

    pub(crate) fn lost(&self, reason: impl Into<String>) -> BackendError {
        BackendError::DeviceLost { adapter: self.name.clone(), reason: reason.into() }
    }

    pub(crate) fn refused(&self, reason: impl Into<String>) -> BackendError {
        BackendError::Device { adapter: self.name.clone(), reason: reason.into() }
    }

    /// Runs what may be refused; the first refusal is the error.
    pub(crate) fn scoped<T>(
        &self,
        work: impl FnOnce() -> Result<T, BackendError>,
    ) -> Result<T, BackendError> {
        // The last pushed is the first asked.
        let internal = self.device.push_error_scope(wgpu::ErrorFilter::Internal);
        let memory = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let validation = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let done = work();
        let found = [validation.pop(), memory.pop(), internal.pop()].map(pollster::block_on);
        match found.into_iter().flatten().next() {
            Some(e) if self.is_lost() => Err(self.lost(e.to_string())),
            Some(e) => Err(self.refused(e.to_string())),
            None => done,
        }
    }

    /// Whether nothing works any more. A lost device says only that what was made after its loss is no good, as it would of a
    /// fault of ours: so it is asked for what cannot be wrong.
    fn is_lost(&self) -> bool {
        let scope = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: 4,
            usage: wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        self.queue.write_buffer(&buffer, 0, &[0; 4]);
        pollster::block_on(scope.pop()).is_some()
    }

    /// Bytes that one storage binding can have.
    pub(crate) fn binding_bytes(&self) -> u64 {
        self.limits.max_storage_buffer_binding_size.min(self.limits.max_buffer_size)
    }

    /// How many invocations one dispatch along x can have, in workgroups of this size.
    pub(crate) fn dispatch_items(&self, workgroup: u32) -> u64 {
        u64::from(self.limits.max_compute_workgroups_per_dimension) * u64::from(workgroup)
    }

    /// Sends work to the queue; the answer is read by [`Pending`].
    pub(crate) fn submit(&self, encoder: wgpu::CommandEncoder) {
        self.queue.submit([encoder.finish()]);
    }

    pub(crate) fn encoder(&self) -> wgpu::CommandEncoder {
        self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("etendue") })
    }

    /// Lets the device go on with what is sent; waits for all of it if asked to.
    pub(crate) fn poll(&self, wait: bool) -> Result<(), BackendError> {
        let kind = if wait { wgpu::PollType::wait_indefinitely() } else { wgpu::PollType::Poll };
        self.device.poll(kind).map(|_| ()).map_err(|e| self.lost(e.to_string()))
    }
}
