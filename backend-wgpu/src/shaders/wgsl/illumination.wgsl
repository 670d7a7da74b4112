// Sums of flux in fixed point: core's FluxUnit where it multiplies by a power of two. Numbers of 64 bits are two words, the low one first.

// The nearest integer to flux * 2^power, halves to even; 0 for NaN and from -2^51 downward, 2^51 from there upward.
fn illumination_units(flux: f32, power: i32) -> vec2<u32> {
    let bits = bitcast<u32>(flux);
    let is_negative = bits >= 0x80000000u;
    let exponent = (bits >> 23u) & 0xffu;
    let fraction = bits & 0x7fffffu;
    // |flux| = digits * 2^(shift - power), with 24 digits.
    let missing = select(0u, countLeadingZeros(max(fraction, 1u)) - 8u, exponent == 0u);
    let digits = select(fraction | 0x800000u, fraction << missing, exponent == 0u);
    let shift = i32(max(exponent, 1u)) - 150 + power - i32(missing);
    let left = u32(clamp(shift, 0, 27));
    var whole = vec2(digits << left, (digits >> 1u) >> (31u - left));
    if shift < 0 {
        let right = u32(clamp(-shift, 1, 25));
        let rest = digits & ((1u << right) - 1u);
        let half = 1u << (right - 1u);
        let nearest = digits >> right;
        let up = (rest > half) | ((rest == half) & ((nearest & 1u) == 1u));
        whole = vec2(nearest + u32(up), 0u);
    }
    let low = ~whole.x + 1u;
    whole = select(whole, vec2(low, ~whole.y + u32(low == 0u)), is_negative);
    // From 2^51 on, infinity among it; NaN.
    let large = (shift >= 28) | (exponent == 0xffu);
    whole = select(whole, select(vec2(0u, 1u << 19u), vec2(0u), is_negative), large);
    return select(whole, vec2(0u), (exponent == 0xffu) & (fraction != 0u));
}
