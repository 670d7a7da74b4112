//! y = S x on the device, for S in tiles.

use super::lists::{List, Part, parts};
use super::spread;
use crate::gpu::{Binding, Buffer, Gpu, Pipeline, PipelineKey};
use crate::shaders::Link;
use etendue_core::backend::BackendError;
use etendue_core::radiosity::tiles::Tiles;
use std::sync::Arc;

/// One dispatch.
#[derive(Debug)]
pub(super) struct Dispatch {
    pub(super) pipeline: Arc<Pipeline>,
    pub(super) group: wgpu::BindGroup,
    pub(super) groups: [u32; 3],
}

impl Dispatch {
    pub(super) fn encode(&self, pass: &mut wgpu::ComputePass<'_>) {
        let [x, y, z] = self.groups;
        pass.set_pipeline(&self.pipeline.raw);
        pass.set_bind_group(0, &self.group, &[]);
        pass.dispatch_workgroups(x, y, z);
    }
}

/// Matrices that are uploaded, with where they read and write.
#[derive(Debug)]
pub(super) struct Product {
    dispatches: Vec<Dispatch>,
    /// Bytes that it reads.
    pub(super) bytes: u64,
    /// How many parts the limits made of it.
    pub(super) parts: usize,
}

impl Product {
    /// One matrix for all channels, or one for each of three. `x` and `y` are in runs of eight, three channels each.
    pub(super) fn new(gpu: &Gpu, matrices: &[&Tiles], x: &Buffer, y: &Buffer) -> Result<Self, BackendError> {
        let one = matrices.len() > 1;
        let features: &[&str] = if one { &["ONE"] } else { &[] };
        let name = if one { "relight::product, one channel" } else { "relight::product" };
        let bindings =
            [Binding::Uniform, Binding::Read, Binding::Read, Binding::Read, Binding::Read, Binding::Write];
        let pipeline = |entry: &'static str| {
            let link = Link { root: "//: use relight::product", features, mutations: &[] };
            gpu.pipeline(PipelineKey { name: name.into(), entry }, link, &bindings)
        };
        let (rows, columns) = (pipeline("tiles_rows")?, pipeline("tiles_columns")?);
        let layers = matrices.len() as u32;
        let parts = parts(matrices, gpu.binding_bytes())?;
        let mut made = Self { dispatches: Vec::new(), bytes: 0, parts: parts.len() };
        // Rows of a part before its columns, parts in order: so sums are in core's order.
        for Part { first, count, codes, rows: row_list, columns: column_list } in parts {
            let shape = gpu.uniform("part of tiles", &[first as u32, count as u32, 0, 0]);
            let code_buffer = gpu.upload("codes of tiles", &codes)?;
            for (pipeline, list, count) in [(&rows, row_list, count), (&columns, column_list, first + count)]
            {
                let List { starts, heads } = list;
                let starts = gpu.upload("starts of tiles", &starts)?;
                let heads_buffer = gpu.upload("heads of tiles", heads.as_flattened())?;
                let group = gpu.bind(pipeline, &[&shape, &code_buffer, &starts, &heads_buffer, x, y]);
                let [gx, gy] = spread(gpu, count as u32);
                let groups = [gx, gy, layers];
                made.dispatches.push(Dispatch { pipeline: pipeline.clone(), group, groups });
                made.bytes += code_buffer.raw.size() + heads_buffer.raw.size();
            }
        }
        Ok(made)
    }

    pub(super) fn encode(&self, pass: &mut wgpu::ComputePass<'_>) {
        for dispatch in &self.dispatches {
            dispatch.encode(pass);
        }
    }
}
