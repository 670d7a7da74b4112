// Waves of samples from both ends. A step has three parts: `trace` answers, `walk` takes walks to their next vertex, `join` joins it: each
// holds but a part of the code. `walk` alone takes annexes and `join` alone gives them back, so that no list is read where it is written.
//: use transport::bidirectional::connect
//: use transport::bidirectional::splats
//: use transport::bidirectional::walk
//: use transport::bidirectional::weight
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

// The walk from the sensor before its first ray; of a probe there is none, and `vertex` is the probe.
fn wave_sensor_walk(slot: u32, sampler: BlockSampler, vertex: ptr<function, WalkVertex>) -> PathWalk {
    let at = wave_start(slot);
    if job.probes == 0u {
        let ray = wave_camera_ray(at);
        var walk = path_walk_new(false, ray, vec3(1.0f));
        walk.left = Left(true, camera_pdf_solid_angle(wave_camera(scene_at.camera), ray.direction), 0.0f);
        //: if VOLUME
        walk.inside = vec3(job.camera_inside0, job.camera_inside1, job.camera_inside2);
        //: end
        return walk;
    }
    var words = 7u;
    //: if VOLUME
    words = 10u;
    //: end
    let probe = job.probes + words * at.element;
    let chain = Chain(1.0f, 0.0f, 0.0f, 0.0f);
    *vertex = walk_vertex_at_surface(surface_white(wave_probe_point(probe), wave_probe_normal(probe)), chain);
    (*vertex).carried = vec3(PI);
    var walk = path_walk_new(false, Ray(vec3(0.0f), vec3(0.0f), 0.0f), vec3(PI));
    walk.edges = 0u;
    //: if VOLUME
    walk.inside = vec3(states[probe + 7u], states[probe + 8u], states[probe + 9u]);
    (*vertex).inside = walk.inside;
    (*vertex).beyond = walk.inside;
    //: end
    return walk;
}

// Adds what a walk from the sensor sees by itself, weighted: s = 0.
fn wave_see(slot: u32, walk: PathWalk, step: Step, radiance: ptr<function, vec3<f32>>) {
    var weight = 1.0f;
    if step.end.is_there && job.only_s == JOB_ALL {
        var nothing: End;
        weight = weight_weigh(slot, nothing, step.end, 1.0f);
    }
    let seen = step.radiance * weight;
    if step.kind != STEP_AWAY {
        *radiance += seen;
    } else if weight_uses(0u, walk.index + 2u) {
        *radiance += walk.carried * (light_float3(scene_at.environment) + seen);
    }
}

@compute @workgroup_size(64)
fn walk(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = wave_slot(id.x);
    if slot == job.slots { return; }
    let phase = wave_get(slot, ROW_PHASE);
    if phase >= PHASE_SPLAT { return; }
    let sampler = wave_sampler(slot);
    //: if SEARCH
    if phase == PHASE_SEARCH {
        search_step(slot);
        return;
    }
    //: end
    let from_light = phase == PHASE_LIGHT;
    var vertex: WalkVertex;
    var walk: PathWalk;
    if phase == PHASE_TURN {
        walk = wave_sensor_walk(slot, sampler, &vertex);
        if job.probes == 0u {
            wave_put_walk(slot, walk);
            wave_query(slot, PHASE_SENSOR, QUERY_CLOSEST, path_walk_ray(walk));
            return;
        }
    } else {
        walk = wave_walk(slot, from_light);
        if !wave_has_annex(slot, walk) {
            // The same again; the ray is not counted twice.
            wave_put(slot, ROW_RAYS, wave_get(slot, ROW_RAYS) - 1u);
            wave_ask(slot);
            return;
        }
        var radiance = wave_triple(slot, ROW_RADIANCE);
        let step = path_walk_arrive(slot, &walk, wave_hit(slot), sampler, &radiance);
        if !from_light {
            wave_see(slot, walk, step, &radiance);
            wave_put_triple(slot, ROW_RADIANCE, radiance);
        }
        if step.kind != STEP_AT {
            let over = step.kind != STEP_ON;
            wave_put_walk(slot, walk);
            wave_follow(slot, from_light, walk.origin, select(walk.direction, vec3(0.0f), over));
            return;
        }
        vertex = step.vertex;
        if from_light && walk.index == 0u {
            let light = light_record(walk.light);
            vertex.chain.open *= emitters_preference_at(light, vertex.point.position, walk.place);
        }
    }
    path_walk_scatter(slot, &walk, vertex, sampler);
    wave_put_walk(slot, walk);
    let connects = lobes_has_density(vertex.lobes);
    if !connects {
        wave_follow(slot, from_light, walk.origin, walk.direction);
        return;
    }
    var number = 0u;
    if from_light {
        number = wave_get(slot, ROW_COUNT) + 1u;
        wave_put(slot, ROW_COUNT, number);
    }
    wave_put_vertex(slot, number, vertex);
    wave_put(slot, ROW_PHASE, select(PHASE_JOIN, PHASE_SPLAT, from_light));
    wave_put(slot, ROW_QUERY, QUERY_NOTHING);
}

fn queue_add(at: u32, x: u32) -> u32 {
    if x == 0u { return 0u; }
    let old = atomicAdd(&queue[at], x);
    return u32(old + x < old);
}

// Adds a number of three words to another.
fn wave_add(at: u32, x: vec3<u32>) {
    let first = queue_add(at, x.x);
    // Both together may be beyond a word: all ones, and one that is carried.
    let middle = x.y + first;
    let second = select(queue_add(at + 1u, middle), 1u, middle < first);
    queue_add(at + 2u, x.z + second);
}

// A joint has come through: what it brings lands.
fn wave_land(slot: u32, value: vec3<f32>) {
    let pixel = wave_get(slot, ROW_PIXEL);
    if pixel == NO_INDEX {
        wave_put_triple(slot, ROW_RADIANCE, wave_triple(slot, ROW_RADIANCE) + value);
        return;
    }
    let block = job.first_block + (job.first_element + slot / job.samples) / job.elements;
    let at = job.splats + 9u * ((block % job.splat_blocks) * job.elements + pixel);
    wave_add(at, splat_units(value.x, job.per_unit));
    wave_add(at + 3u, splat_units(value.y, job.per_unit));
    wave_add(at + 6u, splat_units(value.z, job.per_unit));
}

//: if VOLUME
fn wave_way(slot: u32) -> Followed {
    return Followed(
        wave_ray(slot),
        wave_float(slot, ROW_WAY_LEAD),
        wave_float(slot, ROW_WAY_LENGTH),
        wave_media(slot, ROW_WAY_INSIDE),
        wave_get(slot, ROW_WAY_CROSSED),
        wave_triple(slot, ROW_JOINT),
        wave_float(slot, ROW_WAY_THROUGH),
    );
}

fn wave_put_way(slot: u32, way: Followed) {
    wave_put_float(slot, ROW_WAY_LEAD, way.lead);
    wave_put_float(slot, ROW_WAY_LENGTH, way.length);
    wave_put_media(slot, ROW_WAY_INSIDE, way.inside);
    wave_put(slot, ROW_WAY_CROSSED, way.crossed);
    wave_put_triple(slot, ROW_JOINT, way.carried);
    wave_put_float(slot, ROW_WAY_THROUGH, way.through);
}

//: if CUTOFF
fn wave_end(slot: u32, row: u32) -> End {
    let index = wave_get(slot, row);
    let chain = Chain(
        wave_float(slot, row + 1u),
        wave_float(slot, row + 2u),
        wave_float(slot, row + 3u),
        wave_float(slot, row + 4u),
    );
    return End(index != NO_INDEX, index, chain, wave_float(slot, row + 5u), wave_float(slot, row + 6u));
}

fn wave_put_end(slot: u32, row: u32, end: End) {
    wave_put(slot, row, select(NO_INDEX, end.index, end.is_there));
    wave_put_float(slot, row + 1u, end.chain.pdf);
    wave_put_float(slot, row + 2u, end.chain.back);
    wave_put_float(slot, row + 3u, end.chain.open);
    wave_put_float(slot, row + 4u, end.chain.sum);
    wave_put_float(slot, row + 5u, end.forward);
    wave_put_float(slot, row + 6u, end.backward);
}
//: end
//: end

// The answer to a joint: whether it goes on.
fn wave_joined(slot: u32, phase: u32) -> bool {
    let met = wave_hit(slot);
    //: if VOLUME
    var way = wave_way(slot);
    let kind = connect_follow(&way, met);
    if kind == FOLLOWED_PART {
        wave_put_way(slot, way);
        wave_query(slot, phase, QUERY_CLOSEST, way.ray);
        return true;
    }
    if kind == FOLLOWED_WHOLE {
        var weight = 1.0f;
        if job.only_s == JOB_ALL {
            //: if CUTOFF
            weight = weight_weigh(slot, wave_end(slot, ROW_ENDS), wave_end(slot, ROW_ENDS + 7u), way.through);
            //: else
            weight = weight_by_sum(wave_float(slot, ROW_SUM), way.through);
            //: end
        }
        wave_land(slot, way.carried * weight);
    }
    //: else
    if met.primitive == TREE_NOTHING { wave_land(slot, wave_triple(slot, ROW_JOINT)); }
    //: end
    return false;
}

// Sends a joint on its way, if it can bring anything.
fn wave_launch(slot: u32, phase: u32, given: Joint, sampler: BlockSampler, eye: u32) -> bool {
    if !given.goes { return false; }
    var joint = given;
    var weight = 1.0f;
    //: if CUTOFF
    //: if not VOLUME
    // Where the way is not known weights may be nothing now and something then.
    if job.only_s == JOB_ALL { weight = weight_weigh(slot, joint.light, joint.sensor, 1.0f); }
    //: end
    //: else
    let sum = weight_others(joint.light) + weight_others(joint.sensor);
    if job.only_s == JOB_ALL { weight = weight_by_sum(sum, 1.0f); }
    //: end
    connect_by_chance(&joint, weight, wave_triple(slot, ROW_RADIANCE), sampler, eye);
    if !joint.goes { return false; }
    wave_put(slot, ROW_PIXEL, select(NO_INDEX, joint.pixel.y * job.width + joint.pixel.x, joint.to_camera));
    //: if VOLUME
    //: if CUTOFF
    wave_put_end(slot, ROW_ENDS, joint.light);
    wave_put_end(slot, ROW_ENDS + 7u, joint.sensor);
    //: else
    wave_put_float(slot, ROW_SUM, sum);
    //: end
    wave_put_way(slot, Followed(joint.ray, joint.lead, joint.length, joint.inside, 0u, joint.carried, 1.0f));
    wave_query(slot, phase, QUERY_CLOSEST, joint.ray);
    //: else
    // Nothing on the way changes what it brings.
    wave_put_triple(slot, ROW_JOINT, joint.carried * weight);
    wave_query(slot, phase, QUERY_SHADOW, joint.ray);
    //: end
    return true;
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
