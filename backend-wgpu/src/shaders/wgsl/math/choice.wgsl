// What Rust's own floats and glam's vectors do: clamps that keep NaN, casts that saturate, tests of all components.
//: use math::bits
//: use math::rounding

// NaN stays, unlike with `math_clamp`; and so does a zero of either sign.
fn math_clamp_number(x_in: f32, low: f32, high: f32) -> f32 {
    var x = x_in;
    if x < low { x = low; }
    if x > high { x = high; }
    return x;
}

// 0 for NaN and below; the largest integer above.
fn math_to_u32(x: f32) -> u32 {
    if x >= 4294967296.0f { return 0xffffffffu; }
    if x > 0.0f { return u32(x); }
    return 0u;
}

fn math_to_i32(x: f32) -> i32 {
    if x >= 2147483648.0f { return 2147483647; }
    if x <= -2147483648.0f { return -2147483647 - 1; }
    if math_is_nan(x) { return 0; }
    return i32(x);
}

fn math_is_finite3(v: vec3<f32>) -> bool {
    return math_is_finite(v.x) && math_is_finite(v.y) && math_is_finite(v.z);
}

fn math_is_zero3(v: vec3<f32>) -> bool { return v.x == 0.0f && v.y == 0.0f && v.z == 0.0f; }

fn math_abs3(v: vec3<f32>) -> vec3<f32> { return vec3(math_abs(v.x), math_abs(v.y), math_abs(v.z)); }

fn math_min3(a: vec3<f32>, b: vec3<f32>) -> vec3<f32> {
    return vec3(math_min(a.x, b.x), math_min(a.y, b.y), math_min(a.z, b.z));
}

fn math_max3(a: vec3<f32>, b: vec3<f32>) -> vec3<f32> {
    return vec3(math_max(a.x, b.x), math_max(a.y, b.y), math_max(a.z, b.z));
}

// Component 0 to 2; of larger numbers the last one.
fn math_component(v: vec3<f32>, k: u32) -> f32 {
    return select(select(v.z, v.y, k == 1u), v.x, k == 0u);
}

fn math_max_element(v: vec3<f32>) -> f32 { return math_max(v.x, math_max(v.y, v.z)); }
