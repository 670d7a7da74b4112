// Waves of paths through media and boundaries: the rows of paths between surfaces, and more behind them.
//: use transport::volume
//: use wavefront::slots
//: use wavefront::states::media
//: if AIRLIGHT
//: use wavefront::airlight
//: end

const ROW_INSIDE: u32 = 33u;
const ROW_NEXT_INSIDE: u32 = 36u;
const ROW_LEAD: u32 = 39u;
const ROW_NEXT_LEAD: u32 = 40u;
const ROW_LENGTH: u32 = 41u;
const ROW_CROSSED: u32 = 42u;
const ROW_EVENT: u32 = 43u;
const ROW_CHANNEL: u32 = 44u;

fn wave_load(slot: u32) -> VolumeState {
    return VolumeState(
        wave_sampler(slot),
        wave_triple(slot, ROW_RADIANCE),
        wave_triple(slot, ROW_THROUGHPUT),
        wave_triple(slot, ROW_PENDING),
        wave_triple(slot, ROW_NEXT),
        wave_float(slot, ROW_PDF),
        wave_triple(slot, ROW_VERTEX),
        wave_get(slot, ROW_DEPTH),
        wave_ray(slot),
        wave_get(slot, ROW_QUERY),
        wave_inside(slot, ROW_INSIDE),
        wave_inside(slot, ROW_NEXT_INSIDE),
        wave_float(slot, ROW_LEAD),
        wave_float(slot, ROW_NEXT_LEAD),
        wave_float(slot, ROW_LENGTH),
        wave_get(slot, ROW_CROSSED),
        wave_get(slot, ROW_EVENT),
        wave_get(slot, ROW_CHANNEL),
    );
}

fn wave_store(slot: u32, state: VolumeState) {
    wave_put_triple(slot, ROW_RADIANCE, state.radiance);
    wave_put(slot, ROW_QUERY, state.query);
    if state.query == QUERY_DONE { return; }
    wave_put_sampler(slot, state.sampler);
    wave_put_triple(slot, ROW_THROUGHPUT, state.throughput);
    wave_put_triple(slot, ROW_PENDING, state.carried);
    wave_put_triple(slot, ROW_NEXT, state.next);
    wave_put_float(slot, ROW_PDF, state.pdf);
    wave_put_triple(slot, ROW_VERTEX, state.vertex);
    wave_put(slot, ROW_DEPTH, state.depth);
    wave_put_ray(slot, state.ray);
    wave_put_inside(slot, ROW_INSIDE, state.inside);
    wave_put_inside(slot, ROW_NEXT_INSIDE, state.next_inside);
    wave_put_float(slot, ROW_LEAD, state.lead);
    wave_put_float(slot, ROW_NEXT_LEAD, state.next_lead);
    wave_put_float(slot, ROW_LENGTH, state.length);
    wave_put(slot, ROW_CROSSED, state.crossed);
    wave_put(slot, ROW_EVENT, state.event);
    wave_put(slot, ROW_CHANNEL, state.channel);
    wave_ask(slot);
}

@compute @workgroup_size(64)
fn start(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = id.x;
    if slot >= job.count { return; }
    let at = wave_start(slot);
    wave_put(slot, ROW_RAYS, 0u);
    if job.probes != 0u {
        let probe = job.probes + 10u * at.element;
        let point = wave_probe_point(probe);
        let inside = vec3(states[probe + 7u], states[probe + 8u], states[probe + 9u]);
        wave_store(slot, volume_start_probe(at.sampler, point, wave_probe_normal(probe), inside, job.max_depth));
        return;
    }
    var state = volume_new(at.sampler, vec3(job.camera_inside0, job.camera_inside1, job.camera_inside2));
    state.ray = wave_camera_ray(at);
    state.vertex = state.ray.origin;
    state.depth = 1u;
    if job.max_depth >= 1u { state.query = QUERY_CLOSEST; }
    wave_store(slot, state);
    //: if AIRLIGHT
    wave_start_airlight(slot, state);
    //: end
}

@compute @workgroup_size(64)
fn advance(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = wave_slot(id.x);
    if slot == job.slots { return; }
    //: if AIRLIGHT
    let stage = wave_get(slot, ROW_STAGE);
    if stage == STAGE_SEGMENT { return; }
    //: end
    var state = wave_load(slot);
    volume_arrive(&state, wave_hit(slot), job.max_depth);
    wave_store(slot, state);
    //: if AIRLIGHT
    if stage == STAGE_NODE && state.query == QUERY_DONE { wave_put(slot, ROW_QUERY, QUERY_NOTHING); }
    //: end
}
