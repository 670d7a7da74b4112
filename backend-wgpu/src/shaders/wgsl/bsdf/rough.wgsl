// Rough mirrors, and a rough metal.
//: use bsdf::facets
//: use bsdf::fresnel
//: use bsdf::phong
//: use bsdf::sample

const ROUGH_SMOOTH: u32 = 0u;
const ROUGH_GGX: u32 = 1u;
const ROUGH_BECKMANN: u32 = 2u;
const ROUGH_PHONG: u32 = 3u;

// `size` is the scale of slopes of microfacets, or the exponent of a lobe.
struct Rough { kind: u32, size: f32 }

fn rough_facets(rough: Rough) -> Facets { return facets_new(rough.size, rough.kind == ROUGH_BECKMANN); }

fn rough_is_facets(rough: Rough) -> bool { return rough.kind == ROUGH_GGX || rough.kind == ROUGH_BECKMANN; }

// A value (f) and its density.
struct RoughValue { f: f32, pdf: f32 }

fn rough_half_vector(wo: vec3<f32>, wi: vec3<f32>) -> vec3<f32> { return math_normalize_or(wo + wi, wo); }

// f of perfect reflectors at facets of normal `m`, and the density of the directions that they reflect to.
fn rough_facets_reflect(facets: Facets, n: vec3<f32>, wo: vec3<f32>, wi: vec3<f32>, m: vec3<f32>) -> RoughValue {
    let pdf = 0.25f * facets_pdf_over_cos(facets, n, wo, m);
    let g = facets_masking_over_cos(facets, n, wo) * facets_masking_over_cos(facets, n, wi);
    return RoughValue(0.25f * facets_density(facets, n, m) * g, pdf);
}

fn rough_reflect(rough: Rough, n: vec3<f32>, wo: vec3<f32>, wi: vec3<f32>) -> RoughValue {
    if math_dot(wo, n) <= 0.0f || math_dot(wi, n) <= 0.0f { return RoughValue(0.0f, 0.0f); }
    if rough.kind == ROUGH_PHONG {
        let f = phong_pdf_solid_angle(rough.size, n, wo, wi);
        return RoughValue(f, f);
    }
    return rough_facets_reflect(rough_facets(rough), n, wo, wi, rough_half_vector(wo, wi));
}

fn rough_sample(rough: Rough, n: vec3<f32>, wo: vec3<f32>, u: vec2<f32>) -> vec3<f32> {
    if rough.kind == ROUGH_PHONG { return phong_sample(rough.size, n, wo, u); }
    return math_reflect(wo, facets_sample_visible(rough_facets(rough), n, wo, u));
}

struct Metal { rough: Rough, eta: vec3<f32>, k: vec3<f32> }

fn metal_reflectance(metal: Metal, wo: vec3<f32>, wi: vec3<f32>) -> vec3<f32> {
    let cos = math_clamp_number(math_dot(wo, rough_half_vector(wo, wi)), 0.0f, 1.0f);
    return fresnel_conductor_rgb(cos, metal.eta, metal.k);
}

fn metal_eval(metal: Metal, n: vec3<f32>, wo: vec3<f32>, wi: vec3<f32>) -> vec3<f32> {
    let f = rough_reflect(metal.rough, n, wo, wi).f;
    if f > 0.0f { return metal_reflectance(metal, wo, wi) * f; }
    return vec3(0.0f);
}

fn metal_sample(metal: Metal, n: vec3<f32>, wo: vec3<f32>, u: vec2<f32>) -> BsdfSample {
    if math_dot(wo, n) <= 0.0f { return bsdf_absorbed(); }
    let wi = rough_sample(metal.rough, n, wo, u);
    let value = rough_reflect(metal.rough, n, wo, wi);
    if !(value.pdf > 0.0f) { return bsdf_absorbed(); }
    let weight = metal_reflectance(metal, wo, wi) * (value.f / value.pdf * math_dot(wi, n));
    return BsdfSample(true, wi, weight, value.pdf);
}
