// The tree as it lies in buffers. Blocks are in two, since one binding may be too small for them.
//: use geometry::shape
//: use scene::arrays

@group(0) @binding(2) var<storage, read> nodes: array<vec4<u32>>;
@group(0) @binding(3) var<storage, read> blocks: array<vec4<u32>>;
@group(0) @binding(4) var<storage, read> more_blocks: array<vec4<u32>>;

fn tree_root() -> u32 { return scene_at.tree_root; }

fn tree_first_shape() -> u32 { return scene_at.triangle_count; }

fn tree_words(block: u32, at: u32) -> vec4<u32> {
    if block < scene_at.first_blocks { return blocks[block * 20u + at]; }
    return more_blocks[(block - scene_at.first_blocks) * 20u + at];
}

// Coordinates of four of the eight triangles.
fn tree_row(block: u32, row: u32, part: u32) -> vec4<f32> {
    return bitcast<vec4<f32>>(tree_words(block, 2u * row + part));
}

fn tree_ids(block: u32, part: u32) -> vec4<u32> { return tree_words(block, 18u + part); }

fn tree_shape(i: u32) -> RoundShape {
    let at = scene_at.shapes + 8u * i;
    return RoundShape(scene_word(at), scene_float(at + 1u), scene_triple(at + 2u), scene_triple(at + 5u));
}
