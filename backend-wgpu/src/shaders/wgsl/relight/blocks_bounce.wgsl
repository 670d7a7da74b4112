// What is between products of a matrix in blocks: one invocation for a channel of four rows.

struct BouncePart { rows: u32, pad0: u32, pad1: u32, pad2: u32 }

@group(0) @binding(0) var<uniform> bounce_part: BouncePart;
// Factors before and after products, albedos.
@group(0) @binding(1) var<storage, read> bounce_fixed: array<f32>;
@group(0) @binding(2) var<storage, read> bounce_start: array<f32>;
@group(0) @binding(3) var<storage, read_write> bounce_x: array<f32>;
@group(0) @binding(4) var<storage, read_write> bounce_y: array<f32>;

fn bounce_place(group: vec3<u32>, groups: vec3<u32>, lane: u32) -> u32 { return (group.y * groups.x + group.x) * 64u + lane; }

fn bounce_out(i: u32, k: u32) -> f32 {
    return bounce_y[4u * i + k] * bounce_fixed[4u * (bounce_part.rows + i / 3u) + k];
}

fn bounce_send(i: u32, k: u32, more: f32) {
    bounce_x[4u * i + k] = bounce_fixed[4u * (i / 3u) + k] * (bounce_start[4u * i + k] + more);
}

@compute @workgroup_size(64)
fn bounce_first(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let i = bounce_place(group, groups, lane);
    if i >= 3u * bounce_part.rows { return; }
    for (var k = 0u; k < 4u; k++) { bounce_send(i, k, 0.0f); }
}

@compute @workgroup_size(64)
fn bounce_next(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let i = bounce_place(group, groups, lane);
    if i >= 3u * bounce_part.rows { return; }
    for (var k = 0u; k < 4u; k++) {
        bounce_send(i, k, bounce_fixed[4u * (2u * bounce_part.rows + i) + k] * bounce_out(i, k));
    }
}

@compute @workgroup_size(64)
fn bounce_last(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let i = bounce_place(group, groups, lane);
    if i >= 3u * bounce_part.rows { return; }
    for (var k = 0u; k < 4u; k++) { bounce_y[4u * i + k] = bounce_out(i, k); }
}
