// Rough boundaries between dielectrics.
//: use bsdf::rough

struct Boundary { rough: Rough, ratio: vec3<f32>, schlick: bool }

// As seen from `wo`: n on its side, and the index beyond over that before.
struct BoundarySeen { n: vec3<f32>, ratio: f32 }

fn boundary_seen(boundary: Boundary, n: vec3<f32>, wo: vec3<f32>) -> BoundarySeen {
    let ratio = boundary.ratio.x;
    if math_dot(wo, n) >= 0.0f { return BoundarySeen(n, ratio); }
    return BoundarySeen(-n, 1.0f / ratio);
}

fn boundary_fresnel(boundary: Boundary, cos: f32, ratio: f32) -> f32 {
    return fresnel_reflectance(math_clamp_number(cos, 0.0f, 1.0f), ratio, boundary.schlick);
}

fn boundary_reflected(
    boundary: Boundary, seen: BoundarySeen, wo: vec3<f32>, wi: vec3<f32>, m: vec3<f32>,
) -> RoughValue {
    let share = boundary_fresnel(boundary, math_dot(wo, m), seen.ratio);
    let value = rough_facets_reflect(rough_facets(boundary.rough), seen.n, wo, wi, m);
    return RoughValue(share * value.f, share * value.pdf);
}

fn boundary_passed(
    boundary: Boundary, seen: BoundarySeen, wo: vec3<f32>, wi: vec3<f32>, m: vec3<f32>,
) -> RoughValue {
    let co = math_dot(wo, m);
    let ci = -math_dot(wi, m);
    if co <= 0.0f || ci <= 0.0f { return RoughValue(0.0f, 0.0f); }
    let ratio = seen.ratio;
    let root = co - ratio * ci;
    let stretch = root * root;
    if stretch < 1e-12f { return RoughValue(0.0f, 0.0f); }
    let facets = rough_facets(boundary.rough);
    let share = (1.0f - boundary_fresnel(boundary, co, ratio)) * (co * ci / stretch);
    let pdf = share * ratio * ratio * facets_pdf_over_cos(facets, seen.n, wo, m);
    let g = facets_masking_over_cos(facets, seen.n, wo) * facets_masking_over_cos(facets, seen.n, wi);
    return RoughValue(share * facets_density(facets, seen.n, m) * g, pdf);
}

fn boundary_phong(boundary: Boundary, seen: BoundarySeen, wo: vec3<f32>, wi: vec3<f32>) -> RoughValue {
    let exponent = boundary.rough.size;
    let ratio = seen.ratio;
    let share = boundary_fresnel(boundary, math_dot(wo, seen.n), ratio);
    if math_dot(wi, seen.n) > 0.0f {
        let f = share * phong_pdf_solid_angle(exponent, seen.n, wo, wi);
        return RoughValue(f, f);
    }
    let axis = fresnel_refract(seen.n, wo, ratio);
    if !axis.found { return RoughValue(0.0f, 0.0f); }
    let pdf = (1.0f - share) * phong_about(exponent, axis.wi, wi);
    return RoughValue(pdf / (ratio * ratio), pdf);
}

fn boundary_values(boundary: Boundary, n_in: vec3<f32>, wo: vec3<f32>, wi: vec3<f32>) -> RoughValue {
    let seen = boundary_seen(boundary, n_in, wo);
    let before = math_dot(wo, seen.n);
    let after = math_dot(wi, seen.n);
    if before == 0.0f || after == 0.0f { return RoughValue(0.0f, 0.0f); }
    if boundary.rough.kind == ROUGH_PHONG { return boundary_phong(boundary, seen, wo, wi); }
    if after > 0.0f { return boundary_reflected(boundary, seen, wo, wi, rough_half_vector(wo, wi)); }
    var m = math_normalize_or(wo + wi * seen.ratio, vec3(0.0f));
    if math_dot(m, seen.n) < 0.0f { m = -m; }
    return boundary_passed(boundary, seen, wo, wi, m);
}

fn boundary_sample(boundary: Boundary, n_in: vec3<f32>, wo: vec3<f32>, u: vec2<f32>, lobe: f32) -> BsdfSample {
    let seen = boundary_seen(boundary, n_in, wo);
    var wi: vec3<f32>;
    var value: RoughValue;
    var passes: bool;
    if boundary.rough.kind == ROUGH_PHONG {
        passes = lobe >= boundary_fresnel(boundary, math_dot(wo, seen.n), seen.ratio);
        if passes {
            let axis = fresnel_refract(seen.n, wo, seen.ratio);
            if !axis.found { return bsdf_absorbed(); }
            wi = phong_sample_about(boundary.rough.size, axis.wi, u);
        } else {
            wi = phong_sample(boundary.rough.size, seen.n, wo, u);
        }
        value = boundary_phong(boundary, seen, wo, wi);
    } else {
        let m = facets_sample_visible(rough_facets(boundary.rough), seen.n, wo, u);
        passes = !(lobe < boundary_fresnel(boundary, math_dot(wo, m), seen.ratio));
        if passes {
            let refracted = fresnel_refract(m, wo, seen.ratio);
            if !refracted.found { return bsdf_absorbed(); }
            wi = refracted.wi;
            value = boundary_passed(boundary, seen, wo, wi, m);
        } else {
            wi = math_reflect(wo, m);
            value = boundary_reflected(boundary, seen, wo, wi, m);
        }
    }
    let cos = math_dot(wi, seen.n);
    if cos == 0.0f || (cos < 0.0f) != passes || value.pdf <= 0.0f { return bsdf_absorbed(); }
    return BsdfSample(true, wi, vec3(value.f / value.pdf * math_abs(cos)), value.pdf);
}
