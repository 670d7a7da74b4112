// Where walks from lights start, and how likely.
//: use light
//: use light::emit
//: use wavefront::job

// At infinity.
fn emitters_is_distant(light: u32) -> bool {
    let kind = scene_word(light);
    return kind == LIGHT_DIRECTIONAL || kind == LIGHT_ENVIRONMENT;
}

// A ray can meet it by chance.
fn emitters_is_met(light: u32) -> bool {
    return scene_float(light + LIGHT_AREA) > 0.0f || scene_word(light) == LIGHT_ENVIRONMENT;
}

// Density of the place that emission draws on a light, the choice of the light included: per area, or its chance where it has none.
fn emitters_pdf_place(light: u32) -> f32 {
    let pmf = scene_float(light + LIGHT_PMF);
    let area = scene_float(light + LIGHT_AREA);
    if area > 0.0f { return pmf / area; }
    return pmf;
}

//: if ENVIRONMENT_MAP
// Density per solid angle at which light sampling and emission draw a direction to the picture of the environment.
fn emitters_pdf_picture(pdf: f32) -> f32 {
    return pdf * scene_float(light_record(scene_at.environment_light) + LIGHT_PMF);
}
//: end

// By how much light sampling at a point is likelier to draw a place on a light than emission is: 1 but for spheres.
fn emitters_preference(light: u32, pdf: f32, facing: f32) -> f32 {
    if scene_word(light) == LIGHT_SPHERE { return pdf * facing / emitters_pdf_place(light); }
    return 1.0f;
}

// The same for a place on the light seen from `p`.
fn emitters_preference_at(light: u32, p: vec3<f32>, place: vec3<f32>) -> f32 {
    if scene_word(light) != LIGHT_SPHERE { return 1.0f; }
    let to = place - p;
    let d2 = math_dot(to, to);
    let wi = math_normalize_or(to, vec3(0.0f));
    let normal = math_normalize_or(place - light_float3(light + LIGHT_PLACE), vec3(0.0f));
    let pdf = light_pdf_solid_angle(light, p, wi, sqrt(d2), normal);
    return emitters_preference(light, pdf, math_abs(math_dot(wi, normal)) / d2);
}

// What is sent from a light to a vertex that it lights: the density per solid angle, or per area of a beam, by which emission draws it.
fn emitters_pdf_towards(light: u32, wi: vec3<f32>, normal: vec3<f32>) -> f32 {
    if emitters_is_distant(light) { return 1.0f / (PI * job.sphere.w * job.sphere.w); }
    return emit_pdf_direction(light, -wi, normal);
}

// Number of a light that is picked as light sampling picks it.
fn emitters_pick(word: u32) -> u32 {
    if scene_at.light_count == 1u { return 0u; }
    counts_at = scene_at.light_cumulative;
    return discrete_pick_in(scene_at.light_count, word).index;
}

// The start of a walk: `carried` is flux over the chance of the light, the densities are of place and direction.
struct EmittersStart {
    found: bool,
    light: u32,
    ray: Ray,
    position: vec3<f32>,
    normal: vec3<f32>,
    carried: vec3<f32>,
    pdf_place: f32,
    pdf_direction: f32,
}

fn emitters_start(word: u32, u: vec4<f32>) -> EmittersStart {
    let index = emitters_pick(word);
    let light = light_record(index);
    let is_distant = emitters_is_distant(light);
    var emission: Emission;
    var pdf_place = emitters_pdf_place(light);
    //: if ENVIRONMENT_MAP
    if scene_word(light) == LIGHT_ENVIRONMENT {
        emission = emit_picture(job.sphere, u);
        pdf_place = emitters_pdf_picture(environment_pdf_solid_angle(-emission.ray.direction));
    } else {
        emission = emit_emit(light, job.sphere, u);
    }
    //: else
    emission = emit_emit(light, job.sphere, u);
    //: end
    let origin = emission.ray.origin;
    let at = light_float3(light + LIGHT_PLACE);
    var position = at;
    var normal = vec3(0.0f);
    if scene_word(light) == LIGHT_SPHERE {
        normal = math_normalize_or(origin - at, vec3(0.0f));
        position = at + normal * light_params(light).x;
    } else if scene_float(light + LIGHT_AREA) > 0.0f {
        // The ray starts beside the surface along its normal.
        normal = light_float3(light + LIGHT_NORMAL);
        position = origin - normal * math_dot(origin - at, normal);
    }
    let pdf_direction = emitters_pdf_towards(light, -emission.ray.direction, normal);
    let carried = emission.flux / scene_float(light + LIGHT_PMF);
    let found = !math_is_zero3(carried) && math_is_finite3(carried) && pdf_direction > 0.0f;
    return EmittersStart(found, index, emission.ray, position, normal, carried, pdf_place, pdf_direction);
}
