// Where the states of samples from both ends lie: rows as in `wavefront::slots`, behind them the vertices of the light's walk, and what is
// beyond the first BASE of them in annexes, of which there are a few for all slots.
//: use transport::bidirectional::vertex
//: use transport::bidirectional::walk
//: use wavefront::slots
//: if VOLUME
//: use wavefront::states::media
//: end

const ROW_PHASE: u32 = 8u;
const ROW_WALK_ORIGIN: u32 = 9u;
const ROW_WALK_DIRECTION: u32 = 12u;
const ROW_CARRIED: u32 = 15u;
const ROW_PLACE: u32 = 18u;
const ROW_EDGES: u32 = 21u;
const ROW_INDEX: u32 = 33u;
const ROW_CHAIN: u32 = 34u;
const ROW_LEFT: u32 = 38u;
const ROW_FLAGS: u32 = 40u;
const ROW_FACING: u32 = 41u;
const ROW_LIGHT: u32 = 42u;
const ROW_EVENT: u32 = 43u;
// Vertices of the light's walk.
const ROW_COUNT: u32 = 44u;
// The annex of the slot, counted from 1.
const ROW_ANNEX: u32 = 45u;
// What the running joint brings, and its pixel.
const ROW_JOINT: u32 = 46u;
const ROW_PIXEL: u32 = 49u;
//: if VOLUME
const ROW_INSIDE: u32 = 50u;
const ROW_LEAD: u32 = 53u;
const ROW_THROUGH: u32 = 54u;
const ROW_CROSSED: u32 = 55u;
const ROW_WAY_INSIDE: u32 = 56u;
const ROW_WAY_LEAD: u32 = 59u;
const ROW_WAY_LENGTH: u32 = 60u;
const ROW_WAY_CROSSED: u32 = 61u;
const ROW_WAY_THROUGH: u32 = 62u;
//: if CUTOFF
// Of both ends their chain, densities and number.
const ROW_ENDS: u32 = 63u;
const ROW_LINKS: u32 = 77u;
//: else
// What the weight of the joint is made of.
const ROW_SUM: u32 = 63u;
const ROW_LINKS: u32 = 64u;
//: end
//: else
const ROW_LINKS: u32 = 50u;
//: end

// Vertices and links of a walk in rows, and those that an annex has room for.
const BASE: u32 = 16u;
const ANNEX: u32 = VERTICES_MAX - BASE;
//: if CUTOFF
const LINK_LISTS: u32 = 4u;
//: else
const LINK_LISTS: u32 = 0u;
//: end
const ROW_VERTICES: u32 = ROW_LINKS + LINK_LISTS * BASE;

// Words of a vertex, and where the parts begin that not all have.
const VERTEX_SHADING: u32 = 22u;
//: if SHADING
const VERTEX_VOLUME: u32 = VERTEX_SHADING + 3u;
//: else
const VERTEX_VOLUME: u32 = VERTEX_SHADING;
//: end
//: if VOLUME
const VERTEX_LOBES: u32 = VERTEX_VOLUME + 9u;
//: else
const VERTEX_LOBES: u32 = VERTEX_VOLUME;
//: end
//: if LOBES
const VERTEX_WORDS: u32 = VERTEX_LOBES + 10u;
//: else
const VERTEX_WORDS: u32 = VERTEX_LOBES;
//: end
const ANNEX_LINKS: u32 = VERTEX_WORDS * ANNEX;
const ANNEX_WORDS: u32 = ANNEX_LINKS + LINK_LISTS * ANNEX;

// A walk follows its ray.
const PHASE_LIGHT: u32 = 0u;
const PHASE_SENSOR: u32 = 1u;
// It is at a vertex.
const PHASE_AT_LIGHT: u32 = 2u;
const PHASE_AT_SENSOR: u32 = 3u;
// The walk from the light is over, that from the sensor not begun.
const PHASE_TURN: u32 = 4u;
// Which media a light sends into is looked for.
const PHASE_SEARCH: u32 = 5u;
// From here on it is `join` that goes on. A vertex is joined to the camera.
const PHASE_SPLAT: u32 = 6u;
const PHASE_OVER: u32 = 7u;
// And more: by the number of the joint.
const PHASE_JOIN: u32 = 8u;

const FLAG_OPENS: u32 = 1u;
const FLAG_DISTANT: u32 = 2u;
const FLAG_COLOURED: u32 = 4u;

fn wave_annex(slot: u32) -> u32 { return job.annexes + ANNEX_WORDS * (wave_get(slot, ROW_ANNEX) - 1u); }

// Words of a vertex: where they begin, and how far they are apart.
struct VertexPlace { at: u32, step: u32 }

// Number 0 is the sensor's last, then come the light's.
fn wave_vertex_place(slot: u32, number: u32) -> VertexPlace {
    if number <= BASE { return VertexPlace((ROW_VERTICES + VERTEX_WORDS * number) * job.slots + slot, job.slots); }
    return VertexPlace(wave_annex(slot) + VERTEX_WORDS * (number - BASE - 1u), 1u);
}

fn vertex_word(p: VertexPlace, k: u32) -> u32 { return states[p.at + k * p.step]; }

fn vertex_float(p: VertexPlace, k: u32) -> f32 { return bitcast<f32>(vertex_word(p, k)); }

fn vertex_triple(p: VertexPlace, k: u32) -> vec3<f32> {
    return vec3(vertex_float(p, k), vertex_float(p, k + 1u), vertex_float(p, k + 2u));
}

fn vertex_put(p: VertexPlace, k: u32, x: u32) { states[p.at + k * p.step] = x; }

fn vertex_put_float(p: VertexPlace, k: u32, x: f32) { vertex_put(p, k, bitcast<u32>(x)); }

fn vertex_put_triple(p: VertexPlace, k: u32, v: vec3<f32>) {
    vertex_put_float(p, k, v.x);
    vertex_put_float(p, k + 1u, v.y);
    vertex_put_float(p, k + 2u, v.z);
}

const COLOURED: u32 = 0x80000000u;

fn wave_put_vertex(slot: u32, number: u32, v: WalkVertex) {
    let p = wave_vertex_place(slot, number);
    vertex_put_triple(p, 0u, v.point.position);
    vertex_put_float(p, 3u, v.point.extent);
    vertex_put_triple(p, 4u, v.wo);
    vertex_put_triple(p, 7u, v.geometric);
    vertex_put_triple(p, 10u, v.carried);
    vertex_put_float(p, 13u, v.chain.pdf);
    vertex_put_float(p, 14u, v.chain.back);
    vertex_put_float(p, 15u, v.chain.open);
    vertex_put_float(p, 16u, v.chain.sum);
    vertex_put(p, 17u, v.edges);
    vertex_put(p, 18u, v.index | select(0u, COLOURED, v.coloured));
    vertex_put_triple(p, 19u, v.lobes.albedo);
    //: if SHADING
    vertex_put_triple(p, VERTEX_SHADING, v.shading);
    //: end
    //: if VOLUME
    vertex_put(p, VERTEX_VOLUME, v.inside.x);
    vertex_put(p, VERTEX_VOLUME + 1u, v.inside.y);
    vertex_put(p, VERTEX_VOLUME + 2u, v.inside.z);
    vertex_put(p, VERTEX_VOLUME + 3u, v.beyond.x);
    vertex_put(p, VERTEX_VOLUME + 4u, v.beyond.y);
    vertex_put(p, VERTEX_VOLUME + 5u, v.beyond.z);
    vertex_put(p, VERTEX_VOLUME + 6u, select(0u, 1u, v.in_medium));
    vertex_put_float(p, VERTEX_VOLUME + 7u, v.g);
    vertex_put_float(p, VERTEX_VOLUME + 8u, v.extinction);
    //: end
    //: if LOBES
    let l = v.lobes;
    vertex_put_float(p, VERTEX_LOBES, l.exponent);
    vertex_put_triple(p, VERTEX_LOBES + 1u, l.specular);
    vertex_put_triple(p, VERTEX_LOBES + 4u, l.ior);
    vertex_put(p, VERTEX_LOBES + 7u, l.coat);
    vertex_put_float(p, VERTEX_LOBES + 8u, l.rough.size);
    let bits = l.finish | (l.rough.kind << 8u) | select(0u, 1u << 16u, l.mirror) | select(0u, 1u << 17u, l.schlick);
    vertex_put(p, VERTEX_LOBES + 9u, bits);
    //: end
}

fn wave_vertex(slot: u32, number: u32) -> WalkVertex {
    let p = wave_vertex_place(slot, number);
    var v: WalkVertex;
    v.point = SurfacePoint(vertex_triple(p, 0u), vertex_float(p, 3u));
    v.wo = vertex_triple(p, 4u);
    v.geometric = vertex_triple(p, 7u);
    v.carried = vertex_triple(p, 10u);
    v.chain = Chain(vertex_float(p, 13u), vertex_float(p, 14u), vertex_float(p, 15u), vertex_float(p, 16u));
    v.edges = vertex_word(p, 17u);
    let index = vertex_word(p, 18u);
    v.index = index & ~COLOURED;
    v.coloured = (index & COLOURED) != 0u;
    v.lobes = lobes_diffuse(vertex_triple(p, 19u));
    v.shading = v.geometric;
    //: if SHADING
    v.shading = vertex_triple(p, VERTEX_SHADING);
    //: end
    //: if VOLUME
    let m = VERTEX_VOLUME;
    v.inside = vec3(vertex_word(p, m), vertex_word(p, m + 1u), vertex_word(p, m + 2u));
    v.beyond = vec3(vertex_word(p, m + 3u), vertex_word(p, m + 4u), vertex_word(p, m + 5u));
    v.in_medium = vertex_word(p, m + 6u) != 0u;
    v.g = vertex_float(p, m + 7u);
    v.extinction = vertex_float(p, m + 8u);
    //: end
    //: if LOBES
    let bits = vertex_word(p, VERTEX_LOBES + 9u);
    v.lobes.exponent = vertex_float(p, VERTEX_LOBES);
    v.lobes.specular = vertex_triple(p, VERTEX_LOBES + 1u);
    v.lobes.ior = vertex_triple(p, VERTEX_LOBES + 4u);
    v.lobes.coat = vertex_word(p, VERTEX_LOBES + 7u);
    v.lobes.rough = Rough((bits >> 8u) & 0xffu, vertex_float(p, VERTEX_LOBES + 8u));
    v.lobes.finish = bits & 0xffu;
    v.lobes.mirror = (bits & (1u << 16u)) != 0u;
    v.lobes.schlick = (bits & (1u << 17u)) != 0u;
    //: end
    return v;
}

fn wave_walk(slot: u32, from_light: bool) -> PathWalk {
    let flags = wave_get(slot, ROW_FLAGS);
    var walk: PathWalk;
    walk.from_light = from_light;
    walk.origin = wave_triple(slot, ROW_WALK_ORIGIN);
    walk.direction = wave_triple(slot, ROW_WALK_DIRECTION);
    walk.carried = wave_triple(slot, ROW_CARRIED);
    walk.edges = wave_get(slot, ROW_EDGES);
    walk.place = wave_triple(slot, ROW_PLACE);
    walk.index = wave_get(slot, ROW_INDEX);
    walk.chain = Chain(
        wave_float(slot, ROW_CHAIN),
        wave_float(slot, ROW_CHAIN + 1u),
        wave_float(slot, ROW_CHAIN + 2u),
        wave_float(slot, ROW_CHAIN + 3u),
    );
    let opens = (flags & FLAG_OPENS) != 0u;
    walk.left = Left(opens, wave_float(slot, ROW_LEFT), wave_float(slot, ROW_LEFT + 1u));
    walk.facing = wave_float(slot, ROW_FACING);
    walk.light = wave_get(slot, ROW_LIGHT);
    walk.distant = (flags & FLAG_DISTANT) != 0u;
    walk.coloured = (flags & FLAG_COLOURED) != 0u;
    walk.event = wave_get(slot, ROW_EVENT);
    //: if VOLUME
    walk.inside = wave_inside(slot, ROW_INSIDE);
    walk.lead = wave_float(slot, ROW_LEAD);
    walk.through = wave_float(slot, ROW_THROUGH);
    walk.crossed = wave_get(slot, ROW_CROSSED);
    //: end
    return walk;
}

fn wave_put_walk(slot: u32, walk: PathWalk) {
    wave_put_triple(slot, ROW_WALK_ORIGIN, walk.origin);
    wave_put_triple(slot, ROW_WALK_DIRECTION, walk.direction);
    wave_put_triple(slot, ROW_CARRIED, walk.carried);
    wave_put(slot, ROW_EDGES, walk.edges);
    wave_put_triple(slot, ROW_PLACE, walk.place);
    wave_put(slot, ROW_INDEX, walk.index);
    wave_put_float(slot, ROW_CHAIN, walk.chain.pdf);
    wave_put_float(slot, ROW_CHAIN + 1u, walk.chain.back);
    wave_put_float(slot, ROW_CHAIN + 2u, walk.chain.open);
    wave_put_float(slot, ROW_CHAIN + 3u, walk.chain.sum);
    wave_put_float(slot, ROW_LEFT, walk.left.forward);
    wave_put_float(slot, ROW_LEFT + 1u, walk.left.backward);
    let flags = select(0u, FLAG_OPENS, walk.left.opens) | select(0u, FLAG_DISTANT, walk.distant)
        | select(0u, FLAG_COLOURED, walk.coloured);
    wave_put(slot, ROW_FLAGS, flags);
    wave_put_float(slot, ROW_FACING, walk.facing);
    wave_put(slot, ROW_LIGHT, walk.light);
    wave_put(slot, ROW_EVENT, walk.event);
    //: if VOLUME
    wave_put_inside(slot, ROW_INSIDE, walk.inside);
    wave_put_float(slot, ROW_LEAD, walk.lead);
    wave_put_float(slot, ROW_THROUGH, walk.through);
    wave_put(slot, ROW_CROSSED, walk.crossed);
    //: end
}

// The slot asks for what its ray meets, or (QUERY_NOTHING) for another step.
fn wave_query(slot: u32, phase: u32, query: u32, ray: Ray) {
    wave_put(slot, ROW_PHASE, phase);
    wave_put(slot, ROW_QUERY, query);
    wave_put_ray(slot, ray);
    wave_ask(slot);
}

// On along the walk's own ray, or what comes after it.
fn wave_follow(slot: u32, from_light: bool, origin: vec3<f32>, direction: vec3<f32>) {
    let ray = Ray(origin, direction, MAX_FLOAT);
    if !math_is_zero3(direction) {
        wave_query(slot, select(PHASE_SENSOR, PHASE_LIGHT, from_light), QUERY_CLOSEST, ray);
    } else if from_light {
        wave_query(slot, PHASE_TURN, QUERY_NOTHING, ray);
    } else {
        wave_put(slot, ROW_PHASE, PHASE_OVER);
        wave_put(slot, ROW_QUERY, QUERY_DONE);
    }
}
