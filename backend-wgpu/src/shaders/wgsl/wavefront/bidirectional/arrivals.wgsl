// What becomes of walks whose rays have met something, or nothing.
//: use transport::bidirectional::walk
//: use transport::bidirectional::weight
//: use wavefront::bidirectional::rows

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
