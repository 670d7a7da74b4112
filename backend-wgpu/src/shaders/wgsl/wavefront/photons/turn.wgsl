// Between two steps of a wave of photons: `landed` says how many workgroups those take that have landed, `turn` changes the lists of those that ask.

@group(0) @binding(0) var<storage, read_write> head: array<u32>;
@group(0) @binding(1) var<storage, read_write> groups: array<u32>;

const HEAD_TURN: u32 = 2u;
const HEAD_LANDED: u32 = 3u;
const HEAD_RAYS: u32 = 4u;

@compute @workgroup_size(1)
fn landed() {
    groups[4] = (head[HEAD_LANDED] + 63u) / 64u;
    groups[5] = 1u;
    groups[6] = 1u;
}

@compute @workgroup_size(1)
fn turn() {
    let old = head[HEAD_TURN];
    let rays = head[HEAD_RAYS] + head[old];
    head[HEAD_RAYS + 1u] += u32(rays < head[old]);
    head[HEAD_RAYS] = rays;
    head[old] = 0u;
    head[HEAD_LANDED] = 0u;
    head[HEAD_TURN] = 1u - old;
    groups[0] = (head[1u - old] + 63u) / 64u;
    groups[1] = 1u;
    groups[2] = 1u;
}
