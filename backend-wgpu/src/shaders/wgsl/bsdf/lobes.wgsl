// The sum of lobes at one surface point. Without `LOBES` there is nothing but a diffuse surface.
//: use bsdf::diffuse
//: use bsdf::sample
//: if LOBES
//: use bsdf::boundary
//: use bsdf::film
//: use bsdf::phong
//: use bsdf::plastic
//: use bsdf::rough

const FINISH_PLAIN: u32 = 0u;
const FINISH_METAL: u32 = 1u;
const FINISH_BOUNDARY: u32 = 2u;
const FINISH_PLASTIC: u32 = 3u;
const FINISH_FILM: u32 = 4u;
//: end

// A finish has its numbers in the fields that its material's record has them in: `ior` is eta of a metal, the ratio of a boundary, the
// index of a coat; `specular` is k of a metal, the transmitted albedo of a film. `coat` is where a `CoatRecord` begins.
struct Lobes {
    albedo: vec3<f32>,
    //: if LOBES
    exponent: f32,
    specular: vec3<f32>,
    finish: u32,
    ior: vec3<f32>,
    coat: u32,
    rough: Rough,
    mirror: bool,
    schlick: bool,
    //: end
}

fn lobes_diffuse(albedo: vec3<f32>) -> Lobes {
    //: if LOBES
    let smooth_ = Rough(ROUGH_SMOOTH, 0.0f);
    return Lobes(albedo, 0.0f, vec3(0.0f), FINISH_PLAIN, vec3(1.0f), 0u, smooth_, false, false);
    //: else
    return Lobes(albedo);
    //: end
}

fn lobes_plain(albedo: vec3<f32>, specular: vec3<f32>, exponent: f32, mirror: bool) -> Lobes {
    var lobes = lobes_diffuse(albedo);
    //: if LOBES
    lobes.specular = specular;
    lobes.exponent = exponent;
    lobes.mirror = mirror;
    //: end
    return lobes;
}

//: if LOBES
fn lobes_of_metal(rough: Rough, eta: vec3<f32>, k: vec3<f32>) -> Lobes {
    var lobes = lobes_diffuse(vec3(0.0f));
    lobes.finish = FINISH_METAL;
    lobes.rough = rough;
    lobes.ior = eta;
    lobes.specular = k;
    return lobes;
}

fn lobes_of_boundary(rough: Rough, ratio: vec3<f32>, schlick: bool) -> Lobes {
    var lobes = lobes_diffuse(vec3(0.0f));
    lobes.finish = FINISH_BOUNDARY;
    lobes.rough = rough;
    lobes.ior = ratio;
    lobes.schlick = schlick;
    return lobes;
}

// `body` is what `plastic_body` gives.
fn lobes_of_plastic(body: vec3<f32>, rough: Rough, ior: f32, coat: u32) -> Lobes {
    var lobes = lobes_diffuse(body);
    lobes.finish = FINISH_PLASTIC;
    lobes.rough = rough;
    lobes.ior = vec3(ior);
    lobes.coat = coat;
    return lobes;
}

fn lobes_of_film(reflect: vec3<f32>, transmit: vec3<f32>) -> Lobes {
    var lobes = lobes_diffuse(reflect);
    lobes.finish = FINISH_FILM;
    lobes.specular = transmit;
    return lobes;
}

fn lobes_metal(lobes: Lobes) -> Metal { return Metal(lobes.rough, lobes.ior, lobes.specular); }

fn lobes_boundary(lobes: Lobes) -> Boundary { return Boundary(lobes.rough, lobes.ior, lobes.schlick); }

fn lobes_coat(lobes: Lobes) -> Coat { return Coat(lobes.ior.x, lobes.rough, lobes.coat); }
//: end

fn lobes_has_density(lobes: Lobes) -> bool {
    //: if LOBES
    return !lobes.mirror;
    //: else
    return true;
    //: end
}

fn lobes_has_delta(lobes: Lobes) -> bool {
    //: if LOBES
    return lobes.mirror || (lobes.finish == FINISH_PLASTIC && lobes.rough.kind == ROUGH_SMOOTH);
    //: else
    return false;
    //: end
}

fn lobes_transmits(lobes: Lobes) -> bool {
    //: if LOBES
    return lobes.finish == FINISH_BOUNDARY || lobes.finish == FINISH_FILM;
    //: else
    return false;
    //: end
}

fn lobes_disperses(lobes: Lobes) -> bool {
    //: if LOBES
    return lobes.finish == FINISH_BOUNDARY && (lobes.ior.x != lobes.ior.y || lobes.ior.x != lobes.ior.z);
    //: else
    return false;
    //: end
}

fn lobes_of_channel(lobes_in: Lobes, channel: u32) -> Lobes {
    var lobes = lobes_in;
    //: if LOBES
    if lobes.finish == FINISH_BOUNDARY { lobes.ior = vec3(math_component(lobes.ior, channel % 3u)); }
    //: end
    return lobes;
}

fn lobes_index_ratio_squared(lobes: Lobes, n: vec3<f32>, wo: vec3<f32>, wi: vec3<f32>) -> f32 {
    //: if LOBES
    if lobes.finish == FINISH_BOUNDARY && math_dot(wo, n) * math_dot(wi, n) < 0.0f {
        var ratio = lobes.ior.x;
        if !(math_dot(wo, n) > 0.0f) { ratio = 1.0f / lobes.ior.x; }
        return ratio * ratio;
    }
    //: end
    return 1.0f;
}

fn lobes_is_plain(lobes: Lobes) -> bool {
    //: if LOBES
    return lobes.finish == FINISH_PLAIN;
    //: else
    return true;
    //: end
}

fn lobes_diffuse_albedo(lobes: Lobes, n: vec3<f32>, wo: vec3<f32>) -> vec3<f32> {
    //: if LOBES
    if lobes.finish == FINISH_PLASTIC {
        return plastic_diffuse_albedo(lobes_coat(lobes), lobes.albedo, math_dot(wo, n));
    }
    if lobes.finish != FINISH_PLAIN || lobes.mirror { return vec3(0.0f); }
    //: end
    return lobes.albedo;
}

//: if LOBES
fn lobes_diffuse_share(lobes: Lobes) -> f32 {
    let d = math_mean(lobes.albedo);
    let s = math_mean(lobes.specular);
    if d + s > 0.0f { return d / (d + s); }
    return 1.0f;
}

// f and the density of a finish.
fn lobes_finished(lobes: Lobes, n: vec3<f32>, wo: vec3<f32>, wi: vec3<f32>) -> BsdfValue {
    if lobes.finish == FINISH_METAL {
        let f = metal_eval(lobes_metal(lobes), n, wo, wi);
        return BsdfValue(f, rough_reflect(lobes.rough, n, wo, wi).pdf);
    }
    if lobes.finish == FINISH_BOUNDARY {
        let value = boundary_values(lobes_boundary(lobes), n, wo, wi);
        return BsdfValue(vec3(value.f), value.pdf);
    }
    if lobes.finish == FINISH_PLASTIC { return plastic_values(lobes_coat(lobes), lobes.albedo, n, wo, wi); }
    return film_values(lobes.albedo, lobes.specular, n, wo, wi);
}
//: end

// f of what has no finish. Apart from what has one, so that drivers, which put functions where they are called, have that but once.
fn lobes_eval_plain(lobes: Lobes, n: vec3<f32>, wo: vec3<f32>, wi: vec3<f32>) -> vec3<f32> {
    let f = diffuse_eval(lobes.albedo, n, wi);
    //: if LOBES
    if !math_is_zero3(lobes.specular) {
        return f + phong_eval(lobes.specular, lobes.exponent, n, wo, wi);
    }
    //: end
    return f;
}

fn lobes_pdf_plain(lobes: Lobes, n: vec3<f32>, wo: vec3<f32>, wi: vec3<f32>) -> f32 {
    //: if LOBES
    if !math_is_zero3(lobes.specular) {
        let share = lobes_diffuse_share(lobes);
        return share * diffuse_pdf_solid_angle(n, wi)
            + (1.0f - share) * phong_pdf_solid_angle(lobes.exponent, n, wo, wi);
    }
    //: end
    return diffuse_pdf_solid_angle(n, wi);
}

// `lobes_eval` and `lobes_pdf_solid_angle` at once.
fn lobes_value(lobes: Lobes, n: vec3<f32>, wo: vec3<f32>, wi: vec3<f32>) -> BsdfValue {
    //: if LOBES
    if lobes.mirror { return BsdfValue(vec3(0.0f), 0.0f); }
    if lobes.finish != FINISH_PLAIN { return lobes_finished(lobes, n, wo, wi); }
    //: end
    return BsdfValue(lobes_eval_plain(lobes, n, wo, wi), lobes_pdf_plain(lobes, n, wo, wi));
}

fn lobes_eval(lobes: Lobes, n: vec3<f32>, wo: vec3<f32>, wi: vec3<f32>) -> vec3<f32> {
    return lobes_value(lobes, n, wo, wi).f;
}

fn lobes_pdf_solid_angle(lobes: Lobes, n: vec3<f32>, wo: vec3<f32>, wi: vec3<f32>) -> f32 {
    return lobes_value(lobes, n, wo, wi).pdf;
}

//: if LOBES
fn lobes_sample_finished(lobes: Lobes, n: vec3<f32>, wo: vec3<f32>, u: vec2<f32>, lobe: f32) -> BsdfSample {
    if lobes.finish == FINISH_METAL { return metal_sample(lobes_metal(lobes), n, wo, u); }
    if lobes.finish == FINISH_BOUNDARY { return boundary_sample(lobes_boundary(lobes), n, wo, u, lobe); }
    if lobes.finish == FINISH_PLASTIC {
        return plastic_sample(lobes_coat(lobes), lobes.albedo, n, wo, u, lobe);
    }
    return film_sample(lobes.albedo, lobes.specular, n, wo, u, lobe);
}
//: end

fn lobes_sample(lobes: Lobes, n: vec3<f32>, wo: vec3<f32>, u: vec2<f32>, lobe: f32) -> BsdfSample {
    //: if LOBES
    if lobes.mirror {
        let wi = phong_mirror_direction(n, wo);
        return BsdfSample(math_dot(wi, n) > 0.0f, wi, lobes.albedo, 0.0f);
    }
    if lobes.finish != FINISH_PLAIN { return lobes_sample_finished(lobes, n, wo, u, lobe); }
    if !math_is_zero3(lobes.specular) {
        var wi: vec3<f32>;
        if lobe < lobes_diffuse_share(lobes) {
            wi = diffuse_sample(n, u);
        } else {
            wi = phong_sample(lobes.exponent, n, wo, u);
        }
        let cos = math_dot(wi, n);
        let pdf = lobes_pdf_plain(lobes, n, wo, wi);
        if !(cos > 0.0f && pdf > 0.0f) { return bsdf_absorbed(); }
        return BsdfSample(true, wi, lobes_eval_plain(lobes, n, wo, wi) * (cos / pdf), pdf);
    }
    //: end
    let wi = diffuse_sample(n, u);
    let pdf = diffuse_pdf_solid_angle(n, wi);
    return BsdfSample(pdf > 0.0f, wi, lobes.albedo, pdf);
}
