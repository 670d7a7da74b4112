// Waves of paths between surfaces.
//: use transport::path
//: use wavefront::slots

fn wave_load(slot: u32) -> PathState {
    return PathState(
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
    );
}

fn wave_store(slot: u32, state: PathState) {
    wave_put_triple(slot, ROW_RADIANCE, state.radiance);
    wave_put(slot, ROW_QUERY, state.query);
    if state.query == QUERY_DONE { return; }
    wave_put_sampler(slot, state.sampler);
    wave_put_triple(slot, ROW_THROUGHPUT, state.throughput);
    wave_put_triple(slot, ROW_PENDING, state.pending);
    wave_put_triple(slot, ROW_NEXT, state.next);
    wave_put_float(slot, ROW_PDF, state.pdf);
    wave_put_triple(slot, ROW_VERTEX, state.vertex);
    wave_put(slot, ROW_DEPTH, state.depth);
    wave_put_ray(slot, state.ray);
    wave_ask(slot);
}

@compute @workgroup_size(64)
fn start(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = id.x;
    if slot >= job.count { return; }
    let at = wave_start(slot);
    wave_put(slot, ROW_RAYS, 0u);
    if job.probes != 0u {
        let probe = job.probes + 7u * at.element;
        let point = wave_probe_point(probe);
        wave_store(slot, path_start_probe(at.sampler, point, wave_probe_normal(probe), job.max_depth));
        return;
    }
    var state = path_new(at.sampler);
    state.ray = wave_camera_ray(at);
    state.depth = 1u;
    if job.max_depth >= 1u { state.query = QUERY_CLOSEST; }
    wave_store(slot, state);
}

@compute @workgroup_size(64)
fn advance(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = wave_slot(id.x);
    if slot == job.slots { return; }
    var state = wave_load(slot);
    let hit = wave_hit(slot);
    if state.query == QUERY_SHADOW {
        path_lit(&state, hit.primitive != TREE_NOTHING);
    } else {
        path_arrive(&state, hit, job.max_depth);
    }
    wave_store(slot, state);
}
