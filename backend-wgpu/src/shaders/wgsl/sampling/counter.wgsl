// Counter-based random bits (Philox4x32-10). A seed or key of 64 bits is (low, high).
//: use math::bits

fn counter_philox4x32_10(counter: vec4<u32>, key: vec2<u32>) -> vec4<u32> {
    var c = counter;
    var k = key;
    for (var round = 0u; round < 10u; round++) {
        let p0 = math_wide_mul(0xd2511f53u, c.x);
        let p1 = math_wide_mul(0xcd9e8d57u, c.z);
        c = vec4(p1.x ^ c.y ^ k.x, p1.y, p0.x ^ c.w ^ k.y, p0.y);
        k += vec2(0x9e3779b9u, 0xbb67ae85u);
    }
    return c;
}

fn counter_bits4(seed: vec2<u32>, stream: u32, sample: u32, group: u32) -> vec4<u32> {
    return counter_philox4x32_10(vec4(group, sample, stream, 0u), seed);
}

fn counter_bits(seed: vec2<u32>, stream: u32, sample: u32, dimension: u32) -> u32 {
    return counter_bits4(seed, stream, sample, dimension >> 2u)[dimension & 3u];
}

fn counter_unit(seed: vec2<u32>, stream: u32, sample: u32, dimension: u32) -> f32 {
    return math_u32_to_unit(counter_bits(seed, stream, sample, dimension));
}

fn counter_hash_u32(x_in: u32) -> u32 {
    var x = x_in;
    x = (x ^ (x >> 16u)) * 0x7feb352du;
    x = (x ^ (x >> 15u)) * 0x846ca68bu;
    return x ^ (x >> 16u);
}

fn counter_hash_combine(seed: u32, value: u32) -> u32 {
    return counter_hash_u32(counter_hash_u32(seed + 0x9e3779b9u) + value);
}
