// Media on grids: a trilinear field, value by value. Values come from `grid_value`; a record's words lie in the arena. Without
// `COLOURED_GRIDS` every grid has one value per cell, and a third of the arithmetic is left.
//: use math::choice
//: use math::vector

const GRID_BLOCK_BITS: u32 = 3u;
const GRID_SLACK: f32 = 1.0f / 1024.0f;

//: if COLOURED_GRIDS
alias GridValue = vec3<f32>;

fn grid_zero() -> GridValue { return vec3(0.0f); }

fn grid_channel(v: GridValue, channel: u32) -> f32 { return math_component(v, channel); }

fn grid_wide(v: GridValue) -> vec3<f32> { return v; }
//: else
alias GridValue = f32;

fn grid_zero() -> GridValue { return 0.0f; }

fn grid_channel(v: GridValue, channel: u32) -> f32 { return v; }

fn grid_wide(v: GridValue) -> vec3<f32> { return vec3(v); }
//: end

struct Grid {
    // Rows of the map to cells; the last column is the corner.
    x: vec4<f32>,
    y: vec4<f32>,
    z: vec4<f32>,
    size: vec3<u32>,
    channels: u32,
    first_value: u32,
    first_majorant: u32,
}

// A straight way through the coordinates of a grid, by metres.
struct GridLine { origin: vec3<f32>, direction: vec3<f32> }

fn grid_float4(at: u32) -> vec4<f32> {
    return vec4(scene_float(at), scene_float(at + 1u), scene_float(at + 2u), scene_float(at + 3u));
}

// Of the words of a `GridRecord` at `at`.
fn grid_new(at: u32) -> Grid {
    return Grid(
        grid_float4(at),
        grid_float4(at + 4u),
        grid_float4(at + 8u),
        vec3(scene_word(at + 12u), scene_word(at + 13u), scene_word(at + 14u)),
        scene_word(at + 15u),
        scene_word(at + 16u),
        scene_word(at + 17u),
    );
}

fn grid_blocks(size: vec3<u32>) -> vec3<u32> { return (size + vec3(8u)) >> vec3(GRID_BLOCK_BITS); }

fn grid_is_coloured(grid: Grid) -> bool { return grid.channels == 3u; }

fn grid_vector(grid: Grid, v: vec3<f32>) -> vec3<f32> {
    return vec3(math_dot(grid.x.xyz, v), math_dot(grid.y.xyz, v), math_dot(grid.z.xyz, v));
}

fn grid_point(grid: Grid, point: vec3<f32>) -> vec3<f32> {
    return grid_vector(grid, point - vec3(grid.x.w, grid.y.w, grid.z.w)) + vec3(0.5f);
}

fn grid_line(grid: Grid, origin: vec3<f32>, direction: vec3<f32>) -> GridLine {
    return GridLine(grid_point(grid, origin), grid_vector(grid, direction));
}

fn grid_fetch(grid: Grid, index: u32) -> GridValue {
    //: if COLOURED_GRIDS
    if grid.channels == 3u {
        let at = grid.first_value + 3u * index;
        return vec3(grid_value(at), grid_value(at + 1u), grid_value(at + 2u));
    }
    //: end
    return GridValue(grid_value(grid.first_value + index));
}

// The values at the corners of a piece (x runs fastest, then y, then z), and its lower corner.
struct GridCell {
    c0: GridValue,
    c1: GridValue,
    c2: GridValue,
    c3: GridValue,
    c4: GridValue,
    c5: GridValue,
    c6: GridValue,
    c7: GridValue,
    base: vec3<f32>,
}

fn grid_cell(grid: Grid, piece: vec3<u32>) -> GridCell {
    let last = grid.size - vec3(1u);
    let low = min(piece - min(piece, vec3(1u)), last);
    let high = min(piece, last);
    let row0 = (low.z * grid.size.y + low.y) * grid.size.x;
    let row1 = (low.z * grid.size.y + high.y) * grid.size.x;
    let row2 = (high.z * grid.size.y + low.y) * grid.size.x;
    let row3 = (high.z * grid.size.y + high.y) * grid.size.x;
    return GridCell(
        grid_fetch(grid, row0 + low.x),
        grid_fetch(grid, row0 + high.x),
        grid_fetch(grid, row1 + low.x),
        grid_fetch(grid, row1 + high.x),
        grid_fetch(grid, row2 + low.x),
        grid_fetch(grid, row2 + high.x),
        grid_fetch(grid, row3 + low.x),
        grid_fetch(grid, row3 + high.x),
        vec3<f32>(piece),
    );
}

fn grid_mix(a: GridValue, b: GridValue, t: f32) -> GridValue { return a * (1.0f - t) + b * t; }

fn grid_cell_at(c: GridCell, q: vec3<f32>) -> GridValue {
    let f = math_min3(math_max3(q - c.base, vec3(0.0f)), vec3(1.0f));
    let low = grid_mix(grid_mix(c.c0, c.c1, f.x), grid_mix(c.c2, c.c3, f.x), f.y);
    let high = grid_mix(grid_mix(c.c4, c.c5, f.x), grid_mix(c.c6, c.c7, f.x), f.y);
    return grid_mix(low, high, f.z);
}

fn grid_inside(q: f32, n: u32) -> bool { return q >= 0.5f - GRID_SLACK && q <= f32(n) + (0.5f + GRID_SLACK); }

// The value at a point; 0 beyond the box.
fn grid_at(grid: Grid, point: vec3<f32>) -> vec3<f32> {
    let q = grid_point(grid, point);
    let size = grid.size;
    if !(grid_inside(q.x, size.x) && grid_inside(q.y, size.y) && grid_inside(q.z, size.z)) {
        return vec3(0.0f);
    }
    return grid_wide(grid_cell_at(grid_cell(grid, vec3<u32>(q)), q));
}
