// What waves of paths have in common: `start` fills the slots, then `trace` answers what each asks and `advance` takes the answer, until
// none asks. A state is in rows, word r of slot s at r * slots + s: the first four rows are what the host reads.
//: use scene::camera
//: use transport::back
//: use tree::walk
//: use wavefront::job
//: use wavefront::states::rays

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
// What a shadow ray or a connection may bring.
const ROW_PENDING: u32 = 11u;
const ROW_NEXT: u32 = 14u;
const ROW_PDF: u32 = 17u;
const ROW_VERTEX: u32 = 18u;
const ROW_DEPTH: u32 = 21u;
const ROW_ORIGIN: u32 = 22u;
const ROW_DIRECTION: u32 = 25u;
const ROW_T_MAX: u32 = 28u;
const ROW_HIT: u32 = 29u;

fn wave_sampler(slot: u32) -> BlockSampler {
    let key = vec2(wave_get(slot, ROW_SAMPLER), wave_get(slot, ROW_SAMPLER + 1u));
    return BlockSampler(key, wave_get(slot, ROW_SAMPLER + 2u));
}

fn wave_put_sampler(slot: u32, sampler: BlockSampler) {
    wave_put(slot, ROW_SAMPLER, sampler.key.x);
    wave_put(slot, ROW_SAMPLER + 1u, sampler.key.y);
    wave_put(slot, ROW_SAMPLER + 2u, sampler.reversed_index);
}

// The slot asks in the next step.
fn wave_ask(slot: u32) {
    let list = 1u - atomicLoad(&queue[QUEUE_TURN]);
    let place = atomicAdd(&queue[list], 1u);
    atomicStore(&queue[QUEUE_LISTS + list * job.slots + place], slot);
}

// The slot of an invocation, `slots` where there is none.
fn wave_slot(id: u32) -> u32 {
    //: if REORDERED
    math_opaque = job.zero;
    //: end
    let list = atomicLoad(&queue[QUEUE_TURN]);
    if id >= atomicLoad(&queue[list]) { return job.slots; }
    return atomicLoad(&queue[QUEUE_LISTS + list * job.slots + id]);
}

// The element of the film and the sample that a slot starts with.
struct WaveStart { element: u32, sampler: BlockSampler }

fn wave_start(slot: u32) -> WaveStart {
    //: if REORDERED
    math_opaque = job.zero;
    //: end
    let unit = job.first_element + slot / job.samples;
    let element = unit % job.elements;
    let block = job.first_block + unit / job.elements;
    let index = job.first_sample + slot % job.samples;
    return WaveStart(element, sobol_block_sampler(job.seed, element, block, index));
}

fn wave_camera_ray(at: WaveStart) -> Ray {
    let camera = scene_camera(scene_at.camera);
    var u = vec4(sobol_group2(at.sampler, 0u), 0.0f, 0.0f);
    if camera.lens_radius > 0.0f { u = sobol_group4(at.sampler, 0u); }
    return camera_sample_ray(camera, at.element % job.width, at.element / job.width, u.xy, u.zw);
}

fn wave_probe(at: u32) -> vec3<f32> {
    return vec3(bitcast<f32>(states[at]), bitcast<f32>(states[at + 1u]), bitcast<f32>(states[at + 2u]));
}

// Words of a probe: its point with its extent, and its normal.
fn wave_probe_point(at: u32) -> SurfacePoint { return SurfacePoint(wave_probe(at), bitcast<f32>(states[at + 3u])); }

fn wave_probe_normal(at: u32) -> vec3<f32> { return wave_probe(at + 4u); }

@compute @workgroup_size(64)
fn trace(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = wave_slot(id.x);
    if slot == job.slots { return; }
    let query = wave_get(slot, ROW_QUERY);
    if query == QUERY_NOTHING { return; }
    let hit = tree_walk(wave_ray(slot), query == QUERY_SHADOW);
    wave_put_hit(slot, ROW_HIT, hit);
    wave_put(slot, ROW_RAYS, wave_get(slot, ROW_RAYS) + 1u);
}
