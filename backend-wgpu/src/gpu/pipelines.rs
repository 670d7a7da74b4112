//! Pipelines, each made once for a device.

use super::{Buffer, Gpu};
use crate::shaders::{Link, REORDERED};
use etendue_core::backend::BackendError;
use std::collections::HashMap;
use std::sync::Arc;

/// What an entry point binds, in the order of its numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Binding {
    Uniform,
    Read,
    Write,
    /// Layers of a texture whose texels are loaded.
    Texture,
}

impl Binding {
    fn kind(self) -> wgpu::BindingType {
        let ty = match self {
            Self::Uniform => wgpu::BufferBindingType::Uniform,
            Self::Read => wgpu::BufferBindingType::Storage { read_only: true },
            Self::Write => wgpu::BufferBindingType::Storage { read_only: false },
            Self::Texture => {
                return wgpu::BindingType::Texture {
                    sample_type: wgpu::TextureSampleType::Float { filterable: false },
                    view_dimension: wgpu::TextureViewDimension::D2Array,
                    multisampled: false,
                };
            }
        };
        wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None }
    }
}

/// A pipeline and the layout of its one bind group.
#[derive(Debug)]
pub(crate) struct Pipeline {
    pub(crate) raw: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
}

/// What a pipeline is known by: its root's name with what varies, and its entry point.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) struct PipelineKey {
    pub(crate) name: String,
    pub(crate) entry: &'static str,
}

/// Pipelines made so far.
#[derive(Debug, Default)]
pub(super) struct Pipelines {
    made: HashMap<PipelineKey, Arc<Pipeline>>,
    /// Bytes of each one's shader.
    bytes: Vec<(PipelineKey, usize)>,
}

impl Gpu {
    /// The pipeline of an entry point of the shader `link`, which the name of `key` stands for.
    pub(crate) fn pipeline(
        &self,
        key: PipelineKey,
        link: Link<'_>,
        bindings: &[Binding],
    ) -> Result<Arc<Pipeline>, BackendError> {
        let mut pipelines = self.pipelines.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if let Some(made) = pipelines.made.get(&key) {
            return Ok(made.clone());
        }
        let mut features = link.features.to_vec();
        if !self.is_exact() {
            features.push(REORDERED);
        }
        let text = Link { features: &features, mutations: &self.mutations, ..link }
            .text()
            .map_err(|e| self.refused(e.to_string()))?;
        let (module, bytes) = self.scoped(|| self.module(&key.name, key.entry, text))?;
        let made = self.scoped(|| Ok(Arc::new(self.make(&key, &module, bindings))))?;
        pipelines.bytes.push((key.clone(), bytes));
        pipelines.made.insert(key, made.clone());
        Ok(made)
    }

    /// What was made so far, and the bytes of the shaders as the device was given them.
    pub(crate) fn shader_bytes(&self) -> Vec<(PipelineKey, usize)> {
        self.pipelines.lock().unwrap_or_else(std::sync::PoisonError::into_inner).bytes.clone()
    }

    fn make(&self, key: &PipelineKey, module: &wgpu::ShaderModule, bindings: &[Binding]) -> Pipeline {
        let entries: Vec<_> = bindings
            .iter()
            .enumerate()
            .map(|(i, b)| wgpu::BindGroupLayoutEntry {
                binding: i as u32,
                visibility: wgpu::ShaderStages::COMPUTE,
                ty: b.kind(),
                count: None,
            })
            .collect();
        let layout = self.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some(&key.name),
            entries: &entries,
        });
        let pipeline_layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(&key.name),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let raw = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(key.entry),
            layout: Some(&pipeline_layout),
            module,
            entry_point: Some(key.entry),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        Pipeline { raw, layout }
    }

    /// Binds buffers in the order of their numbers.
    pub(crate) fn bind(&self, pipeline: &Pipeline, buffers: &[&Buffer]) -> wgpu::BindGroup {
        let resources: Vec<_> = buffers.iter().map(|b| b.raw.as_entire_binding()).collect();
        self.bind_all(pipeline, &resources)
    }

    /// Binds buffers and textures in the order of their numbers.
    pub(crate) fn bind_all(
        &self,
        pipeline: &Pipeline,
        resources: &[wgpu::BindingResource<'_>],
    ) -> wgpu::BindGroup {
        let entries: Vec<_> = resources
            .iter()
            .zip(0..)
            .map(|(resource, binding)| wgpu::BindGroupEntry { binding, resource: resource.clone() })
            .collect();
        self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.layout,
            entries: &entries,
        })
    }
}
