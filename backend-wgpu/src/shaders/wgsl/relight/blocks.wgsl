// y = X x with X in blocks, in the order of sums that core's blocks have, and what is between products.
//
// x and y are runs of four rows, three channels one after the other.
//: use radiosity::blocks
//: if TEXTURE
//: use codec::bc1_texture
//: end

// Rows of blocks of all, those of this part, and rows of the matrix.
struct BlocksPart {
    rows: u32,
    first: u32,
    count: u32,
    patches: u32,
    unit: f32,
    // Blocks along an edge of the texture that has them.
    side: u32,
    pad0: u32,
    pad1: u32,
}

@group(0) @binding(0) var<uniform> blocks_part: BlocksPart;
//: if TEXTURE
@group(0) @binding(2) var blocks_texture: texture_2d_array<f32>;
//: else
@group(0) @binding(2) var<storage, read> blocks_words: array<vec2<u32>>;
//: end
// Where kept entries begin: of each row, or of each column.
@group(0) @binding(3) var<storage, read> blocks_starts: array<u32>;
// Kept entries by row: column and values.
@group(0) @binding(4) var<storage, read> blocks_kept: array<u32>;
// Kept entries by column: row, and which entry.
@group(0) @binding(5) var<storage, read> blocks_sent: array<vec2<u32>>;
@group(0) @binding(6) var<storage, read> blocks_x: array<f32>;
@group(0) @binding(7) var<storage, read_write> blocks_y: array<f32>;

fn blocks_load(row: u32, k: u32) -> vec3<f32> {
    let at = 12u * row + k;
    return vec3(blocks_x[at], blocks_x[at + 4u], blocks_x[at + 8u]);
}

fn blocks_store(row: u32, k: u32, value: vec3<f32>) {
    let at = 12u * row + k;
    blocks_y[at] = value.x;
    blocks_y[at + 4u] = value.y;
    blocks_y[at + 8u] = value.z;
}

// Where a row of blocks begins.
fn blocks_row(row: u32) -> u32 {
//: if HALF
    return row * (row + 1u) / 2u;
//: else
    return row * blocks_part.rows;
//: end
}

//: if TEXTURE
// Entry e of block i, which the device decodes.
fn blocks_value(i: u32, e: u32) -> vec3<f32> {
    let code = vec3<u32>(255.0f * bc1_texture_load(blocks_texture, i, e, blocks_part.side).rgb + 0.5f);
    return vec3(blocks_lookup[3u * code.x], blocks_lookup[3u * code.y], blocks_lookup[3u * code.z]);
}

fn blocks_are_empty(i: u32) -> bool { return false; }
//: else
// Entry e of block i.
fn blocks_value(i: u32, e: u32) -> vec3<f32> { return blocks_entry(blocks_words[i], e); }

fn blocks_are_empty(i: u32) -> bool { return (blocks_words[i].x | blocks_words[i].y) == 0u; }
//: end

struct BlocksKept { column: u32, value: vec3<f32> }

//: if SHORT
// f16; there is no infinite one.
fn blocks_half(bits: u32) -> f32 {
    let exponent = bits >> 10u & 31u;
    let fraction = bits & 0x3ffu;
    var x = bitcast<f32>((exponent + 112u) << 23u | fraction << 13u);
    if exponent == 0u { x = f32(fraction) * (1.0f / 16777216.0f); }
    return bitcast<f32>(bitcast<u32>(x) | (bits & 0x8000u) << 16u) * blocks_part.unit;
}

fn blocks_entry_kept(i: u32) -> BlocksKept {
//: if BC4
    let word = blocks_kept[i];
    return BlocksKept(word & 0xffffu, vec3(blocks_half(word >> 16u)));
//: else
    let words = vec2(blocks_kept[2u * i], blocks_kept[2u * i + 1u]);
    let value = vec3(blocks_half(words.x >> 16u), blocks_half(words.y & 0xffffu), blocks_half(words.y >> 16u));
    return BlocksKept(words.x & 0xffffu, value);
//: end
}
//: else
fn blocks_entry_kept(i: u32) -> BlocksKept {
//: if BC4
    return BlocksKept(blocks_kept[2u * i], vec3(bitcast<f32>(blocks_kept[2u * i + 1u])));
//: else
    let at = 4u * i;
    let bits = vec3(blocks_kept[at + 1u], blocks_kept[at + 2u], blocks_kept[at + 3u]);
    return BlocksKept(blocks_kept[at], bitcast<vec3<f32>>(bits));
//: end
}
//: end

var<workgroup> blocks_lanes: array<vec3<f32>, 64>;
var<workgroup> blocks_kept_sums: array<vec3<f32>, 32>;

// A workgroup has four rows of blocks, sixteen invocations each; the longest rows begin first.
@compute @workgroup_size(64)
fn blocks_rows(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let turn = 4u * (group.y * groups.x + group.x) + lane / 16u;
    let here = turn < blocks_part.count;
    let index = blocks_part.count - 1u - turn;
    let row = blocks_part.first + index;
    let e = lane & 15u;
    var sum: vec3<f32>;
    var kept: vec3<f32>;
    if here {
        let base = blocks_row(row) - blocks_row(blocks_part.first);
//: if HALF
        let columns = row + 1u;
//: else
        let columns = blocks_part.rows;
//: end
        for (var column = 0u; column < columns; column++) {
            let block = base + column;
            if blocks_are_empty(block) { continue; }
            sum = sum + blocks_value(block, e) * blocks_load(column, e & 3u);
        }
        // Two sums of every other entry of a row.
        let kept_row = 4u * index + e / 2u;
        if e < 8u && 4u * row + e / 2u < blocks_part.patches {
            let end = blocks_starts[kept_row + 1u];
            for (var i = blocks_starts[kept_row] + (e & 1u); i < end; i += 2u) {
                let entry = blocks_entry_kept(i);
                kept = kept + entry.value * blocks_load(entry.column / 4u, entry.column & 3u);
            }
        }
    }
    blocks_lanes[lane] = sum;
    if e < 8u { blocks_kept_sums[8u * (lane / 16u) + e] = kept; }
    workgroupBarrier();
    if here && e < 4u {
        let s = 16u * (lane / 16u) + 4u * e;
        let kept_at = 8u * (lane / 16u) + 2u * e;
        let folded = (blocks_lanes[s] + blocks_lanes[s + 2u]) + (blocks_lanes[s + 1u] + blocks_lanes[s + 3u]);
        blocks_store(row, e, folded + (blocks_kept_sums[kept_at] + blocks_kept_sums[kept_at + 1u]));
    }
}

//: if HALF
// Rows of blocks of a stripe, whose sums are complete in themselves.
const BLOCKS_STRIPE: u32 = 64u;
// Stripes at once.
const BLOCKS_STRIPES: u32 = 16u;

// The first place in [start, end) of the list whose row is not below `row`.
fn blocks_seek(start: u32, end: u32, row: u32) -> u32 {
    var low = start;
    var high = end;
    while low < high {
        let middle = low + (high - low) / 2u;
        if blocks_sent[middle].x < row { low = middle + 1u; } else { high = middle; }
    }
    return low;
}

// A workgroup has a column of blocks, an invocation a column of theirs in a stripe of rows; stripes are added one after the other.
@compute @workgroup_size(64)
fn blocks_columns(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let column = group.y * groups.x + group.x;
    let columns = blocks_part.first + blocks_part.count;
    let here = column < columns;
    let stripes = (columns + BLOCKS_STRIPE - 1u) / BLOCKS_STRIPE;
    let s = lane >> 2u;
    let k = lane & 3u;
    var begin = 0u;
    var end = 0u;
    var total: vec3<f32>;
    if here {
        begin = blocks_starts[4u * column + k];
        end = blocks_starts[4u * column + k + 1u];
        if lane < 4u {
            let at = 12u * column + k;
            total = vec3(blocks_y[at], blocks_y[at + 4u], blocks_y[at + 8u]);
        }
    }
    let base = blocks_row(blocks_part.first);
    for (var first = max(column, blocks_part.first) / BLOCKS_STRIPE; first < stripes; first += BLOCKS_STRIPES) {
        let stripe = first + s;
        var sum: vec3<f32>;
        if here && stripe < stripes {
            let low = max(stripe * BLOCKS_STRIPE, column + 1u);
            let high = min((stripe + 1u) * BLOCKS_STRIPE, columns);
            var i = blocks_seek(begin, end, 4u * low);
            for (var row = low; row < high; row++) {
                let block = blocks_row(row) - base + column;
                if !blocks_are_empty(block) {
                    let x0 = blocks_value(block, k) * blocks_load(row, 0u);
                    let x1 = blocks_value(block, 4u + k) * blocks_load(row, 1u);
                    let x2 = blocks_value(block, 8u + k) * blocks_load(row, 2u);
                    let x3 = blocks_value(block, 12u + k) * blocks_load(row, 3u);
                    sum = sum + ((x0 + x1) + (x2 + x3));
                }
                for (; i < end; i++) {
                    let sent = blocks_sent[i];
                    if sent.x >= 4u * (row + 1u) { break; }
                    sum = sum + blocks_entry_kept(sent.y).value * blocks_load(sent.x / 4u, sent.x & 3u);
                }
            }
        }
        blocks_lanes[lane] = sum;
        workgroupBarrier();
        if lane < 4u {
            for (var t = 0u; t < min(BLOCKS_STRIPES, stripes - first); t++) { total = total + blocks_lanes[4u * t + k]; }
        }
        workgroupBarrier();
    }
    if here && lane < 4u { blocks_store(column, k, total); }
}
//: end
