// Points of the parent triangle on a grid: second and third barycentric in steps of 2^-24.

const SUBDIVIDE_GRID: u32 = 16777216u;

fn subdivide_bary_is_valid(p: vec2<u32>) -> bool {
    return p.x <= SUBDIVIDE_GRID && p.y <= SUBDIVIDE_GRID - p.x;
}

fn subdivide_bary_to_f32(p: vec2<u32>) -> vec3<f32> {
    return vec3<f32>(vec3(SUBDIVIDE_GRID - p.x - p.y, p.x, p.y)) * (1.0f / 16777216.0f);
}
