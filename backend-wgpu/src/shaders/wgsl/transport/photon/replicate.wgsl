// How many photons live on, by counts of chances in units of 2^-32.
//: use math::choice

fn photon_chance_count(chance: f32) -> u32 { return math_to_u32(chance * 4294967296.0f); }

// The nearest number with `digits` binary digits fewer, halves to even; `more`: something lies below the last digit.
fn photon_rounded(x: vec2<u32>, digits: u32, more: bool) -> vec2<u32> {
    let rest = x.x & ((1u << digits) - 1u);
    let half = 1u << (digits - 1u);
    let low = (x.x >> digits) | (x.y << (32u - digits));
    let high = x.y >> digits;
    let up = (rest > half) | ((rest == half) & (more | ((low & 1u) == 1u)));
    let sum = low + u32(up);
    return vec2(sum, high + u32(sum < low));
}

// 2^32 / count as core has it: the quotient rounded to 53 digits, and then to 24.
fn photon_survivor_factor(count: u32) -> f32 {
    if count == 0u { return 1.0f; }
    let shift = countLeadingZeros(count);
    let divisor = count << shift;
    // 2^31 / divisor is above 1/2; exactly 1 for powers of two.
    if divisor == 0x80000000u { return bitcast<f32>((127u + 1u + shift) << 23u); }
    var rest = 0x80000000u;
    var quotient = vec2(0u);
    for (var digit = 0u; digit < 54u; digit++) {
        let over = (rest >> 31u) == 1u;
        rest <<= 1u;
        let one = over | (rest >= divisor);
        if one { rest -= divisor; }
        quotient = vec2((quotient.x << 1u) | u32(one), (quotient.y << 1u) | (quotient.x >> 31u));
    }
    let digits53 = photon_rounded(quotient, 1u, rest != 0u);
    let digits24 = photon_rounded(digits53, 29u, false).x;
    // Of 2^(shift + 1) times the quotient, digits24 / 2^24; a quotient that rounds to 2^24 is the next power of two.
    return f32(digits24) * bitcast<f32>((127u + 1u + shift - 24u) << 23u);
}
