// The phase function of Henyey and Greenstein.
//: use math::consts
//: use math::roots
//: use math::trig
//: use math::vector

fn phase_eval(g: f32, wo: vec3<f32>, wi: vec3<f32>) -> f32 {
    var turned = wi + wo;
    if g < 0.0f { turned = wi - wo; }
    let versine = 0.5f * math_dot(turned, turned);
    let a = math_abs(g);
    let rest = 1.0f - math_abs(g);
    let d = rest * rest + 2.0f * a * versine;
    return (1.0f - a) * (1.0f + a) / (4.0f * PI * d * sqrt(d));
}

fn phase_sample(g: f32, wo: vec3<f32>, numbers: vec2<f32>) -> vec3<f32> {
    let u = numbers.x;
    let rest = 1.0f - u;
    let d = (1.0f - g) + 2.0f * g * u;
    let scale = 2.0f / (d * d);
    let below = scale * rest * (1.0f - g) * (1.0f - g) * (1.0f + g * u);
    let above = scale * u * (1.0f + g) * (1.0f + g) * (1.0f - g * rest);
    var near = above;
    var cos = near - 1.0f;
    if below < above {
        near = below;
        cos = 1.0f - near;
    }
    let sin = math_sqrt_clamped(near * (2.0f - near));
    let turn = math_sin_cos(TAU * numbers.y);
    let along = -wo;
    let basis = math_orthonormal_basis(along);
    return basis.t * (sin * turn.c) + basis.b * (sin * turn.s) + along * cos;
}
