//! Which adapters there are, and a device of one of them.

use etendue_core::backend::BackendError;
use std::fmt;

/// An adapter, in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AdapterName {
    /// As the driver calls it.
    pub name: String,
    /// The driver and its version.
    pub driver: String,
    /// `vulkan`, `metal`, `dx12` or `gl`.
    pub api: String,
    /// Computes on the CPU.
    pub software: bool,
}

impl fmt::Display for AdapterName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({}, {})", self.name, self.api, self.driver)
    }
}

impl AdapterName {
    fn of(info: &wgpu::AdapterInfo) -> Self {
        Self {
            name: info.name.clone(),
            driver: format!("{} {}", info.driver, info.driver_info).trim().to_string(),
            api: info.backend.to_str().into(),
            software: info.device_type == wgpu::DeviceType::Cpu,
        }
    }
}

pub(super) fn describe(info: &wgpu::AdapterInfo) -> String {
    AdapterName::of(info).to_string()
}

fn instance() -> wgpu::Instance {
    let flags = wgpu::InstanceFlags::empty();
    wgpu::Instance::new(wgpu::InstanceDescriptor {
        flags,
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    })
}

async fn all() -> Vec<wgpu::Adapter> {
    instance().enumerate_adapters(wgpu::Backends::all()).await
}

/// The adapters of this machine that can compute.
pub fn adapters() -> Vec<AdapterName> {
    let list = pollster::block_on(all());
    list.iter().filter(|a| computes(a)).map(|a| AdapterName::of(&a.get_info())).collect()
}

fn computes(adapter: &wgpu::Adapter) -> bool {
    adapter.get_downlevel_capabilities().flags.contains(wgpu::DownlevelFlags::COMPUTE_SHADERS)
}

/// Real devices before those that compute on the CPU, Vulkan and its like before GL.
fn rank(adapter: &wgpu::Adapter) -> (u8, u8) {
    let info = adapter.get_info();
    let device = match info.device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu | wgpu::DeviceType::Other => 2,
        wgpu::DeviceType::Cpu => 3,
    };
    (device, u8::from(info.backend == wgpu::Backend::Gl))
}

/// A device of the best adapter whose description has `wanted` in it, whatever the case.
pub(super) async fn request(wanted: Option<&str>) -> Result<(wgpu::Device, wgpu::Queue), BackendError> {
    let mut list = all().await;
    list.retain(computes);
    list.sort_by_key(rank);
    let described = |a: &wgpu::Adapter| describe(&a.get_info());
    let fits =
        |a: &&wgpu::Adapter| wanted.is_none_or(|w| described(a).to_lowercase().contains(&w.to_lowercase()));
    let Some(adapter) = list.iter().find(fits) else {
        let there: Vec<String> = list.iter().map(described).collect();
        let there = if there.is_empty() { "none that computes".to_string() } else { there.join("; ") };
        let wanted =
            wanted.map_or_else(|| "any that wgpu can use".to_string(), |w| format!("one named `{w}`"));
        return Err(BackendError::NoAdapter { wanted: format!("{wanted}; there are: {there}") });
    };
    let limits = adapter.limits();
    // WebGPU's defaults but for sizes, of which it takes all that there is.
    let required = wgpu::Limits {
        max_storage_buffer_binding_size: limits.max_storage_buffer_binding_size,
        max_buffer_size: limits.max_buffer_size,
        max_texture_dimension_2d: limits.max_texture_dimension_2d,
        ..wgpu::Limits::downlevel_defaults().using_alignment(limits.clone()).or_worse_values_from(&limits)
    };
    let required = wgpu::Limits {
        max_storage_buffers_per_shader_stage: 8.min(limits.max_storage_buffers_per_shader_stage),
        ..required
    };
    let descriptor = wgpu::DeviceDescriptor {
        label: Some("etendue"),
        required_features: adapter.features()
            & (wgpu::Features::TEXTURE_COMPRESSION_BC | wgpu::Features::PASSTHROUGH_SHADERS),
        required_limits: required,
        ..Default::default()
    };
    adapter.request_device(&descriptor).await.map_err(|e| BackendError::NoAdapter {
        wanted: format!("{}, which gives no device: {e}", described(adapter)),
    })
}
