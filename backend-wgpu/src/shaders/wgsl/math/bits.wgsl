// Integer operations on the bits of a float, and values that WGSL has no literal of.

const ONE_MINUS_EPSILON: f32 = 0.99999994f;
const MIN_POSITIVE: f32 = 1.1754944e-38f;
const MAX_FLOAT: f32 = 3.4028235e38f;

//: if REORDERED
// Zero, which the compiler cannot know: entry points set it from a word of the host.
var<private> math_opaque: u32;

// The number as it was computed: a compiler that reorders sums and fuses products may not look through.
fn math_kept(x: f32) -> f32 { return bitcast<f32>(bitcast<u32>(x) ^ math_opaque); }

fn math_kept4(x: vec4<f32>) -> vec4<f32> { return bitcast<vec4<f32>>(bitcast<vec4<u32>>(x) ^ vec4(math_opaque)); }
//: else
// Sums and products are as written.
fn math_kept(x: f32) -> f32 { return x; }

fn math_kept4(x: vec4<f32>) -> vec4<f32> { return x; }
//: end

// From a variable, since constant expressions may not be infinite.
fn math_infinity() -> f32 {
    var bits = 0x7f800000u;
    return bitcast<f32>(bits);
}

fn math_nan() -> f32 {
    var bits = 0x7fc00000u;
    return bitcast<f32>(bits);
}

fn math_is_nan(x: f32) -> bool { return (bitcast<u32>(x) & 0x7fffffffu) > 0x7f800000u; }

fn math_is_finite(x: f32) -> bool { return (bitcast<u32>(x) & 0x7fffffffu) < 0x7f800000u; }

fn math_abs(x: f32) -> f32 { return bitcast<f32>(bitcast<u32>(x) & 0x7fffffffu); }

fn math_copysign(x: f32, sign: f32) -> f32 {
    return bitcast<f32>((bitcast<u32>(x) & 0x7fffffffu) | (bitcast<u32>(sign) & 0x80000000u));
}

// 0 for either zero: the twin of `x + 0.0`, which drivers drop.
fn math_positive_zero(x: f32) -> f32 {
    let bits = bitcast<u32>(x);
    return bitcast<f32>(select(bits, 0u, bits == 0x80000000u));
}

fn math_u32_to_unit(x: u32) -> f32 { return f32(x >> 8u) * (1.0f / 16777216.0f); }

fn math_pow2(k: i32) -> f32 { return bitcast<f32>(u32(k + 127) << 23u); }

fn math_scale(y: f32, k: i32) -> f32 {
    let h = k >> 1u;
    return math_kept(y * math_pow2(h)) * math_pow2(k - h);
}

// Powers of two that together are no float: their product must not be taken first.
fn math_ldexp(x_in: f32, k_in: i32) -> f32 {
    var x = x_in;
    var k = k_in;
    if k > 127 {
        x = math_kept(x * math_pow2(127));
        k -= 127;
        if k > 127 {
            x = math_kept(x * math_pow2(127));
            k -= 127;
            if k > 127 { k = 127; }
        }
    } else if k < -126 {
        x = math_kept(x * math_pow2(-102));
        k += 102;
        if k < -126 {
            x = math_kept(x * math_pow2(-102));
            k += 102;
            if k < -126 { k = -126; }
        }
    }
    return x * math_pow2(k);
}

fn math_exponent(x: f32) -> i32 {
    let magnitude = bitcast<u32>(x) & 0x7fffffffu;
    if magnitude >= 0x00800000u { return i32(magnitude >> 23u) - 127; }
    if magnitude == 0u { return 0; }
    return -118 - i32(countLeadingZeros(magnitude));
}

fn math_upper12(x: f32) -> f32 { return bitcast<f32>(bitcast<u32>(x) & 0xfffff000u); }

fn math_upper8(x: f32) -> f32 { return bitcast<f32>(bitcast<u32>(x) & 0xffff0000u); }

struct Nearest { k: i32, kf: f32 }

fn math_nearest(x: f32) -> Nearest {
    let kf = round(x);
    return Nearest(i32(kf), kf);
}

fn math_is_positive_normal(x: f32) -> bool { return bitcast<u32>(x) - 0x00800000u < 0x7f000000u; }

struct AroundOne { k: i32, m: f32 }

fn math_split_around_one(x: f32) -> AroundOne {
    let above = bitcast<u32>(x) - 0x3f3504f3u;
    return AroundOne(bitcast<i32>(above) >> 23u, bitcast<f32>((above & 0x007fffffu) + 0x3f3504f3u));
}

fn math_normalised(x: f32) -> f32 { return x * 8388608.0f; }

// The high word of a product, and the low one: (high, low).
fn math_wide_mul(a: u32, b: u32) -> vec2<u32> {
    let al = a & 0xffffu;
    let ah = a >> 16u;
    let bl = b & 0xffffu;
    let bh = b >> 16u;
    let ll = al * bl;
    let lh = al * bh;
    let hl = ah * bl;
    // Below 3 * 2^16: no carry is lost.
    let middle = (ll >> 16u) + (lh & 0xffffu) + (hl & 0xffffu);
    return vec2(ah * bh + (lh >> 16u) + (hl >> 16u) + (middle >> 16u), a * b);
}
