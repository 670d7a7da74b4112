// Waves of samples from both ends. A step has four parts: `trace` answers, `arrive` takes walks to their next vertex, `scatter` sends them
// on from there, `join` joins it. Each holds but a part of the code, and hands on by what is stored; `search` is a part where it is needed.
// `arrive` alone takes annexes and `join` alone gives them back, so that no list is read where it is written.
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

// Adds what a walk from the sensor sees by itself, weighted: s = 0.
fn wave_see(slot: u32, walk: PathWalk, seen: Seen, away: bool) {
    var weight = 1.0f;
    if seen.end.is_there && job.only_s == JOB_ALL {
        var nothing: End;
        weight = weight_weigh(slot, nothing, seen.end, 1.0f);
    }
    var brings = seen.radiance * weight;
    if away { brings = walk.carried * (light_float3(scene_at.environment) + brings); }
    wave_put_triple(slot, ROW_RADIANCE, wave_triple(slot, ROW_RADIANCE) + brings);
}

// Where the vertex goes that a walk has come to: of the light's walk behind the others.
fn wave_vertex_number(slot: u32, from_light: bool) -> u32 {
    if !from_light { return 0u; }
    return wave_get(slot, ROW_COUNT) + 1u;
}

// Takes a vertex into the lists with what it has of its walk.
fn wave_at(slot: u32, walk: PathWalk, given: WalkVertex) {
    var vertex = given;
    vertex.carried = walk.carried;
    vertex.edges = walk.edges;
    vertex.index = walk.index + 1u;
    vertex.coloured = walk.coloured;
    //: if VOLUME
    vertex.inside = walk.inside;
    //: end
    if walk.from_light && walk.index == 0u {
        let light = light_record(walk.light);
        vertex.chain.open *= emitters_preference_at(light, vertex.point.position, walk.place);
    }
    wave_put_vertex(slot, wave_vertex_number(slot, walk.from_light), vertex);
    wave_put(slot, ROW_PHASE, select(PHASE_AT_SENSOR, PHASE_AT_LIGHT, walk.from_light));
}

// What becomes of a walk whose ray has met a surface, or nothing. What it comes to is stored at once.
fn wave_arrive(slot: u32, walk: ptr<function, PathWalk>, met: Hit, sampler: BlockSampler) -> u32 {
    let missed = met.primitive == TREE_NOTHING;
    let ray = path_walk_ray(*walk);
    let sees = !(*walk).from_light && weight_uses(0u, (*walk).index + 2u);
    var vertex: WalkVertex;
    var hit = met;
    //: if VOLUME
    let record = inside_current((*walk).inside);
    if record != MEDIUM_NONE {
        let medium = medium_new(record);
        let limit = select((*walk).lead + met.t, math_infinity(), missed);
        if sees {
            let glow = (*walk).carried * medium_emitted(medium, ray, (*walk).lead, limit);
            wave_put_triple(slot, ROW_RADIANCE, wave_triple(slot, ROW_RADIANCE) + glow);
        }
        let flown = path_walk_fly(walk, medium, limit, sampler);
        if flown.kind == STEP_AT {
            let chain = path_walk_link(*walk, flown.position, flown.extinction);
            wave_at(slot, *walk, walk_vertex_in_medium(flown.position, -ray.direction, medium.g, flown.extinction, chain));
        }
        if flown.kind != STEP_ON { return flown.kind; }
    }
    //: end
    if missed {
        if sees { wave_see(slot, *walk, path_walk_away(*walk), true); }
        return STEP_OVER;
    }
    //: if VOLUME
    let resolved = boundaries_resolve(ray, met, (*walk).inside);
    hit = resolved.hit;
    //: end
    let surface = surface_at(ray, hit);
    if !surface.found { return STEP_OVER; }
    //: if VOLUME
    if (surface_flags(hit.primitive) & MATERIAL_NULL) != 0u { return path_walk_pass(walk, surface, resolved.inside); }
    //: end
    let facing = math_abs(math_dot(surface.wo, surface.geometric));
    let chain = path_walk_link(*walk, surface.point.position, facing);
    if sees && back_is_lit(surface) { wave_see(slot, *walk, path_walk_sees(*walk, surface, chain), false); }
    vertex = walk_vertex_at_surface(surface, chain);
    //: if VOLUME
    vertex.beyond = resolved.inside;
    //: if LOBES
    if surface.interface_.kind != INTERFACE_OPAQUE {
        return path_walk_meet_interface(slot, walk, surface, chain, resolved.inside, sampler);
    }
    if lobes_disperses(surface.lobes) {
        let channel = path_walk_channel(sampler);
        path_walk_choose(walk, channel);
        vertex.lobes = lobes_of_channel(surface.lobes, channel);
    }
    //: end
    //: end
    wave_at(slot, *walk, vertex);
    return STEP_AT;
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
