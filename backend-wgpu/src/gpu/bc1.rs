//! Textures of BC1, and how a device decodes them: the format leaves the rounding open, and some drivers that have the feature decode
//! nothing at all. So the device is tried, once, with blocks that tell all known rules apart.

use super::{Binding, Gpu, PipelineKey};
use crate::shaders::Link;
use etendue_core::backend::BackendError;
use etendue_core::codec::bc1::{Block, Rule, decode_with};

/// How a device decodes textures of BC1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bc1Texture {
    /// It has none.
    Missing,
    /// By a rule that core knows, to the last bit of every texel that was tried.
    Rule(Rule),
    /// By none of them, if at all: blocks are decoded by hand there.
    Wrong,
}

/// Invocations of a workgroup, as the shader has it.
const WORKGROUP: u32 = 64;
/// Blocks that are tried: each pair of green codes in either mode.
const TRIED: u32 = 2 * 64 * 64;

/// A block that is hard to decode: each pair of green codes occurs with four colours and with three, and so do the pairs of red and of blue codes
/// that can. Indices differ from texel to texel, and all four occur.
fn hard(i: u32) -> Block {
    let (four, pair) = (i & 1 == 1, i >> 1);
    let (green, other) = ([pair >> 6, pair & 63], pair.wrapping_mul(0x9e37_79b1) >> 12);
    // Red is highest in the words that choose the mode.
    let (low, high) = ((pair & 31).min(pair >> 5 & 31), (pair & 31).max(pair >> 5 & 31));
    let red = match (four, low == high) {
        (true, false) => [high, low],
        (true, true) => [low.max(1), low.max(1) - 1],
        // Of equal codes green decides.
        (false, true) if green[0] >= green[1] => [low.max(1) - 1, low.max(1)],
        (false, _) => [low, high],
    };
    let blue = [pair >> 7 & 31, (pair >> 1 ^ other) & 31];
    let word = |k: usize| (red[k] << 11 | green[k] << 5 | blue[k]) as u16;
    let ([a, b], [c, d]) = (word(0).to_le_bytes(), word(1).to_le_bytes());
    // The first row has all four indices.
    let [f, g, h, _] = other.to_le_bytes();
    [a, b, c, d, 0b11_10_01_00_u8.rotate_left(2 * (i >> 1 & 3)), f, g, h]
}

/// Blocks in a texture.
#[derive(Debug)]
pub(crate) struct BlockTexture {
    pub(crate) view: wgpu::TextureView,
    /// Blocks along either edge of a layer.
    pub(crate) side: u32,
}

impl Gpu {
    /// Blocks as a texture, in rows and then layers (`codec/bc1_texture.wgsl` finds them).
    pub(crate) fn bc1_blocks(
        &self,
        label: &'static str,
        blocks: &[Block],
    ) -> Result<BlockTexture, BackendError> {
        let most = u64::from(self.limits.max_texture_dimension_2d / 4).max(1);
        // Two layers at least: wgpu makes no array of one on GL.
        let side = (1..most).find(|s| 2 * s * s >= blocks.len() as u64).unwrap_or(most);
        let layers = (blocks.len() as u64).div_ceil(side * side).max(2);
        let allowed = u64::from(self.limits.max_texture_array_layers);
        if layers > allowed {
            let (asked, allowed) = (blocks.len() as u64, side * side * allowed);
            return Err(BackendError::LimitExceeded { what: "blocks in one texture", asked, allowed });
        }
        let edge = 4 * side as u32;
        let size = wgpu::Extent3d { width: edge, height: edge, depth_or_array_layers: layers as u32 };
        let texture = self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Bc1RgbaUnorm,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let mut bytes = blocks.as_flattened().to_vec();
        bytes.resize((8 * side * side * layers) as usize, 0);
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(8 * side as u32),
            rows_per_image: Some(side as u32),
        };
        self.queue.write_texture(texture.as_image_copy(), &bytes, layout, size);
        let view = texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..wgpu::TextureViewDescriptor::default()
        });
        Ok(BlockTexture { view, side: side as u32 })
    }

    /// How this device decodes textures of BC1; tried once.
    pub(crate) fn bc1_texture(&self) -> Result<Bc1Texture, BackendError> {
        if let Some(known) = self.bc1.get() {
            return Ok(*known);
        }
        let found = if self.device.features().contains(wgpu::Features::TEXTURE_COMPRESSION_BC) {
            self.try_bc1()?
        } else {
            Bc1Texture::Missing
        };
        Ok(*self.bc1.get_or_init(|| found))
    }

    fn try_bc1(&self) -> Result<Bc1Texture, BackendError> {
        let blocks: Vec<Block> = (0..TRIED).map(hard).collect();
        // One word for all, and one a texel.
        let room = (self.binding_bytes() / 4).saturating_sub(1) / 16;
        let mut texels = Vec::new();
        for blocks in blocks.chunks((room as usize).clamp(1, blocks.len())) {
            let words = self.decoded(blocks)?;
            match words.split_first() {
                Some((0, decoded)) => texels.extend_from_slice(decoded),
                _ => return Ok(Bc1Texture::Wrong),
            }
        }
        let follows = |rule: &Rule| {
            let expected = blocks.iter().flat_map(|b| decode_with(*b, *rule)).map(u32::from_le_bytes);
            texels.iter().copied().eq(expected)
        };
        Ok(Rule::ALL.into_iter().find(follows).map_or(Bc1Texture::Wrong, Bc1Texture::Rule))
    }

    /// How many texels of these blocks are no bytes, and their bytes.
    fn decoded(&self, blocks: &[Block]) -> Result<Vec<u32>, BackendError> {
        let key = PipelineKey { name: "bc1_test".into(), entry: "main" };
        let link = Link { root: "//: use codec::bc1_test\n", features: &[], mutations: &[] };
        let pipeline = self.pipeline(key, link, &[Binding::Uniform, Binding::Texture, Binding::Write])?;
        self.scoped(|| {
            let texture = self.bc1_blocks("hard blocks", blocks)?;
            let texels = 16 * blocks.len() as u32;
            let uniform = self.uniform("hard blocks", &[texels, texture.side, 0, 0]);
            let found = self.room("decoded blocks", 1 + u64::from(texels))?;
            let resources = [
                uniform.raw.as_entire_binding(),
                wgpu::BindingResource::TextureView(&texture.view),
                found.raw.as_entire_binding(),
            ];
            let group = self.bind_all(&pipeline, &resources);
            let mut encoder = self.encoder();
            {
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
                pass.set_pipeline(&pipeline.raw);
                pass.set_bind_group(0, &group, &[]);
                pass.dispatch_workgroups(texels.div_ceil(WORKGROUP), 1, 1);
            }
            self.submit_and_read(encoder, &found, 1 + u64::from(texels)).wait(self)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn hard_blocks_tell_the_rules_apart() {
        let blocks: Vec<Block> = (0..TRIED).map(hard).collect();
        let mut pairs: [HashSet<(bool, u32, u32)>; 3] = Default::default();
        for block in &blocks {
            let [a, b] = [0, 2].map(|i| u32::from(u16::from_le_bytes([block[i], block[i + 1]])));
            for (c, shift, mask) in [(0, 11, 31), (1, 5, 63), (2, 0, 31)] {
                pairs[c].insert((a > b, a >> shift & mask, b >> shift & mask));
            }
            let indices: HashSet<u8> = (0..4).map(|i| block[4] >> (2 * i) & 3).collect();
            assert_eq!(indices.len(), 4);
        }
        // Of red all that the mode allows: a pair of equal codes can have either by the others alone.
        let of = |c: usize, four: bool| pairs[c].iter().filter(|p| p.0 == four).count();
        assert_eq!([of(1, true), of(1, false)], [4096, 4096]);
        assert!(of(0, true) >= 496 && of(0, false) >= 520, "{} {}", of(0, true), of(0, false));
        assert!(of(2, true) > 900 && of(2, false) > 900, "{} {}", of(2, true), of(2, false));
        for a in Rule::ALL {
            for b in Rule::ALL.into_iter().filter(|b| *b != a) {
                let differ = blocks.iter().any(|x| decode_with(*x, a) != decode_with(*x, b));
                assert!(differ, "{a:?} {b:?}");
            }
        }
    }
}
