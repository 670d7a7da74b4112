// Blocks of BC1: exact integers. Texels are 0xAABBGGRR.

const BC1_NEAREST: u32 = 0u;
const BC1_TRUNCATED: u32 = 1u;
const BC1_MESA: u32 = 2u;
const BC1_AMD: u32 = 3u;
const BC1_NVIDIA: u32 = 4u;

// A 5-bit code (6-bit: green) as 8 bits.
fn bc1_widen(code: u32, five: bool) -> u32 {
    if five { return code << 3u | code >> 2u; }
    return code << 2u | code >> 4u;
}

fn bc1_narrow(value: u32, five: bool) -> u32 {
    if five { return (value * 31u + 127u) / 255u; }
    return (value * 63u + 127u) / 255u;
}

fn bc1_codes(word: u32) -> vec3<u32> {
    return vec3(word >> 11u & 31u, word >> 5u & 63u, word & 31u);
}

fn bc1_nvidia_green(a: u32, b: u32, part: i32) -> u32 {
    let d = i32(b) - i32(a);
    return u32((256i * i32(a) + d / 4i + 128i + part * d) >> 8u);
}

// Two parts of code a and one of b; a is the first endpoint's, or the second's where `back` is set.
fn bc1_third(rule: u32, code_a: u32, code_b: u32, five: bool, back: bool) -> u32 {
    let a = bc1_widen(code_a, five);
    let b = bc1_widen(code_b, five);
    switch rule {
        case BC1_TRUNCATED: { return (2u * a + b) / 3u; }
        case BC1_MESA: { return select(171u * a + 85u * b, 170u * a + 86u * b, back) >> 8u; }
        case BC1_AMD: { return (43u * a + 21u * b + 32u) >> 6u; }
        case BC1_NVIDIA: {
            if five { return (2u * code_a + code_b) * 22u / 8u; }
            return bc1_nvidia_green(a, b, 80i);
        }
        default: { return (2u * a + b + 1u) / 3u; }
    }
}

fn bc1_half(rule: u32, code_a: u32, code_b: u32, five: bool) -> u32 {
    let a = bc1_widen(code_a, five);
    let b = bc1_widen(code_b, five);
    switch rule {
        case BC1_TRUNCATED: { return (a + b) / 2u; }
        case BC1_NVIDIA: {
            if five { return (code_a + code_b) * 33u / 8u; }
            return bc1_nvidia_green(a, b, 128i);
        }
        default: { return (a + b + 1u) / 2u; }
    }
}

fn bc1_texel(rgb: vec3<u32>, alpha: u32) -> u32 {
    return (rgb.x & 255u) | (rgb.y & 255u) << 8u | (rgb.z & 255u) << 16u | alpha << 24u;
}

fn bc1_rgb(texel: u32) -> vec3<u32> {
    return vec3(texel & 255u, texel >> 8u & 255u, texel >> 16u & 255u);
}

fn bc1_palette(first: u32, second: u32, rule: u32) -> array<u32, 4> {
    let a = bc1_codes(first);
    let b = bc1_codes(second);
    let four = first > second;
    var ends = array<vec3<u32>, 2>();
    var between = array<vec3<u32>, 2>();
    for (var c = 0u; c < 3u; c++) {
        let five = c != 1u;
        ends[0][c] = bc1_widen(a[c], five);
        ends[1][c] = bc1_widen(b[c], five);
        if four {
            between[0][c] = bc1_third(rule, a[c], b[c], five, false);
            between[1][c] = bc1_third(rule, b[c], a[c], five, true);
        } else {
            between[0][c] = bc1_half(rule, a[c], b[c], five);
        }
    }
    return array<u32, 4>(
        bc1_texel(ends[0], 255u),
        bc1_texel(ends[1], 255u),
        bc1_texel(between[0], 255u),
        bc1_texel(between[1], select(0u, 255u, four)),
    );
}

fn bc1_decode_with(ends: u32, indices: u32, rule: u32) -> array<u32, 16> {
    var entries = bc1_palette(ends & 0xffffu, ends >> 16u, rule);
    var out = array<u32, 16>();
    for (var i = 0u; i < 16u; i++) { out[i] = entries[indices >> (2u * i) & 3u]; }
    return out;
}

fn bc1_distance(a: u32, b: u32) -> u32 {
    let d = vec3<i32>(bc1_rgb(a)) - vec3<i32>(bc1_rgb(b));
    return u32(d.x * d.x + d.y * d.y + d.z * d.z);
}

// The nearest palette entry for each texel that counts, the lowest among equals; 0 for others.
fn bc1_nearest_indices(texels: array<u32, 16>, counts: u32, first: u32, second: u32) -> u32 {
    var x = texels;
    var entries = bc1_palette(first, second, BC1_NEAREST);
    var indices = 0u;
    for (var i = 0u; i < 16u; i++) {
        var best = 0xffffffffu;
        var index = 0u;
        for (var p = 0u; p < 4u; p++) {
            let d = bc1_distance(x[i], entries[p]);
            if d < best {
                best = d;
                index = p;
            }
        }
        indices |= (index * (counts >> i & 1u)) << (2u * i);
    }
    return indices;
}

fn bc1_end_word(texel: u32) -> u32 {
    let rgb = bc1_rgb(texel);
    return bc1_narrow(rgb.x, true) << 11u | bc1_narrow(rgb.y, false) << 5u | bc1_narrow(rgb.z, true);
}

// Endpoints and indices.
fn bc1_encode_range_fit(texels: array<u32, 16>, counts: u32) -> vec2<u32> {
    var x = texels;
    var low = vec3<i32>(255i);
    var high = vec3<i32>(0i);
    var sum = vec3<i32>(0i);
    var n = 0i;
    for (var i = 0u; i < 16u; i++) {
        if (counts >> i & 1u) == 0u { continue; }
        let rgb = vec3<i32>(bc1_rgb(x[i]));
        low = min(low, rgb);
        high = max(high, rgb);
        sum += rgb;
        n += 1i;
    }
    if n == 0i { return vec2(0u, 0u); }
    let extent = high - low;
    var widest = 0u;
    for (var c = 1u; c < 3u; c++) {
        if extent[c] > extent[widest] { widest = c; }
    }
    // n^2 times the covariance, less the product of sums: at most 2^24.
    var products = vec3<i32>(0i);
    for (var i = 0u; i < 16u; i++) {
        if (counts >> i & 1u) == 0u { continue; }
        let rgb = vec3<i32>(bc1_rgb(x[i]));
        products += rgb * rgb[widest];
    }
    var axis = extent;
    for (var c = 0u; c < 3u; c++) {
        if n * products[c] < sum[c] * sum[widest] { axis[c] = -extent[c]; }
    }
    var ends = array<u32, 2>(0u, 0u);
    var least = 2147483647i;
    var most = -2147483647i - 1i;
    for (var i = 0u; i < 16u; i++) {
        if (counts >> i & 1u) == 0u { continue; }
        let rgb = vec3<i32>(bc1_rgb(x[i]));
        let t = axis.x * rgb.x + axis.y * rgb.y + axis.z * rgb.z;
        if t < least {
            least = t;
            ends[0] = x[i];
        }
        if t > most {
            most = t;
            ends[1] = x[i];
        }
    }
    let a = bc1_end_word(ends[0]);
    let b = bc1_end_word(ends[1]);
    let first = max(a, b);
    let second = min(a, b);
    var indices = 0u;
    if first > second { indices = bc1_nearest_indices(x, counts, first, second); }
    return vec2(first | second << 16u, indices);
}
