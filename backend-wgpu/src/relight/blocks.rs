//! Core's operator in texture blocks on the device.

use super::blocks_layout::{Part, cut, row_start};
use super::product::Dispatch;
use super::{ANOTHER, SUBMIT_BYTES, spread, words};
use crate::gpu::{Bc1Texture, Binding, BlockTexture, Buffer, Gpu, PipelineKey};
use crate::shaders::Link;
use etendue_core::backend::BackendError;
use etendue_core::codec::bc1::{Block, Rule};
use etendue_core::radiosity::Identity;
use etendue_core::radiosity::blocks::{
    BlockError, BlockOperator, Entries, Format, Parts, Quad, SIDE, block_rows,
};
use std::sync::{Arc, Mutex, PoisonError};

/// Invocations of a workgroup, and rows of blocks.
const WORKGROUP: u32 = 64;
const GROUP_ROWS: u32 = 4;

/// An operator in blocks that is on the device, with room for one relighting at a time.
#[derive(Debug)]
pub struct BlocksOperator {
    gpu: Arc<Gpu>,
    identity: Identity,
    rows: usize,
    product: Vec<Dispatch>,
    parts: usize,
    bytes: u64,
    first: Dispatch,
    next: Dispatch,
    last: Dispatch,
    start: Buffer,
    y: Buffer,
    /// Start and y are one job's at a time.
    turn: Mutex<()>,
}

/// Who decodes blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Decoder {
    /// The shader: by core's rule on every device.
    Shader,
    /// The device, of a texture.
    Texture,
}

impl Decoder {
    /// A texture where the device follows the rule by which operators are made.
    pub(super) fn of(gpu: &Gpu, operator: &BlockOperator) -> Result<Self, BackendError> {
        if operator.parts().format == Format::Bc1 && gpu.bc1_texture()? == Bc1Texture::Rule(Rule::Nearest) {
            return Ok(Self::Texture);
        }
        Ok(Self::Shader)
    }
}

/// Blocks of a part.
enum Stored {
    Words(Buffer),
    Texture(BlockTexture),
}

impl Stored {
    fn new(gpu: &Gpu, blocks: &[Block], decoder: Decoder) -> Result<Self, BackendError> {
        Ok(match decoder {
            Decoder::Shader => {
                let words: Vec<u32> = bytemuck::pod_collect_to_vec(blocks.as_flattened());
                Self::Words(gpu.upload("blocks", &words)?)
            }
            Decoder::Texture => Self::Texture(gpu.bc1_blocks("blocks", blocks)?),
        })
    }

    fn resource(&self) -> wgpu::BindingResource<'_> {
        match self {
            Self::Words(buffer) => buffer.raw.as_entire_binding(),
            Self::Texture(texture) => wgpu::BindingResource::TextureView(&texture.view),
        }
    }

    fn side(&self) -> u32 {
        match self {
            Self::Words(_) => 0,
            Self::Texture(texture) => texture.side,
        }
    }
}

/// What the shader is made for.
fn features(parts: &Parts, decoder: Decoder) -> Vec<&'static str> {
    let mut features = Vec::new();
    if decoder == Decoder::Texture {
        features.push("TEXTURE");
    }
    if parts.format == Format::Bc4 {
        features.push("BC4");
    }
    if matches!(parts.entries, Entries::Short { .. }) {
        features.push("SHORT");
    }
    if parts.half {
        features.push("HALF");
    }
    features
}

/// The dispatches of a product, and the bytes that it reads.
fn product(
    gpu: &Gpu,
    operator: &BlockOperator,
    decoder: Decoder,
    cut: &[Part],
    [x, y]: [&Buffer; 2],
) -> Result<(Vec<Dispatch>, u64), BackendError> {
    let parts = operator.parts();
    let features = features(parts, decoder);
    let name = format!("relight::blocks {}", features.join(" "));
    let mut bindings = [Binding::Read; 8];
    (bindings[0], bindings[7]) = (Binding::Uniform, Binding::Write);
    if decoder == Decoder::Texture {
        bindings[2] = Binding::Texture;
    }
    let pipeline = |entry: &'static str| {
        let link = Link { root: "//: use relight::blocks", features: &features, mutations: &[] };
        gpu.pipeline(PipelineKey { name: name.clone(), entry }, link, &bindings)
    };
    let unit = match &parts.entries {
        Entries::Full { .. } => 1.0,
        Entries::Short { unit, .. } => *unit,
    };
    let lookup = gpu.upload("values of sums of endpoints", words(operator.view().lookup))?;
    let (mut dispatches, mut bytes) = (Vec::new(), 0);
    for Part { first, count, row_starts, kept, column_starts, sent } in cut {
        let end = first + count;
        let shape = [block_rows(operator.len()), *first, *count, operator.len()].map(|x| x as u32);
        let blocks = &parts.blocks[row_start(parts, *first)..row_start(parts, end)];
        let stored = Stored::new(gpu, blocks, decoder)?;
        let shape = [&shape[..], &[unit.to_bits(), stored.side(), 0, 0]].concat();
        let shape = gpu.uniform("part of blocks", &shape);
        let kept = gpu.upload("kept entries", kept)?;
        let sent = gpu.upload("kept entries of columns", sent.as_flattened())?;
        let mut add = |entry: &'static str, starts: &[u32], groups: u32| -> Result<(), BackendError> {
            let pipeline = pipeline(entry)?;
            let starts = gpu.upload("starts of kept entries", starts)?;
            let mut resources =
                [&shape, &lookup, &lookup, &starts, &kept, &sent, x, y].map(|b| b.raw.as_entire_binding());
            resources[2] = stored.resource();
            let group = gpu.bind_all(&pipeline, &resources);
            let [gx, gy] = spread(gpu, groups);
            dispatches.push(Dispatch { pipeline, group, groups: [gx, gy, 1] });
            bytes += blocks.as_flattened().len() as u64 + kept.raw.size();
            Ok(())
        };
        // Rows of a part before its columns, parts in order: so sums are in core's order.
        add("blocks_rows", row_starts, (*count as u32).div_ceil(GROUP_ROWS))?;
        if parts.half {
            add("blocks_columns", column_starts, end as u32)?;
        }
    }
    Ok((dispatches, bytes))
}

impl BlocksOperator {
    /// Uploads an operator.
    ///
    /// # Errors
    /// [`BackendError::LimitExceeded`] where a stripe of blocks exceeds a binding; what the device refuses.
    pub(crate) fn new(
        gpu: &Arc<Gpu>,
        operator: &BlockOperator,
        decoder: Decoder,
    ) -> Result<Self, BackendError> {
        gpu.scoped(|| Self::make(gpu, operator, decoder))
    }

    fn make(gpu: &Arc<Gpu>, operator: &BlockOperator, decoder: Decoder) -> Result<Self, BackendError> {
        let view = operator.view();
        let rows = block_rows(operator.len());
        let numbers = (rows * 3 * SIDE) as u64;
        let mut fixed = [view.into.as_flattened(), view.out.as_flattened()].concat();
        fixed.extend(view.albedo.as_flattened().as_flattened());
        let fixed = gpu.upload("fixed numbers of rows", words(&fixed))?;
        let (start, x, y) = (gpu.room("start", numbers)?, gpu.room("x", numbers)?, gpu.room("y", numbers)?);
        let part = gpu.uniform("rows of blocks", &[rows as u32, 0, 0, 0]);
        let step = |entry: &'static str| -> Result<Dispatch, BackendError> {
            let bindings = [Binding::Uniform, Binding::Read, Binding::Read, Binding::Write, Binding::Write];
            let link = Link { root: "//: use relight::blocks_bounce", features: &[], mutations: &[] };
            let key = PipelineKey { name: "relight::blocks_bounce".into(), entry };
            let pipeline = gpu.pipeline(key, link, &bindings)?;
            let group = gpu.bind(&pipeline, &[&part, &fixed, &start, &x, &y]);
            let [gx, gy] = spread(gpu, (3 * rows as u32).div_ceil(WORKGROUP));
            Ok(Dispatch { pipeline, group, groups: [gx, gy, 1] })
        };
        let (first, next, last) = (step("bounce_first")?, step("bounce_next")?, step("bounce_last")?);
        let cut = cut(operator.parts(), gpu.binding_bytes())?;
        let (product, bytes) = product(gpu, operator, decoder, &cut, [&x, &y])?;
        Ok(Self {
            gpu: gpu.clone(),
            identity: operator.identity().clone(),
            rows,
            product,
            parts: cut.len(),
            bytes,
            first,
            next,
            last,
            start,
            y,
            turn: Mutex::new(()),
        })
    }

    /// Whether it is of this operator as it is now.
    pub fn is_of(&self, operator: &BlockOperator) -> bool {
        self.identity.is(operator.identity())
    }

    /// Whether it is on this device.
    pub(crate) fn is_on(&self, gpu: &Arc<Gpu>) -> bool {
        Arc::ptr_eq(&self.gpu, gpu)
    }

    /// How many parts it is in, since a binding has its limit.
    pub fn parts(&self) -> usize {
        self.parts
    }

    /// [`BlockOperator::relight`] of the operator that it was made of.
    ///
    /// # Errors
    /// As there, or of the device.
    pub fn relight(
        &self,
        operator: &BlockOperator,
        light: (&[[f32; 3]], &[[f32; 3]]),
        indirect: &mut [[f32; 3]],
    ) -> Result<(), BlockError> {
        if !self.is_of(operator) {
            return Err(ANOTHER.into());
        }
        let mut start = vec![Quad::default(); self.rows];
        operator.start(light, indirect.len(), &mut start)?;
        let _turn = self.turn.lock().unwrap_or_else(PoisonError::into_inner);
        let words = self.gpu.scoped(|| {
            if !start.is_empty() {
                let start = bytemuck::cast_slice(start.as_flattened().as_flattened());
                self.gpu.queue.write_buffer(&self.start.raw, 0, start);
            }
            let mut encoder = self.gpu.encoder();
            let mut bytes = 0;
            let products = operator.products();
            for product in 0..products {
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
                (if product == 0 { &self.first } else { &self.next }).encode(&mut pass);
                self.product.iter().for_each(|d| d.encode(&mut pass));
                if product + 1 == products {
                    self.last.encode(&mut pass);
                }
                drop(pass);
                bytes += self.bytes;
                if bytes > SUBMIT_BYTES {
                    self.gpu.submit(std::mem::replace(&mut encoder, self.gpu.encoder()));
                    bytes = 0;
                }
            }
            let words = (self.rows * 3 * SIDE) as u64;
            self.gpu.submit_and_read(encoder, &self.y, words).wait(&self.gpu)
        })?;
        let found: Vec<Quad> = bytemuck::pod_collect_to_vec(&words);
        for row in 0..operator.len() {
            if let (Some(to), Some(quad)) = (indirect.get_mut(operator.patch(row)), found.get(row / SIDE)) {
                *to = [0, 1, 2].map(|c| quad[c][row % SIDE]);
            }
        }
        Ok(())
    }
}
