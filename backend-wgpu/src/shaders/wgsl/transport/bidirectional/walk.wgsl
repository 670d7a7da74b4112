// One walk, from a light or from the sensor: flights, boundaries that are passed straight, and the vertices between.
//: use sampling::sobol
//: use transport::back
//: use transport::bidirectional::emitters
//: use transport::bidirectional::vertex
//: use transport::bidirectional::weight
//: if VOLUME
//: use medium
//: use medium::inside
//: use transport::volume::boundaries
//: use transport::volume::way
//: end
//: if CUTOFF
//: use wavefront::bidirectional::links
//: end

// Most vertices of one walk.
const VERTICES_MAX: u32 = 512u;
// Groups of sample dimensions of an event, and the first ones of the walk from a light: its start, then which light and which colour.
const WALK_GROUPS: u32 = 3u;
const LIGHT_START: u32 = 1u << 27u;
const LIGHT_PICK: u32 = LIGHT_START + 1u;
const LIGHT_GROUPS: u32 = LIGHT_START + 2u;

struct PathWalk {
    from_light: bool,
    // The ray that is followed; of no direction when the walk ends.
    origin: vec3<f32>,
    direction: vec3<f32>,
    // What is carried along it, and the edges up to and including it.
    carried: vec3<f32>,
    edges: u32,
    // The last vertex: where, its number, how likely it was, how it was left, and the cosine or extinction there (0: nothing meets it).
    place: vec3<f32>,
    index: u32,
    chain: Chain,
    left: Left,
    facing: f32,
    light: u32,
    // The last vertex is at infinity.
    distant: bool,
    // Scatterings and crossings so far.
    event: u32,
    coloured: bool,
    //: if VOLUME
    inside: Inside,
    lead: f32,
    // Mean chance over the channels to have come here from the last vertex, and boundaries crossed since.
    through: f32,
    crossed: u32,
    //: end
}

fn path_walk_new(from_light: bool, ray: Ray, carried: vec3<f32>) -> PathWalk {
    var walk: PathWalk;
    walk.from_light = from_light;
    walk.origin = ray.origin;
    walk.direction = ray.direction;
    walk.place = ray.origin;
    walk.carried = carried;
    walk.edges = 1u;
    walk.chain = Chain(1.0f, 0.0f, 0.0f, 0.0f);
    walk.left = Left(false, 1.0f, 1.0f);
    //: if VOLUME
    walk.through = 1.0f;
    //: end
    return walk;
}

fn path_walk_of_light(start: EmittersStart) -> PathWalk {
    var walk = path_walk_new(true, start.ray, start.carried);
    let light = light_record(start.light);
    let is_met = emitters_is_met(light);
    walk.light = start.light;
    walk.place = start.position;
    walk.chain = Chain(start.pdf_place, 0.0f, select(0.0f, 1.0f, is_met), 0.0f);
    walk.left = Left(true, start.pdf_direction, 0.0f);
    walk.distant = emitters_is_distant(light);
    if is_met {
        walk.facing = math_max_number(math_dot(start.ray.direction, start.normal), 0.0f);
        // Its place is a direction.
        if walk.distant { walk.facing = 1.0f; }
    }
    //: if VOLUME
    if !math_is_zero3(start.normal) {
        walk.lead = way_lead(start.position, start.normal, start.ray.origin, start.ray.direction);
    }
    //: end
    return walk;
}

fn path_walk_ray(walk: PathWalk) -> Ray { return Ray(walk.origin, walk.direction, MAX_FLOAT); }

fn path_walk_through(walk: PathWalk) -> f32 {
    //: if VOLUME
    return walk.through;
    //: else
    return 1.0f;
    //: end
}

// The vertex at a place: `facing` what it turns to the walk (cosine or extinction).
fn path_walk_link(walk: PathWalk, position: vec3<f32>, facing: f32) -> Chain {
    let to = position - walk.place;
    var d2 = 1.0f;
    if !walk.distant { d2 = math_max(math_dot(to, to), 1e-30f); }
    let per = path_walk_through(walk) / d2;
    return chain_next(walk.chain, walk.left, walk.facing * per, facing * per);
}

// Groups of sample dimensions of what happens next.
fn path_walk_groups(walk: PathWalk) -> u32 { return select(1u, LIGHT_GROUPS, walk.from_light) + WALK_GROUPS * walk.event; }

// Whether there may be another edge: the last one of a walk from a light is that to the sensor.
fn path_walk_has_room(walk: PathWalk, edges: u32, index: u32) -> bool {
    return edges + select(1u, 2u, walk.from_light) <= job.max_depth && index + 2u < VERTICES_MAX;
}

// Leaves a vertex along a ray that is set already.
fn path_walk_leave(walk: ptr<function, PathWalk>, index: u32, chain: Chain, left: Left, facing: f32) {
    (*walk).index = index;
    (*walk).chain = chain;
    (*walk).left = left;
    (*walk).facing = facing;
    (*walk).distant = false;
    (*walk).edges += 1u;
    //: if VOLUME
    (*walk).through = 1.0f;
    (*walk).crossed = 0u;
    //: end
}

// Sends a walk on from a vertex; its ray has no direction where it ends.
fn path_walk_scatter(slot: u32, walk: ptr<function, PathWalk>, vertex: WalkVertex, sampler: BlockSampler) {
    let u = sobol_group4(sampler, path_walk_groups(*walk) + 2u);
    (*walk).event += 1u;
    (*walk).direction = vec3(0.0f);
    if !path_walk_has_room(*walk, vertex.edges, vertex.index) { return; }
    let from_light = (*walk).from_light;
    let s = walk_vertex_sample(vertex, from_light, u.xy, u.z);
    if !s.found { return; }
    // The roulette is about what is absorbed: the squared index comes back when light leaves.
    let squared = walk_vertex_index_ratio_squared(vertex, from_light, s.wi);
    let played = back_play(vertex.carried, s.weight * squared, vertex.edges, u.w);
    if !played.survives { return; }
    (*walk).carried = played.throughput / squared;
    //: if CUTOFF
    links_leave(slot, from_light, vertex.index, vertex.chain, s.left);
    //: end
    (*walk).place = vertex.point.position;
    (*walk).origin = walk_vertex_leave(vertex, s.wi, 0.0f);
    (*walk).direction = s.wi;
    //: if VOLUME
    (*walk).lead = walk_vertex_lead(vertex, (*walk).origin, s.wi);
    (*walk).inside = walk_vertex_media(vertex, s.wi);
    //: end
    path_walk_leave(walk, vertex.index, vertex.chain, s.left, walk_vertex_facing(vertex, s.wi, 1.0f));
}

const STEP_ON: u32 = 0u;
const STEP_OVER: u32 = 1u;
const STEP_AT: u32 = 2u;

// What the sensor's walk sees by itself: radiance, with what its weight needs to know.
struct Seen { radiance: vec3<f32>, end: End }

//: if VOLUME
// Straight on, beyond a boundary: the same edge, and a direction of the same density. What kind of step that is.
fn path_walk_pass(walk: ptr<function, PathWalk>, surface: Surface, beyond: Inside) -> u32 {
    let direction = (*walk).direction;
    (*walk).inside = beyond;
    (*walk).event += 1u;
    (*walk).crossed += 1u;
    (*walk).origin = geometry_offset_origin(surface.point, surface.geometric, direction);
    (*walk).lead = way_lead(surface.point.position, surface.geometric, (*walk).origin, direction);
    return select(STEP_ON, STEP_OVER, (*walk).crossed > CROSSINGS_MAX);
}
//: end

//: if VOLUME
//: if LOBES
// The colour of walks that are of one.
fn path_walk_channel(sampler: BlockSampler) -> u32 { return min(u32(3.0f * sobol_group2(sampler, LIGHT_PICK).y), 2u); }

// From here on the walk is of one colour, which stands for all three.
fn path_walk_choose(walk: ptr<function, PathWalk>, channel: u32) {
    if !(*walk).coloured {
        (*walk).coloured = true;
        (*walk).carried = back_one_colour((*walk).carried, channel);
    }
}

// Reflected at a dielectric or a pane, or on through it: what kind of step that is.
fn path_walk_meet_interface(
    slot: u32, walk: ptr<function, PathWalk>, surface: Surface, chain: Chain, beyond: Inside, sampler: BlockSampler,
) -> u32 {
    let u = sobol_group4(sampler, path_walk_groups(*walk) + 2u);
    let channel = path_walk_channel(sampler);
    if interface_disperses(surface.interface_) { path_walk_choose(walk, channel); }
    let passage = interface_pass(surface.interface_, surface.shading, surface.wo, channel, u.x);
    // An interpolated normal would send it to the wrong side.
    if !passage.found || (math_dot(passage.wi, surface.geometric) < 0.0f) != passage.through { return STEP_OVER; }
    var weight = passage.weight;
    let straight = interface_straight(surface.interface_);
    if passage.through && straight.found {
        (*walk).carried *= weight;
        (*walk).through *= straight.chance;
        if math_is_zero3((*walk).carried) { return STEP_OVER; }
        return path_walk_pass(walk, surface, beyond);
    }
    (*walk).event += 1u;
    if !path_walk_has_room(*walk, (*walk).edges, (*walk).index + 1u) { return STEP_OVER; }
    let from_light = (*walk).from_light;
    if from_light {
        // Importance keeps its measure where radiance is squeezed into a smaller solid angle.
        if passage.through { weight = vec3(1.0f); }
        let n = surface.shading;
        let g = surface.geometric;
        let turned = math_dot(surface.wo, n) * math_dot(passage.wi, g)
            / (math_dot(surface.wo, g) * math_dot(passage.wi, n));
        weight *= math_abs(turned);
    }
    // The roulette is about what is absorbed: the squared index comes back when light leaves.
    let absorbed = select(weight, vec3(1.0f), passage.through);
    let played = back_play((*walk).carried, absorbed, (*walk).edges, u.w);
    if !played.survives { return STEP_OVER; }
    (*walk).carried = played.throughput;
    if passage.through {
        (*walk).carried = played.throughput * weight;
        (*walk).inside = beyond;
    }
    let left = Left(false, 1.0f, 1.0f);
    let index = (*walk).index + 1u;
    //: if CUTOFF
    links_leave(slot, from_light, index, chain, left);
    //: end
    (*walk).place = surface.point.position;
    (*walk).origin = geometry_offset_origin(surface.point, surface.geometric, passage.wi);
    (*walk).direction = passage.wi;
    (*walk).lead = way_lead(surface.point.position, surface.geometric, (*walk).origin, passage.wi);
    path_walk_leave(walk, index, chain, left, math_abs(math_dot(passage.wi, surface.geometric)));
    return STEP_ON;
}
//: end
//: end

// The picture of the environment, where the sensor's walk leaves the scene: s = 0, the last vertex being a direction.
fn path_walk_away(walk: PathWalk) -> Seen {
    var seen: Seen;
    //: if ENVIRONMENT_MAP
    if environment_is_there() {
        let met = environment_meet(walk.direction);
        let light = light_record(scene_at.environment_light);
        let through = path_walk_through(walk);
        var chain = chain_next(walk.chain, walk.left, walk.facing * through, through);
        if walk.index == 0u && job.probes == 0u { chain.open = 0.0f; }
        let towards = emitters_pdf_towards(light, walk.direction, vec3(0.0f));
        seen.radiance = met.radiance;
        seen.end = End(true, walk.index + 1u, chain, emitters_pdf_picture(met.pdf), towards);
    }
    //: end
    return seen;
}

// Emission of a surface that the sensor's walk meets.
fn path_walk_sees(walk: PathWalk, surface: Surface, met: Chain) -> Seen {
    let light = light_record(surface.light);
    var chain = met;
    if walk.index == 0u && job.probes == 0u {
        chain.open *= 0.0f;
    } else {
        chain.open *= emitters_preference_at(light, walk.place, surface.point.position);
    }
    let towards = emitters_pdf_towards(light, -surface.wo, surface.front);
    let end = End(true, walk.index + 1u, chain, emitters_pdf_place(light), towards);
    return Seen(walk.carried * light_radiance(light), end);
}

//: if VOLUME
// Where a flight through a medium has come to: on, over, or at a place in it.
struct Flown { kind: u32, position: vec3<f32>, extinction: f32 }

fn path_walk_fly(walk: ptr<function, PathWalk>, medium: Medium, limit: f32, sampler: BlockSampler) -> Flown {
    let ray = path_walk_ray(*walk);
    let u = sobol_group2(sampler, path_walk_groups(*walk));
    let flown = medium_fly(medium, ray, (*walk).lead, limit, (*walk).carried, u);
    (*walk).carried *= flown.weight;
    (*walk).through *= math_mean(flown.left);
    var out = Flown(STEP_ON, vec3(0.0f), 0.0f);
    if flown.collided {
        out.kind = STEP_AT;
        out.position = ray.origin + ray.direction * (flown.length - (*walk).lead);
        (*walk).carried *= medium_sigma_s_at(medium, out.position);
        out.extinction = math_mean(medium_sigma_t_at(medium, out.position));
    }
    if math_is_zero3((*walk).carried) { out.kind = STEP_OVER; }
    return out;
}
//: end
