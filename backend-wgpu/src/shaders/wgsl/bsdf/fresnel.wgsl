// How much a smooth boundary reflects.
//: use math::choice
//: use math::roots
//: use math::vector

// Cosine beyond the boundary; -1 where all is reflected.
fn fresnel_refracted_cos(cos: f32, ratio: f32) -> f32 {
    let sin2 = (1.0f - cos) * (1.0f + cos) / (ratio * ratio);
    if sin2 < 1.0f { return sqrt(1.0f - sin2); }
    return -1.0f;
}

fn fresnel_dielectric(cos: f32, ratio: f32) -> f32 {
    let beyond = fresnel_refracted_cos(cos, ratio);
    if beyond < 0.0f { return 1.0f; }
    let senkrecht = (cos - ratio * beyond) / (cos + ratio * beyond);
    let parallel = (ratio * cos - beyond) / (ratio * cos + beyond);
    let both = 0.5f * (senkrecht * senkrecht + parallel * parallel);
    if both <= 1.0f { return both; }
    return 1.0f;
}

fn fresnel_schlick(cos: f32, ratio: f32) -> f32 {
    var c = cos;
    if ratio < 1.0f {
        c = fresnel_refracted_cos(cos, ratio);
        if c < 0.0f { return 1.0f; }
    }
    let r = (1.0f - ratio) / (1.0f + ratio);
    let r0 = r * r;
    let m = 1.0f - c;
    let m2 = m * m;
    return r0 + (1.0f - r0) * (m2 * m2 * m);
}

// By the one or the other.
fn fresnel_reflectance(cos: f32, ratio: f32, schlick: bool) -> f32 {
    if schlick { return fresnel_schlick(cos, ratio); }
    return fresnel_dielectric(cos, ratio);
}

fn fresnel_conductor(cos: f32, eta: f32, k: f32) -> f32 {
    let cos2 = cos * cos;
    let sin2 = (1.0f - cos) * (1.0f + cos);
    let difference = (eta - k) * (eta + k) - sin2;
    let product = eta * k;
    let a2_b2 = sqrt(difference * difference + 4.0f * product * product);
    var a2 = 0.5f * (a2_b2 + difference);
    if difference < 0.0f { a2 = 2.0f * product * product / (a2_b2 - difference); }
    let a = math_sqrt_clamped(a2);
    let senkrecht = (a2_b2 + cos2 - 2.0f * a * cos) / (a2_b2 + cos2 + 2.0f * a * cos);
    let s = cos2 * a2_b2 + sin2 * sin2;
    let t = 2.0f * a * cos * sin2;
    let parallel = senkrecht * (s - t) / (s + t);
    let both = 0.5f * (senkrecht + parallel);
    if both <= 1.0f { return math_max_number(both, 0.0f); }
    return 1.0f;
}

fn fresnel_conductor_rgb(cos: f32, eta: vec3<f32>, k: vec3<f32>) -> vec3<f32> {
    return vec3(
        fresnel_conductor(cos, eta.x, k.x),
        fresnel_conductor(cos, eta.y, k.y),
        fresnel_conductor(cos, eta.z, k.z),
    );
}

struct Refracted { found: bool, wi: vec3<f32> }

fn fresnel_refract(n: vec3<f32>, wo: vec3<f32>, ratio: f32) -> Refracted {
    let cos = math_clamp_number(math_dot(wo, n), 0.0f, 1.0f);
    let beyond = fresnel_refracted_cos(cos, ratio);
    if beyond < 0.0f { return Refracted(false, vec3(0.0f)); }
    return Refracted(true, math_normalize_or((n * cos - wo) / ratio - n * beyond, -n));
}
