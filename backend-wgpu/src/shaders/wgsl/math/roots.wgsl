// Square root and cube root.
//: use math::bits

fn math_sqrt(x: f32) -> f32 { return sqrt(x); }

fn math_sqrt_clamped(x: f32) -> f32 { return sqrt(select(0.0f, x, x > 0.0f)); }

fn math_cbrt(x: f32) -> f32 {
    let a = math_abs(x);
    var v = a;
    var back = 1.0f;
    if a < 8.0e-19f {
        v = a * 281474976710656.0f;
        back = 1.0f / 65536.0f;
    }
    let third = 0.333333343f;
    var y = bitcast<f32>(0x54a21d2au - bitcast<u32>(v) / 3u);
    y = y + y * third * (1.0f - (v * y) * y * y);
    y = y + y * third * (1.0f - (v * y) * y * y);
    let y2 = y * y;
    let t = math_kept(v * y2);
    let upper = math_upper8(t);
    let lower = math_kept(t - upper);
    let residual = math_kept(v - math_kept(upper * upper * upper)) - lower * (3.0f * (upper * t) + lower * lower);
    let root = (t + residual * (y2 * third)) * back;
    if a > 0.0f && math_is_finite(a) { return math_copysign(root, x); }
    return x;
}
