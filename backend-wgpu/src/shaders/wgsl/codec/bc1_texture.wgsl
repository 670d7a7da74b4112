// Blocks of BC1 in a texture, which the device decodes. They fill rows of blocks, then layers, in their order.

// Texel i of a block, red, green, blue, alpha of [0, 1], in a texture of `side` blocks along either edge.
fn bc1_texture_load(blocks: texture_2d_array<f32>, block: u32, i: u32, side: u32) -> vec4<f32> {
    let within = block % (side * side);
    let at = 4u * vec2(within % side, within / side) + vec2(i & 3u, i >> 2u);
    return textureLoad(blocks, at, block / (side * side), 0);
}
