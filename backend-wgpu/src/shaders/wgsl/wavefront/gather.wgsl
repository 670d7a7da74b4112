// Waves of paths that read a map. Behind the rows of states lie a head, elements, lights, the map's numbers, and probes.
//: use scene::counts
//: use sampling::discrete
//: use transport::gather
//: use wavefront::slots
//: if VOLUME
//: use transport::gather::through
//: use wavefront::states::media
//: end

const ROW_MET: u32 = 33u;
const ROW_MET_HIT: u32 = 39u;
const ROW_KIND: u32 = 43u;
const ROW_STAGE: u32 = 44u;
//: if VOLUME
const ROW_INSIDE: u32 = 45u;
const ROW_BEYOND: u32 = 48u;
// Lead, flown, crossed, event, channel.
const ROW_WAY: u32 = 51u;
const ROW_LEFT: u32 = 56u;
const ROW_TO_INSIDE: u32 = 59u;
// Lead, length, crossed.
const ROW_TO: u32 = 62u;
const GATHER_ROWS: u32 = 65u;
//: else
const GATHER_ROWS: u32 = 45u;
//: end

// Words of a probe: point and extent, normal, its hit, bits (1 it has one, 2 on its front, 4 it gathers), and what it lies in.
const PROBE_WORDS: u32 = 16u;

// Words are counted from the head on.
fn job_word(i: u32) -> u32 { return states[GATHER_ROWS * job.slots + i]; }

fn job_float(i: u32) -> f32 { return bitcast<f32>(job_word(i)); }

fn element_word(i: u32) -> u32 { return job_word(job_word(0u) + i); }

fn map_value(values: u32, i: u32) -> vec3<f32> {
    let at = values + 3u * i;
    return vec3(job_float(at), job_float(at + 1u), job_float(at + 2u));
}

fn gather_job() -> GatherJob {
    let flags = job_word(3u);
    return GatherJob(
        job.max_depth,
        (flags & 4u) != 0u,
        job_float(4u),
        ElementMap(job_word(1u), job_word(2u), (flags & 1u) != 0u, (flags & 2u) != 0u),
        job_word(5u),
        job_word(6u),
        (flags & 8u) != 0u,
        GatherChoice(job_word(7u), job_word(8u), job_word(9u)),
        GatherChoice(job_word(10u), job_word(11u), job_word(12u)),
        job_float(13u),
    );
}

//: if VOLUME
fn wave_way(slot: u32) -> GatherWay {
    return GatherWay(
        wave_inside(slot, ROW_INSIDE),
        wave_inside(slot, ROW_BEYOND),
        wave_float(slot, ROW_WAY),
        wave_float(slot, ROW_WAY + 1u),
        wave_get(slot, ROW_WAY + 2u),
        wave_get(slot, ROW_WAY + 3u),
        wave_get(slot, ROW_WAY + 4u),
        wave_triple(slot, ROW_LEFT),
        wave_inside(slot, ROW_TO_INSIDE),
        wave_float(slot, ROW_TO),
        wave_float(slot, ROW_TO + 1u),
        wave_get(slot, ROW_TO + 2u),
    );
}

fn wave_put_way(slot: u32, way: GatherWay) {
    wave_put_inside(slot, ROW_INSIDE, way.inside);
    wave_put_inside(slot, ROW_BEYOND, way.beyond);
    wave_put_float(slot, ROW_WAY, way.lead);
    wave_put_float(slot, ROW_WAY + 1u, way.flown);
    wave_put(slot, ROW_WAY + 2u, way.crossed);
    wave_put(slot, ROW_WAY + 3u, way.event);
    wave_put(slot, ROW_WAY + 4u, way.channel);
    wave_put_triple(slot, ROW_LEFT, way.left);
    wave_put_inside(slot, ROW_TO_INSIDE, way.to_inside);
    wave_put_float(slot, ROW_TO, way.to_lead);
    wave_put_float(slot, ROW_TO + 1u, way.to_length);
    wave_put(slot, ROW_TO + 2u, way.to_crossed);
}
//: end

fn wave_load(slot: u32) -> GatherState {
    let kind = wave_get(slot, ROW_KIND);
    return GatherState(
        wave_sampler(slot),
        wave_triple(slot, ROW_RADIANCE),
        wave_triple(slot, ROW_THROUGHPUT),
        wave_triple(slot, ROW_PENDING),
        wave_float(slot, ROW_PDF),
        wave_triple(slot, ROW_VERTEX),
        wave_get(slot, ROW_DEPTH),
        wave_ray(slot),
        wave_get(slot, ROW_QUERY),
        Ray(wave_triple(slot, ROW_MET), wave_triple(slot, ROW_MET + 3u), MAX_FLOAT),
        wave_hit_at(slot, ROW_MET_HIT),
        kind & 7u,
        wave_get(slot, ROW_STAGE),
        (kind & 8u) != 0u,
        (kind & 16u) != 0u,
        //: if VOLUME
        wave_way(slot),
        //: end
    );
}

fn wave_store(slot: u32, state: GatherState) {
    wave_put_triple(slot, ROW_RADIANCE, state.radiance);
    wave_put(slot, ROW_QUERY, state.query);
    if state.query == QUERY_DONE { return; }
    wave_put_sampler(slot, state.sampler);
    wave_put_triple(slot, ROW_THROUGHPUT, state.throughput);
    wave_put_triple(slot, ROW_PENDING, state.pending);
    wave_put_float(slot, ROW_PDF, state.pdf);
    wave_put_triple(slot, ROW_VERTEX, state.vertex);
    wave_put(slot, ROW_DEPTH, state.depth);
    wave_put_ray(slot, state.ray);
    wave_put_triple(slot, ROW_MET, state.met.origin);
    wave_put_triple(slot, ROW_MET + 3u, state.met.direction);
    wave_put_hit(slot, ROW_MET_HIT, state.hit);
    wave_put(slot, ROW_KIND, state.kind | select(0u, 8u, state.gathers) | select(0u, 16u, state.seen));
    wave_put(slot, ROW_STAGE, state.stage);
    //: if VOLUME
    wave_put_way(slot, state.way);
    //: end
    wave_ask(slot);
}

@compute @workgroup_size(64)
fn start(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = id.x;
    if slot >= job.count { return; }
    let at = wave_start(slot);
    let gather = gather_job();
    wave_put(slot, ROW_RAYS, 0u);
    var state: GatherState;
    state.sampler = at.sampler;
    state.throughput = vec3(1.0f);
    state.gathers = gather.gather;
    state.seen = true;
    if job.probes != 0u {
        // The last sample of a block is what all others have.
        let probe = job.probes + PROBE_WORDS * at.element;
        let once = job.first_sample + slot % job.samples + 1u == job_word(14u);
        let bits = states[probe + 11u];
        state.throughput = vec3(PI);
        state.kind = select(GATHER_PROBE, GATHER_ONCE, once);
        state.met = Ray(wave_probe(probe), wave_probe_normal(probe), MAX_FLOAT);
        state.hit = Hit(bitcast<f32>(states[probe + 3u]), at.element, 0.0f, 0.0f);
        //: if VOLUME
        state.way.inside = vec3(states[probe + 12u], states[probe + 13u], states[probe + 14u]);
        //: end
        if job.max_depth > 0u && (once || (bits & 4u) != 0u) { state.query = QUERY_HERE; }
        wave_store(slot, state);
        return;
    }
    //: if VOLUME
    state.way.inside = vec3(job.camera_inside0, job.camera_inside1, job.camera_inside2);
    //: end
    state.ray = wave_camera_ray(at);
    state.vertex = state.ray.origin;
    state.depth = 1u;
    if job.max_depth >= 1u { state.query = QUERY_CLOSEST; }
    wave_store(slot, state);
}

// The surface at which a path is, or what its ray met: none in a medium.
fn gather_surface(state: GatherState, ray: Ray, hit: Hit) -> Surface {
    var surface: Surface;
    //: if VOLUME
    if state.kind == GATHER_MEDIUM && state.query != QUERY_CONNECT { return surface; }
    //: end
    if state.kind == GATHER_PROBE || state.kind == GATHER_ONCE {
        surface = surface_white(SurfacePoint(state.met.origin, state.hit.t), state.met.direction);
        //: if VOLUME
        if state.query != QUERY_CONNECT { return surface; }
        //: else
        return surface;
        //: end
    }
    return surface_at(ray, hit);
}

// At a surface that a path has reached: what it sends back, and whether something is done there.
fn gather_reach(state: ptr<function, GatherState>, surface_in: Surface, gather: GatherJob) -> bool {
    var surface = surface_in;
    let ray = (*state).ray;
    let hit = (*state).hit;
    var t = hit.t;
    //: if VOLUME
    if (surface_flags(hit.primitive) & MATERIAL_NULL) != 0u {
        gather_pass(state, surface, hit.t);
        return false;
    }
    t = (*state).way.flown + hit.t;
    //: end
    if back_is_lit(surface) {
        let emission =
            back_emission(surface, ray.direction, t, (*state).vertex, (*state).pdf, gather.surface_share);
        (*state).radiance += (*state).throughput * emission.met * emission.weight;
    }
    if (*state).depth >= job.max_depth { return false; }
    //: if VOLUME
    //: if LOBES
    if surface.interface_.kind != INTERFACE_OPAQUE {
        gather_meet_interface(state, surface, hit.t);
        return false;
    }
    if !lobes_is_plain(surface.lobes) && lobes_disperses(surface.lobes) {
        let more = sobol_group4((*state).sampler, GATHER_EVENT_GROUP + 2u * (*state).way.event + 1u);
        surface.lobes = lobes_of_channel(surface.lobes, gather_choose_colour(state, more.y));
    }
    //: end
    //: end
    gather_arrive(state, surface, gather);
    return true;
}

// The vertex at which lights are asked.
fn gather_vertex(state: GatherState, surface_in: Surface) -> Vertex {
    //: if VOLUME
    if state.kind == GATHER_MEDIUM {
        let medium = medium_new(inside_current(state.way.inside));
        return vertex_in(state.met.origin, -state.met.direction, medium.g);
    }
    var surface = surface_in;
    //: if LOBES
    if state.kind == GATHER_LOBES && lobes_disperses(surface.lobes) {
        surface.lobes = lobes_of_channel(surface.lobes, max(state.way.channel, 1u) - 1u);
    }
    //: end
    return vertex_on(surface, state.way.beyond);
    //: else
    return vertex_on(surface_in, vec3(0u));
    //: end
}

@compute @workgroup_size(64)
fn advance(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = wave_slot(id.x);
    if slot == job.slots { return; }
    var state = wave_load(slot);
    let gather = gather_job();
    let found = wave_hit(slot);
    let missed = found.primitive == TREE_NOTHING;
    let arrives = state.query == QUERY_CLOSEST;
    // What the surface is looked up for: a vertex, what the path reached, or a boundary on the way to a light.
    var surface_ray = state.met;
    var surface_hit = state.hit;
    var in_medium = false;
    var meets = arrives && !missed;
    //: if VOLUME
    let connects = state.query == QUERY_CONNECT;
    var beyond = vec3(0u);
    var gone = state.way.to_length;
    var crosses = false;
    if connects {
        if !missed { gone = state.way.to_lead + found.t; }
        let record = inside_current(state.way.to_inside);
        if record != MEDIUM_NONE {
            state.way.left *= medium_transmittance(medium_new(record), state.ray, state.way.to_lead, gone);
        }
        if missed { state.radiance += state.pending * state.way.left; }
        crosses = !missed && boundaries_passes(found.primitive) && state.way.to_crossed < CROSSINGS_MAX;
        state.query = QUERY_HERE;
    }
    if arrives {
        var limit = state.way.lead + found.t;
        if missed { limit = math_infinity(); }
        in_medium = gather_fly(&state, limit, job.max_depth);
        meets = meets && !in_medium && state.query != QUERY_DONE;
        if state.query == QUERY_DONE {
            wave_store(slot, state);
            return;
        }
    }
    if meets || crosses {
        let resolved = boundaries_resolve(state.ray, found, select(state.way.to_inside, state.way.inside, meets));
        beyond = resolved.inside;
        surface_ray = state.ray;
        surface_hit = resolved.hit;
        if crosses {
            crosses = boundaries_passes(resolved.hit.primitive);
            if crosses { state.query = QUERY_CONNECT; }
        }
        if meets { state.way.beyond = beyond; }
        if !meets && !crosses {
            surface_ray = state.met;
            surface_hit = state.hit;
        }
    }
    //: else
    surface_ray = state.met;
    if state.query == QUERY_SHADOW && missed { state.radiance += state.pending; }
    if meets {
        surface_ray = state.ray;
        surface_hit = found;
    }
    //: end
    if arrives && !in_medium {
        if !meets {
            let escaped = light_escaped(state.ray.direction, state.pdf, gather.surface_share);
            state.radiance += state.throughput * escaped;
            state.query = QUERY_DONE;
            wave_store(slot, state);
            return;
        }
        state.met = surface_ray;
        state.hit = surface_hit;
        state.kind = 0u;
    }
    let surface = gather_surface(state, surface_ray, surface_hit);
    //: if VOLUME
    if crosses {
        gather_connect_on(&state, surface, gone, beyond);
        wave_store(slot, state);
        return;
    }
    //: end
    state.query = QUERY_DONE;
    var goes_on = surface.found || state.kind == GATHER_MEDIUM;
    if goes_on && meets { goes_on = gather_reach(&state, surface, gather); }
    if goes_on {
        let vertex = gather_vertex(state, surface);
        if !gather_ask_lights(&state, vertex, gather) {
            if state.kind == GATHER_ONCE {
                state.radiance += gather_at_probe(state, gather);
            } else {
                gather_follow(&state, vertex);
            }
        }
    }
    wave_store(slot, state);
}

// What the map says at a probe: all of it, or what rays that gather do not find.
fn gather_at_probe(state: GatherState, gather: GatherJob) -> vec3<f32> {
    let probe = job.probes + PROBE_WORDS * state.hit.primitive;
    let bits = states[probe + 11u];
    let gathers = (bits & 4u) != 0u;
    if (bits & 1u) == 0u || (gathers && !gather.has_caustics) { return vec3(0.0f); }
    let values = select(gather.all, gather.caustics, gathers);
    let b1 = bitcast<f32>(states[probe + 9u]);
    return elements_read(
        gather.elements,
        values,
        states[probe + 8u],
        b1,
        bitcast<f32>(states[probe + 10u]),
        (bits & 2u) != 0u,
    );
}
