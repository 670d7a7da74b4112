// Microfacets: how their normals are distributed, how they hide each other, and which of them are seen.
//: use bsdf::erf
//: use math::consts
//: use math::roots
//: use math::vector
//: use sampling::warp

const FACETS_ALPHA_MIN: f32 = 1e-4f;
const FACETS_STEPS: u32 = 8u;

struct Facets { alpha: f32, beckmann: bool }

fn facets_new(alpha: f32, beckmann: bool) -> Facets {
    return Facets(math_max_number(alpha, FACETS_ALPHA_MIN), beckmann);
}

struct CosSin2 { cos: f32, sin2: f32 }

fn facets_cos_sin2(n: vec3<f32>, v: vec3<f32>) -> CosSin2 {
    let across = math_cross(n, v);
    return CosSin2(math_dot(n, v), math_dot(across, across));
}

fn facets_density(facets: Facets, n: vec3<f32>, m: vec3<f32>) -> f32 {
    let angle = facets_cos_sin2(n, m);
    if angle.cos <= 0.0f { return 0.0f; }
    let alpha2 = facets.alpha * facets.alpha;
    let cos2 = angle.cos * angle.cos;
    if facets.beckmann {
        let e = math_exp(-angle.sin2 / (alpha2 * cos2));
        if e > 0.0f { return e * INV_PI / (alpha2 * cos2 * cos2); }
        return 0.0f;
    }
    let k = angle.sin2 / alpha2 + cos2;
    return INV_PI / (alpha2 * k * k);
}

fn facets_masking_over_cos(facets: Facets, n: vec3<f32>, v: vec3<f32>) -> f32 {
    let angle = facets_cos_sin2(n, v);
    let cos = math_abs(angle.cos);
    if !facets.beckmann {
        return 2.0f / (cos + sqrt(cos * cos + facets.alpha * facets.alpha * angle.sin2));
    }
    let spread = facets.alpha * sqrt(angle.sin2);
    if cos >= 1.6f * spread { return 1.0f / cos; }
    let a = cos / spread;
    return (3.535f + 2.181f * a) / ((1.0f + a * (2.276f + 2.577f * a)) * spread);
}

fn facets_masking(facets: Facets, n: vec3<f32>, v: vec3<f32>) -> f32 {
    let cos = math_abs(math_dot(n, v));
    if cos > 0.0f { return math_min_number(facets_masking_over_cos(facets, n, v) * cos, 1.0f); }
    return 0.0f;
}

// The same of which samples are drawn: exact.
fn facets_seen_over_cos(facets: Facets, n: vec3<f32>, v: vec3<f32>) -> f32 {
    if !facets.beckmann { return facets_masking_over_cos(facets, n, v); }
    let angle = facets_cos_sin2(n, v);
    let cos = math_abs(angle.cos);
    let spread = facets.alpha * sqrt(angle.sin2);
    var a = math_infinity();
    if spread > 0.0f { a = cos / spread; }
    return 2.0f / (cos * (1.0f + erf_erf(a)) + spread * INV_SQRT_PI * math_exp(-a * a));
}

fn facets_pdf_over_cos(facets: Facets, n: vec3<f32>, wo: vec3<f32>, m: vec3<f32>) -> f32 {
    return facets_density(facets, n, m) * facets_seen_over_cos(facets, n, wo);
}

fn facets_pdf_visible(facets: Facets, n: vec3<f32>, wo: vec3<f32>, m: vec3<f32>) -> f32 {
    return facets_pdf_over_cos(facets, n, wo, m) * math_max_number(math_dot(wo, m), 0.0f);
}

fn facets_sample_cap(v: vec3<f32>, u: vec2<f32>) -> vec3<f32> {
    let height = u.x * (1.0f + v.z);
    let s = math_sqrt_clamped(height * (2.0f - height));
    let turn = warp_sin_cos_turns(u.y);
    return vec3(s * turn.c + v.x, s * turn.s + v.y, (1.0f - u.x) * (1.0f + v.z));
}

fn facets_sample_gaussian(v: vec3<f32>, u: vec2<f32>) -> vec3<f32> {
    let sin = sqrt(v.x * v.x + v.y * v.y);
    let cos = v.z;
    let sine = sin * INV_SQRT_PI;
    var cot = math_infinity();
    if sin > 0.0f { cot = cos / sin; }
    let top = erf_erf(cot);
    let end = math_min_number(cot, 1e18f);
    let all = cos * (1.0f + top) + sine * math_exp(-end * end);
    let u0 = math_clamp(u.x, 1e-6f, 1.0f - 1e-6f);
    let wanted = u0 * all;
    var low = -1.0f;
    var high = top;
    var y = top - (top + 1.0f) * erf_erf(math_sqrt_clamped(-math_ln(u0)));
    for (var i = 0u; i < FACETS_STEPS; i++) {
        let x = erf_inverse(y);
        let error = (cos * (1.0f + y) + sine * math_exp(-x * x)) - wanted;
        if error > 0.0f { high = y; } else { low = y; }
        let slope = cos - x * sin;
        if math_abs(error) <= 1e-7f * slope { break; }
        let next = y - error / slope;
        if slope > 0.0f && next > low && next < high { y = next; } else { y = 0.5f * (low + high); }
    }
    let x = erf_inverse(y);
    let across = erf_inverse(2.0f * u.y - 1.0f);
    var c = 1.0f;
    var s = 0.0f;
    if sin > 0.0f {
        c = v.x / sin;
        s = v.y / sin;
    }
    return vec3(s * across - c * x, -s * x - c * across, 1.0f);
}

fn facets_sample_visible(facets: Facets, n: vec3<f32>, wo: vec3<f32>, u: vec2<f32>) -> vec3<f32> {
    let basis = math_orthonormal_basis(n);
    let w = math_to_local(wo, basis.t, basis.b, n);
    let stretched = vec3(facets.alpha * w.x, facets.alpha * w.y, math_max_number(w.z, 0.0f));
    let v = math_normalize_or(stretched, vec3(0.0f, 0.0f, 1.0f));
    var m: vec3<f32>;
    if facets.beckmann { m = facets_sample_gaussian(v, u); } else { m = facets_sample_cap(v, u); }
    let back = vec3(facets.alpha * m.x, facets.alpha * m.y, m.z);
    return math_from_local(math_normalize_or(back, vec3(0.0f, 0.0f, 1.0f)), basis.t, basis.b, n);
}
