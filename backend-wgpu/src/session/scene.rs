//! A scene in the device's buffers: one arena of records, the tree, and the texels with the values of grids behind them.

use crate::gpu::{Buffer, Gpu};
use bytemuck::{Pod, Zeroable};
use etendue_core::backend::BackendError;
use etendue_core::scene::{CoatRecord, CompiledScene};
use etendue_core::transport::volume::LightMedia;
use etendue_tree::layout::{Block, NOTHING, Node};
use etendue_tree::{WideTree, layout};
use std::borrow::Cow;

/// Whether it is known what a light sends into, wherever on it, and that; or what lies around the scene.
pub(super) fn light_media_words(media: &LightMedia, light: usize) -> [u32; 4] {
    let known = media.all_over(light);
    let [a, b, c] = known.unwrap_or(media.outside()).packed();
    [u32::from(known.is_some()), a, b, c]
}

macro_rules! offsets {
    ($($(#[$doc:meta])* $field:ident,)*) => {
        /// Where things are, in words of the arena; how many; and what else shaders ask of the scene. A uniform.
        #[repr(C)]
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
        pub(crate) struct SceneOffsets {
            $($(#[$doc])* pub(crate) $field: u32,)*
        }

        /// The same for shaders.
        pub(crate) const OFFSETS: &str =
            concat!("struct SceneOffsets {\n", $("    ", stringify!($field), ": u32,\n",)* "}\n");
    };
}

offsets! {
    /// The root as a child word of the tree.
    tree_root,
    /// Blocks in the first of the two buffers.
    first_blocks,
    /// Texels in the first of the two buffers.
    first_texels,
    positions,
    triangles,
    triangle_count,
    shapes,
    surfaces,
    materials,
    texcoords,
    texcoord_count,
    normals,
    normal_count,
    textures,
    texture_count,
    checkers,
    checker_count,
    coats,
    coat_count,
    coat_words,
    srgb_decode,
    lights,
    light_count,
    light_cumulative,
    /// Radiance of the constant environment, three floats.
    environment,
    /// The picture of the environment; its width is 0 where there is none.
    environment_width,
    environment_height,
    environment_light,
    environment_to_world,
    environment_texels,
    environment_rows,
    environment_row_count,
    environment_starts,
    environment_columns,
    media,
    grids,
    /// Behind the texels.
    grid_values,
    /// Nodes of the tree of crossings, how many, and the entries of its leaves.
    crossings,
    crossing_count,
    crossing_order,
    camera,
}

const _: () = assert!(size_of::<Node>() == 256 && size_of::<Block>() == 320);

/// Words in the order in which they came.
#[derive(Default)]
struct Arena(Vec<u32>);

impl Arena {
    fn add<T: Pod>(&mut self, items: &[T]) -> u32 {
        let at = self.0.len() as u32;
        self.0.extend_from_slice(bytemuck::cast_slice(items));
        at
    }
}

fn arena(scene: &CompiledScene) -> (Vec<u32>, SceneOffsets) {
    let mut a = Arena::default();
    let mut o = SceneOffsets {
        positions: a.add(&scene.positions),
        triangles: a.add(&scene.triangles),
        triangle_count: scene.triangles.len() as u32,
        shapes: a.add(&scene.shapes),
        surfaces: a.add(&scene.surfaces),
        materials: a.add(&scene.materials),
        texcoords: a.add(&scene.texcoords),
        texcoord_count: scene.texcoords.len() as u32,
        normals: a.add(&scene.normals),
        normal_count: scene.normals.len() as u32,
        textures: a.add(&scene.textures),
        texture_count: scene.textures.len() as u32,
        checkers: a.add(&scene.checkers),
        checker_count: scene.checkers.len() as u32,
        coats: a.add(&scene.coats),
        coat_count: scene.coats.len() as u32,
        coat_words: (size_of::<CoatRecord>() / 4) as u32,
        srgb_decode: a.add(&scene.srgb_decode),
        lights: a.add(&scene.lights),
        light_count: scene.lights.len() as u32,
        light_cumulative: a.add(&scene.light_cumulative),
        environment: a.add(&scene.environment),
        media: a.add(&scene.media),
        grids: a.add(&scene.grids),
        grid_values: scene.texels.len() as u32,
        crossing_order: a.add(scene.crossings.order()),
        ..SceneOffsets::default()
    };
    let crossings: Vec<_> = scene.crossings.node_words().collect();
    o.crossing_count = crossings.len() as u32;
    o.crossings = a.add(&crossings);
    if let Some(map) = &scene.environment_map {
        o.environment_width = map.width;
        o.environment_height = map.height;
        o.environment_light = map.light;
        o.environment_to_world = a.add(&map.to_world);
        o.environment_texels = a.add(&map.texels);
        o.environment_rows = a.add(&map.rows);
        o.environment_row_count = map.rows.len() as u32;
        o.environment_starts = a.add(&map.starts);
        o.environment_columns = a.add(&map.columns);
    }
    if let Some(camera) = &scene.camera {
        o.camera = a.add(std::slice::from_ref(camera));
    }
    (a.0, o)
}

/// Entries by which stacks differ.
const STACK_STEP: usize = 16;

/// What jobs on a scene bind.
#[derive(Debug)]
pub(crate) struct SceneBuffers {
    pub(crate) offsets: Buffer,
    pub(crate) nodes: Buffer,
    pub(crate) blocks: [Buffer; 2],
    pub(crate) arena: Buffer,
    pub(crate) texels: [Buffer; 2],
    /// Entries of a walk's stack.
    pub(crate) stack: usize,
}

/// Nodes and blocks as words; both are plain numbers without padding.
fn node_words(nodes: &[Node]) -> Vec<u32> {
    let mut words = Vec::with_capacity(64 * nodes.len());
    for n in nodes {
        words.extend(n.rows.as_flattened().iter().map(|x| x.to_bits()));
        words.extend(n.child);
        words.extend(n.pad);
    }
    words
}

fn block_words(blocks: &[Block]) -> Vec<u32> {
    let mut words = Vec::with_capacity(80 * blocks.len());
    for b in blocks {
        words.extend(b.rows.as_flattened().iter().map(|x| x.to_bits()));
        words.extend(b.id);
    }
    words
}

/// Texels, and behind them the values of grids.
fn texels(scene: &CompiledScene) -> Cow<'_, [u32]> {
    let values: &[u32] = bytemuck::cast_slice(&scene.grid_values);
    match (scene.texels.is_empty(), values.is_empty()) {
        (_, true) => Cow::Borrowed(&scene.texels),
        (true, _) => Cow::Borrowed(values),
        _ => Cow::Owned([&scene.texels, values].concat()),
    }
}

/// How many items of so many bytes go into the first of two buffers; an error where both are too small.
fn split(what: &'static str, count: usize, each: usize, allowed: u64) -> Result<usize, BackendError> {
    let fit = (allowed / each as u64) as usize;
    if count > 2 * fit {
        let asked = count as u64 * each as u64;
        return Err(BackendError::LimitExceeded { what, asked, allowed: 2 * allowed });
    }
    Ok(count.min(fit))
}

/// What a scene takes of a device, found out before anything is sent.
pub(crate) fn plan(gpu: &Gpu, scene: &CompiledScene, tree: &WideTree) -> Result<[usize; 2], BackendError> {
    let allowed = gpu.binding_bytes();
    let parts = tree.parts();
    let single = |what: &'static str, asked: u64| {
        if asked <= allowed { Ok(()) } else { Err(BackendError::LimitExceeded { what, asked, allowed }) }
    };
    single("bytes for the nodes of the tree in one binding", 256 * parts.nodes.len() as u64)?;
    single("bytes for the records of the scene in one binding", 4 * arena(scene).0.len() as u64)?;
    let blocks = split("bytes for the triangles in two bindings", parts.blocks.len(), 320, allowed)?;
    let texels = scene.texels.len() + scene.grid_values.len();
    let texels = split("bytes for the texels and the values of grids in two bindings", texels, 4, allowed)?;
    Ok([blocks, texels])
}

impl SceneBuffers {
    pub(crate) fn new(gpu: &Gpu, scene: &CompiledScene, tree: &WideTree) -> Result<Self, BackendError> {
        let [first_blocks, first_texels] = plan(gpu, scene, tree)?;
        let parts = tree.parts();
        let (words, mut offsets) = arena(scene);
        // A reader cannot tell an empty array from one of zeros.
        let is_empty = parts.nodes.is_empty() && parts.root & layout::LEAF == 0;
        offsets.tree_root = if is_empty { NOTHING } else { parts.root };
        offsets.first_blocks = first_blocks as u32;
        offsets.first_texels = first_texels as u32;
        let (low, high) = parts.blocks.split_at(first_blocks);
        let texels = texels(scene);
        let (near, far) = texels.split_at(first_texels);
        gpu.scoped(|| {
            Ok(Self {
                offsets: gpu.uniform("scene", bytemuck::cast_slice(std::slice::from_ref(&offsets))),
                nodes: gpu.upload("nodes", &node_words(parts.nodes))?,
                blocks: [
                    gpu.upload("blocks", &block_words(low))?,
                    gpu.upload("more blocks", &block_words(high))?,
                ],
                arena: gpu.upload("arena", &words)?,
                texels: [gpu.upload("texels", near)?, gpu.upload("more texels", far)?],
                // What the depth asks for, in steps: scenes of about the same depth share their pipelines.
                stack: (7 * parts.depth.saturating_sub(1) + 8).next_multiple_of(STACK_STEP),
            })
        })
    }
}
