// Plastic: a diffuse body under a clear coat. What is computed of a coat once are words of a `CoatRecord` in the arena:
// internal reflectance, mean transmittance, two of padding, a table of transmittances.
//: use bsdf::diffuse
//: use bsdf::rough

const PLASTIC_TABLE: u32 = 16u;
const PLASTIC_COAT_MEAN: u32 = 1u;
const PLASTIC_COAT_TABLE: u32 = 4u;

// `record` is where the words begin.
struct Coat { ior: f32, rough: Rough, record: u32 }

fn plastic_body(internal: f32, ior: f32, albedo: vec3<f32>, nonlinear: bool) -> vec3<f32> {
    var kept = vec3(internal);
    if nonlinear { kept = albedo * internal; }
    let left = math_max3(vec3(1.0f) - kept, vec3(1.1920929e-7f));
    return albedo / (left * (ior * ior));
}

fn plastic_look_up(table: u32, cos: f32) -> f32 {
    let x = math_sqrt_clamped(math_min_number(cos, 1.0f)) * f32(PLASTIC_TABLE - 1u);
    let cell = min(u32(x), PLASTIC_TABLE - 2u);
    let f = x - f32(cell);
    let b = scene_float(table + cell);
    let c = scene_float(table + cell + 1u);
    var a = 2.0f * b - c;
    if cell > 0u { a = scene_float(table + cell - 1u); }
    var d = 2.0f * c - b;
    if cell + 2u < PLASTIC_TABLE { d = scene_float(table + cell + 2u); }
    let k1 = 0.5f * (c - a);
    let k2 = a - 2.5f * b + 2.0f * c - 0.5f * d;
    let k3 = 0.5f * (d - a) + 1.5f * (b - c);
    return math_clamp(b + f * (k1 + f * (k2 + f * k3)), 0.0f, 1.0f);
}

fn plastic_transmittance(coat: Coat, cos: f32) -> f32 {
    if rough_is_facets(coat.rough) {
        return plastic_look_up(coat.record + PLASTIC_COAT_TABLE, math_max_number(cos, 0.0f));
    }
    return 1.0f - fresnel_dielectric(math_clamp_number(cos, 0.0f, 1.0f), coat.ior);
}

fn plastic_diffuse_albedo(coat: Coat, body: vec3<f32>, cos: f32) -> vec3<f32> {
    return body * (plastic_transmittance(coat, cos) * scene_float(coat.record + PLASTIC_COAT_MEAN));
}

fn plastic_body_share(coat: Coat, body: vec3<f32>, cos: f32) -> f32 {
    let d = math_mean(plastic_diffuse_albedo(coat, body, cos));
    let s = 1.0f - plastic_transmittance(coat, cos);
    if d + s > 0.0f { return d / (d + s); }
    return 1.0f;
}

fn plastic_values(coat: Coat, body: vec3<f32>, n: vec3<f32>, wo: vec3<f32>, wi: vec3<f32>) -> BsdfValue {
    let before = math_dot(wo, n);
    let after = math_dot(wi, n);
    if before <= 0.0f || after <= 0.0f { return BsdfValue(vec3(0.0f), 0.0f); }
    let share = plastic_body_share(coat, body, before);
    var f = body * (plastic_transmittance(coat, before) * plastic_transmittance(coat, after) * INV_PI);
    var pdf = share * diffuse_pdf_solid_angle(n, wi);
    if coat.rough.kind != ROUGH_SMOOTH {
        let value = rough_reflect(coat.rough, n, wo, wi);
        let cos = math_clamp_number(math_dot(wo, rough_half_vector(wo, wi)), 0.0f, 1.0f);
        f += vec3(value.f * fresnel_dielectric(cos, coat.ior));
        pdf += (1.0f - share) * value.pdf;
    }
    return BsdfValue(f, pdf);
}

fn plastic_sample(coat: Coat, body: vec3<f32>, n: vec3<f32>, wo: vec3<f32>, u: vec2<f32>, lobe: f32) -> BsdfSample {
    let cos = math_dot(wo, n);
    if cos <= 0.0f { return bsdf_absorbed(); }
    let share = plastic_body_share(coat, body, cos);
    var wi: vec3<f32>;
    if lobe < share {
        wi = diffuse_sample(n, u);
    } else if coat.rough.kind != ROUGH_SMOOTH {
        wi = rough_sample(coat.rough, n, wo, u);
    } else {
        let reflectance = fresnel_dielectric(math_clamp_number(cos, 0.0f, 1.0f), coat.ior);
        let mirrored = phong_mirror_direction(n, wo);
        return BsdfSample(math_dot(mirrored, n) > 0.0f, mirrored, vec3(reflectance / (1.0f - share)), 0.0f);
    }
    let value = plastic_values(coat, body, n, wo, wi);
    if !(value.pdf > 0.0f) { return bsdf_absorbed(); }
    return BsdfSample(true, wi, value.f * (math_dot(wi, n) / value.pdf), value.pdf);
}
