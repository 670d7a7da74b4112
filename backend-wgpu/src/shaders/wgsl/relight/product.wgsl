// y = S x, in the order of sums that core's tiles have: rows first, then stripe after stripe what rows send to their columns.
//
// x and y are runs of eight numbers, three channels one after the other. Three channels share a matrix; or (ONE) each has its own, and the
// dispatch has as many layers.
//: use radiosity::tiles

// Rows of tiles of this part.
struct TilesPart { first: u32, count: u32, pad0: u32, pad1: u32 }

@group(0) @binding(0) var<uniform> tiles_part: TilesPart;
@group(0) @binding(2) var<storage, read> tiles_starts: array<u32>;
@group(0) @binding(3) var<storage, read> tiles_list: array<vec2<u32>>;
@group(0) @binding(4) var<storage, read> tiles_x: array<f32>;
@group(0) @binding(5) var<storage, read_write> tiles_y: array<f32>;

//: if ONE
alias TilesValue = f32;

fn tiles_load(row: u32, channel: u32, k: u32) -> TilesValue { return tiles_x[24u * row + 8u * channel + k]; }

fn tiles_loaded_sum(row: u32, channel: u32, k: u32) -> TilesValue { return tiles_y[24u * row + 8u * channel + k]; }

fn tiles_store(row: u32, channel: u32, k: u32, value: TilesValue) { tiles_y[24u * row + 8u * channel + k] = value; }
//: else
alias TilesValue = vec3<f32>;

fn tiles_load(row: u32, channel: u32, k: u32) -> TilesValue {
    let at = 24u * row + k;
    return vec3(tiles_x[at], tiles_x[at + 8u], tiles_x[at + 16u]);
}

fn tiles_loaded_sum(row: u32, channel: u32, k: u32) -> TilesValue {
    let at = 24u * row + k;
    return vec3(tiles_y[at], tiles_y[at + 8u], tiles_y[at + 16u]);
}

fn tiles_store(row: u32, channel: u32, k: u32, value: TilesValue) {
    let at = 24u * row + k;
    tiles_y[at] = value.x;
    tiles_y[at + 8u] = value.y;
    tiles_y[at + 16u] = value.z;
}
//: end

var<workgroup> tiles_lanes: array<TilesValue, 64>;
var<workgroup> tiles_flat: array<TilesValue, 8>;

fn tiles_pairwise(s0: TilesValue, s1: TilesValue, s2: TilesValue, s3: TilesValue, s4: TilesValue, s5: TilesValue, s6: TilesValue, s7: TilesValue) -> TilesValue {
    return ((s0 + s4) + (s2 + s6)) + ((s1 + s5) + (s3 + s7));
}

fn tiles_lanes_pairwise(i: u32) -> TilesValue {
    return tiles_pairwise(
        tiles_lanes[i], tiles_lanes[i + 1u], tiles_lanes[i + 2u], tiles_lanes[i + 3u],
        tiles_lanes[i + 4u], tiles_lanes[i + 5u], tiles_lanes[i + 6u], tiles_lanes[i + 7u],
    );
}

// A workgroup has a row of tiles, an invocation an entry of each: its list is in the order of sums, the diagonal last. The longest rows begin first.
@compute @workgroup_size(64)
fn tiles_rows(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let turn = group.y * groups.x + group.x;
    let here = turn < tiles_part.count;
    let index = tiles_part.count - 1u - turn;
    let row = tiles_part.first + index;
    let r = lane >> 3u;
    let k = lane & 7u;
    var sum: TilesValue;
    var flat: TilesValue;
    if here {
        let at = group.z * (tiles_part.count + 1u) + index;
        let end = tiles_starts[at + 1u];
        var i = tiles_starts[at];
        // Read one ahead: what it points to can then be asked for at once.
        var next = tiles_list[i];
        for (; i < end; i++) {
            let head = tiles_head(next);
            next = tiles_list[i + 1u];
            let x = tiles_load(head.other, group.z, k);
            if head.other == row {
                sum = sum + (head.unit * tiles_entry(head, r, k)) * x;
            } else if head.kind == TILES_MEAN {
                flat = flat + head.unit * x;
            } else {
                sum = sum + tiles_entry(head, r, k) * (head.unit * x);
            }
        }
    }
    tiles_lanes[lane] = sum;
    if r == 0u { tiles_flat[k] = flat; }
    workgroupBarrier();
    if here && lane < 8u {
        let means = tiles_pairwise(
            tiles_flat[0], tiles_flat[1], tiles_flat[2], tiles_flat[3],
            tiles_flat[4], tiles_flat[5], tiles_flat[6], tiles_flat[7],
        );
        tiles_store(row, group.z, lane, tiles_lanes_pairwise(8u * lane) + means);
    }
}

// What a tile of a row sends to column k of its own.
fn tiles_sent(head: TilesHead, channel: u32, k: u32) -> TilesValue {
    let row = head.other;
    let x0 = tiles_load(row, channel, 0u);
    let x1 = tiles_load(row, channel, 1u);
    let x2 = tiles_load(row, channel, 2u);
    let x3 = tiles_load(row, channel, 3u);
    let x4 = tiles_load(row, channel, 4u);
    let x5 = tiles_load(row, channel, 5u);
    let x6 = tiles_load(row, channel, 6u);
    let x7 = tiles_load(row, channel, 7u);
    if head.kind == TILES_MEAN { return head.unit * tiles_pairwise(x0, x1, x2, x3, x4, x5, x6, x7); }
    var even: TilesValue;
    var odd: TilesValue;
    if head.kind >= TILES_F16 {
        even = tiles_plain(head, 0u, k) * x0 + tiles_plain(head, 2u, k) * x2 + tiles_plain(head, 4u, k) * x4
            + tiles_plain(head, 6u, k) * x6;
        odd = tiles_plain(head, 1u, k) * x1 + tiles_plain(head, 3u, k) * x3 + tiles_plain(head, 5u, k) * x5
            + tiles_plain(head, 7u, k) * x7;
    } else {
        let words = tiles_words(head, k);
        let kind = head.kind;
        even = tiles_square(kind, words, 0u) * x0 + tiles_square(kind, words, 2u) * x2
            + tiles_square(kind, words, 4u) * x4 + tiles_square(kind, words, 6u) * x6;
        odd = tiles_square(kind, words, 1u) * x1 + tiles_square(kind, words, 3u) * x3
            + tiles_square(kind, words, 5u) * x5 + tiles_square(kind, words, 7u) * x7;
    }
    return head.unit * (even + odd);
}

// Rows of a stripe, whose sums are complete in themselves.
const TILES_STRIPE: u32 = 64u;
// Stripes at once.
const TILES_STRIPES: u32 = 8u;

// The first place in [start, end) of the list whose row is not below `row`.
fn tiles_seek(start: u32, end: u32, row: u32) -> u32 {
    var low = start;
    var high = end;
    while low < high {
        let middle = low + (high - low) / 2u;
        if (tiles_list[middle].x & 0x1ffffu) < row { low = middle + 1u; } else { high = middle; }
    }
    return low;
}

// A workgroup has a column of tiles, an invocation a column of theirs in a stripe of rows; stripes are added one after the other.
@compute @workgroup_size(64)
fn tiles_columns(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let column = group.y * groups.x + group.x;
    let columns = tiles_part.first + tiles_part.count;
    let here = column < columns;
    let stripes = (columns + TILES_STRIPE - 1u) / TILES_STRIPE;
    let s = lane >> 3u;
    let k = lane & 7u;
    var begin = 0u;
    var end = 0u;
    var total: TilesValue;
    if here {
        let at = group.z * (columns + 1u) + column;
        begin = tiles_starts[at];
        end = tiles_starts[at + 1u];
        if lane < 8u { total = tiles_loaded_sum(column, group.z, k); }
    }
    for (var first = max(column, tiles_part.first) / TILES_STRIPE; first < stripes; first += TILES_STRIPES) {
        let stripe = first + s;
        var sum: TilesValue;
        if here && stripe < stripes {
            var i = tiles_seek(begin, end, stripe * TILES_STRIPE);
            var next = tiles_list[i];
            for (; i < end; i++) {
                let head = tiles_head(next);
                next = tiles_list[i + 1u];
                if head.other >= (stripe + 1u) * TILES_STRIPE { break; }
                sum = sum + tiles_sent(head, group.z, k);
            }
        }
        tiles_lanes[lane] = sum;
        workgroupBarrier();
        if lane < 8u {
            for (var t = 0u; t < min(TILES_STRIPES, stripes - first); t++) { total = total + tiles_lanes[8u * t + k]; }
        }
        workgroupBarrier();
    }
    if here && lane < 8u { tiles_store(column, group.z, k, total); }
}
