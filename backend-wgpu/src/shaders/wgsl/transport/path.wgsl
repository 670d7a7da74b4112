// Path tracing from the sensor with light sampling and multiple importance sampling: core's state machine, one step between two rays.
//: use transport::back

// `ray` is what is asked: the shadow ray, or the ray to follow, which starts at `vertex` into `next`.
struct PathState {
    sampler: BlockSampler,
    radiance: vec3<f32>,
    throughput: vec3<f32>,
    pending: vec3<f32>,
    next: vec3<f32>,
    pdf: f32,
    vertex: vec3<f32>,
    depth: u32,
    ray: Ray,
    query: u32,
}

fn path_new(sampler: BlockSampler) -> PathState {
    var state: PathState;
    state.sampler = sampler;
    state.throughput = vec3(1.0f);
    return state;
}

fn path_follow(state: ptr<function, PathState>) {
    if math_is_zero3((*state).next) {
        (*state).query = QUERY_DONE;
        return;
    }
    (*state).ray = Ray((*state).vertex, (*state).next, MAX_FLOAT);
    (*state).depth += 1u;
    (*state).query = QUERY_CLOSEST;
}

// Light sampling: what it brings, and whether a ray must be free.
fn path_sample_light(state: ptr<function, PathState>, surface: Surface, group: u32) -> bool {
    if scene_at.light_count == 0u || !lobes_has_density(surface.lobes) { return false; }
    let bits = sobol_bits4((*state).sampler, group);
    let s = light_sample_lights(surface.point.position, bits.xyz);
    if !s.found || math_dot(s.wi, surface.geometric) <= 0.0f { return false; }
    let cos = math_dot(s.wi, surface.shading);
    let value = lobes_value(surface.lobes, surface.shading, surface.wo, s.wi);
    var pending = (*state).throughput * value.f * s.contribution * math_max_number(cos, 0.0f);
    if s.pdf > 0.0f { pending *= mis_power_heuristic(s.pdf, value.pdf); }
    if math_is_zero3(pending) { return false; }
    (*state).pending = pending;
    (*state).ray = light_shadow_ray(s, surface.point, surface.geometric);
    return true;
}

// Samples a light and a direction at a vertex.
fn path_scatter(state: ptr<function, PathState>, surface: Surface) {
    let depth = (*state).depth;
    let shadow = path_sample_light(state, surface, 1u + 2u * depth);
    (*state).next = vec3(0.0f);
    let u = sobol_group4((*state).sampler, 2u + 2u * depth);
    let s = lobes_sample(surface.lobes, surface.shading, surface.wo, u.xy, u.z);
    var goes_on = s.found;
    //: if SHADING
    // An interpolated normal can send light through the surface; such directions carry nothing.
    goes_on = goes_on && math_dot(s.wi, surface.geometric) > 0.0f;
    //: end
    if goes_on {
        let played = back_play((*state).throughput, s.weight, depth, u.w);
        if played.survives {
            (*state).throughput = played.throughput;
            (*state).pdf = s.pdf;
            (*state).vertex = geometry_offset_origin(surface.point, surface.geometric, s.wi);
            (*state).next = s.wi;
        }
    }
    if shadow {
        (*state).query = QUERY_SHADOW;
    } else {
        path_follow(state);
    }
}

fn path_start_probe(sampler: BlockSampler, point: SurfacePoint, n: vec3<f32>, max_depth: u32) -> PathState {
    var state = path_new(sampler);
    state.throughput = vec3(PI);
    if max_depth >= 1u { path_scatter(&state, surface_white(point, n)); }
    return state;
}

// The path has reached a surface, or nothing.
fn path_arrive(state: ptr<function, PathState>, hit: Hit, max_depth: u32) {
    let ray = (*state).ray;
    (*state).query = QUERY_DONE;
    if hit.primitive == TREE_NOTHING {
        (*state).radiance += (*state).throughput * light_escaped(ray.direction, (*state).pdf, 1.0f);
        return;
    }
    let surface = surface_at(ray, hit);
    if !surface.found { return; }
    if back_is_lit(surface) {
        let emission = back_emission(surface, ray.direction, hit.t, (*state).vertex, (*state).pdf, 1.0f);
        (*state).radiance += (*state).throughput * emission.met * emission.weight;
    }
    if (*state).depth < max_depth { path_scatter(state, surface); }
}

// The answer to a shadow ray.
fn path_lit(state: ptr<function, PathState>, occluded: bool) {
    if !occluded { (*state).radiance += (*state).pending; }
    path_follow(state);
}
