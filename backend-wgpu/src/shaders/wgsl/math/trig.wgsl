// Sine and cosine: argument in radians.
//: use math::bits

struct SinCos { s: f32, c: f32 }

fn math_sin_reduced(r: f32, lower: f32, z: f32) -> f32 {
    let s = -0.16666654f + z * (0.008332106f + z * -1.9507883e-4f);
    return r + (r * z * s + lower);
}

fn math_cos_reduced(r: f32, lower: f32, z: f32) -> f32 {
    let c = 0.041666646f + z * (-0.0013887308f + z * 2.4432102e-5f);
    let half_z = 0.5f * z;
    let w = math_kept(1.0f - half_z);
    return w + ((math_kept(1.0f - w) - half_z) + (z * z * c - r * lower));
}

fn math_sin_cos(x_in: f32) -> SinCos {
    if math_is_nan(x_in) { return SinCos(x_in, x_in); }
    var x = x_in;
    if math_abs(x) > 3216.0f { x = 0.0f; }
    let n = math_nearest(x * 0.636619747f);
    let r1 = math_kept(x - math_kept(n.kf * 1.5705566f));
    let n2 = math_kept(n.kf * 2.3967028e-4f);
    let r2 = math_kept(r1 - n2);
    let e2 = math_kept(r1 - r2) - n2;
    let n3 = math_kept(n.kf * 1.5890691e-8f);
    let r3 = math_kept(r2 - n3);
    let e3 = math_kept(r2 - r3) - n3;
    let lost = math_kept((e2 + e3) - n.kf * 2.563344e-12f);
    let r = math_kept(r3 + lost);
    let lower = math_kept(r3 - r) + lost;
    let z = r * r;
    let s = bitcast<u32>(math_sin_reduced(r, lower, z));
    let c = bitcast<u32>(math_cos_reduced(r, lower, z));
    let k = bitcast<u32>(n.k);
    let swap = (s ^ c) & (0u - (k & 1u));
    let sin_sign = (k & 2u) << 30u;
    let cos_sign = ((k + 1u) & 2u) << 30u;
    return SinCos(bitcast<f32>(s ^ swap ^ sin_sign), bitcast<f32>(c ^ swap ^ cos_sign));
}

fn math_sin_cos_quarter(x: f32) -> SinCos {
    let z = x * x;
    return SinCos(math_sin_reduced(x, 0.0f, z), math_cos_reduced(x, 0.0f, z));
}
