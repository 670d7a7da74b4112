// What a pass does beside products, as core's relight has it: one invocation for a channel of eight patches.

struct PassPart { rows: u32, weight: f32, damping: f32, pad: u32 }

@group(0) @binding(0) var<uniform> pass_part: PassPart;
// Factors before and after products, albedos; and with clusters: spread, shares, and the clusters' own factors.
@group(0) @binding(1) var<storage, read> pass_fixed: array<f32>;
// Where the sources of each patch begin, then these: a patch and a factor each.
@group(0) @binding(2) var<storage, read> pass_near: array<u32>;
// Start, radiosity, rest, last irradiance and the weighted sum.
@group(0) @binding(3) var<storage, read_write> pass_state: array<f32>;
@group(0) @binding(4) var<storage, read_write> pass_x: array<f32>;
@group(0) @binding(5) var<storage, read_write> pass_y: array<f32>;
@group(0) @binding(6) var<storage, read_write> pass_cluster_x: array<f32>;
@group(0) @binding(7) var<storage, read_write> pass_cluster_y: array<f32>;

fn pass_into(row: u32, k: u32) -> f32 { return pass_fixed[8u * row + k]; }

fn pass_out(row: u32, k: u32) -> f32 { return pass_fixed[8u * (pass_part.rows + row) + k]; }

fn pass_albedo(i: u32, k: u32) -> f32 { return pass_fixed[8u * (2u * pass_part.rows + i) + k]; }

fn pass_spread(row: u32, k: u32) -> f32 { return pass_fixed[8u * (5u * pass_part.rows + row) + k]; }

fn pass_share(row: u32, k: u32) -> f32 { return pass_fixed[8u * (6u * pass_part.rows + row) + k]; }

fn pass_cluster_into(cluster: u32) -> f32 { return pass_fixed[56u * pass_part.rows + cluster]; }

fn pass_cluster_out(cluster: u32) -> f32 {
    return pass_fixed[56u * pass_part.rows + 8u * ((pass_part.rows + 7u) / 8u) + cluster];
}

// Where a state's eight numbers of a channel begin.
fn pass_at(state: u32, i: u32) -> u32 { return 24u * pass_part.rows * state + 8u * i; }

const PASS_START: u32 = 0u;
const PASS_RADIOSITY: u32 = 1u;
const PASS_REST: u32 = 2u;
const PASS_LAST: u32 = 3u;
const PASS_SUM: u32 = 4u;

struct PassPlace { here: bool, i: u32, row: u32, channel: u32 }

fn pass_place(group: vec3<u32>, groups: vec3<u32>, lane: u32) -> PassPlace {
    let i = (group.y * groups.x + group.x) * 64u + lane;
    return PassPlace(i < 3u * pass_part.rows, i, i / 3u, i % 3u);
}

// Where a cluster's number of a channel is.
fn pass_cluster_at(p: PassPlace) -> u32 { return 24u * (p.row / 8u) + 8u * p.channel + p.row % 8u; }

fn pass_mean(row: u32, values: array<f32, 8>) -> f32 {
    var x = values;
    var mean = 0.0f;
    for (var k = 0u; k < 8u; k++) { mean = mean + pass_share(row, k) * x[k]; }
    return mean;
}

// What clusters give of irradiance.
fn pass_cluster_sent(p: PassPlace) -> f32 { return pass_cluster_y[pass_cluster_at(p)] * pass_cluster_out(p.row); }

// B = B0 + R E of the next pass, and what products take of it.
fn pass_bounce(p: PassPlace, k: u32, e: f32) {
    let b = pass_state[pass_at(PASS_START, p.i) + k] + pass_albedo(p.i, k) * e;
    pass_state[pass_at(PASS_RADIOSITY, p.i) + k] = b;
    pass_x[8u * p.i + k] = b * pass_into(p.row, k);
}

fn pass_advance(p: PassPlace, k: u32, e_in: f32) {
    var e = e_in;
    let last = pass_state[pass_at(PASS_LAST, p.i) + k];
    if pass_part.damping < 1.0f { e = last + pass_part.damping * (e - last); }
    let at = pass_at(PASS_SUM, p.i) + k;
    pass_state[at] = pass_state[at] + pass_part.weight * (e - last);
    pass_state[pass_at(PASS_LAST, p.i) + k] = e;
    pass_bounce(p, k, e);
}

//: if COARSE
// Q B0, for clusters to begin with.
@compute @workgroup_size(64)
fn pass_gather(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let p = pass_place(group, groups, lane);
    if !p.here { return; }
    var b = array<f32, 8>();
    for (var k = 0u; k < 8u; k++) { b[k] = pass_state[pass_at(PASS_START, p.i) + k]; }
    pass_cluster_x[pass_cluster_at(p)] = pass_mean(p.row, b) * pass_cluster_into(p.row);
}

// Irradiance as clusters alone have it.
@compute @workgroup_size(64)
fn pass_begin(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let p = pass_place(group, groups, lane);
    if !p.here { return; }
    let sent = pass_cluster_sent(p);
    for (var k = 0u; k < 8u; k++) {
        let e = 0.0f + pass_spread(p.row, k) * sent;
        pass_state[pass_at(PASS_LAST, p.i) + k] = e;
        pass_state[pass_at(PASS_SUM, p.i) + k] = e;
        pass_bounce(p, k, e);
    }
}

// r = B0 + R F B - B, Q r for clusters, and what these cannot hold.
@compute @workgroup_size(64)
fn pass_remain(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let p = pass_place(group, groups, lane);
    if !p.here { return; }
    var rest = array<f32, 8>();
    for (var k = 0u; k < 8u; k++) {
        let e = pass_y[8u * p.i + k] * pass_out(p.row, k);
        pass_y[8u * p.i + k] = e;
        let b = pass_state[pass_at(PASS_START, p.i) + k] + pass_albedo(p.i, k) * e;
        rest[k] = b - pass_state[pass_at(PASS_RADIOSITY, p.i) + k];
    }
    let mean = pass_mean(p.row, rest);
    pass_cluster_x[pass_cluster_at(p)] = mean * pass_cluster_into(p.row);
    for (var k = 0u; k < 8u; k++) {
        pass_state[pass_at(PASS_REST, p.i) + k] = rest[k] - pass_spread(p.row, k) * mean;
    }
}

// The next irradiance: F B, what clusters give, and what goes once more between patches that see much of each other.
@compute @workgroup_size(64)
fn pass_finish(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let p = pass_place(group, groups, lane);
    if !p.here { return; }
    var near = array<f32, 8>();
    let entries = 8u * pass_part.rows + 1u;
    for (var k = 0u; k < 8u; k++) {
        var sum = 0.0f;
        let patch_at = 8u * p.row + k;
        for (var s = pass_near[patch_at]; s < pass_near[patch_at + 1u]; s++) {
            let source = pass_near[entries + 2u * s];
            let factor = bitcast<f32>(pass_near[entries + 2u * s + 1u]);
            sum = sum + factor * pass_state[pass_at(PASS_REST, 3u * (source / 8u) + p.channel) + source % 8u];
        }
        near[k] = sum;
    }
    let mean = pass_mean(p.row, near);
    let sent = pass_cluster_sent(p);
    for (var k = 0u; k < 8u; k++) {
        let e = pass_y[8u * p.i + k] + pass_spread(p.row, k) * sent;
        pass_advance(p, k, e + (near[k] - pass_spread(p.row, k) * mean));
    }
}
//: else
@compute @workgroup_size(64)
fn pass_begin(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let p = pass_place(group, groups, lane);
    if !p.here { return; }
    for (var k = 0u; k < 8u; k++) {
        pass_state[pass_at(PASS_LAST, p.i) + k] = 0.0f;
        pass_state[pass_at(PASS_SUM, p.i) + k] = 0.0f;
        let b = pass_state[pass_at(PASS_START, p.i) + k];
        pass_state[pass_at(PASS_RADIOSITY, p.i) + k] = b;
        pass_x[8u * p.i + k] = b * pass_into(p.row, k);
    }
}

@compute @workgroup_size(64)
fn pass_finish(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let p = pass_place(group, groups, lane);
    if !p.here { return; }
    for (var k = 0u; k < 8u; k++) {
        let last = pass_state[pass_at(PASS_LAST, p.i) + k];
        let e = pass_y[8u * p.i + k] * pass_out(p.row, k);
        let at = pass_at(PASS_SUM, p.i) + k;
        pass_state[at] = pass_state[at] + pass_part.weight * (e - last);
        pass_state[pass_at(PASS_LAST, p.i) + k] = e;
        pass_bounce(p, k, e);
    }
}
//: end
