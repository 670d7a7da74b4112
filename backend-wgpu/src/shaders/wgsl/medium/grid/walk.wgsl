// The pieces of a grid that a line crosses, one after the other.
//: use medium::grid

const WALK_PARALLEL: f32 = 1e-18f;
const WALK_BLOCK_MASK: i32 = 7;
const WALK_AXES: vec3<u32> = vec3(0u, 1u, 2u);

// A stretch within one piece, or of a block where there is nothing to walk by pieces; `found` is false behind the last one.
struct Stretch { found: bool, piece: vec3<u32>, begin: f32, end: f32, majorant: f32 }

struct Walk {
    found: bool,
    coarse: bool,
    blocks: vec3<u32>,
    last: vec3<i32>,
    first_majorant: u32,
    origin: vec3<f32>,
    direction: vec3<f32>,
    inverse: vec3<f32>,
    // Metres of the line before the walk.
    before: f32,
    t: f32,
    end: f32,
    piece: vec3<i32>,
    next: vec3<f32>,
    block: u32,
    majorant: f32,
}

fn walk_plane_one(inverse: f32, origin: f32, plane: i32) -> f32 {
    if inverse == 0.0f { return math_infinity(); }
    return (f32(plane) - origin) * inverse;
}

// Where planes of the three axes are met.
fn walk_planes(walk: ptr<function, Walk>, planes: vec3<i32>) -> vec3<f32> {
    return vec3(
        walk_plane_one((*walk).inverse.x, (*walk).origin.x, planes.x),
        walk_plane_one((*walk).inverse.y, (*walk).origin.y, planes.y),
        walk_plane_one((*walk).inverse.z, (*walk).origin.z, planes.z),
    );
}

fn walk_forward(walk: ptr<function, Walk>) -> vec3<bool> { return (*walk).direction > vec3(0.0f); }

fn walk_at(walk: ptr<function, Walk>, t: f32) -> vec3<f32> { return (*walk).origin + (*walk).direction * t; }

fn walk_least(next: vec3<f32>) -> u32 {
    if next.x <= next.y { return select(2u, 0u, next.x <= next.z); }
    return select(2u, 1u, next.y <= next.z);
}

fn walk_new(grid: Grid, line: GridLine, limit: f32, coarse: bool) -> Walk {
    var walk: Walk;
    var enter = 0.0f;
    var leave = limit;
    let lo = vec3(0.5f) - line.origin;
    let hi = vec3<f32>(grid.size) + vec3(0.5f) - line.origin;
    for (var k = 0u; k < 3u; k++) {
        let d = math_component(line.direction, k);
        let low = math_component(lo, k);
        let high = math_component(hi, k);
        if math_abs(d) > WALK_PARALLEL {
            let inverse = 1.0f / d;
            let a = low * inverse;
            let b = high * inverse;
            enter = math_max_number(enter, math_min_number(a, b));
            leave = math_min_number(leave, math_max_number(a, b));
            walk.inverse = select(walk.inverse, vec3(inverse), WALK_AXES == vec3(k));
        } else if !(low <= 0.0f && high >= 0.0f) {
            return walk;
        }
    }
    if !(math_is_finite3(line.origin) && enter < leave && leave <= MAX_FLOAT) { return walk; }
    let start = line.origin + line.direction * enter;
    let top = vec3<f32>(grid.size) + vec3(0.5f);
    walk.found = true;
    walk.coarse = coarse;
    walk.blocks = grid_blocks(grid.size);
    walk.last = vec3<i32>(grid.size);
    walk.first_majorant = grid.first_majorant;
    walk.origin = vec3(
        math_clamp_number(start.x, 0.5f, top.x),
        math_clamp_number(start.y, 0.5f, top.y),
        math_clamp_number(start.z, 0.5f, top.z),
    );
    walk.direction = select(line.direction, vec3(0.0f), walk.inverse == vec3(0.0f));
    walk.before = enter;
    walk.end = leave - enter;
    walk.piece = min(vec3<i32>(walk.origin), walk.last);
    walk.block = 0xffffffffu;
    walk.next = walk_planes(&walk, walk.piece + select(vec3(0), vec3(1), walk_forward(&walk)));
    return walk;
}

// Goes on into the neighbour along an axis, or ends.
fn walk_cross(walk: ptr<function, Walk>, axis: u32, piece: i32) {
    let here = WALK_AXES == vec3(axis);
    if piece < 0 || any(here & (vec3(piece) > (*walk).last)) {
        (*walk).t = (*walk).end;
        return;
    }
    (*walk).piece = select((*walk).piece, vec3(piece), here);
    let planes = walk_planes(walk, (*walk).piece + select(vec3(0), vec3(1), walk_forward(walk)));
    (*walk).next = select((*walk).next, planes, here);
}

fn walk_component(v: vec3<i32>, k: u32) -> i32 { return select(select(v.z, v.y, k == 1u), v.x, k == 0u); }

// Leaves a block in one step. Returns where it ends.
fn walk_leave_block(walk: ptr<function, Walk>) -> f32 {
    let forward = walk_forward(walk);
    let first = (*walk).piece & vec3(~WALK_BLOCK_MASK);
    let beyond = select(first - vec3(1), first + vec3(WALK_BLOCK_MASK + 1), forward);
    let planes = walk_planes(walk, select(first, beyond, forward));
    let axis = walk_least(planes);
    let plane = math_component(planes, axis);
    if plane >= (*walk).end {
        (*walk).t = (*walk).end;
        return (*walk).end;
    }
    (*walk).t = math_max_number((*walk).t, plane);
    let q = vec3<i32>(walk_at(walk, (*walk).t));
    // On the way that it goes, and no further than the block.
    let low = select(first, (*walk).piece, forward);
    let high = select((*walk).piece, first + vec3(WALK_BLOCK_MASK), forward);
    let to = min(clamp(q, low, high), (*walk).last);
    for (var k = 0u; k < 3u; k++) {
        if k != axis && math_component((*walk).inverse, k) != 0.0f { walk_cross(walk, k, walk_component(to, k)); }
    }
    let t = (*walk).t;
    walk_cross(walk, axis, walk_component(beyond, axis));
    return t;
}

// The next stretch that is not empty and where the density is not known to be 0.
fn walk_next(walk: ptr<function, Walk>) -> Stretch {
    while (*walk).t < (*walk).end {
        let b = vec3<u32>((*walk).piece) >> vec3(GRID_BLOCK_BITS);
        let block = (b.z * (*walk).blocks.y + b.y) * (*walk).blocks.x + b.x;
        if block != (*walk).block {
            (*walk).block = block;
            (*walk).majorant = grid_value((*walk).first_majorant + block);
        }
        let begin = (*walk).t;
        let piece = vec3<u32>((*walk).piece);
        let majorant = (*walk).majorant;
        if majorant == 0.0f || (*walk).coarse {
            let to = walk_leave_block(walk);
            if majorant > 0.0f && to > begin { return Stretch(true, piece, begin, to, majorant); }
            continue;
        }
        let axis = walk_least((*walk).next);
        let to = math_component((*walk).next, axis);
        if to >= (*walk).end {
            (*walk).t = (*walk).end;
            return Stretch(true, piece, begin, (*walk).end, majorant);
        }
        (*walk).t = math_max_number(to, begin);
        let step = select(-1, 1, math_component((*walk).direction, axis) > 0.0f);
        walk_cross(walk, axis, walk_component((*walk).piece, axis) + step);
        if to > begin { return Stretch(true, piece, begin, to, majorant); }
    }
    return Stretch(false, vec3(0u), 0.0f, 0.0f, 0.0f);
}
