// Waves of samples from both ends. A step has four parts: `trace` answers, `arrive` takes walks to their next vertex, `scatter` sends them
// on from there, `join` joins it. Each holds but a part of the code, and hands on by what is stored; `search` is a part where it is needed.
// `arrive` alone takes annexes and `join` alone gives them back, so that no list is read where it is written.
//: use transport::bidirectional::connect
//: use transport::bidirectional::walk
//: use transport::bidirectional::weight
//: use wavefront::bidirectional::arrivals
//: use wavefront::bidirectional::joints
//: use wavefront::bidirectional::rows
//: use wavefront::slots
//: if CUTOFF
//: use wavefront::bidirectional::links
//: end
//: if SEARCH
//: use wavefront::bidirectional::search
//: end

@compute @workgroup_size(64)
fn start(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = id.x;
    if slot >= job.count { return; }
    let at = wave_start(slot);
    wave_put(slot, ROW_RAYS, 0u);
    wave_put_triple(slot, ROW_RADIANCE, vec3(0.0f));
    wave_put(slot, ROW_QUERY, QUERY_DONE);
    if job.max_depth == 0u { return; }
    wave_put_sampler(slot, at.sampler);
    wave_put(slot, ROW_COUNT, 0u);
    wave_put(slot, ROW_ANNEX, 0u);
    //: if CUTOFF
    links_leave(slot, false, 0u, Chain(1.0f, 0.0f, 0.0f, 0.0f), Left(true, 0.0f, 0.0f));
    //: end
    // A path with a vertex of the light's walk has two edges at least.
    if job.max_depth >= 2u && scene_at.light_count > 0u {
        var word = 0u;
        if scene_at.light_count > 1u { word = sobol_bits2(at.sampler, LIGHT_PICK).x; }
        let start = emitters_start(word, sobol_group4(at.sampler, LIGHT_START));
        if start.found {
            var walk = path_walk_of_light(start);
            var query = QUERY_CLOSEST;
            var phase = PHASE_LIGHT;
            var ray = path_walk_ray(walk);
            //: if VOLUME
            let media = job.light_media + 4u * start.light;
            walk.inside = vec3(states[media + 1u], states[media + 2u], states[media + 3u]);
            // Beams start in the open.
            if walk.distant && !all(walk.inside == vec3(0u)) { query = QUERY_DONE; }
            //: if SEARCH
            if states[media] == 0u {
                phase = PHASE_SEARCH;
                ray = search_ray(ray.origin);
            }
            //: end
            //: end
            if query == QUERY_CLOSEST {
                //: if CUTOFF
                links_leave(slot, true, 0u, walk.chain, Left(true, 0.0f, 0.0f));
                //: end
                wave_put_walk(slot, walk);
                wave_query(slot, phase, query, ray);
                return;
            }
        }
    }
    wave_query(slot, PHASE_TURN, QUERY_NOTHING, Ray(vec3(0.0f), vec3(0.0f), 0.0f));
}

// Takes an annex where the slot may need one now. False where none is free: who has one can end, and gives it back.
fn wave_has_annex(slot: u32, walk: PathWalk) -> bool {
    var needed = walk.from_light && wave_get(slot, ROW_COUNT) >= BASE;
    //: if CUTOFF
    needed = needed || walk.index + 1u >= BASE;
    //: end
    if !needed || wave_get(slot, ROW_ANNEX) != 0u { return true; }
    let free = bitcast<i32>(atomicSub(&queue[job.free_annexes], 1u));
    if free <= 0 {
        atomicAdd(&queue[job.free_annexes], 1u);
        return false;
    }
    wave_put(slot, ROW_ANNEX, atomicLoad(&queue[job.free_annexes + u32(free)]));
    return true;
}

// The walk from the sensor begins: of a camera with a ray, of a probe at the probe.
fn wave_begin_sensor(slot: u32) {
    let at = wave_start(slot);
    if job.probes == 0u {
        let ray = wave_camera_ray(at);
        var walk = path_walk_new(false, ray, vec3(1.0f));
        walk.left = Left(true, camera_pdf_solid_angle(scene_camera(scene_at.camera), ray.direction), 0.0f);
        //: if VOLUME
        walk.inside = vec3(job.camera_inside0, job.camera_inside1, job.camera_inside2);
        //: end
        wave_put_walk(slot, walk);
        wave_query(slot, PHASE_SENSOR, QUERY_CLOSEST, ray);
        return;
    }
    var words = 7u;
    //: if VOLUME
    words = 10u;
    //: end
    let probe = job.probes + words * at.element;
    let chain = Chain(1.0f, 0.0f, 0.0f, 0.0f);
    let surface = surface_white(wave_probe_point(probe), wave_probe_normal(probe));
    var vertex = walk_vertex_at_surface(surface, chain);
    vertex.carried = vec3(PI);
    var walk = path_walk_new(false, Ray(vec3(0.0f), vec3(0.0f), 0.0f), vec3(PI));
    walk.edges = 0u;
    //: if VOLUME
    walk.inside = vec3(states[probe + 7u], states[probe + 8u], states[probe + 9u]);
    vertex.inside = walk.inside;
    vertex.beyond = walk.inside;
    //: end
    wave_put_walk(slot, walk);
    wave_put_vertex(slot, 0u, vertex);
    wave_put(slot, ROW_PHASE, PHASE_AT_SENSOR);
}

@compute @workgroup_size(64)
fn arrive(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = wave_slot(id.x);
    if slot == job.slots { return; }
    let phase = wave_get(slot, ROW_PHASE);
    if phase == PHASE_TURN {
        wave_begin_sensor(slot);
        return;
    }
    if phase > PHASE_SENSOR { return; }
    let from_light = phase == PHASE_LIGHT;
    var walk = wave_walk(slot, from_light);
    if !wave_has_annex(slot, walk) {
        // The same again; the ray is not counted twice.
        wave_put(slot, ROW_RAYS, wave_get(slot, ROW_RAYS) - 1u);
        wave_ask(slot);
        return;
    }
    let kind = wave_arrive(slot, &walk, wave_hit(slot), wave_sampler(slot));
    wave_put_walk(slot, walk);
    if kind != STEP_AT {
        wave_follow(slot, from_light, walk.origin, select(walk.direction, vec3(0.0f), kind != STEP_ON));
    }
}

@compute @workgroup_size(64)
fn scatter(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = wave_slot(id.x);
    if slot == job.slots { return; }
    let phase = wave_get(slot, ROW_PHASE);
    if phase != PHASE_AT_LIGHT && phase != PHASE_AT_SENSOR { return; }
    let from_light = phase == PHASE_AT_LIGHT;
    let number = wave_vertex_number(slot, from_light);
    let vertex = wave_vertex(slot, number);
    var walk = wave_walk(slot, from_light);
    path_walk_scatter(slot, &walk, vertex, wave_sampler(slot));
    wave_put_walk(slot, walk);
    if !lobes_has_density(vertex.lobes) {
        wave_follow(slot, from_light, walk.origin, walk.direction);
        return;
    }
    if from_light { wave_put(slot, ROW_COUNT, number); }
    wave_put(slot, ROW_PHASE, select(PHASE_JOIN, PHASE_SPLAT, from_light));
    wave_put(slot, ROW_QUERY, QUERY_NOTHING);
}

@compute @workgroup_size(64)
fn join(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = wave_slot(id.x);
    if slot == job.slots { return; }
    let phase = wave_get(slot, ROW_PHASE);
    if phase < PHASE_SPLAT { return; }
    if phase != PHASE_OVER {
        let answered = wave_get(slot, ROW_QUERY) != QUERY_NOTHING;
        if answered {
            if wave_joined(slot, phase) { return; }
        }
        let to_camera = phase == PHASE_SPLAT;
        let count = wave_get(slot, ROW_COUNT);
        let vertex = wave_vertex(slot, select(0u, count, to_camera));
        // Joints from `number` up to before `end`.
        var number = u32(answered);
        var end = 1u;
        if !to_camera {
            number += phase - PHASE_JOIN;
            end = select(0u, count + 1u, vertex.edges < job.max_depth);
        } else if job.probes != 0u {
            end = 0u;
        }
        let sampler = wave_sampler(slot);
        // The walk has been sent on already.
        let event = wave_get(slot, ROW_EVENT) - 1u;
        var launched = false;
        while !launched && number < end {
            var other = vertex;
            if number > 0u { other = wave_vertex(slot, number); }
            let joint = connect_exchange(vertex, other, to_camera, number, sampler, event);
            launched = wave_launch(slot, select(PHASE_JOIN + number, phase, to_camera), joint, sampler, vertex.index);
            number += 1u;
        }
        if launched { return; }
        let from_light = to_camera;
        wave_follow(slot, from_light, wave_triple(slot, ROW_WALK_ORIGIN), wave_triple(slot, ROW_WALK_DIRECTION));
    }
    // Over: the annex is free again.
    let annex = wave_get(slot, ROW_ANNEX);
    if wave_get(slot, ROW_PHASE) == PHASE_OVER && annex != 0u {
        wave_put(slot, ROW_ANNEX, 0u);
        atomicStore(&queue[job.free_annexes + 1u + atomicAdd(&queue[job.free_annexes], 1u)], annex);
    }
}
