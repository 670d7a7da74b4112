// What starts carry.
//: use math::bits
//: use math::rounding
//: use math::vector

fn first_shot_light_density(e: vec3<f32>, per_watt: f32) -> f32 {
    return math_clamp(per_watt * math_mean(e), 0.0f, MAX_FLOAT);
}

fn first_shot_clamp3(v: vec3<f32>) -> vec3<f32> {
    return vec3(
        math_clamp(v.x, 0.0f, MAX_FLOAT),
        math_clamp(v.y, 0.0f, MAX_FLOAT),
        math_clamp(v.z, 0.0f, MAX_FLOAT),
    );
}

fn first_shot_start_flux(e: vec3<f32>, density: f32, per_watt: f32) -> vec3<f32> {
    let all = math_max(density, 0.0f) + first_shot_light_density(e, per_watt);
    let finite = math_is_finite(e.x) && math_is_finite(e.y) && math_is_finite(e.z);
    if all > 0.0f && finite { return first_shot_clamp3(e / all); }
    return vec3(0.0f);
}

fn first_shot_light_share(e: vec3<f32>, density_in: f32, per_watt: f32) -> f32 {
    let from_light = first_shot_light_density(e, per_watt);
    let density = math_max(density_in, 0.0f);
    let all = from_light + density;
    if all <= 0.0f { return 1.0f; }
    if all <= MAX_FLOAT { return from_light / all; }
    let half = 0.5f * from_light;
    return half / (half + 0.5f * math_min(density, MAX_FLOAT));
}

fn first_shot_look_factor(chance: f32, blocked: bool) -> f32 {
    if !blocked { return 1.0f; }
    if chance > 0.0f && chance < 1.0f { return math_max(1.0f - 1.0f / chance, -MAX_FLOAT); }
    return 0.0f;
}

fn first_shot_piece_flux(colour: vec3<f32>, weights: vec3<f32>, area: f32, pmf: f32) -> vec3<f32> {
    let mean = (weights.x + weights.y + weights.z) / 3.0f;
    let flux = mean * area / pmf;
    if !(pmf > 0.0f && flux >= 0.0f) { return vec3(0.0f); }
    return first_shot_clamp3(colour * math_min(flux, MAX_FLOAT));
}
