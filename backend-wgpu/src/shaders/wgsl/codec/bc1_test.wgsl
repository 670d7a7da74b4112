// What the device makes of blocks in a texture: a word of bytes for each texel, 0xAABBGGRR.
//: use codec::bc1_texture

struct Bc1Test { texels: u32, side: u32, pad0: u32, pad1: u32 }

@group(0) @binding(0) var<uniform> bc1_test: Bc1Test;
@group(0) @binding(1) var bc1_blocks: texture_2d_array<f32>;
// How many texels are between two bytes; then the texels.
@group(0) @binding(2) var<storage, read_write> found: array<atomic<u32>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= bc1_test.texels { return; }
    let scaled = 255.0f * bc1_texture_load(bc1_blocks, id.x / 16u, id.x % 16u, bc1_test.side);
    let bytes = vec4<u32>(scaled + 0.5f);
    // What is no byte, or none at all, is far from each.
    if !all(abs(scaled - vec4<f32>(bytes)) < vec4(1.0f / 64.0f)) { atomicAdd(&found[0], 1u); }
    let word = (bytes.x & 255u) | (bytes.y & 255u) << 8u | (bytes.z & 255u) << 16u | (bytes.w & 255u) << 24u;
    atomicStore(&found[1u + id.x], word);
}
