// Paths in waves: `start` fills the slots, then `trace` answers what each asks and `advance` takes the answer, until none asks.
// A state is in rows, word r of slot s at r * slots + s: the first four rows are what the host reads.
//: use transport::path
//: use sensor

struct PathJob {
    seed: vec2<u32>,
    // Slots that the buffers are made for, and those of this wave.
    slots: u32,
    count: u32,
    // Elements of the film; the first of this wave and its block.
    elements: u32,
    first_element: u32,
    first_block: u32,
    // Samples of a block that this wave takes, from which one on.
    samples: u32,
    first_sample: u32,
    max_depth: u32,
    // Where probes begin among the words of the states; 0 for images.
    probes: u32,
    width: u32,
}

@group(0) @binding(1) var<uniform> job: PathJob;
@group(0) @binding(7) var<storage, read_write> states: array<u32>;
// Slots that ask, in two lists that take turns: the lengths of both, which of them is read, nothing, then the lists.
@group(0) @binding(8) var<storage, read_write> queue: array<atomic<u32>>;

const QUEUE_TURN: u32 = 2u;
const QUEUE_LISTS: u32 = 4u;

const ROW_RADIANCE: u32 = 0u;
const ROW_RAYS: u32 = 3u;
const ROW_QUERY: u32 = 4u;
const ROW_SAMPLER: u32 = 5u;
const ROW_THROUGHPUT: u32 = 8u;
const ROW_PENDING: u32 = 11u;
const ROW_NEXT: u32 = 14u;
const ROW_PDF: u32 = 17u;
const ROW_VERTEX: u32 = 18u;
const ROW_DEPTH: u32 = 21u;
const ROW_ORIGIN: u32 = 22u;
const ROW_DIRECTION: u32 = 25u;
const ROW_T_MAX: u32 = 28u;
const ROW_HIT: u32 = 29u;

fn wave_get(slot: u32, row: u32) -> u32 { return states[row * job.slots + slot]; }

fn wave_float(slot: u32, row: u32) -> f32 { return bitcast<f32>(wave_get(slot, row)); }

fn wave_triple(slot: u32, row: u32) -> vec3<f32> {
    return vec3(wave_float(slot, row), wave_float(slot, row + 1u), wave_float(slot, row + 2u));
}

fn wave_put(slot: u32, row: u32, x: u32) { states[row * job.slots + slot] = x; }

fn wave_put_float(slot: u32, row: u32, x: f32) { wave_put(slot, row, bitcast<u32>(x)); }

fn wave_put_triple(slot: u32, row: u32, v: vec3<f32>) {
    wave_put_float(slot, row, v.x);
    wave_put_float(slot, row + 1u, v.y);
    wave_put_float(slot, row + 2u, v.z);
}

fn wave_ray(slot: u32) -> Ray {
    return Ray(wave_triple(slot, ROW_ORIGIN), wave_triple(slot, ROW_DIRECTION), wave_float(slot, ROW_T_MAX));
}

fn wave_load(slot: u32) -> PathState {
    let key = vec2(wave_get(slot, ROW_SAMPLER), wave_get(slot, ROW_SAMPLER + 1u));
    return PathState(
        BlockSampler(key, wave_get(slot, ROW_SAMPLER + 2u)),
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
    wave_put(slot, ROW_SAMPLER, state.sampler.key.x);
    wave_put(slot, ROW_SAMPLER + 1u, state.sampler.key.y);
    wave_put(slot, ROW_SAMPLER + 2u, state.sampler.reversed_index);
    wave_put_triple(slot, ROW_THROUGHPUT, state.throughput);
    wave_put_triple(slot, ROW_PENDING, state.pending);
    wave_put_triple(slot, ROW_NEXT, state.next);
    wave_put_float(slot, ROW_PDF, state.pdf);
    wave_put_triple(slot, ROW_VERTEX, state.vertex);
    wave_put(slot, ROW_DEPTH, state.depth);
    wave_put_triple(slot, ROW_ORIGIN, state.ray.origin);
    wave_put_triple(slot, ROW_DIRECTION, state.ray.direction);
    wave_put_float(slot, ROW_T_MAX, state.ray.t_max);
    let list = 1u - atomicLoad(&queue[QUEUE_TURN]);
    let place = atomicAdd(&queue[list], 1u);
    atomicStore(&queue[QUEUE_LISTS + list * job.slots + place], slot);
}

// The slot of an invocation, `slots` where there is none.
fn wave_slot(id: u32) -> u32 {
    let list = atomicLoad(&queue[QUEUE_TURN]);
    if id >= atomicLoad(&queue[list]) { return job.slots; }
    return atomicLoad(&queue[QUEUE_LISTS + list * job.slots + id]);
}

@compute @workgroup_size(64)
fn start(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = id.x;
    if slot >= job.count { return; }
    let unit = job.first_element + slot / job.samples;
    let element = unit % job.elements;
    let block = job.first_block + unit / job.elements;
    let sampler = sobol_block_sampler(job.seed, element, block, job.first_sample + slot % job.samples);
    wave_put(slot, ROW_RAYS, 0u);
    if job.probes != 0u {
        let at = job.probes + 7u * element;
        let position = wave_probe(at);
        let point = SurfacePoint(position, bitcast<f32>(states[at + 3u]));
        wave_store(slot, path_start_probe(sampler, point, wave_probe(at + 4u), job.max_depth));
        return;
    }
    var state = path_new(sampler);
    let camera = wave_camera(scene_at.camera);
    var u = vec4(sobol_group2(sampler, 0u), 0.0f, 0.0f);
    if camera.lens_radius > 0.0f { u = sobol_group4(sampler, 0u); }
    state.ray = camera_sample_ray(camera, element % job.width, element / job.width, u.xy, u.zw);
    state.depth = 1u;
    if job.max_depth >= 1u { state.query = QUERY_CLOSEST; }
    wave_store(slot, state);
}

// core's record.
fn wave_camera(at: u32) -> Camera {
    return Camera(
        scene_triple(at),
        scene_float(at + 3u),
        scene_triple(at + 4u),
        scene_float(at + 7u),
        scene_triple(at + 8u),
        scene_word(at + 11u),
        scene_triple(at + 12u),
        scene_word(at + 15u),
    );
}

fn wave_probe(at: u32) -> vec3<f32> {
    return vec3(bitcast<f32>(states[at]), bitcast<f32>(states[at + 1u]), bitcast<f32>(states[at + 2u]));
}

@compute @workgroup_size(64)
fn trace(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = wave_slot(id.x);
    if slot == job.slots { return; }
    let hit = tree_walk(wave_ray(slot), wave_get(slot, ROW_QUERY) == QUERY_SHADOW);
    wave_put_float(slot, ROW_HIT, hit.t);
    wave_put(slot, ROW_HIT + 1u, hit.primitive);
    wave_put_float(slot, ROW_HIT + 2u, hit.b1);
    wave_put_float(slot, ROW_HIT + 3u, hit.b2);
    wave_put(slot, ROW_RAYS, wave_get(slot, ROW_RAYS) + 1u);
}

@compute @workgroup_size(64)
fn advance(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = wave_slot(id.x);
    if slot == job.slots { return; }
    var state = wave_load(slot);
    let primitive = wave_get(slot, ROW_HIT + 1u);
    if state.query == QUERY_SHADOW {
        path_lit(&state, primitive != TREE_NOTHING);
    } else {
        let hit = Hit(
            wave_float(slot, ROW_HIT),
            primitive,
            wave_float(slot, ROW_HIT + 2u),
            wave_float(slot, ROW_HIT + 3u),
        );
        path_arrive(&state, hit, job.max_depth);
    }
    wave_store(slot, state);
}
