// Points of the parent triangle on a grid: second and third barycentric in steps of 2^-24.

const SUBDIVIDE_GRID: u32 = 16777216u;

fn subdivide_bary_is_valid(p: vec2<u32>) -> bool {
    return p.x <= SUBDIVIDE_GRID && p.y <= SUBDIVIDE_GRID - p.x;
}

fn subdivide_bary_steps(p: vec2<u32>) -> vec3<u32> { return vec3(SUBDIVIDE_GRID - p.x - p.y, p.x, p.y); }

fn subdivide_bary_to_f32(p: vec2<u32>) -> vec3<f32> {
    return vec3<f32>(subdivide_bary_steps(p)) * (1.0f / 16777216.0f);
}

// A corner of the parent.
fn subdivide_bary_corner(i: u32) -> vec2<u32> {
    return vec2(select(0u, SUBDIVIDE_GRID, i == 1u), select(0u, SUBDIVIDE_GRID, i == 2u));
}

// On the grid or half a step below.
fn subdivide_bary_midpoint(p: vec2<u32>, q: vec2<u32>) -> vec2<u32> { return (p + q) / 2u; }

fn subdivide_bary_is_even(p: vec2<u32>, q: vec2<u32>) -> bool {
    let sum = p + q;
    return ((sum.x | sum.y) & 1u) == 0u;
}

fn subdivide_bary_centroid(a: vec2<u32>, b: vec2<u32>, c: vec2<u32>) -> vec2<u32> { return (a + b + c) / 3u; }

fn subdivide_bary_minus(p: vec2<u32>, origin: vec2<u32>) -> vec3<f32> {
    let steps = vec3<i32>(subdivide_bary_steps(p)) - vec3<i32>(subdivide_bary_steps(origin));
    return vec3<f32>(steps) * (1.0f / 16777216.0f);
}

// A product of numbers below 2^25 in three parts, to be added up: times 2^24, times 2^12, times 1.
fn subdivide_bary_product(x: i32, y: i32) -> vec3<i32> {
    let x1 = x >> 12u;
    let y1 = y >> 12u;
    let x0 = x & 4095;
    let y0 = y & 4095;
    return vec3(x1 * y1, x1 * y0 + x0 * y1, x0 * y0);
}

// Whether corners run the way of the parent's, and not on a line: the sign of core's area in 64 bits.
fn subdivide_bary_has_area(a: vec2<u32>, b: vec2<u32>, c: vec2<u32>) -> bool {
    let u = vec2<i32>(b) - vec2<i32>(a);
    let v = vec2<i32>(c) - vec2<i32>(a);
    let parts = subdivide_bary_product(u.x, v.y) - subdivide_bary_product(u.y, v.x);
    let middle = parts.y + (parts.z >> 12u);
    let high = parts.x + (middle >> 12u);
    let rest = (parts.z | middle) & 4095;
    return high > 0 || (high == 0 && rest != 0);
}
