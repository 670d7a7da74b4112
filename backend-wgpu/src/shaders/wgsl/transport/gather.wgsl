// Tracing back from the sensor to a map: core's tracer as a state machine, one step between two rays. Where light is scattered lights are asked one after
// another; what is there is found anew at each answer, so that a state need not hold it.
//: use illumination::read
//: use transport::back
//: use transport::volume::vertex
//: if VOLUME
//: use medium
//: use transport::volume::boundaries
//: end

// The light of a map's photon that is asked of what is without size: at first hand, and at second.
const GATHER_LIGHTS_SEEN: u32 = 64u;
const GATHER_LIGHTS_GATHERED: u32 = 4u;

// A step without a ray: what a probe begins with.
const QUERY_HERE: u32 = QUERY_NOTHING;

// What is done at a vertex.
const GATHER_MIRROR: u32 = 1u;
const GATHER_LOBES: u32 = 2u;
const GATHER_SPREAD: u32 = 3u;
const GATHER_READ: u32 = 4u;
// At a probe: a sample, and what is the same for all samples.
const GATHER_PROBE: u32 = 5u;
const GATHER_ONCE: u32 = 6u;
// In a medium.
const GATHER_MEDIUM: u32 = 7u;

struct GatherState {
    sampler: BlockSampler,
    radiance: vec3<f32>,
    throughput: vec3<f32>,
    // What a shadow ray may bring.
    pending: vec3<f32>,
    pdf: f32,
    vertex: vec3<f32>,
    depth: u32,
    // What is asked: the way to a light, or the path's own ray.
    ray: Ray,
    query: u32,
    // What was met last: the ray and the hit, or the probe's point and normal.
    met: Ray,
    hit: Hit,
    kind: u32,
    // How many lights have been asked.
    stage: u32,
    gathers: bool,
    seen: bool,
    //: if VOLUME
    way: GatherWay,
    //: end
}

//: if VOLUME
// The nearest hit on a way to a light.
const QUERY_CONNECT: u32 = 3u;

// What a path flies through: the media in which its ray starts and those beyond the surface that it has met, what lies before its start, what has been flown since the
// last vertex, boundaries crossed, what names its numbers, and its channel where its colours have parted, counted from 1. Then of a way to a light: what is left of its light,
// media, lead, what is left of the way, boundaries crossed.
struct GatherWay {
    inside: Inside,
    beyond: Inside,
    lead: f32,
    flown: f32,
    crossed: u32,
    event: u32,
    channel: u32,
    left: vec3<f32>,
    to_inside: Inside,
    to_lead: f32,
    to_length: f32,
    to_crossed: u32,
}
//: end

// Lights by list: their numbers, and the counts by which one is picked.
struct GatherChoice { lights: u32, count: u32, counts: u32 }

// How a job reads its map.
struct GatherJob {
    max_depth: u32,
    gather: bool,
    // The edge of the largest element; 0 where rays that end nearer are read too.
    near: f32,
    elements: ElementMap,
    all: u32,
    caustics: u32,
    has_caustics: bool,
    point_like: GatherChoice,
    surfaces: GatherChoice,
    surface_share: f32,
}

struct GatherLight { found: bool, light: u32, factor: f32 }

fn gather_pick(choice: GatherChoice, word: u32) -> GatherLight {
    if choice.count == 0u { return GatherLight(false, 0u, 0.0f); }
    counts_at = COUNTS_OF_JOB + choice.counts;
    let pick = discrete_pick_in(choice.count, word);
    let light = light_record(job_word(choice.lights + pick.index));
    return GatherLight(true, light, scene_float(light + LIGHT_PMF) / pick.pmf);
}

fn gather_is_round(primitive: u32) -> bool { return primitive >= scene_at.triangle_count; }

// Lights without size that are asked at a vertex.
fn gather_most(state: GatherState) -> u32 {
    if state.kind == GATHER_ONCE { return 0xffffffffu; }
    return select(GATHER_LIGHTS_GATHERED, GATHER_LIGHTS_SEEN, state.seen);
}

fn gather_read(gather: GatherJob, values: u32, state: GatherState, from_front: bool) -> vec3<f32> {
    return elements_read(gather.elements, values, state.hit.primitive, state.hit.b1, state.hit.b2, from_front);
}

// The k-th light without size of a vertex.
fn gather_point_like(gather: GatherJob, state: GatherState, k: u32) -> GatherLight {
    let most = gather_most(state);
    let choice = gather.point_like;
    if choice.count <= most {
        let light = light_record(job_word(choice.lights + k));
        return GatherLight(true, light, scene_float(light + LIGHT_PMF));
    }
    let word = sobol_bits4(state.sampler, 1u + 2u * state.depth).w;
    var picked = gather_pick(choice, word + (k << select(26u, 30u, most == GATHER_LIGHTS_GATHERED)));
    picked.factor = picked.factor / f32(most);
    return picked;
}

// Value of the lobes towards a surface light, each weighted against its own directions; `chances`: those of the diffuse lobe and of Phong's.
fn gather_competing(surface: Surface, wi: vec3<f32>, density: f32, chances: vec2<f32>) -> vec3<f32> {
    let n = surface.shading;
    var f = vec3(0.0f);
    if chances.x > 0.0f {
        let other = chances.x * diffuse_pdf_solid_angle(n, wi);
        f += diffuse_eval(surface.lobes.albedo, n, wi) * mis_power_heuristic(density, other);
    }
    //: if LOBES
    if chances.y > 0.0f && !math_is_zero3(surface.lobes.specular) {
        let exponent = surface.lobes.exponent;
        let other = chances.y * phong_pdf_solid_angle(exponent, n, surface.wo, wi);
        let value = phong_eval(surface.lobes.specular, exponent, n, surface.wo, wi);
        f += value * mis_power_heuristic(density, other);
    }
    //: end
    return f;
}

fn gather_diffuse_share(surface: Surface) -> f32 {
    //: if LOBES
    return lobes_diffuse_share(surface.lobes);
    //: else
    return 1.0f;
    //: end
}

// The next light of a vertex that may bring something: whether a ray to it is asked.
fn gather_ask_lights(state: ptr<function, GatherState>, vertex: Vertex, gather: GatherJob) -> bool {
    let kind = (*state).kind;
    let surface = vertex.surface;
    var points = min(gather.point_like.count, gather_most(*state));
    if kind == GATHER_PROBE || kind == GATHER_MIRROR { points = 0u; }
    var ends = points + 1u;
    if kind == GATHER_MIRROR || (kind == GATHER_LOBES && !lobes_has_density(surface.lobes)) { ends = 0u; }
    //: if LOBES
    if kind == GATHER_READ && math_is_zero3(surface.lobes.specular) { ends = points; }
    //: else
    if kind == GATHER_READ { ends = points; }
    //: end
    if kind == GATHER_ONCE || gather.surfaces.count == 0u { ends = min(ends, points); }
    let place = surface.point.position;
    var asks = false;
    while (*state).stage < ends && !asks {
        let k = (*state).stage;
        (*state).stage = k + 1u;
        let of_surface = k >= points;
        var words = vec3(0u);
        var picked: GatherLight;
        if of_surface {
            words = sobol_bits4((*state).sampler, 1u + 2u * (*state).depth).xyz;
            picked = gather_pick(gather.surfaces, words.x);
            words.x = 0u;
        } else {
            picked = gather_point_like(gather, *state, k);
            words = vec3(0u);
        }
        let s = light_sample_light(picked.light, place, words.yz);
        let density = s.pdf * gather.surface_share;
        var brings = vec3(0.0f);
        if s.found && picked.found {
            if kind == GATHER_LOBES || kind == GATHER_MEDIUM {
                let value = vertex_scattering(vertex, s.wi);
                var weight = 1.0f;
                if of_surface && density > 0.0f { weight = mis_power_heuristic(density, value.pdf); }
                brings = (*state).throughput * value.f * s.contribution * (picked.factor * weight);
            } else if !(math_dot(s.wi, surface.geometric) <= 0.0f) {
                var f: vec3<f32>;
                if of_surface {
                    let share = gather_diffuse_share(surface);
                    let chances = select(vec2(share, 1.0f - share), vec2(0.0f, 1.0f), kind == GATHER_READ);
                    f = gather_competing(surface, s.wi, density, chances);
                } else {
                    f = lobes_eval_plain(surface.lobes, surface.shading, surface.wo, s.wi);
                }
                let cos = math_max_number(math_dot(s.wi, surface.shading), 0.0f);
                brings = (*state).throughput * (f * picked.factor) * s.contribution * cos;
            }
        }
        if !math_is_zero3(brings) {
            (*state).pending = brings;
            //: if VOLUME
            (*state).ray = vertex_towards(vertex, s);
            (*state).query = QUERY_CONNECT;
            (*state).way.left = vec3(1.0f);
            (*state).way.to_inside = vertex_media(vertex, (*state).way.inside, s.wi);
            (*state).way.to_lead = vertex_lead(vertex, (*state).ray.origin, (*state).ray.direction);
            (*state).way.to_length = vertex_distance(vertex, s);
            (*state).way.to_crossed = 0u;
            //: else
            (*state).ray = light_shadow_ray(s, surface.point, surface.geometric);
            (*state).query = QUERY_SHADOW;
            //: end
            asks = true;
        }
    }
    return asks;
}

// The direction in which a path leaves a vertex, what its throughput is multiplied by, and its density.
struct GatherGoes { found: bool, wi: vec3<f32>, weight: vec3<f32>, pdf: f32, squared: f32, diffuse: bool }

fn gather_direction(kind: u32, vertex: Vertex, u: vec3<f32>) -> GatherGoes {
    let surface = vertex.surface;
    var goes = GatherGoes(false, vec3(0.0f), vec3(0.0f), 0.0f, 1.0f, false);
    if kind == GATHER_ONCE { return goes; }
    //: if VOLUME
    if kind == GATHER_MEDIUM {
        let wi = phase_sample(vertex.g, surface.wo, u.xy);
        return GatherGoes(true, wi, vec3(1.0f), phase_eval(vertex.g, surface.wo, wi), 1.0f, false);
    }
    //: end
    //: if LOBES
    if kind == GATHER_MIRROR || kind == GATHER_LOBES {
        let place = select(u, vec3(0.0f), kind == GATHER_MIRROR);
        let s = lobes_sample(surface.lobes, surface.shading, surface.wo, place.xy, place.z);
        goes.found = s.found;
        goes.wi = s.wi;
        goes.weight = s.weight;
        if kind == GATHER_LOBES {
            goes.pdf = s.pdf;
            //: if SHADING
            goes.found = s.found && vertex_goes(surface, s.wi);
            //: end
            //: if VOLUME
            goes.found = s.found && vertex_goes(surface, s.wi);
            //: end
            goes.squared = vertex_index_ratio_squared(vertex, s.wi);
            return goes;
        }
    } else {
        let share = gather_diffuse_share(surface);
        let reads = kind == GATHER_READ;
        if reads && math_is_zero3(surface.lobes.specular) { return goes; }
        if reads || u.z >= share {
            let chance = select(1.0f - share, 1.0f, reads);
            let exponent = surface.lobes.exponent;
            goes.wi = phong_sample(exponent, surface.shading, surface.wo, u.xy);
            let density = phong_pdf_solid_angle(exponent, surface.shading, surface.wo, goes.wi);
            let cos = math_dot(goes.wi, surface.shading);
            goes.found = cos > 0.0f && density > 0.0f;
            goes.weight = surface.lobes.specular * (cos / chance);
            goes.pdf = chance * density;
        } else {
            goes = gather_diffuse(surface, u.xy, share);
        }
    }
    //: else
    if kind == GATHER_READ { return goes; }
    goes = gather_diffuse(surface, u.xy, 1.0f);
    //: end
    //: if SHADING
    goes.found = goes.found && !(math_dot(goes.wi, surface.geometric) <= 0.0f);
    //: end
    //: if VOLUME
    goes.found = goes.found && !(math_dot(goes.wi, surface.geometric) <= 0.0f);
    //: end
    return goes;
}

fn gather_diffuse(surface: Surface, u: vec2<f32>, share: f32) -> GatherGoes {
    let wi = diffuse_sample(surface.shading, u);
    let pdf = share * diffuse_pdf_solid_angle(surface.shading, wi);
    return GatherGoes(true, wi, surface.lobes.albedo / share, pdf, 1.0f, true);
}

// All lights of a vertex have been asked: on along a direction.
fn gather_follow(state: ptr<function, GatherState>, vertex: Vertex) {
    (*state).query = QUERY_DONE;
    let depth = (*state).depth;
    let u = sobol_group4((*state).sampler, 2u + 2u * depth);
    let goes = gather_direction((*state).kind, vertex, u.xyz);
    // What lies behind a medium is seen at second hand, too.
    if goes.diffuse || (*state).kind == GATHER_MEDIUM {
        (*state).gathers = false;
        (*state).seen = false;
    }
    if !goes.found { return; }
    let played = back_play((*state).throughput, goes.weight * goes.squared, depth, u.w);
    if !played.survives { return; }
    (*state).throughput = played.throughput / goes.squared;
    (*state).pdf = goes.pdf;
    (*state).vertex = vertex_leave(vertex, goes.wi);
    (*state).ray = Ray((*state).vertex, goes.wi, MAX_FLOAT);
    (*state).depth = depth + 1u;
    (*state).query = QUERY_CLOSEST;
    //: if VOLUME
    var inside = (*state).way.inside;
    if (*state).kind == GATHER_LOBES { inside = vertex_media(vertex, inside, goes.wi); }
    gather_leave(state, inside, vertex_lead(vertex, (*state).vertex, goes.wi));
    //: end
}

//: if VOLUME
// The path leaves a vertex into these media.
fn gather_leave(state: ptr<function, GatherState>, inside: Inside, lead: f32) {
    (*state).way.inside = inside;
    (*state).way.lead = lead;
    (*state).way.flown = 0.0f;
    (*state).way.crossed = 0u;
}
//: end

// What is done at a surface that was met, and what the map says there.
fn gather_arrive(state: ptr<function, GatherState>, surface: Surface, gather: GatherJob) {
    let hit = (*state).hit;
    (*state).stage = 0u;
    //: if LOBES
    if surface.lobes.mirror {
        (*state).kind = GATHER_MIRROR;
        return;
    }
    //: end
    let round = gather_is_round(hit.primitive);
    let near = !(*state).seen && hit.t < gather.near;
    var kind = select(GATHER_READ, GATHER_SPREAD, (*state).gathers || round || near);
    var values = gather.all;
    var reads = kind == GATHER_READ;
    var albedo = surface.lobes.albedo;
    //: if LOBES
    if !lobes_is_plain(surface.lobes) {
        kind = GATHER_LOBES;
        albedo = lobes_diffuse_albedo(surface.lobes, surface.shading, surface.wo);
    }
    if kind != GATHER_READ {
        values = gather.caustics;
        reads = gather.has_caustics;
    }
    //: end
    (*state).kind = kind;
    if reads && !math_is_zero3(albedo) {
        let irradiance = gather_read(gather, values, *state, surface.from_front);
        (*state).radiance += (*state).throughput * albedo * INV_PI * irradiance;
    }
}
