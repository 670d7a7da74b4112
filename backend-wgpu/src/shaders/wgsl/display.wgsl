// Pixels as a display shows them: three words each of linear light come in, packed bytes (red lowest, alpha 255) or three floats go out.
//: use tone

struct DisplayJob {
    map: u32,
    exposure: f32,
    gamma_a: f32,
    gamma_c: f32,
    gamma: f32,
    // Pixels of a row, and words of a row of packed bytes.
    width: u32,
    row: u32,
    // For `math_opaque`.
    zero: u32,
}

@group(0) @binding(0) var<uniform> job: DisplayJob;
@group(0) @binding(1) var<storage, read> light: array<u32>;
@group(0) @binding(2) var<storage, read_write> shown: array<u32>;

fn display_pixel(i: u32) -> vec3<f32> { return bitcast<vec3<f32>>(vec3(light[3u * i], light[3u * i + 1u], light[3u * i + 2u])); }

fn display_settings() -> ToneSettings {
    return ToneSettings(job.map, job.exposure, job.gamma_a, job.gamma_c, job.gamma);
}

@compute @workgroup_size(64)
fn packed(@builtin(global_invocation_id) id: vec3<u32>) {
    //: if REORDERED
    math_opaque = job.zero;
    //: end
    if id.x >= job.width { return; }
    //: if REORDERED
    math_opaque = job.zero;
    //: end
    let rgb = tone_display_srgb8(display_settings(), display_pixel(id.y * job.width + id.x));
    shown[id.y * job.row + id.x] = rgb.x | rgb.y << 8u | rgb.z << 16u | 0xff000000u;
}

@compute @workgroup_size(64)
fn floats(@builtin(global_invocation_id) id: vec3<u32>) {
    //: if REORDERED
    math_opaque = job.zero;
    //: end
    if id.x >= job.width { return; }
    //: if REORDERED
    math_opaque = job.zero;
    //: end
    let i = id.y * job.width + id.x;
    let v = tone_display(display_settings(), display_pixel(i));
    shown[3u * i] = bitcast<u32>(v.x);
    shown[3u * i + 1u] = bitcast<u32>(v.y);
    shown[3u * i + 2u] = bitcast<u32>(v.z);
}
