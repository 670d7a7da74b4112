// What a criterion sees, and what it says.
//: use math::rounding

const SUBDIVIDE_LARGEST: f32 = 8.507059e37f;
// Indices of the seven points: corners, midpoints opposite them, centroid.
const SUBDIVIDE_MIDPOINT: u32 = 3u;
const SUBDIVIDE_CENTROID: u32 = 6u;

fn subdivide_bounded(x: f32) -> f32 { return math_min(math_max(x, 0.0f), SUBDIVIDE_LARGEST); }

// Sets of the seven points, a bit each.
const SUBDIVIDE_CORNERS: u32 = 7u;
const SUBDIVIDE_MIDPOINTS: u32 = 56u;
const SUBDIVIDE_ALL: u32 = 127u;

fn subdivide_bit(point: u32) -> u32 { return 1u << point; }

// Points that are not known are 0.
struct SubdivideSamples { values: array<f32, 7>, known: u32 }

fn subdivide_samples(values: array<f32, 7>) -> SubdivideSamples {
    var samples = SubdivideSamples(values, SUBDIVIDE_ALL);
    for (var i = 0u; i < 7u; i++) { samples.values[i] = subdivide_bounded(samples.values[i]); }
    return samples;
}

fn subdivide_has(samples: ptr<function, SubdivideSamples>, point: u32) -> bool {
    return ((*samples).known & subdivide_bit(point)) != 0u;
}

// The largest of all, points that are not known being 0.
fn subdivide_largest(samples: ptr<function, SubdivideSamples>) -> f32 {
    var largest = 0.0f;
    for (var i = 0u; i < 7u; i++) { largest = math_max((*samples).values[i], largest); }
    return largest;
}

fn subdivide_linear_centroid(samples: ptr<function, SubdivideSamples>) -> f32 {
    let a = (*samples).values[0];
    let b = (*samples).values[1];
    let c = (*samples).values[2];
    return a + ((b - a) + (c - a)) / 3.0f;
}

fn subdivide_linear_midpoint(samples: ptr<function, SubdivideSamples>, corner: u32) -> f32 {
    let b = (*samples).values[(corner + 1u) % 3u];
    let c = (*samples).values[(corner + 2u) % 3u];
    return 0.5f * b + 0.5f * c;
}

// How a triangle is cut: one of these, and its corner.
const SUBDIVIDE_TWO: u32 = 0u;
const SUBDIVIDE_THREE: u32 = 1u;
const SUBDIVIDE_FOUR: u32 = 2u;
const SUBDIVIDE_FAN: u32 = 3u;

struct SubdivideSplit { kind: u32, corner: u32 }

fn subdivide_count(split: SubdivideSplit) -> u32 { return min(split.kind + 2u, 4u); }

fn subdivide_piece(a: u32, b: u32, c: u32) -> u32 { return a | (b << 4u) | (c << 8u); }

// Each piece's corners as indices of the seven points, four bits each.
fn subdivide_pieces(split: SubdivideSplit) -> vec4<u32> {
    let a = split.corner;
    let b = (a + 1u) % 3u;
    let c = (a + 2u) % 3u;
    let d = SUBDIVIDE_CENTROID;
    let e = SUBDIVIDE_MIDPOINT + a;
    let f = SUBDIVIDE_MIDPOINT + c;
    let g = SUBDIVIDE_MIDPOINT + b;
    // A fan.
    var pieces = vec4(
        subdivide_piece(a, f, e),
        subdivide_piece(f, b, e),
        subdivide_piece(a, e, g),
        subdivide_piece(e, c, g),
    );
    if split.kind == SUBDIVIDE_TWO {
        pieces = vec4(subdivide_piece(a, b, e), subdivide_piece(a, e, c), 0u, 0u);
    } else if split.kind == SUBDIVIDE_THREE {
        pieces = vec4(subdivide_piece(0u, 1u, d), subdivide_piece(1u, 2u, d), subdivide_piece(2u, 0u, d), 0u);
    } else if split.kind == SUBDIVIDE_FOUR {
        pieces = vec4(
            subdivide_piece(a, f, g),
            subdivide_piece(b, e, f),
            subdivide_piece(c, g, e),
            subdivide_piece(f, e, g),
        );
    }
    return pieces;
}

// Points that become corners of pieces.
fn subdivide_needs(split: SubdivideSplit) -> u32 {
    let others = select(SUBDIVIDE_MIDPOINTS, subdivide_bit(SUBDIVIDE_CENTROID), split.kind == SUBDIVIDE_THREE);
    return select(others, subdivide_bit(SUBDIVIDE_MIDPOINT + split.corner), split.kind == SUBDIVIDE_TWO);
}

// Each piece's share of the triangle's area.
fn subdivide_share(split: SubdivideSplit) -> f32 {
    let others = select(0.25f, 1.0f / 3.0f, split.kind == SUBDIVIDE_THREE);
    return select(others, 0.5f, split.kind == SUBDIVIDE_TWO);
}

// Points that are wanted first; without any, accepted where not cut.
struct SubdivideVerdict {
    wanted: u32,
    cut: bool,
    split: SubdivideSplit,
    error: f32,
    rest: f32,
    bend: f32,
}

fn subdivide_accept() -> SubdivideVerdict {
    return SubdivideVerdict(0u, false, SubdivideSplit(0u, 0u), 0.0f, 0.0f, 0.0f);
}

fn subdivide_probe(wanted: u32) -> SubdivideVerdict {
    return SubdivideVerdict(wanted, false, SubdivideSplit(0u, 0u), 0.0f, 0.0f, 0.0f);
}

fn subdivide_cut(split: SubdivideSplit, error: f32, rest: f32, bend: f32) -> SubdivideVerdict {
    return SubdivideVerdict(0u, true, split, error, rest, bend);
}
