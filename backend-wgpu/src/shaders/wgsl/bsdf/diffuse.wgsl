// Lambert's law.
//: use math::consts
//: use math::vector
//: use sampling::warp

fn diffuse_eval(albedo: vec3<f32>, n: vec3<f32>, wi: vec3<f32>) -> vec3<f32> {
    if math_dot(wi, n) > 0.0f { return albedo * INV_PI; }
    return vec3(0.0f);
}

fn diffuse_pdf_solid_angle(n: vec3<f32>, wi: vec3<f32>) -> f32 {
    return math_max_number(math_dot(wi, n) * INV_PI, 0.0f);
}

fn diffuse_sample(n: vec3<f32>, u: vec2<f32>) -> vec3<f32> {
    let local = warp_sample_cosine_hemisphere(u);
    let basis = math_orthonormal_basis(n);
    return basis.t * local.x + basis.b * local.y + n * local.z;
}
