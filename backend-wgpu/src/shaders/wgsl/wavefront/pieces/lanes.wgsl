// Lanes of the subdivision of lit triangles: the pair that each has at hand, the part of it, the parts that wait and the samples it remembers.
//: use direct::subdivide::walk

struct PiecesJob {
    // Pairs, and the number of the first one.
    count: u32,
    first: u32,
    lanes: u32,
    // Where among the words of work what is outside and what lights send into, the lanes, their stacks and their remembered samples begin.
    media: u32,
    rows: u32,
    stacks: u32,
    samples: u32,
    // Limits and tolerances.
    size: f32,
    largest: f32,
    depth: u32,
    budget: u32,
    relative: f32,
    absolute: f32,
    // For `math_opaque`.
    zero: u32,
}

@group(0) @binding(1) var<uniform> job: PiecesJob;
// Pairs (triangle, light, how they are cut with the least depth above, three numbers), media, lanes.
@group(0) @binding(7) var<storage, read_write> work: array<u32>;
// Pairs taken, pieces, pairs done, rays; then the pieces.
@group(0) @binding(8) var<storage, read_write> made: array<atomic<u32>>;

const PIECES_TAKEN: u32 = 0u;
const PIECES_MADE: u32 = 1u;
const PIECES_DONE: u32 = 2u;
const PIECES_RAYS: u32 = 3u;
const PIECES_HEAD: u32 = 4u;
const PIECE_WORDS: u32 = 12u;
const PAIR_WORDS: u32 = 6u;

// How a pair is cut.
const PIECES_WHOLE: u32 = 0u;
const PIECES_GLANCE: u32 = 1u;
const PIECES_PUBLISHED: u32 = 2u;
const PIECES_ROBUST: u32 = 3u;

// What a lane does when it has the samples it wants.
const PIECES_NEXT: u32 = 0u;
const PIECES_BEGIN: u32 = 1u;
const PIECES_LOOK: u32 = 2u;
const PIECES_CUT: u32 = 3u;

// Samples that a lane remembers: core's.
const PIECES_SLOTS: u32 = 256u;

struct Lane {
    number: u32,
    // The pair plus one; 0 for none.
    pair: u32,
    phase: u32,
    pieces: u32,
    waiting: u32,
    spare: u32,
    budget: u32,
    wanted: u32,
    split: SubdivideSplit,
    rest: f32,
    bend: f32,
    rays: u32,
}

var<private> lane: Lane;
var<private> part: SubdividePart;
var<private> samples: SubdivideSamples;

fn pieces_pair(i: u32) -> u32 { return work[PAIR_WORDS * (lane.pair - 1u) + i]; }

fn pieces_pair_float(i: u32) -> f32 { return bitcast<f32>(pieces_pair(i)); }

// Of no pair at all: whole.
fn pieces_how() -> u32 {
    var how = PIECES_WHOLE;
    if lane.pair != 0u { how = pieces_pair(2u) & 255u; }
    return how;
}

fn pieces_row(row: u32) -> u32 { return job.rows + row * job.lanes + lane.number; }

fn pieces_get(row: u32) -> u32 { return work[pieces_row(row)]; }

fn pieces_put(row: u32, x: u32) { work[pieces_row(row)] = x; }

// A part in words that lie a lane's width apart.
const PART_WORDS: u32 = 15u;

fn pieces_word(at: u32, i: u32) -> u32 { return work[at + i * job.lanes]; }

fn pieces_load_part(at: u32) -> SubdividePart {
    let flags = pieces_word(at, 12u);
    return SubdividePart(
        array(
            vec2(pieces_word(at, 0u), pieces_word(at, 1u)),
            vec2(pieces_word(at, 2u), pieces_word(at, 3u)),
            vec2(pieces_word(at, 4u), pieces_word(at, 5u)),
        ),
        bitcast<vec3<f32>>(vec3(pieces_word(at, 6u), pieces_word(at, 7u), pieces_word(at, 8u))),
        bitcast<f32>(pieces_word(at, 9u)),
        bitcast<f32>(pieces_word(at, 10u)),
        bitcast<f32>(pieces_word(at, 11u)),
        flags & 255u,
        flags >> 8u,
    );
}

fn pieces_store_part(at: u32, stored: SubdividePart) {
    for (var i = 0u; i < 3u; i++) {
        var corners = stored.corners;
        work[at + 2u * i * job.lanes] = corners[i].x;
        work[at + (2u * i + 1u) * job.lanes] = corners[i].y;
        work[at + (6u + i) * job.lanes] = bitcast<u32>(stored.irradiance[i]);
    }
    work[at + 9u * job.lanes] = bitcast<u32>(stored.fraction);
    work[at + 10u * job.lanes] = bitcast<u32>(stored.rest);
    work[at + 11u * job.lanes] = bitcast<u32>(stored.bend);
    work[at + 12u * job.lanes] = stored.depth | (stored.rounded << 8u);
}

fn pieces_stacked(i: u32) -> u32 { return job.stacks + PART_WORDS * i * job.lanes + lane.number; }

const ROW_PART: u32 = 19u;

fn pieces_load() {
    lane.pair = pieces_get(0u);
    lane.phase = pieces_get(1u);
    lane.pieces = pieces_get(2u);
    lane.waiting = pieces_get(3u);
    lane.spare = pieces_get(4u);
    lane.budget = pieces_get(5u);
    lane.wanted = pieces_get(6u);
    let split = pieces_get(7u);
    lane.split = SubdivideSplit(split & 255u, split >> 8u);
    lane.rest = bitcast<f32>(pieces_get(8u));
    lane.bend = bitcast<f32>(pieces_get(9u));
    lane.rays = 0u;
    samples.known = pieces_get(10u);
    for (var i = 0u; i < 7u; i++) { samples.values[i] = bitcast<f32>(pieces_get(11u + i)); }
    part = pieces_load_part(pieces_row(ROW_PART));
}

fn pieces_store() {
    pieces_put(0u, lane.pair);
    pieces_put(1u, lane.phase);
    pieces_put(2u, lane.pieces);
    pieces_put(3u, lane.waiting);
    pieces_put(4u, lane.spare);
    pieces_put(5u, lane.budget);
    pieces_put(6u, lane.wanted);
    pieces_put(7u, lane.split.kind | (lane.split.corner << 8u));
    pieces_put(8u, bitcast<u32>(lane.rest));
    pieces_put(9u, bitcast<u32>(lane.bend));
    pieces_put(10u, samples.known);
    for (var i = 0u; i < 7u; i++) { pieces_put(11u + i, bitcast<u32>(samples.values[i])); }
    pieces_store_part(pieces_row(ROW_PART), part);
}

// Where a lane remembers the sample at a point: the pair's number plus one, the point, the sample.
fn pieces_slot(point: vec2<u32>) -> u32 {
    let mixed = point.x * 0x9E3779B1u + point.y * 0x85EBCA77u;
    let hash = ((mixed ^ (mixed >> 15u)) * 0x2C1B3C6Du) >> 24u;
    return job.samples + 4u * hash * job.lanes + lane.number;
}

fn pieces_remembers(at: u32, point: vec2<u32>) -> bool {
    return pieces_word(at, 0u) == job.first + lane.pair && pieces_word(at, 1u) == point.x && pieces_word(at, 2u) == point.y;
}
