// Blocks of BC4: exact integers. Both words of a block as they are in memory.

fn bc4_palette(a: u32, b: u32) -> array<u32, 8> {
    var out = array<u32, 8>(a, b, 0u, 0u, 0u, 0u, 0u, 255u);
    let n = select(5u, 7u, a > b);
    for (var k = 1u; k < n; k++) { out[k + 1u] = ((n - k) * a + k * b + n / 2u) / n; }
    return out;
}

// Index i of the 16, whose bits begin at 16 + 3 i: the sixth lies in both words.
fn bc4_index(block: vec2<u32>, i: u32) -> u32 {
    if i < 5u { return block.x >> (16u + 3u * i) & 7u; }
    if i == 5u { return (block.x >> 31u | block.y << 1u) & 7u; }
    return block.y >> (3u * i - 16u) & 7u;
}

fn bc4_with_index(block: vec2<u32>, i: u32, index: u32) -> vec2<u32> {
    if i < 5u { return vec2(block.x | index << (16u + 3u * i), block.y); }
    if i == 5u { return vec2(block.x | index << 31u, block.y | index >> 1u); }
    return vec2(block.x, block.y | index << (3u * i - 16u));
}

fn bc4_decode(block: vec2<u32>) -> array<u32, 16> {
    var entries = bc4_palette(block.x & 255u, block.x >> 8u & 255u);
    var out = array<u32, 16>();
    for (var i = 0u; i < 16u; i++) { out[i] = entries[bc4_index(block, i)]; }
    return out;
}

// Endpoints and the nearest index for each texel that counts, the lowest among equals; 0 for others.
fn bc4_block(texels: array<u32, 16>, counts: u32, a: u32, b: u32) -> vec2<u32> {
    var x = texels;
    var entries = bc4_palette(a, b);
    var block = vec2(a | b << 8u, 0u);
    for (var i = 0u; i < 16u; i++) {
        if (counts >> i & 1u) == 0u { continue; }
        var best = 0xffffffffu;
        var index = 0u;
        for (var p = 0u; p < 8u; p++) {
            let d = u32(abs(i32(x[i]) - i32(entries[p])));
            if d < best {
                best = d;
                index = p;
            }
        }
        block = bc4_with_index(block, i, index);
    }
    return block;
}

fn bc4_encode_range_fit(texels: array<u32, 16>, counts: u32) -> vec2<u32> {
    var x = texels;
    var low = 255u;
    var high = 0u;
    for (var i = 0u; i < 16u; i++) {
        if (counts >> i & 1u) == 0u { continue; }
        low = min(low, x[i]);
        high = max(high, x[i]);
    }
    // The upper bits of the word say nothing of texels.
    if (counts & 0xffffu) == 0u { return vec2(0u, 0u); }
    return bc4_block(x, counts, high, low);
}
