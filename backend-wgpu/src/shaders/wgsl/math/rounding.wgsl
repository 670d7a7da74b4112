// Rounding to integers and choosing between values: all exact.
//: use math::bits

fn math_trunc(x: f32) -> f32 {
    if math_abs(x) < 8388608.0f { return math_copysign(f32(i32(x)), x); }
    return x;
}

fn math_floor(x: f32) -> f32 {
    let t = math_trunc(x);
    if t > x { return t - 1.0f; }
    return t;
}

fn math_ceil(x: f32) -> f32 {
    let t = math_trunc(x);
    if t < x { return t + 1.0f; }
    return t;
}

fn math_round(x: f32) -> f32 {
    let t = math_trunc(x);
    if math_abs(x - t) >= 0.5f { return t + math_copysign(1.0f, x); }
    return t;
}

fn math_fract(x: f32) -> f32 {
    let d = x - math_floor(x);
    if d >= 1.0f { return ONE_MINUS_EPSILON; }
    return d;
}

// `b` if either is NaN or both are zeros.
fn math_min(a: f32, b: f32) -> f32 { return select(b, a, a < b); }

fn math_max(a: f32, b: f32) -> f32 { return select(b, a, a > b); }

fn math_clamp(x: f32, low: f32, high: f32) -> f32 { return math_min(math_max(x, low), high); }
