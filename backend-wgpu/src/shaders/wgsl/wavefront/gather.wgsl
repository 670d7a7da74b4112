// Waves of paths that read a map. Behind the rows of states lie a head, elements, lights, the map's numbers, and probes.
//: use scene::counts
//: use sampling::discrete
//: use transport::gather
//: use wavefront::slots

const ROW_MET: u32 = 33u;
const ROW_MET_HIT: u32 = 39u;
const ROW_KIND: u32 = 43u;
const ROW_STAGE: u32 = 44u;
const GATHER_ROWS: u32 = 45u;

// Words of a probe: point and extent, normal, its hit, and bits: 1 it has one, 2 on its front, 4 it gathers.
const PROBE_WORDS: u32 = 12u;

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
        Hit(
            wave_float(slot, ROW_MET_HIT),
            wave_get(slot, ROW_MET_HIT + 1u),
            wave_float(slot, ROW_MET_HIT + 2u),
            wave_float(slot, ROW_MET_HIT + 3u),
        ),
        kind & 7u,
        wave_get(slot, ROW_STAGE),
        (kind & 8u) != 0u,
        (kind & 16u) != 0u,
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
    wave_put_float(slot, ROW_MET_HIT, state.hit.t);
    wave_put(slot, ROW_MET_HIT + 1u, state.hit.primitive);
    wave_put_float(slot, ROW_MET_HIT + 2u, state.hit.b1);
    wave_put_float(slot, ROW_MET_HIT + 3u, state.hit.b2);
    wave_put(slot, ROW_KIND, state.kind | select(0u, 8u, state.gathers) | select(0u, 16u, state.seen));
    wave_put(slot, ROW_STAGE, state.stage);
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
        if job.max_depth > 0u && (once || (bits & 4u) != 0u) { state.query = QUERY_HERE; }
        wave_store(slot, state);
        return;
    }
    state.ray = wave_camera_ray(at);
    state.vertex = state.ray.origin;
    state.depth = 1u;
    if job.max_depth >= 1u { state.query = QUERY_CLOSEST; }
    wave_store(slot, state);
}

// The surface at which a path is.
fn gather_surface(state: GatherState) -> Surface {
    if state.kind >= GATHER_PROBE {
        return surface_white(SurfacePoint(state.met.origin, state.hit.t), state.met.direction);
    }
    return surface_at(state.met, state.hit);
}

@compute @workgroup_size(64)
fn advance(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = wave_slot(id.x);
    if slot == job.slots { return; }
    var state = wave_load(slot);
    let gather = gather_job();
    let found = wave_hit(slot);
    let query = state.query;
    let arrives = query == QUERY_CLOSEST;
    state.query = QUERY_DONE;
    if arrives {
        if found.primitive == TREE_NOTHING {
            let escaped = light_escaped(state.ray.direction, state.pdf, gather.surface_share);
            state.radiance += state.throughput * escaped;
            wave_store(slot, state);
            return;
        }
        state.met = state.ray;
        state.hit = found;
        state.kind = 0u;
    } else if query == QUERY_SHADOW && found.primitive == TREE_NOTHING {
        state.radiance += state.pending;
    }
    let surface = gather_surface(state);
    var goes_on = surface.found;
    if arrives && goes_on {
        if back_is_lit(surface) {
            let emission =
                back_emission(surface, state.ray.direction, found.t, state.vertex, state.pdf, gather.surface_share);
            state.radiance += state.throughput * emission.met * emission.weight;
        }
        goes_on = state.depth < job.max_depth;
        if goes_on { gather_arrive(&state, surface, gather); }
    }
    if goes_on && !gather_ask_lights(&state, surface, gather) {
        if state.kind == GATHER_ONCE {
            state.radiance += gather_at_probe(state, gather);
        } else {
            gather_follow(&state, surface);
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
