// Blocks of a transport matrix: entries by one look into the table of weighted sums of endpoints.
//: use codec::bc1
//: use codec::bc4

// Halves of BC1 follow its thirds, then comes black; fifths of BC4 follow its sevenths.
const BLOCKS_HALVES: u32 = 766u;
const BLOCKS_BLACK: u32 = 1277u;
const BLOCKS_FIFTHS: u32 = 1786u;

@group(0) @binding(1) var<storage, read> blocks_lookup: array<f32>;

//: if BC4
// Entry i of the 16, the same for all channels.
fn blocks_entry(block: vec2<u32>, i: u32) -> vec3<f32> {
    let a = block.x & 255u;
    let b = block.x >> 8u & 255u;
    let index = bc4_index(block, i);
    var at = 7u * select(a, b, index == 1u);
    if index > 1u {
        let k = index - 1u;
        if a > b {
            at = (7u - k) * a + k * b;
        } else if k < 5u {
            at = BLOCKS_FIFTHS + (5u - k) * a + k * b;
        } else {
            at = BLOCKS_FIFTHS + select(1275u, 0u, k == 5u);
        }
    }
    return vec3(blocks_lookup[at]);
}
//: else
fn blocks_channel(a_code: u32, b_code: u32, five: bool, index: u32, four: bool) -> f32 {
    let a = bc1_widen(a_code, five);
    let b = bc1_widen(b_code, five);
    var at = 3u * select(a, b, index == 1u);
    if index == 2u { at = select(BLOCKS_HALVES + a + b, 2u * a + b, four); }
    if index == 3u { at = select(BLOCKS_BLACK, a + 2u * b, four); }
    return blocks_lookup[at];
}

// Entry i of the 16.
fn blocks_entry(block: vec2<u32>, i: u32) -> vec3<f32> {
    let first = block.x & 0xffffu;
    let second = block.x >> 16u;
    let four = first > second;
    let a = bc1_codes(first);
    let b = bc1_codes(second);
    let index = block.y >> (2u * i) & 3u;
    return vec3(
        blocks_channel(a.x, b.x, true, index, four),
        blocks_channel(a.y, b.y, false, index, four),
        blocks_channel(a.z, b.z, true, index, four),
    );
}
//: end
