// Sobol' points in padded groups of four dimensions; words are kept bit-reversed between the steps.
//: use math::bits
//: use sampling::counter

fn sobol_scramble_reversed(x_in: u32, seed: u32) -> u32 {
    var x = x_in;
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16u) | 1u;
    x ^= x * 0x05526c56u;
    return x ^ (x * 0x53a22864u);
}

fn sobol_nested_uniform_scramble(x: u32, seed: u32) -> u32 {
    return reverseBits(sobol_scramble_reversed(reverseBits(x), seed));
}

// Dimensions 1 to 3 of a point, bit-reversed, without tables. With the bits of the index as coefficients of a polynomial
// over GF(2) and p the primitive polynomial of the dimension, of degree s, the recurrence of the direction numbers says
// that p(E) = z^s for the step E to the next number and the shift z to the next digit. So the point has the digits of the
// index to the base p, s bits each, times the first s direction numbers. Division by p^8, p^4, p^2 and p gives the digits:
// over GF(2), p^2 (E) = p(E^2).
fn sobol_reversed1(index: u32) -> u32 {
    var x = index;
    x ^= x >> 16u;
    x ^= (x & 0xff00ff00u) >> 8u;
    x ^= (x & 0xf0f0f0f0u) >> 4u;
    x ^= (x & 0xccccccccu) >> 2u;
    return x ^ ((x & 0xaaaaaaaau) >> 1u);
}

// Division of each field of 2 d bits by E^d + E^g + 1: quotients above, rests below. `low` masks the lower d bits of the
// fields, `carry` the lower g.
fn sobol_divided(x: u32, d: u32, g: u32, low: u32, carry: u32) -> u32 {
    let high = (x >> d) & low;
    let top = (high >> (d - g)) & carry;
    return x ^ (top << d) ^ high ^ top ^ ((high << g) & low) ^ (top << g);
}

// p = E^2 + E + 1; direction numbers 1 and 1 + z.
fn sobol_reversed2(index: u32) -> u32 {
    var x = index;
    x = sobol_divided(x, 16u, 8u, 0x0000ffffu, 0x000000ffu);
    x = sobol_divided(x, 8u, 4u, 0x00ff00ffu, 0x000f000fu);
    x = sobol_divided(x, 4u, 2u, 0x0f0f0f0fu, 0x03030303u);
    x = sobol_divided(x, 2u, 1u, 0x33333333u, 0x11111111u);
    return x ^ ((x >> 1u) & 0x55555555u);
}

// p = E^3 + E + 1; direction numbers 1, 1 + z and z^2.
fn sobol_reversed3(index: u32) -> u32 {
    var x = index;
    x = sobol_divided(x, 24u, 8u, 0x00ffffffu, 0x000000ffu);
    x = sobol_divided(x, 12u, 4u, 0xff000fffu, 0x0f00000fu);
    x = sobol_divided(x, 6u, 2u, 0x3f03f03fu, 0x03003003u);
    x = sobol_divided(x, 3u, 1u, 0xc71c71c7u, 0x41041041u);
    return x ^ ((x >> 1u) & 0x49249249u);
}

fn sobol_key(seed: vec2<u32>, counter: vec4<u32>) -> vec2<u32> {
    return counter_philox4x32_10(counter, seed).xy;
}

fn sobol_derive(key: vec2<u32>, n: u32) -> u32 {
    var x = key.x + n * 0x9e3779b9u;
    x = ((x ^ (x >> 16u)) * 0x7feb352du) ^ key.y;
    x = (x ^ (x >> 15u)) * 0x846ca68bu;
    return x ^ (x >> 16u);
}

struct BlockSampler { key: vec2<u32>, reversed_index: u32 }

fn sobol_block_sampler(seed: vec2<u32>, stream: u32, block: u32, index: u32) -> BlockSampler {
    return BlockSampler(sobol_key(seed, vec4(stream, block, 0u, 1u)), reverseBits(index));
}

fn sobol_with_index(sampler: BlockSampler, index: u32) -> BlockSampler {
    return BlockSampler(sampler.key, reverseBits(index));
}

fn sobol_shuffled(sampler: BlockSampler, group: u32) -> u32 {
    return reverseBits(sobol_scramble_reversed(sampler.reversed_index, sobol_derive(sampler.key, group << 3u)));
}

fn sobol_bits4(sampler: BlockSampler, group: u32) -> vec4<u32> {
    let i = sobol_shuffled(sampler, group);
    let n = group << 3u;
    return reverseBits(vec4(
        sobol_scramble_reversed(i, sobol_derive(sampler.key, n | 1u)),
        sobol_scramble_reversed(sobol_reversed1(i), sobol_derive(sampler.key, n | 2u)),
        sobol_scramble_reversed(sobol_reversed2(i), sobol_derive(sampler.key, n | 3u)),
        sobol_scramble_reversed(sobol_reversed3(i), sobol_derive(sampler.key, n | 4u)),
    ));
}

fn sobol_bits2(sampler: BlockSampler, group: u32) -> vec2<u32> {
    let i = sobol_shuffled(sampler, group);
    let n = group << 3u;
    return reverseBits(vec2(
        sobol_scramble_reversed(i, sobol_derive(sampler.key, n | 1u)),
        sobol_scramble_reversed(sobol_reversed1(i), sobol_derive(sampler.key, n | 2u)),
    ));
}

fn sobol_group4(sampler: BlockSampler, group: u32) -> vec4<f32> {
    let b = sobol_bits4(sampler, group);
    return vec4(math_u32_to_unit(b.x), math_u32_to_unit(b.y), math_u32_to_unit(b.z), math_u32_to_unit(b.w));
}

fn sobol_group2(sampler: BlockSampler, group: u32) -> vec2<f32> {
    let b = sobol_bits2(sampler, group);
    return vec2(math_u32_to_unit(b.x), math_u32_to_unit(b.y));
}
