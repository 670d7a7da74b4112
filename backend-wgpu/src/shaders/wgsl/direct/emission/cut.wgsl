// Cutting a piece along the lines of a grid, and integrals over the parts.
//: use math::bits
//: use math::rounding

const EMISSION_CORNERS: u32 = 8u;

// Column and row, and barycentric coordinates.
struct EmissionCorner { at: vec2<f32>, bary: vec3<f32> }

struct EmissionPart { len: u32, corners: array<EmissionCorner, EMISSION_CORNERS> }

fn emission_part_push(part: ptr<function, EmissionPart>, corner: EmissionCorner) {
    let len = (*part).len;
    if len < EMISSION_CORNERS {
        (*part).corners[len] = corner;
        (*part).len = len + 1u;
    }
}

fn emission_part_whole(points: array<vec2<f32>, 3>) -> EmissionPart {
    var part: EmissionPart;
    emission_part_push(&part, EmissionCorner(points[0], vec3(1.0f, 0.0f, 0.0f)));
    emission_part_push(&part, EmissionCorner(points[1], vec3(0.0f, 1.0f, 0.0f)));
    emission_part_push(&part, EmissionCorner(points[2], vec3(0.0f, 0.0f, 1.0f)));
    return part;
}

// Least and greatest coordinate on an axis.
fn emission_part_range(part: ptr<function, EmissionPart>, axis: u32) -> vec2<f32> {
    var low = math_infinity();
    var high = -math_infinity();
    for (var i = 0u; i < (*part).len; i++) {
        let x = (*part).corners[i].at[axis];
        low = math_min(low, x);
        high = math_max(high, x);
    }
    return vec2(low, high);
}

fn emission_between_one(low: f32, high: f32, t: f32) -> f32 {
    let x = low + t * (high - low);
    return math_clamp(x, math_min(low, high), math_max(low, high));
}

fn emission_between(axis: u32, p: EmissionCorner, d: f32, q: EmissionCorner, e: f32, at: f32) -> EmissionCorner {
    var low = p;
    var high = q;
    var t = 0.0f;
    if d < 0.0f {
        t = d / (d - e);
    } else {
        low = q;
        high = p;
        t = e / (e - d);
    }
    var out = EmissionCorner(
        vec2(emission_between_one(low.at.x, high.at.x, t), emission_between_one(low.at.y, high.at.y, t)),
        vec3(
            emission_between_one(low.bary.x, high.bary.x, t),
            emission_between_one(low.bary.y, high.bary.y, t),
            emission_between_one(low.bary.z, high.bary.z, t),
        ),
    );
    out.at[axis] = at;
    return out;
}

// The part up to the line `at` on an axis, and the part beyond it.
fn emission_part_split(
    part: ptr<function, EmissionPart>,
    axis: u32,
    at: f32,
    below: ptr<function, EmissionPart>,
    above: ptr<function, EmissionPart>,
) {
    (*below).len = 0u;
    (*above).len = 0u;
    let len = (*part).len;
    for (var i = 0u; i < len; i++) {
        let corner = (*part).corners[i];
        let next = (*part).corners[select(0u, i + 1u, i + 1u < len)];
        let d = corner.at[axis] - at;
        let e = next.at[axis] - at;
        if d <= 0.0f { emission_part_push(below, corner); }
        if d >= 0.0f { emission_part_push(above, corner); }
        if (d < 0.0f && e > 0.0f) || (d > 0.0f && e < 0.0f) {
            let crossing = emission_between(axis, corner, d, next, e, at);
            emission_part_push(below, crossing);
            emission_part_push(above, crossing);
        }
    }
}

fn emission_part_share(part: ptr<function, EmissionPart>, i: u32) -> f32 {
    let a = (*part).corners[0].bary;
    let b = (*part).corners[i].bary;
    let c = (*part).corners[i + 1u].bary;
    let area = (b.y - a.y) * (c.z - a.z) - (b.z - a.z) * (c.y - a.y);
    return math_max(area, 0.0f);
}

// Integrals of the barycentrics over the part.
fn emission_part_constant(part: ptr<function, EmissionPart>) -> vec3<f32> {
    var out = vec3(0.0f);
    let a = (*part).corners[0].bary;
    for (var i = 1u; i + 1u < (*part).len; i++) {
        let share = emission_part_share(part, i) * (1.0f / 3.0f);
        let b = (*part).corners[i].bary;
        let c = (*part).corners[i + 1u].bary;
        out += share * (a + b + c);
    }
    return out;
}

// Integrals over the part of the barycentrics times each weight of the bilinear filter over a cell.
fn emission_part_bilinear(part: ptr<function, EmissionPart>, cell: vec2<f32>) -> array<vec3<f32>, 4> {
    var out: array<vec3<f32>, 4>;
    // 1 - x, x and 1 - y, y.
    var xs: array<vec2<f32>, EMISSION_CORNERS>;
    var ys: array<vec2<f32>, EMISSION_CORNERS>;
    for (var i = 0u; i < (*part).len; i++) {
        let at = (*part).corners[i].at;
        let x = math_clamp(at.x - cell.x, 0.0f, 1.0f);
        let y = math_clamp(at.y - cell.y, 0.0f, 1.0f);
        xs[i] = vec2(1.0f - x, x);
        ys[i] = vec2(1.0f - y, y);
    }
    let ar = (*part).corners[0].bary;
    for (var i = 1u; i + 1u < (*part).len; i++) {
        let share = emission_part_share(part, i) * (1.0f / 60.0f);
        let br = (*part).corners[i].bary;
        let cr = (*part).corners[i + 1u].bary;
        let sum = ar + br + cr;
        for (var corner = 0u; corner < 4u; corner++) {
            let column = corner & 1u;
            let row = corner >> 1u;
            let ax = xs[0][column];
            let bx = xs[i][column];
            let cx = xs[i + 1u][column];
            let ay = ys[0][row];
            let by = ys[i][row];
            let cy = ys[i + 1u][row];
            let sx = ax + bx + cx;
            let sy = ay + by + cy;
            let sxy = ax * ay + bx * by + cx * cy;
            let pair_y = ay * ar + by * br + cy * cr;
            let pair_x = ax * ar + bx * br + cx * cr;
            let triple = (ax * ay) * ar + (bx * by) * br + (cx * cy) * cr;
            let whole = sum * (sx * sy + sxy) + sx * pair_y + sy * pair_x + 2.0f * triple;
            out[corner] += share * whole;
        }
    }
    return out;
}

struct EmissionOverlap { share: f32, bary: vec3<f32> }

fn emission_overlap_unit(points: array<vec2<f32>, 3>) -> EmissionOverlap {
    let nothing = EmissionOverlap(0.0f, vec3(0.0f));
    for (var i = 0u; i < 3u; i++) {
        let p = points[i];
        if !(math_abs(p.x) <= 1e18f && math_abs(p.y) <= 1e18f) { return nothing; }
    }
    var part = emission_part_whole(points);
    var kept: EmissionPart;
    var lost: EmissionPart;
    emission_part_split(&part, 1u, 0.0f, &lost, &kept);
    emission_part_split(&kept, 1u, 1.0f, &part, &lost);
    emission_part_split(&part, 0u, 0.0f, &lost, &kept);
    emission_part_split(&kept, 0u, 1.0f, &part, &lost);
    let integrals = emission_part_constant(&part);
    let share = integrals.x + integrals.y + integrals.z;
    if share > 0.0f {
        let bary = integrals / share;
        return EmissionOverlap(
            math_min(share, 1.0f),
            vec3(math_min(bary.x, 1.0f), math_min(bary.y, 1.0f), math_min(bary.z, 1.0f)),
        );
    }
    return nothing;
}
