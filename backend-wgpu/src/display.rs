//! Tone mapping on the device: core's [`tone`](etendue_core::tone), for pixels that come back, and for a texture that a host presents.

use crate::WgpuBackend;
use crate::gpu::{Binding, Buffer, Gpu, Pipeline, PipelineKey};
use crate::shaders::Link;
use etendue_core::backend::BackendError;
use etendue_core::tone::{ToneMap, ToneSettings};
use std::sync::Arc;

/// Invocations of a workgroup, as the shader has it.
const WORKGROUP: u32 = 64;
/// Pixels of one submission.
const SLICE: u64 = 1 << 20;
/// Words of a pixel's light.
const WORDS: u64 = 3;
/// Rows of a buffer that is copied to a texture begin at multiples of so many words.
const ROW: u32 = wgpu::COPY_BYTES_PER_ROW_ALIGNMENT / 4;

fn pipeline(gpu: &Gpu, entry: &'static str) -> Result<Arc<Pipeline>, BackendError> {
    let link = Link { root: "//: use display\n", features: &[], mutations: &[] };
    let bindings = [Binding::Uniform, Binding::Read, Binding::Write];
    gpu.pipeline(PipelineKey { name: "display".into(), entry }, link, &bindings)
}

/// What the shader knows of a job: rows of `width` pixels, `row` words of packed bytes each.
fn words(s: &ToneSettings, width: u32, row: u32) -> [u32; 8] {
    let map = match s.map {
        ToneMap::Reinhard => 0,
        ToneMap::Gamma => 1,
        ToneMap::None => 2,
    };
    let [exposure, a, c, gamma] = [s.exposure, s.gamma_a, s.gamma_c, s.gamma].map(f32::to_bits);
    [map, exposure, a, c, gamma, width, row, 0]
}

fn dispatch(
    encoder: &mut wgpu::CommandEncoder,
    pipeline: &Pipeline,
    group: &wgpu::BindGroup,
    [width, height]: [u32; 2],
) {
    let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
    pass.set_pipeline(&pipeline.raw);
    pass.set_bind_group(0, group, &[]);
    pass.dispatch_workgroups(width.div_ceil(WORKGROUP), height, 1);
}

/// Maps pixels in slices; `each` words of a result.
fn map(
    gpu: &Gpu,
    entry: &'static str,
    each: u64,
    settings: &ToneSettings,
    pixels: &[[f32; 3]],
    mut take: impl FnMut(&[u32]),
) -> Result<(), BackendError> {
    let pipeline = pipeline(gpu, entry)?;
    let slice = SLICE.min(gpu.binding_bytes() / (4 * WORDS)).min(gpu.dispatch_items(WORKGROUP));
    gpu.scoped(|| {
        for pixels in pixels.chunks((slice as usize).max(1)) {
            let count = pixels.len() as u32;
            let uniform = gpu.uniform("tone", &words(settings, count, count));
            let light = gpu.upload("light", bytemuck::cast_slice(pixels.as_flattened()))?;
            let shown = gpu.room("shown", each * u64::from(count))?;
            let group = gpu.bind(&pipeline, &[&uniform, &light, &shown]);
            let mut encoder = gpu.encoder();
            dispatch(&mut encoder, &pipeline, &group, [count, 1]);
            take(&gpu.submit_and_read(encoder, &shown, each * u64::from(count)).wait(gpu)?);
        }
        Ok(())
    })
}

impl WgpuBackend {
    /// The bytes of a PNG for each pixel of linear light: [`display_srgb8`](etendue_core::tone::display_srgb8) on the device.
    ///
    /// # Errors
    /// The device's.
    pub fn tone_map(
        &self,
        settings: &ToneSettings,
        pixels: &[[f32; 3]],
    ) -> Result<Vec<[u8; 3]>, BackendError> {
        self.source.run(|gpu| {
            let mut out = Vec::with_capacity(pixels.len());
            map(gpu, "packed", 1, settings, pixels, |words| {
                out.extend(words.iter().map(|word| {
                    let [r, g, b, _] = word.to_le_bytes();
                    [r, g, b]
                }));
            })?;
            Ok(out)
        })
    }

    /// Display values on \[0, 1\] for each pixel of linear light: [`display`](etendue_core::tone::display) on the device.
    ///
    /// # Errors
    /// The device's.
    pub fn tone_map_floats(
        &self,
        settings: &ToneSettings,
        pixels: &[[f32; 3]],
    ) -> Result<Vec<[f32; 3]>, BackendError> {
        self.source.run(|gpu| {
            let mut out = Vec::with_capacity(pixels.len());
            map(gpu, "floats", WORDS, settings, pixels, |words| {
                out.extend(words.as_chunks::<3>().0.iter().map(|rgb| rgb.map(f32::from_bits)));
            })?;
            Ok(out)
        })
    }

    /// A picture on the device for a host that presents it, black at first.
    ///
    /// # Errors
    /// [`BackendError::LimitExceeded`] where the device has no texture or buffer so large.
    pub fn picture(&self, size: [u32; 2]) -> Result<Picture, BackendError> {
        self.source.run(|gpu| Picture::new(gpu, size))
    }
}

/// A picture on the device: a texture that a host presents, and what fills it anew for each frame.
///
/// If the device is lost, so is the picture.
#[derive(Debug)]
pub struct Picture {
    gpu: Arc<Gpu>,
    size: [u32; 2],
    pipeline: Arc<Pipeline>,
    uniform: Buffer,
    light: Buffer,
    shown: Buffer,
    group: wgpu::BindGroup,
    texture: wgpu::Texture,
}

impl Picture {
    fn new(gpu: &Arc<Gpu>, size: [u32; 2]) -> Result<Self, BackendError> {
        let [width, height] = size;
        let limits = &gpu.limits;
        let most = limits.max_texture_dimension_2d.min(limits.max_compute_workgroups_per_dimension);
        if width.max(height) > most {
            let (asked, allowed) = (width.max(height).into(), most.into());
            return Err(BackendError::LimitExceeded {
                what: "pixels of a side of a picture",
                asked,
                allowed,
            });
        }
        let pipeline = pipeline(gpu, "packed")?;
        gpu.scoped(|| {
            let uniform = gpu.uniform("tone", &[0; 8]);
            let light = gpu.room("light", WORDS * u64::from(width) * u64::from(height))?;
            let shown = gpu.room("shown", u64::from(width.next_multiple_of(ROW)) * u64::from(height))?;
            let group = gpu.bind(&pipeline, &[&uniform, &light, &shown]);
            // Views of another format are not for every device.
            let texture = gpu.scoped(|| Ok(texture(gpu, size, &[wgpu::TextureFormat::Rgba8UnormSrgb])));
            let texture = match texture {
                Ok(texture) => texture,
                Err(_) => self::texture(gpu, size, &[]),
            };
            Ok(Self { gpu: gpu.clone(), size, pipeline, uniform, light, shown, group, texture })
        })
    }

    /// Display values as bytes, already encoded, alpha 255. Where the device has such views, one of the format `Rgba8UnormSrgb` reads them as linear light, for
    /// targets that encode themselves.
    pub fn texture(&self) -> &wgpu::Texture {
        &self.texture
    }

    /// The same bytes in a buffer, and its bytes per row.
    pub fn buffer(&self) -> (&wgpu::Buffer, u32) {
        (&self.shown.raw, 4 * self.size[0].next_multiple_of(ROW))
    }

    /// Columns and rows.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Fills the picture with pixels, row by row; those that are missing are as they were. The queue takes the work; nothing is waited for.
    ///
    /// # Errors
    /// The device's.
    pub fn show(&self, settings: &ToneSettings, pixels: &[[f32; 3]]) -> Result<(), BackendError> {
        self.gpu.scoped(|| {
            let count = pixels.len().min(self.size[0] as usize * self.size[1] as usize);
            if count > 0 {
                let words = bytemuck::cast_slice(pixels[..count].as_flattened());
                self.gpu.queue.write_buffer(&self.light.raw, 0, words);
            }
            self.fill(settings, &self.group);
            Ok(())
        })
    }

    /// The same with pixels that are on the device already: three floats each, in a buffer with the usage `STORAGE`.
    ///
    /// # Errors
    /// The device's: a buffer of another device, or without that usage.
    pub fn show_buffer(&self, settings: &ToneSettings, pixels: &wgpu::Buffer) -> Result<(), BackendError> {
        self.gpu.scoped(|| {
            let buffers = [&self.uniform.raw, pixels, &self.shown.raw];
            let group = self.gpu.bind_all(&self.pipeline, &buffers.map(wgpu::Buffer::as_entire_binding));
            self.fill(settings, &group);
            Ok(())
        })
    }

    fn fill(&self, settings: &ToneSettings, group: &wgpu::BindGroup) {
        let [width, height] = self.size;
        if width == 0 || height == 0 {
            return;
        }
        let row = width.next_multiple_of(ROW);
        let words = words(settings, width, row);
        self.gpu.queue.write_buffer(&self.uniform.raw, 0, bytemuck::cast_slice(&words));
        let mut encoder = self.gpu.encoder();
        dispatch(&mut encoder, &self.pipeline, group, self.size);
        let from = wgpu::TexelCopyBufferInfo {
            buffer: &self.shown.raw,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(4 * row),
                rows_per_image: None,
            },
        };
        encoder.copy_buffer_to_texture(from, self.texture.as_image_copy(), extent(self.size));
        self.gpu.submit(encoder);
    }
}

fn texture(gpu: &Gpu, [width, height]: [u32; 2], views: &[wgpu::TextureFormat]) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("picture"),
        size: extent([width.max(1), height.max(1)]),
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_DST
            | wgpu::TextureUsages::COPY_SRC,
        view_formats: views,
    })
}

fn extent([width, height]: [u32; 2]) -> wgpu::Extent3d {
    wgpu::Extent3d { width, height, depth_or_array_layers: 1 }
}
