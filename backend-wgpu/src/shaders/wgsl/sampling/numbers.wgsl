// The numbers of one photon: random, or a point of a scrambled Sobol' block, behind one door.
//: use math::bits
//: use sampling::counter
//: use sampling::sobol

// Random where `random`: then `key` is the seed, `place` the replicate. Sobol' points otherwise: the key of the block, 0.
// `index` is bit-reversed for these.
struct Numbers { key: vec2<u32>, place: u32, index: u32, random: bool }

fn numbers_apart(seed: vec2<u32>) -> vec2<u32> { return seed ^ vec2(0x6f6a9a9bu, 0x9e6d62d0u); }

fn numbers_random(seed: vec2<u32>, replicate: u32) -> Numbers {
    return Numbers(numbers_apart(seed), replicate, 0u, true);
}

fn numbers_sobol(seed: vec2<u32>, replicate: u32) -> Numbers {
    let sampler = sobol_block_sampler(numbers_apart(seed), 0u, replicate, 0u);
    return Numbers(sampler.key, 0u, sampler.reversed_index, false);
}

fn numbers_with_index(n: Numbers, index: u32) -> Numbers {
    return Numbers(n.key, n.place, select(reverseBits(index), index, n.random), n.random);
}

fn numbers_bits4(n: Numbers, group: u32) -> vec4<u32> {
    if n.random { return counter_bits4(n.key, n.place, n.index, group); }
    return sobol_bits4(BlockSampler(n.key, n.index), group);
}

fn numbers_group4(n: Numbers, group: u32) -> vec4<f32> {
    let b = numbers_bits4(n, group);
    return vec4(math_u32_to_unit(b.x), math_u32_to_unit(b.y), math_u32_to_unit(b.z), math_u32_to_unit(b.w));
}
