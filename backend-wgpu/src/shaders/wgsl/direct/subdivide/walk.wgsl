// One step of a subdivision: the points of a part, whether a cut keeps the tiling, and how a budget is divided.
//: use direct::subdivide::bary
//: use direct::subdivide::criterion

// Most cuts above a piece, and most parts that wait.
const SUBDIVIDE_MOST_CUTS: u32 = 48u;
const SUBDIVIDE_STACK: u32 = 96u;
// Share of the expected error for a part whose corners differ by less than that error.
const SUBDIVIDE_DOUBT: f32 = 0.7f;

// A triangle on its way to be cut.
struct SubdividePart {
    corners: array<vec2<u32>, 3>,
    irradiance: vec3<f32>,
    fraction: f32,
    rest: f32,
    bend: f32,
    depth: u32,
    // 1 below a cut at a centroid.
    rounded: u32,
}

fn subdivide_corners() -> array<vec2<u32>, 3> {
    return array(subdivide_bary_corner(0u), subdivide_bary_corner(1u), subdivide_bary_corner(2u));
}

fn subdivide_whole(irradiance: vec3<f32>) -> SubdividePart {
    return SubdividePart(subdivide_corners(), irradiance, 1.0f, math_infinity(), math_infinity(), 0u, 0u);
}

// The seven points of a triangle.
fn subdivide_points(corners_in: array<vec2<u32>, 3>) -> array<vec2<u32>, 7> {
    var corners = corners_in;
    let a = corners[0];
    let b = corners[1];
    let c = corners[2];
    return array(
        a,
        b,
        c,
        subdivide_bary_midpoint(b, c),
        subdivide_bary_midpoint(c, a),
        subdivide_bary_midpoint(a, b),
        subdivide_bary_centroid(a, b, c),
    );
}

fn subdivide_can_cut(part: SubdividePart, split: SubdivideSplit) -> bool {
    var corners = part.corners;
    var points = subdivide_points(part.corners);
    let needs = subdivide_needs(split);
    var exact = true;
    for (var i = 0u; i < 3u; i++) {
        let even = subdivide_bary_is_even(corners[(i + 1u) % 3u], corners[(i + 2u) % 3u]);
        exact = exact && (even || (needs & subdivide_bit(SUBDIVIDE_MIDPOINT + i)) == 0u);
    }
    let pieces = subdivide_pieces(split);
    let count = subdivide_count(split);
    var tiles = part.rounded != 0u || exact;
    for (var i = 0u; i < count; i++) {
        let piece = pieces[i];
        tiles = tiles && subdivide_bary_has_area(points[piece & 15u], points[(piece >> 4u) & 15u], points[piece >> 8u]);
    }
    return tiles;
}

// The largest difference between the corners of a part.
fn subdivide_spread(irradiance: vec3<f32>) -> f32 {
    let largest = math_max(irradiance.x, math_max(irradiance.y, irradiance.z));
    return largest - math_min(irradiance.x, math_min(irradiance.y, irradiance.z));
}

// A part of a cut, of which this much is expected.
fn subdivide_part(
    part: SubdividePart, split: SubdivideSplit, piece: u32, samples: ptr<function, SubdivideSamples>, rest: f32, bend: f32,
) -> SubdividePart {
    var points = subdivide_points(part.corners);
    let a = piece & 15u;
    let b = (piece >> 4u) & 15u;
    let c = piece >> 8u;
    let irradiance = vec3((*samples).values[a], (*samples).values[b], (*samples).values[c]);
    return SubdividePart(
        array(points[a], points[b], points[c]),
        irradiance,
        part.fraction * subdivide_share(split),
        select(SUBDIVIDE_DOUBT * rest, rest, subdivide_spread(irradiance) >= rest),
        bend,
        part.depth + 1u,
        part.rounded | u32(split.kind == SUBDIVIDE_THREE),
    );
}

// What each part of a cut may become, and which comes first.
struct SubdivideShares { budgets: vec4<u32>, first: u32 }

fn subdivide_shares(spreads: vec4<f32>, count: u32, budget: u32) -> SubdivideShares {
    var first = 0u;
    for (var i = 1u; i < count; i++) { first = select(first, i, spreads[i] > spreads[first]); }
    let largest = spreads[first];
    var scaled = vec4(1.0f);
    for (var i = 0u; i < 4u; i++) { scaled[i] = select(1.0f, spreads[i] / largest, largest > 0.0f); }
    var total = 0.0f;
    for (var i = 0u; i < count; i++) { total += scaled[i]; }
    let weight = scaled + vec4(total / 16.0f);
    var all = 0.0f;
    for (var i = 0u; i < count; i++) { all += weight[i]; }
    let free = budget - min(budget, count);
    var left = free;
    var shares = SubdivideShares(vec4(1u), first);
    for (var i = 0u; i < count; i++) {
        let share = min(u32(f32(free) * (weight[i] / all)), left);
        let own = select(share, 0u, i == first);
        shares.budgets[i] += own;
        left -= own;
    }
    shares.budgets[first] += left;
    return shares;
}
