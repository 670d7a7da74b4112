// Sums of flux in fixed point: core's FluxUnit where it multiplies by a power of two. Numbers of 64 bits are two words, the low one first.

// The nearest integer to flux * 2^power, halves to even; 0 for NaN and from -2^51 downward, 2^51 from there upward.
fn illumination_units(flux: f32, power: i32) -> vec2<u32> {
    let bits = bitcast<u32>(flux);
    let is_negative = bits >= 0x80000000u;
    let exponent = (bits >> 23u) & 0xffu;
    var digits = bits & 0x7fffffu;
    if exponent == 0xffu {
        if digits != 0u || is_negative { return vec2(0u); }
        return vec2(0u, 1u << 19u);
    }
    // |flux| = digits * 2^(shift - power), with 24 digits.
    var shift = i32(max(exponent, 1u)) - 150 + power;
    if exponent != 0u {
        digits |= 0x800000u;
    } else {
        if digits == 0u { return vec2(0u); }
        let missing = countLeadingZeros(digits) - 8u;
        digits <<= missing;
        shift -= i32(missing);
    }
    if shift >= 28 {
        return select(vec2(0u, 1u << 19u), vec2(0u), is_negative);
    }
    var whole = vec2(0u);
    if shift >= 0 {
        let left = u32(shift);
        whole = vec2(digits << left, (digits >> 1u) >> (31u - left));
    } else if shift >= -24 {
        let right = u32(-shift);
        let rest = digits & ((1u << right) - 1u);
        let half = 1u << (right - 1u);
        var nearest = digits >> right;
        if rest > half || (rest == half && (nearest & 1u) == 1u) { nearest += 1u; }
        whole = vec2(nearest, 0u);
    }
    if is_negative {
        let low = ~whole.x + 1u;
        return vec2(low, ~whole.y + u32(low == 0u));
    }
    return whole;
}
