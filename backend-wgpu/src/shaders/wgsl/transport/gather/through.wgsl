// Rays back from the sensor through media and through surfaces that light passes.
//: use transport::gather

//: if VOLUME
// The first of the groups of sample dimensions for what happens between vertices, two an event.
const GATHER_EVENT_GROUP: u32 = 16777216u;

// From here on the path is of one colour, which stands for all three.
fn gather_choose_colour(state: ptr<function, GatherState>, u: f32) -> u32 {
    if (*state).way.channel == 0u {
        let channel = min(u32(3.0f * u), 2u);
        (*state).way.channel = channel + 1u;
        (*state).throughput = back_one_colour((*state).throughput, channel);
    }
    return (*state).way.channel - 1u;
}

// Straight on, beyond a boundary: the same edge, and a direction of the same density.
fn gather_pass(state: ptr<function, GatherState>, surface: Surface, t: f32) {
    let direction = (*state).ray.direction;
    (*state).way.inside = (*state).way.beyond;
    (*state).way.flown += t;
    (*state).way.crossed += 1u;
    let origin = geometry_offset_origin(surface.point, surface.geometric, direction);
    (*state).ray.origin = origin;
    (*state).way.lead = way_lead(surface.point.position, surface.geometric, origin, direction);
    let goes_on = (*state).way.crossed <= CROSSINGS_MAX && !math_is_zero3((*state).throughput);
    (*state).query = select(QUERY_DONE, QUERY_CLOSEST, goes_on);
}

//: if LOBES
// Reflected at a dielectric or a pane, or on through it.
fn gather_meet_interface(state: ptr<function, GatherState>, surface: Surface, t: f32) {
    let more = sobol_group4((*state).sampler, GATHER_EVENT_GROUP + 2u * (*state).way.event + 1u);
    var channel = 0u;
    if interface_disperses(surface.interface_) { channel = gather_choose_colour(state, more.y); }
    let passage = interface_pass(surface.interface_, surface.shading, surface.wo, channel, more.x);
    if !passage.found || (math_dot(passage.wi, surface.geometric) < 0.0f) != passage.through { return; }
    if passage.through && surface.interface_.kind == INTERFACE_PANE {
        (*state).throughput *= passage.weight;
        gather_pass(state, surface, t);
        return;
    }
    let depth = (*state).depth;
    // The roulette is about what is absorbed: the squared index comes back when light leaves.
    let absorbed = select(passage.weight, vec3(1.0f), passage.through);
    let survive = sobol_group4((*state).sampler, 2u + 2u * depth).w;
    let played = back_play((*state).throughput, absorbed, depth, survive);
    if !played.survives { return; }
    (*state).throughput = played.throughput;
    var inside = (*state).way.inside;
    if passage.through {
        (*state).throughput = played.throughput * passage.weight;
        inside = (*state).way.beyond;
    }
    (*state).pdf = 0.0f;
    (*state).vertex = geometry_offset_origin(surface.point, surface.geometric, passage.wi);
    (*state).ray = Ray((*state).vertex, passage.wi, MAX_FLOAT);
    (*state).depth = depth + 1u;
    (*state).query = QUERY_CLOSEST;
    let lead = way_lead(surface.point.position, surface.geometric, (*state).vertex, passage.wi);
    gather_leave(state, inside, lead);
}
//: end

// The medium along the path's ray up to `limit`: whether the flight ends in it. The path is over where its query is QUERY_DONE then.
fn gather_fly(state: ptr<function, GatherState>, limit: f32, max_depth: u32) -> bool {
    let event = (*state).way.event;
    (*state).way.event = event + 1u;
    let record = inside_current((*state).way.inside);
    if record == MEDIUM_NONE { return false; }
    let medium = medium_new(record);
    let ray = (*state).ray;
    let lead = (*state).way.lead;
    let u = sobol_group2((*state).sampler, GATHER_EVENT_GROUP + 2u * event);
    (*state).radiance += (*state).throughput * medium_emitted(medium, ray, lead, limit);
    let flown = medium_fly(medium, ray, lead, limit, (*state).throughput, u);
    (*state).throughput *= flown.weight;
    if flown.collided {
        let position = ray.origin + ray.direction * (flown.length - lead);
        (*state).throughput *= medium_sigma_s_at(medium, position);
        (*state).met = Ray(position, ray.direction, MAX_FLOAT);
        (*state).kind = GATHER_MEDIUM;
        (*state).stage = 0u;
        if (*state).depth >= max_depth { (*state).query = QUERY_DONE; }
    }
    if math_is_zero3((*state).throughput) { (*state).query = QUERY_DONE; }
    return flown.collided;
}

// A way to a light has come to a boundary: on beyond it, or back to where it began.
fn gather_connect_on(state: ptr<function, GatherState>, surface: Surface, gone: f32, beyond: Inside) {
    (*state).query = QUERY_HERE;
    if !surface.found { return; }
    //: if LOBES
    let straight = interface_straight(surface.interface_);
    if straight.found { (*state).way.left *= straight.transmit; }
    //: end
    if math_is_zero3((*state).way.left) { return; }
    let ray = (*state).ray;
    let origin = geometry_offset_origin(surface.point, surface.geometric, ray.direction);
    // It ends where it ended before.
    if ray.t_max < MAX_FLOAT { (*state).ray.t_max = ray.t_max - math_dot(origin - ray.origin, ray.direction); }
    (*state).ray.origin = origin;
    (*state).way.to_lead = way_lead(surface.point.position, surface.geometric, origin, ray.direction);
    (*state).way.to_length = math_max((*state).way.to_length - gone, 0.0f);
    (*state).way.to_inside = beyond;
    (*state).way.to_crossed += 1u;
    (*state).query = QUERY_CONNECT;
}
//: end
