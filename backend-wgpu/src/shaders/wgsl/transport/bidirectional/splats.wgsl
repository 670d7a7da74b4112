// What lands in pixels from elsewhere, as whole numbers of units in three words, the lowest first: core's sums of 64 bits, which saturate
// where these go on.
//: use math::choice

// 2^58: what is larger is clipped.
const SPLAT_UNITS_MAX: f32 = 288230376151711744.0f;

fn splat_units(value: f32, per_unit: f32) -> vec3<u32> {
    let units = math_clamp_number(value * per_unit, -SPLAT_UNITS_MAX, SPLAT_UNITS_MAX);
    if math_is_nan(units) { return vec3(0u); }
    // To the nearest, and what is left of a fraction is cut off.
    let bits = bitcast<u32>(units + select(0.5f, -0.5f, units < 0.0f));
    let digits = (bits & 0x7fffffu) | 0x800000u;
    let shift = i32((bits >> 23u) & 0xffu) - 150;
    var whole = vec2(0u);
    if shift >= 32 {
        whole.y = digits << u32(min(shift - 32, 7));
    } else if shift >= 0 {
        // Two shifts, since one of 32 would be none.
        whole = vec2(digits << u32(shift), (digits >> 1u) >> u32(31 - shift));
    } else if shift > -24 {
        whole.x = digits >> u32(-shift);
    }
    if bits < 0x80000000u || (whole.x | whole.y) == 0u { return vec3(whole, 0u); }
    let low = ~whole.x + 1u;
    return vec3(low, ~whole.y + u32(low == 0u), 0xffffffffu);
}
