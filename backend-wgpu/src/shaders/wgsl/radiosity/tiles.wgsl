// Tiles of form factors: entries from the words that relight/lists.rs lays out.
//
// A tile has a head of two words. The first has the tile's row or column, whichever the list is not of, in 17 bits, and above them the upper
// half of the scale, whose sign is no part of it. The second has the kind in 4 bits, and where the codes begin in units of two words.

// Numbers of kinds, those between being codes of bits.
const TILES_MEAN: u32 = 1u;
const TILES_F16: u32 = 8u;
const TILES_F32: u32 = 9u;
// Bits of the upper part of a code and of the lower, a digit for each kind.
const TILES_HIGH: u32 = 0x44422100u;
const TILES_LOW: u32 = 0x42010000u;

@group(0) @binding(1) var<storage, read> tiles_codes: array<u32>;

struct TilesHead { other: u32, kind: u32, at: u32, unit: f32 }

// What entries are multiples of.
fn tiles_unit(kind: u32, scale: f32) -> f32 {
    switch kind {
        case 1u, 2u: { return scale; }
        case 3u: { return scale * (1.0f / 9.0f); }
        case 4u: { return scale * (1.0f / 49.0f); }
        case 5u: { return scale * (1.0f / 225.0f); }
        case 6u: { return scale * (1.0f / 3969.0f); }
        case 7u: { return scale * (1.0f / 65025.0f); }
        default: { return 1.0f; }
    }
}

fn tiles_head(words: vec2<u32>) -> TilesHead {
    let kind = words.y & 15u;
    let scale = bitcast<f32>(words.x >> 17u << 16u);
    return TilesHead(words.x & 0x1ffffu, kind, words.y >> 4u << 1u, tiles_unit(kind, scale));
}

fn tiles_half(bits: u32) -> f32 {
    let exponent = bits >> 10u & 31u;
    let fraction = bits & 0x3ffu;
    if exponent == 0u { return f32(fraction) * (1.0f / 16777216.0f); }
    return bitcast<f32>((exponent + 112u) << 23u | fraction << 13u);
}

// The codes of all rows in column k: upper parts and lower ones, those of row 0 lowest.
fn tiles_words(head: TilesHead, k: u32) -> vec2<u32> {
    let high = TILES_HIGH >> (4u * head.kind) & 15u;
    let low = TILES_LOW >> (4u * head.kind) & 15u;
    let bit = 8u * high * k;
    var words = vec2(tiles_codes[head.at + (bit >> 5u)] >> (bit & 31u), 0u);
    if low > 0u {
        let low_bit = 8u * low * k;
        words.y = tiles_codes[head.at + 2u * high + (low_bit >> 5u)] >> (low_bit & 31u);
    }
    return words;
}

// The square of the code of a row.
fn tiles_square(kind: u32, words: vec2<u32>, r: u32) -> f32 {
    let high = TILES_HIGH >> (4u * kind) & 15u;
    let low = TILES_LOW >> (4u * kind) & 15u;
    let upper = words.x >> (high * r) & ((1u << high) - 1u);
    let q = f32(upper << low | (words.y >> (low * r) & ((1u << low) - 1u)));
    return q * q;
}

// Entries that are no codes.
fn tiles_plain(head: TilesHead, r: u32, k: u32) -> f32 {
    let i = 8u * r + k;
    if head.kind == TILES_F32 { return bitcast<f32>(tiles_codes[head.at + i]); }
    return tiles_half(tiles_codes[head.at + (i >> 1u)] >> (16u * (i & 1u)) & 0xffffu);
}

// Entry (r, k) in units; 1 where the tile is one mean.
fn tiles_entry(head: TilesHead, r: u32, k: u32) -> f32 {
    if head.kind >= TILES_F16 { return tiles_plain(head, r, k); }
    if head.kind == TILES_MEAN { return 1.0f; }
    return tiles_square(head.kind, tiles_words(head, k), r);
}
