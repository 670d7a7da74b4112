// What waves of photons have in common: their job, rows of states, and the lists of those that ask for a ray or have landed.
//: use math::bits
//: use wavefront::states

struct PhotonJob {
    seed: vec2<u32>,
    replicate: u32,
    // Photons that the buffers are made for, those of this wave, and the first of them.
    slots: u32,
    count: u32,
    first: u32,
    // Of a list, from where on this dispatch takes it.
    window: u32,
    flags: u32,
    // Where photons start along the distribution of starts.
    shift: u32,
    bits: u32,
    max_hits: u32,
    // Elements: their words among those of states, where nodes begin among them, and how many there are.
    elements_at: u32,
    nodes: u32,
    per_side: u32,
    elements: u32,
    // Flux is counted in units of 2^-power W.
    power: i32,
    // Counts by which what emits is picked, among the words of states.
    plan_at: u32,
    plan_count: u32,
    // Of photons in order: the group of numbers of this bounce, and where its roulette begins.
    group: u32,
    offset: u32,
    sphere_x: f32,
    sphere_y: f32,
    sphere_z: f32,
    sphere_radius: f32,
    grid_x: f32,
    grid_y: f32,
    grid_z: f32,
    grid_scale: f32,
    // Words of lists before the sums.
    lists: u32,
    // Where the first shot's tables begin, its pieces, its entries.
    shot_at: u32,
    pieces: u32,
    entries: u32,
    // Where the media of lights and what glows are, and how many of each.
    media_at: u32,
    media_count: u32,
    glows_at: u32,
    glows: u32,
    // For `math_opaque`.
    zero: u32,
}

const PHOTONS_RANDOM: u32 = 1u;
const PHOTONS_CHOICE: u32 = 2u;
const PHOTONS_REGISTER_DIRECT: u32 = 4u;
const PHOTONS_SURVIVE_FIRST: u32 = 8u;
const PHOTONS_LINEAR: u32 = 16u;
const PHOTONS_APART: u32 = 32u;
const PHOTONS_CAUSTICS: u32 = 64u;
const PHOTONS_EXACT: u32 = 128u;

@group(0) @binding(1) var<uniform> job: PhotonJob;
// Rows of states, word r of slot s at r * slots + s; then words that are only read.
@group(0) @binding(7) var<storage, read_write> states: array<u32>;
// The head, lists of as many words as there are slots, and the sums of elements.
@group(0) @binding(8) var<storage, read_write> sums: array<atomic<u32>>;

// The lengths of two lists of those that ask, which take turns, and which of them is read; how many have landed; rays and hits in two words.
const HEAD_TURN: u32 = 2u;
const HEAD_LANDED: u32 = 3u;
const HEAD_RAYS: u32 = 4u;
const HEAD_HITS: u32 = 6u;
// How many are in order, in which of two lists, the pass of their sort, and how many there will be.
const HEAD_ORDERED: u32 = 8u;
const HEAD_PARITY: u32 = 9u;
const HEAD_PASS: u32 = 10u;
const HEAD_TOTAL: u32 = 11u;
const HEAD_WORDS: u32 = 16u;
// Lists behind the two: of those that landed, or two in order with two of their keys, and counts.
const LIST_LANDED: u32 = 2u;
const LIST_KEYS: u32 = 4u;
const LIST_COUNTS: u32 = 6u;

const ROW_FLUX: u32 = 0u;
const ROW_ORIGIN: u32 = 3u;
const ROW_DIRECTION: u32 = 6u;
const ROW_T_MAX: u32 = 9u;
const ROW_HIT: u32 = 10u;
const ROW_QUERY: u32 = 14u;
const ROW_HITS: u32 = 15u;
const ROW_FLAGS: u32 = 16u;
const ROW_LIGHT: u32 = 17u;
// Where there are media.
const ROW_INSIDE: u32 = 18u;
const ROW_BEYOND: u32 = 21u;
const ROW_LEAD: u32 = 24u;
const ROW_EVENT: u32 = 25u;
const ROW_CHANCE: u32 = 26u;
const ROW_CHANNEL: u32 = 27u;
const ROW_CROSSED: u32 = 28u;

// What a photon waits for, or what it has come to.
const PHOTON_OVER: u32 = 0u;
const PHOTON_CLOSEST: u32 = 1u;
const PHOTON_SHADOW: u32 = 2u;
const PHOTON_CLEAR: u32 = 3u;
const PHOTON_BLOCKED: u32 = 4u;
const PHOTON_LANDED: u32 = 5u;

fn job_word(i: u32) -> u32 { return states[i]; }

fn job_float(i: u32) -> f32 { return bitcast<f32>(states[i]); }

fn photons_has(flag: u32) -> bool { return (job.flags & flag) != 0u; }

fn list_at(list: u32) -> u32 { return HEAD_WORDS + list * job.slots; }

// The photon asks in the next step.
fn wave_ask(slot: u32, query: u32) {
    wave_put(slot, ROW_QUERY, query);
    let list = 1u - atomicLoad(&sums[HEAD_TURN]);
    let place = atomicAdd(&sums[list], 1u);
    atomicStore(&sums[list_at(list) + place], slot);
}

// The slot of an invocation among those that ask, `slots` where there is none.
fn wave_slot(id: u32) -> u32 {
    //: if REORDERED
    math_opaque = job.zero;
    //: end
    let list = atomicLoad(&sums[HEAD_TURN]);
    let i = job.window + id;
    if i >= atomicLoad(&sums[list]) { return job.slots; }
    return atomicLoad(&sums[list_at(list) + i]);
}
