// Path tracing through participating media: core's state machine, one step between two rays.
//: use medium
//: use medium::inside
//: use transport::back
//: use transport::volume::boundaries
//: use transport::volume::vertex
//: use transport::volume::way

// The nearest hit on a way to a light.
const QUERY_CONNECT: u32 = 3u;

const VOLUME_GROUPS: u32 = 3u;
const VOLUME_COLOUR_GROUP: u32 = 1u << 24u;

// `ray` is what is asked, with the media that it starts in and what lies before its start: on the way to a light, or the path's own, which
// goes on at `vertex` into `next`, into `next_inside` and `next_lead`.
struct VolumeState {
    sampler: BlockSampler,
    radiance: vec3<f32>,
    throughput: vec3<f32>,
    // What a connection brings if the rest of its way is free and clear.
    carried: vec3<f32>,
    next: vec3<f32>,
    pdf: f32,
    vertex: vec3<f32>,
    depth: u32,
    ray: Ray,
    query: u32,
    inside: Inside,
    next_inside: Inside,
    lead: f32,
    next_lead: f32,
    // Of the path what has been flown since its vertex, of a connection what is left to its light; and boundaries crossed on that way.
    length: f32,
    crossed: u32,
    event: u32,
    // The channel of a path that was refracted by its colour, counted from 1; 0 where it has all.
    channel: u32,
}

fn volume_new(sampler: BlockSampler, inside: Inside) -> VolumeState {
    var state: VolumeState;
    state.sampler = sampler;
    state.throughput = vec3(1.0f);
    state.inside = inside;
    return state;
}

fn volume_follow(state: ptr<function, VolumeState>) {
    if math_is_zero3((*state).next) {
        (*state).query = QUERY_DONE;
        return;
    }
    (*state).ray = Ray((*state).vertex, (*state).next, MAX_FLOAT);
    (*state).inside = (*state).next_inside;
    (*state).lead = (*state).next_lead;
    (*state).length = 0.0f;
    (*state).crossed = 0u;
    (*state).depth += 1u;
    (*state).query = QUERY_CLOSEST;
}

// From here on the path is of one colour, which stands for all three.
fn volume_choose_channel(state: ptr<function, VolumeState>, u: f32) -> u32 {
    if (*state).channel == 0u {
        let channel = min(u32(3.0f * u), 2u);
        (*state).channel = channel + 1u;
        (*state).throughput = back_one_colour((*state).throughput, channel);
    }
    return (*state).channel - 1u;
}

// Light sampling: whether there is a way to a light, which is what is asked then.
fn volume_sample_light(state: ptr<function, VolumeState>, vertex: Vertex, group: u32) -> bool {
    if scene_at.light_count == 0u || !lobes_has_density(vertex.surface.lobes) { return false; }
    let bits = sobol_bits4((*state).sampler, group);
    let s = light_sample_lights(vertex.surface.point.position, bits.xyz);
    if !s.found { return false; }
    let value = vertex_scattering(vertex, s.wi);
    var carried = (*state).throughput * value.f * s.contribution;
    if s.pdf > 0.0f { carried *= mis_power_heuristic(s.pdf, value.pdf); }
    //: if AIRLIGHT
    // Its airlight is summed already.
    if s.pdf <= 0.0f && (*state).depth == 1u && vertex.in_medium { return false; }
    //: end
    if math_is_zero3(carried) { return false; }
    (*state).carried = carried;
    (*state).ray = vertex_towards(vertex, s);
    (*state).length = vertex_distance(vertex, s);
    (*state).lead = vertex_lead(vertex, (*state).ray.origin, (*state).ray.direction);
    (*state).inside = vertex_media(vertex, (*state).inside, s.wi);
    (*state).crossed = 0u;
    return true;
}

// Samples a light and a direction at a vertex.
fn volume_scatter(state: ptr<function, VolumeState>, vertex_in: Vertex) {
    var vertex = vertex_in;
    let event = (*state).event;
    //: if LOBES
    if !vertex.in_medium && lobes_disperses(vertex.surface.lobes) {
        let colour = sobol_group4((*state).sampler, VOLUME_COLOUR_GROUP + event).x;
        vertex.surface.lobes = lobes_of_channel(vertex.surface.lobes, volume_choose_channel(state, colour));
    }
    //: end
    let groups = 1u + VOLUME_GROUPS * event;
    let here = (*state).inside;
    let connects = volume_sample_light(state, vertex, groups + 1u);
    (*state).next = vec3(0.0f);
    let u = sobol_group4((*state).sampler, groups + 2u);
    let s = vertex_sample(vertex, u.xy, u.z);
    if s.found {
        // The roulette is about what is absorbed: the squared index comes back when light leaves.
        let squared = vertex_index_ratio_squared(vertex, s.wi);
        let played = back_play((*state).throughput, s.weight * squared, (*state).depth, u.w);
        if played.survives {
            (*state).throughput = played.throughput / squared;
            (*state).pdf = s.pdf;
            (*state).vertex = vertex_leave(vertex, s.wi);
            (*state).next = s.wi;
            (*state).next_inside = vertex_media(vertex, here, s.wi);
            (*state).next_lead = vertex_lead(vertex, (*state).vertex, s.wi);
        }
    }
    (*state).event += 1u;
    if connects {
        (*state).query = QUERY_CONNECT;
    } else {
        volume_follow(state);
    }
}

fn volume_start_probe(
    sampler: BlockSampler, point: SurfacePoint, n: vec3<f32>, inside: Inside, max_depth: u32,
) -> VolumeState {
    var state = volume_new(sampler, inside);
    state.throughput = vec3(PI);
    if max_depth >= 1u { volume_scatter(&state, vertex_on(surface_white(point, n), inside)); }
    return state;
}

// Straight on, beyond a boundary: the same edge, and a direction of the same density.
fn volume_pass(state: ptr<function, VolumeState>, surface: Surface, t: f32, beyond: Inside) {
    (*state).inside = beyond;
    (*state).length += t;
    (*state).event += 1u;
    (*state).crossed += 1u;
    if (*state).crossed > CROSSINGS_MAX { return; }
    let direction = (*state).ray.direction;
    let origin = geometry_offset_origin(surface.point, surface.geometric, direction);
    (*state).ray.origin = origin;
    (*state).lead = way_lead(surface.point.position, surface.geometric, origin, direction);
    (*state).query = QUERY_CLOSEST;
}

//: if LOBES
// Reflected at a dielectric or a pane, or on through it.
fn volume_meet_interface(
    state: ptr<function, VolumeState>, surface: Surface, t: f32, beyond: Inside, max_depth: u32,
) {
    let u = sobol_group4((*state).sampler, 1u + VOLUME_GROUPS * (*state).event + 2u);
    var channel = max((*state).channel, 1u) - 1u;
    if interface_disperses(surface.interface_) { channel = volume_choose_channel(state, u.y); }
    let passage = interface_pass(surface.interface_, surface.shading, surface.wo, channel, u.x);
    // An interpolated normal would send it to the wrong side.
    if !passage.found || (math_dot(passage.wi, surface.geometric) < 0.0f) != passage.through { return; }
    if passage.through && surface.interface_.kind == INTERFACE_PANE {
        (*state).throughput *= passage.weight;
        if !math_is_zero3((*state).throughput) { volume_pass(state, surface, t, beyond); }
        return;
    }
    if (*state).depth >= max_depth { return; }
    // The roulette is about what is absorbed: the squared index comes back when light leaves.
    let absorbed = select(passage.weight, vec3(1.0f), passage.through);
    let played = back_play((*state).throughput, absorbed, (*state).depth, u.w);
    if !played.survives { return; }
    (*state).throughput = played.throughput;
    (*state).next_inside = (*state).inside;
    if passage.through {
        (*state).throughput = played.throughput * passage.weight;
        (*state).next_inside = beyond;
    }
    (*state).pdf = 0.0f;
    (*state).vertex = geometry_offset_origin(surface.point, surface.geometric, passage.wi);
    (*state).next_lead = way_lead(surface.point.position, surface.geometric, (*state).vertex, passage.wi);
    (*state).next = passage.wi;
    (*state).event += 1u;
    volume_follow(state);
}
//: end

// Whether the path is scattered where it is now, and that place.
struct Arrival { scatters: bool, vertex: Vertex }

fn volume_ends() -> Arrival {
    var arrival: Arrival;
    return arrival;
}

// The medium along the path's ray up to `limit`: what it emits, and whether the flight ends in it.
fn volume_fly(state: ptr<function, VolumeState>, medium: Medium, limit: f32) -> Arrival {
    let ray = (*state).ray;
    (*state).radiance += (*state).throughput * medium_emitted(medium, ray, (*state).lead, limit);
    let u = sobol_group2((*state).sampler, 1u + VOLUME_GROUPS * (*state).event);
    let flown = medium_fly(medium, ray, (*state).lead, limit, (*state).throughput, u);
    (*state).throughput *= flown.weight;
    var position = ray.origin;
    if flown.collided {
        position = ray.origin + ray.direction * (flown.length - (*state).lead);
        (*state).throughput *= medium_sigma_s_at(medium, position);
    }
    return Arrival(flown.collided, vertex_in(position, -ray.direction, medium.g));
}

// A connection has come through to a boundary: on beyond it. False where its way ends there.
fn volume_connect_on(state: ptr<function, VolumeState>, surface: Surface, gone: f32, beyond: Inside) -> bool {
    //: if LOBES
    let straight = interface_straight(surface.interface_);
    if straight.found { (*state).carried *= straight.transmit; }
    //: end
    if math_is_zero3((*state).carried) { return false; }
    let ray = (*state).ray;
    let origin = geometry_offset_origin(surface.point, surface.geometric, ray.direction);
    // It ends where it ended before.
    if ray.t_max < MAX_FLOAT { (*state).ray.t_max = ray.t_max - math_dot(origin - ray.origin, ray.direction); }
    (*state).ray.origin = origin;
    (*state).lead = way_lead(surface.point.position, surface.geometric, origin, ray.direction);
    (*state).length = math_max((*state).length - gone, 0.0f);
    (*state).inside = beyond;
    (*state).crossed += 1u;
    return true;
}

// The ray that was asked has reached a surface, or nothing.
fn volume_arrive(state: ptr<function, VolumeState>, met: Hit, max_depth: u32) {
    let arrival = volume_reach(state, met, max_depth);
    if arrival.scatters && (*state).depth < max_depth { volume_scatter(state, arrival.vertex); }
}

// All of that but scattering. Of a path and of a connection alike, so that each part is in the shader once.
fn volume_reach(state: ptr<function, VolumeState>, met: Hit, max_depth: u32) -> Arrival {
    let ray = (*state).ray;
    let connecting = (*state).query == QUERY_CONNECT;
    let missed = met.primitive == TREE_NOTHING;
    (*state).query = QUERY_DONE;
    var limit = (*state).lead + met.t;
    if missed {
        limit = math_infinity();
        if connecting { limit = (*state).length; }
    }
    let record = inside_current((*state).inside);
    if record != MEDIUM_NONE {
        let medium = medium_new(record);
        if connecting {
            (*state).carried *= medium_transmittance(medium, ray, (*state).lead, limit);
        } else {
            let flown = volume_fly(state, medium, limit);
            if math_is_zero3((*state).throughput) { return volume_ends(); }
            if flown.scatters { return flown; }
        }
    }
    if missed {
        if connecting {
            (*state).radiance += (*state).carried;
            volume_follow(state);
        } else {
            (*state).radiance += (*state).throughput * light_escaped(ray.direction, (*state).pdf, 1.0f);
        }
        return volume_ends();
    }
    if connecting && (!boundaries_passes(met.primitive) || (*state).crossed >= CROSSINGS_MAX) {
        volume_follow(state);
        return volume_ends();
    }
    let resolved = boundaries_resolve(ray, met, (*state).inside);
    let hit = resolved.hit;
    let surface = surface_at(ray, hit);
    if connecting {
        let goes_on = surface.found && boundaries_passes(hit.primitive)
            && volume_connect_on(state, surface, limit, resolved.inside);
        if goes_on {
            (*state).query = QUERY_CONNECT;
        } else {
            volume_follow(state);
        }
        return volume_ends();
    }
    if !surface.found { return volume_ends(); }
    if (surface_flags(hit.primitive) & MATERIAL_NULL) != 0u {
        volume_pass(state, surface, hit.t, resolved.inside);
        return volume_ends();
    }
    if back_is_lit(surface) {
        let distance = (*state).length + hit.t;
        let emission = back_emission(surface, ray.direction, distance, (*state).vertex, (*state).pdf, 1.0f);
        (*state).radiance += (*state).throughput * emission.met * emission.weight;
    }
    //: if LOBES
    if surface.interface_.kind != INTERFACE_OPAQUE {
        volume_meet_interface(state, surface, hit.t, resolved.inside, max_depth);
        return volume_ends();
    }
    //: end
    return Arrival(true, vertex_on(surface, resolved.inside));
}
