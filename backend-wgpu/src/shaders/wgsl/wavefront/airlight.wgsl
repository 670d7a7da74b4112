// Waves of paths through media with summed airlight: the camera's ray first, segment by segment and node by node, then the walk.
//: use transport::volume::airlight
//: use wavefront::volume

const ROW_STAGE: u32 = 45u;
// The next node: its light, and its number.
const ROW_NODE: u32 = 46u;
const ROW_SHIFT: u32 = 48u;
// Whether there is a segment, and whether the ray goes on beyond it.
const ROW_AIR: u32 = 49u;
const ROW_SEGMENT: u32 = 50u;
const ROW_REACH: u32 = 53u;
const ROW_AIR_RAY: u32 = 54u;
const ROW_BEYOND: u32 = 68u;

const STAGE_WALK: u32 = 0u;
// The end of a segment is asked for.
const STAGE_SEGMENT: u32 = 1u;
// A node's way to its light is followed.
const STAGE_NODE: u32 = 2u;

const AIR_SEGMENT: u32 = 1u;
const AIR_GOES_ON: u32 = 2u;

fn wave_air(slot: u32, row: u32) -> AirRay {
    return AirRay(
        wave_triple(slot, row),
        wave_triple(slot, row + 3u),
        wave_float(slot, row + 6u),
        wave_inside(slot, row + 7u),
        wave_triple(slot, row + 10u),
        wave_get(slot, row + 13u),
    );
}

fn wave_put_air(slot: u32, row: u32, air: AirRay) {
    wave_put_triple(slot, row, air.origin);
    wave_put_triple(slot, row + 3u, air.direction);
    wave_put_float(slot, row + 6u, air.lead);
    wave_put_inside(slot, row + 7u, air.inside);
    wave_put_triple(slot, row + 10u, air.left);
    wave_put(slot, row + 13u, air.crossed);
}

// Asks for the end of a segment.
fn wave_ask_segment(slot: u32, air: AirRay) {
    wave_put_air(slot, ROW_AIR_RAY, air);
    wave_put(slot, ROW_STAGE, STAGE_SEGMENT);
    wave_put(slot, ROW_QUERY, QUERY_CLOSEST);
    wave_put_ray(slot, airlight_ray(air));
}

// The start of a sample whose walk is `state`, which has asked already.
fn wave_start_airlight(slot: u32, state: VolumeState) {
    let ray = state.ray;
    wave_ask_segment(slot, AirRay(ray.origin, ray.direction, 0.0f, state.inside, vec3(1.0f), 0u));
}

// The end of a segment is known.
fn wave_begin_segment(slot: u32, air: AirRay) -> bool {
    let hit = wave_hit(slot);
    let length = select(air.lead + hit.t, math_infinity(), hit.primitive == TREE_NOTHING);
    let segment = airlight_segment(air, length);
    let end = airlight_end(air, hit);
    wave_put_float(slot, ROW_SEGMENT, segment.begin);
    wave_put_float(slot, ROW_SEGMENT + 1u, segment.end);
    wave_put_float(slot, ROW_SEGMENT + 2u, segment.sigma);
    wave_put(slot, ROW_AIR, select(0u, AIR_SEGMENT, segment.is_there) | select(0u, AIR_GOES_ON, end.goes_on));
    wave_put_float(slot, ROW_REACH, end.reach);
    wave_put_air(slot, ROW_BEYOND, end.beyond);
    wave_put(slot, ROW_SHIFT, sobol_bits2(wave_sampler(slot), AIRLIGHT_GROUP + air.crossed).x);
    wave_put(slot, ROW_NODE, 0u);
    wave_put(slot, ROW_NODE + 1u, 0u);
    return end.found;
}

// The walk begins, with what is summed.
fn wave_walk_on(slot: u32) {
    let at = wave_start(slot);
    var state = volume_new(at.sampler, vec3(job.camera_inside0, job.camera_inside1, job.camera_inside2));
    state.ray = wave_camera_ray(at);
    state.vertex = state.ray.origin;
    state.depth = 1u;
    state.radiance = wave_triple(slot, ROW_RADIANCE);
    state.query = QUERY_CLOSEST;
    wave_put(slot, ROW_STAGE, STAGE_WALK);
    wave_store(slot, state);
}

// Asks on the way from the next node that brings anything; false where there is none left in the segment.
fn wave_next_node(slot: u32, air: AirRay) -> bool {
    let segment = Segment(
        (wave_get(slot, ROW_AIR) & AIR_SEGMENT) != 0u,
        wave_float(slot, ROW_SEGMENT),
        wave_float(slot, ROW_SEGMENT + 1u),
        wave_float(slot, ROW_SEGMENT + 2u),
    );
    if !segment.is_there { return false; }
    let reach = wave_float(slot, ROW_REACH);
    let shift = wave_get(slot, ROW_SHIFT);
    var light = wave_get(slot, ROW_NODE);
    var node = wave_get(slot, ROW_NODE + 1u);
    var aim: Aim;
    while !aim.found && light < scene_at.light_count {
        if node < job.nodes && airlight_is_summed(light_record(light)) {
            aim = airlight_aim(air, segment, reach, shift, light, node);
            node += 1u;
        } else {
            light += 1u;
            node = 0u;
        }
    }
    wave_put(slot, ROW_NODE, light);
    wave_put(slot, ROW_NODE + 1u, node);
    if !aim.found { return false; }
    wave_put(slot, ROW_STAGE, STAGE_NODE);
    wave_put(slot, ROW_QUERY, QUERY_CONNECT);
    wave_put_ray(slot, aim.ray);
    wave_put_triple(slot, ROW_PENDING, aim.carried);
    wave_put_float(slot, ROW_LENGTH, aim.length);
    wave_put_float(slot, ROW_LEAD, 0.0f);
    wave_put_inside(slot, ROW_INSIDE, air.inside);
    wave_put(slot, ROW_CROSSED, 0u);
    // Nothing follows it.
    wave_put_triple(slot, ROW_NEXT, vec3(0.0f));
    return true;
}

// What `advance` leaves: ends of segments, and nodes that are over.
@compute @workgroup_size(64)
fn airlight(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = wave_slot(id.x);
    if slot == job.slots { return; }
    let stage = wave_get(slot, ROW_STAGE);
    if stage == STAGE_WALK { return; }
    if stage == STAGE_NODE && wave_get(slot, ROW_QUERY) != QUERY_NOTHING { return; }
    let air = wave_air(slot, ROW_AIR_RAY);
    var goes_on = true;
    if stage == STAGE_SEGMENT { goes_on = wave_begin_segment(slot, air); }
    if goes_on {
        if !wave_next_node(slot, air) {
            goes_on = (wave_get(slot, ROW_AIR) & AIR_GOES_ON) != 0u;
            if goes_on { wave_ask_segment(slot, wave_air(slot, ROW_BEYOND)); }
        }
    }
    if goes_on { wave_ask(slot); } else { wave_walk_on(slot); }
}
