// Order along Hilbert's curve. Core's table of states is made from its rule here: entry corner and direction of each octant.
//: use math::choice

const HILBERT_LEVELS: u32 = 10u;
// Two bits for each octant in the order of the curve: the axis along which it is crossed.
const HILBERT_DIRECTIONS: u32 = 5780u;

fn hilbert_rotate_right(x: u32, by: u32) -> u32 { return ((x >> by) | (x << (3u - by))) & 7u; }

fn hilbert_rotate_left(x: u32, by: u32) -> u32 { return ((x << by) | (x >> (3u - by))) & 7u; }

// The corner through which the curve enters the w-th octant.
fn hilbert_entry(w: u32) -> u32 {
    let even = 2u * ((max(w, 1u) - 1u) / 2u);
    return even ^ (even >> 1u);
}

// The place on the curve of a cell with coordinates below 2^10.
fn hilbert_index(cell: vec3<u32>) -> u32 {
    var index = 0u;
    var corner = 0u;
    var direction = 0u;
    for (var level = HILBERT_LEVELS; level > 0u; level--) {
        let bits = (cell >> vec3(level - 1u)) & vec3(1u);
        let octant = bits.x | (bits.y << 1u) | (bits.z << 2u);
        let turn = (direction + 1u) % 3u;
        let gray = hilbert_rotate_right(octant ^ corner, turn);
        let w = gray ^ (gray >> 1u) ^ (gray >> 2u);
        corner ^= hilbert_rotate_left(hilbert_entry(w), turn);
        direction = (direction + ((HILBERT_DIRECTIONS >> (2u * w)) & 3u) + 1u) % 3u;
        index = (index << 3u) | w;
    }
    return index;
}

// The same of a point in a grid with this lower corner and so many cells a metre.
fn hilbert_grid_index(low: vec3<f32>, scale: f32, p: vec3<f32>) -> u32 {
    let cell = math_min3((p - low) * scale, vec3(1023.0f));
    return hilbert_index(vec3(math_to_u32(cell.x), math_to_u32(cell.y), math_to_u32(cell.z)));
}
