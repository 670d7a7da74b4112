// The compiled scene as it lies in buffers: records in one arena; texels in two, and behind them the values of grids. SceneOffsets, in
// words of the arena, is made by the host.

@group(0) @binding(0) var<uniform> scene_at: SceneOffsets;
@group(0) @binding(5) var<storage, read> scene_arena: array<u32>;
@group(0) @binding(6) var<storage, read> texels: array<u32>;
@group(0) @binding(9) var<storage, read> more_texels: array<u32>;

const NO_INDEX: u32 = 0xffffffffu;

fn scene_word(i: u32) -> u32 { return scene_arena[i]; }

fn scene_float(i: u32) -> f32 { return bitcast<f32>(scene_arena[i]); }

fn scene_triple(i: u32) -> vec3<f32> { return vec3(scene_float(i), scene_float(i + 1u), scene_float(i + 2u)); }

fn texel(i: u32) -> u32 {
    if i < scene_at.first_texels { return texels[i]; }
    return more_texels[i - scene_at.first_texels];
}

//: if GRIDS
fn grid_value(i: u32) -> f32 { return bitcast<f32>(texel(scene_at.grid_values + i)); }
//: end
