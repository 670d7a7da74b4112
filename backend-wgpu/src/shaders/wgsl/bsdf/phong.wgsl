// The Phong lobe.
//: use math::choice
//: use math::consts
//: use math::pow
//: use math::vector
//: use sampling::warp

fn phong_mirror_direction(n: vec3<f32>, wo: vec3<f32>) -> vec3<f32> { return n * (2.0f * math_dot(wo, n)) - wo; }

// The density of a lobe about an axis.
fn phong_about(exponent: f32, axis: vec3<f32>, wi: vec3<f32>) -> f32 {
    let cos = math_clamp_number(math_dot(wi, axis), 0.0f, 1.0f);
    if cos > 0.0f { return (exponent + 1.0f) / TAU * math_pow(cos, exponent); }
    return 0.0f;
}

fn phong_pdf_solid_angle(exponent: f32, n: vec3<f32>, wo: vec3<f32>, wi: vec3<f32>) -> f32 {
    return phong_about(exponent, phong_mirror_direction(n, wo), wi);
}

fn phong_eval(specular: vec3<f32>, exponent: f32, n: vec3<f32>, wo: vec3<f32>, wi: vec3<f32>) -> vec3<f32> {
    if math_dot(wi, n) > 0.0f { return specular * phong_pdf_solid_angle(exponent, n, wo, wi); }
    return vec3(0.0f);
}

fn phong_sample_about(exponent: f32, axis: vec3<f32>, u: vec2<f32>) -> vec3<f32> {
    let local = warp_sample_power_cosine(u, exponent);
    let basis = math_orthonormal_basis(axis);
    return math_from_local(local, basis.t, basis.b, axis);
}

fn phong_sample(exponent: f32, n: vec3<f32>, wo: vec3<f32>, u: vec2<f32>) -> vec3<f32> {
    return phong_sample_about(exponent, phong_mirror_direction(n, wo), u);
}
