// A piece in the coordinates of a bitmap's texels, near the origin.
//: use math::bits
//: use math::rounding
//: use math::sums

const EMISSION_MAX_SIDE: u32 = 65536u;
const EMISSION_MAX_SPAN: f32 = 1048576.0f;

// Coordinates of the three vertices in two parts; not `ok` for a span that is too wide.
struct EmissionCoordinates { ok: bool, high: vec3<f32>, low: vec3<f32> }

fn emission_texel_coordinates(u_in: vec3<f32>, side: u32) -> EmissionCoordinates {
    var u = u_in;
    if !(math_is_finite(u.x) && math_is_finite(u.y) && math_is_finite(u.z)) { u = vec3(0.0f); }
    var near = u.x;
    if math_abs(u.y) < math_abs(near) { near = u.y; }
    if math_abs(u.z) < math_abs(near) { near = u.z; }
    u -= math_trunc(near);
    let n = f32(side);
    let fits = math_abs(u.x * n) <= EMISSION_MAX_SPAN
        && math_abs(u.y * n) <= EMISSION_MAX_SPAN
        && math_abs(u.z * n) <= EMISSION_MAX_SPAN;
    if !fits { return EmissionCoordinates(false, vec3(0.0f), vec3(0.0f)); }
    let x = math_two_prod(u.x, n);
    let y = math_two_prod(u.y, n);
    let z = math_two_prod(u.z, n);
    return EmissionCoordinates(true, vec3(x.value, y.value, z.value), vec3(x.error, y.error, z.error));
}

// `cell` within a period of `side` cells. Of unsigned numbers alone, since drivers differ in the rest of negative ones.
fn emission_within_period(cell: f32, side: u32) -> u32 {
    let c = i32(cell);
    if c >= 0i { return u32(c) % side; }
    return side - 1u - u32(-1i - c) % side;
}

struct EmissionAxis { ok: bool, local: vec3<f32>, base: u32 }

fn emission_axis(u: vec3<f32>, side: u32, shift: f32) -> EmissionAxis {
    let x = emission_texel_coordinates(u, side);
    if !x.ok { return EmissionAxis(false, vec3(0.0f), 0u); }
    let least = math_min(x.high.x, math_min(x.high.y, x.high.z));
    let base = math_floor(least - shift);
    let local = ((x.high - base) - shift) + x.low;
    let positive = vec3(math_max(local.x, 0.0f), math_max(local.y, 0.0f), math_max(local.z, 0.0f));
    return EmissionAxis(true, positive, emission_within_period(base, side));
}

// Not `ok` where the piece is too wide.
struct EmissionFrame { ok: bool, points: array<vec2<f32>, 3>, base: vec2<u32> }

fn emission_frame(size: vec2<u32>, uv: array<vec2<f32>, 3>, shift: f32) -> EmissionFrame {
    let x = emission_axis(vec3(uv[0].x, uv[1].x, uv[2].x), size.x, shift);
    // Rows run downwards.
    let y = emission_axis(vec3(-uv[0].y, -uv[1].y, -uv[2].y), size.y, shift);
    let points = array(
        vec2(x.local.x, y.local.x),
        vec2(x.local.y, y.local.y),
        vec2(x.local.z, y.local.z),
    );
    return EmissionFrame(x.ok && y.ok, points, vec2(x.base, y.base));
}

fn emission_twice_area(frame: EmissionFrame) -> f32 {
    let p = frame.points[1] - frame.points[0];
    let q = frame.points[2] - frame.points[0];
    return p.x * q.y - p.y * q.x;
}

fn emission_cells_of_edge(p: vec2<f32>, q: vec2<f32>) -> f32 {
    return math_abs(p.x - q.x) + math_abs(p.y - q.y) + 3.0f;
}

fn emission_edge_cells(frame: EmissionFrame) -> f32 {
    let a = frame.points[0];
    let b = frame.points[1];
    let c = frame.points[2];
    return emission_cells_of_edge(a, b) + emission_cells_of_edge(b, c) + emission_cells_of_edge(c, a);
}

fn emission_cells(frame: EmissionFrame) -> f32 {
    return 0.5f * math_abs(emission_twice_area(frame)) + emission_edge_cells(frame);
}

// Texels of one axis, repeating.
struct EmissionTouched { first: u32, count: u32 }

fn emission_touched(u: vec3<f32>, side: u32) -> EmissionTouched {
    let all = EmissionTouched(0u, side);
    if !(math_is_finite(u.x) && math_is_finite(u.y) && math_is_finite(u.z)) { return all; }
    let x = emission_texel_coordinates(u, side);
    if !x.ok { return all; }
    let n = f32(side);
    let largest = math_max(math_abs(u.x), math_max(math_abs(u.y), math_abs(u.z)));
    let margin = (1.0f + largest) * n * (1.0f / 1048576.0f);
    let low = math_min(math_min(math_min(math_infinity(), x.high.x), x.high.y), x.high.z);
    let high = math_max(math_max(math_max(-math_infinity(), x.high.x), x.high.y), x.high.z);
    let first = math_floor(low - margin - 0.5f);
    let last = math_floor(high + margin - 0.5f) + 1.0f;
    let count = last - first + 1.0f;
    if count >= n { return all; }
    return EmissionTouched(emission_within_period(first, side), u32(count));
}
