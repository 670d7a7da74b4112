// A film that scatters evenly to both sides.
//: use bsdf::diffuse
//: use bsdf::sample

fn film_share(reflect: vec3<f32>, transmit: vec3<f32>) -> f32 {
    let r = math_mean(reflect);
    let t = math_mean(transmit);
    if r + t > 0.0f { return r / (r + t); }
    return 1.0f;
}

fn film_values(reflect: vec3<f32>, transmit: vec3<f32>, n: vec3<f32>, wo: vec3<f32>, wi: vec3<f32>) -> BsdfValue {
    let cos = math_dot(wi, n);
    let share = film_share(reflect, transmit);
    if cos == 0.0f { return BsdfValue(vec3(0.0f), 0.0f); }
    if (cos > 0.0f) == (math_dot(wo, n) >= 0.0f) {
        return BsdfValue(reflect * INV_PI, share * math_abs(cos) * INV_PI);
    }
    return BsdfValue(transmit * INV_PI, (1.0f - share) * math_abs(cos) * INV_PI);
}

fn film_sample(
    reflect: vec3<f32>, transmit: vec3<f32>, n: vec3<f32>, wo: vec3<f32>, u: vec2<f32>, lobe: f32,
) -> BsdfSample {
    let stays = lobe < film_share(reflect, transmit);
    var side = n;
    if stays != (math_dot(wo, n) >= 0.0f) { side = -n; }
    let wi = diffuse_sample(side, u);
    let value = film_values(reflect, transmit, n, wo, wi);
    if !(value.pdf > 0.0f) { return bsdf_absorbed(); }
    return BsdfSample(true, wi, value.f * (math_abs(math_dot(wi, n)) / value.pdf), value.pdf);
}
