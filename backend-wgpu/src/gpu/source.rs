//! Where devices come from: a host, or an adapter that gives a fresh one when one is lost.

use super::{Gpu, request};
use crate::Options;
use etendue_core::backend::BackendError;
use std::sync::{Arc, Mutex, PoisonError};

/// How a lost device is replaced.
#[derive(Clone, Debug)]
enum Origin {
    /// The host's affair.
    Host,
    /// A new one of the same adapter.
    Adapter(Option<String>),
}

/// The device that is in use, and how to get another.
#[derive(Debug)]
pub(crate) struct Source {
    origin: Origin,
    options: Options,
    gpu: Mutex<Arc<Gpu>>,
}

impl Source {
    pub(crate) async fn request(name: Option<&str>, options: Options) -> Result<Self, BackendError> {
        let gpu = make(name, &options).await?;
        let origin = Origin::Adapter(name.map(Into::into));
        Ok(Self { origin, options, gpu: Mutex::new(Arc::new(gpu)) })
    }

    pub(crate) fn of_host(device: wgpu::Device, queue: wgpu::Queue, options: Options) -> Self {
        let gpu = Gpu::new((device, queue), options.limits.clone(), options.mutations.clone());
        Self { origin: Origin::Host, options, gpu: Mutex::new(Arc::new(gpu)) }
    }

    pub(crate) fn gpu(&self) -> Arc<Gpu> {
        self.gpu.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Runs a job; if its device is lost and is ours to replace, once more on a fresh one. A job that fails leaves nothing behind.
    pub(crate) fn run<T>(
        &self,
        mut job: impl FnMut(&Arc<Gpu>) -> Result<T, BackendError>,
    ) -> Result<T, BackendError> {
        let gpu = self.gpu();
        match job(&gpu) {
            Err(BackendError::DeviceLost { .. }) if matches!(self.origin, Origin::Adapter(_)) => {
                job(&self.replace(&gpu)?)
            }
            other => other,
        }
    }

    /// A fresh device in place of a lost one, unless another thread has replaced it already.
    fn replace(&self, lost: &Arc<Gpu>) -> Result<Arc<Gpu>, BackendError> {
        let mut gpu = self.gpu.lock().unwrap_or_else(PoisonError::into_inner);
        if let (true, Origin::Adapter(name)) = (Arc::ptr_eq(&gpu, lost), &self.origin) {
            *gpu = Arc::new(pollster::block_on(make(name.as_deref(), &self.options))?);
        }
        Ok(gpu.clone())
    }
}

async fn make(name: Option<&str>, options: &Options) -> Result<Gpu, BackendError> {
    Ok(Gpu::new(request(name).await?, options.limits.clone(), options.mutations.clone()))
}
