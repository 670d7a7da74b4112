// Between two steps of a wave: the lists change places, and the next step has as many workgroups as the list asks for.

@group(0) @binding(0) var<storage, read_write> queue: array<u32>;
@group(0) @binding(1) var<storage, read_write> groups: array<u32>;

@compute @workgroup_size(1)
fn turn() {
    let old = queue[2];
    queue[old] = 0u;
    queue[2] = 1u - old;
    groups[0] = (queue[1u - old] + 63u) / 64u;
    groups[1] = 1u;
    groups[2] = 1u;
}
