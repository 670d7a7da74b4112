// Optical lengths of rays through a grid, and where they reach a value.
//: use math::exp_ln
//: use medium::flight
//: use medium::grid
//: use medium::grid::walk

const REGULAR_GAUSS: f32 = 0.28867513f;
const REGULAR_STEPS: u32 = 40u;
const REGULAR_OPAQUE: f32 = 104.0f;
const REGULAR_PART: f32 = 0.25f;
const REGULAR_DIM: f32 = 17.0f;

// `met` is false where the way is free to its limit.
struct Reached { met: bool, length: f32, optical: vec3<f32> }

fn regular_integral(walk: ptr<function, Walk>, cell: GridCell, begin: f32, end: f32) -> GridValue {
    let half = 0.5f * (begin + end);
    let span = end - begin;
    let off = REGULAR_GAUSS * span;
    return (grid_cell_at(cell, walk_at(walk, half - off)) + grid_cell_at(cell, walk_at(walk, half + off)))
        * (0.5f * span);
}

// Where a line is in the box, on the way from 0 to `limit`.
struct GridExtent { found: bool, begin: f32, end: f32 }

fn regular_extent(grid: Grid, line: GridLine, limit: f32) -> GridExtent {
    let walk = walk_new(grid, line, limit, true);
    return GridExtent(walk.found, walk.before, walk.before + walk.end);
}

fn regular_is_opaque(grid: Grid, sum: GridValue, sigma: vec3<f32>) -> bool {
    if grid_is_coloured(grid) {
        let depth = grid_wide(sum) * sigma;
        return depth.x > REGULAR_OPAQUE && depth.y > REGULAR_OPAQUE && depth.z > REGULAR_OPAQUE;
    }
    return grid_channel(sum, 0u) * math_min_component(sigma) > REGULAR_OPAQUE;
}

fn regular_optical_length(grid: Grid, line: GridLine, limit: f32, sigma: vec3<f32>) -> vec3<f32> {
    var sum = grid_zero();
    var walk = walk_new(grid, line, limit, false);
    if !walk.found { return grid_wide(sum); }
    loop {
        let s = walk_next(&walk);
        if !s.found { break; }
        sum = sum + regular_integral(&walk, grid_cell(grid, s.piece), s.begin, s.end);
        if regular_is_opaque(grid, sum, sigma) { break; }
    }
    return grid_wide(sum);
}

fn regular_invert(
    walk: ptr<function, Walk>, cell: GridCell, s: Stretch, whole: f32, wanted: f32, channel: u32,
) -> f32 {
    var low = s.begin;
    var high = s.end;
    var t = s.begin + (s.end - s.begin) * math_clamp_number(wanted / whole, 0.0f, 1.0f);
    for (var i = 0u; i < REGULAR_STEPS; i++) {
        let over = grid_channel(regular_integral(walk, cell, s.begin, t), channel) - wanted;
        if over == 0.0f { break; }
        if over > 0.0f { high = t; } else { low = t; }
        let slope = grid_channel(grid_cell_at(cell, walk_at(walk, t)), channel);
        let newton = t - over / slope;
        var next = 0.5f * (low + high);
        if newton > low && newton < high { next = newton; }
        if next == t || !(next > low && next < high) { break; }
        t = next;
    }
    return t;
}

fn regular_fly(grid: Grid, line: GridLine, limit: f32, wanted: f32, channel: u32) -> Reached {
    var sum = grid_zero();
    var walk = walk_new(grid, line, limit, false);
    if !walk.found { return Reached(false, 0.0f, grid_wide(sum)); }
    loop {
        let s = walk_next(&walk);
        if !s.found { break; }
        let cell = grid_cell(grid, s.piece);
        let piece = regular_integral(&walk, cell, s.begin, s.end);
        if grid_channel(sum + piece, channel) > wanted {
            let rest = math_max_number(wanted - grid_channel(sum, channel), 0.0f);
            let t = regular_invert(&walk, cell, s, grid_channel(piece, channel), rest, channel);
            let optical = sum + regular_integral(&walk, cell, s.begin, t);
            return Reached(true, walk.before + t, grid_wide(optical));
        }
        sum = sum + piece;
    }
    return Reached(false, 0.0f, grid_wide(sum));
}

// Integral of T along a part of a piece for one channel.
fn regular_glow(
    walk: ptr<function, Walk>, cell: GridCell, s: Stretch, sigma: f32, before: f32, whole: f32, channel: u32,
) -> f32 {
    let tau = sigma * whole;
    let left = math_exp(-sigma * before);
    var to = s.end;
    if tau > REGULAR_DIM { to = regular_invert(walk, cell, s, whole, REGULAR_DIM / sigma, channel); }
    let parts = math_to_u32(math_min(tau, REGULAR_DIM) / REGULAR_PART) + 1u;
    let step = (to - s.begin) / f32(parts);
    var sum = 0.0f;
    var begin = s.begin;
    var behind = 0.0f;
    for (var i = 0u; i < parts; i++) {
        let half = begin + 0.5f * step;
        let first = grid_channel(regular_integral(walk, cell, begin, half - REGULAR_GAUSS * step), channel);
        sum += math_exp(-sigma * (behind + first));
        let second = grid_channel(regular_integral(walk, cell, begin, half + REGULAR_GAUSS * step), channel);
        sum += math_exp(-sigma * (behind + second));
        behind += grid_channel(regular_integral(walk, cell, begin, begin + step), channel);
        begin += step;
    }
    return left * 0.5f * step * sum;
}

fn regular_emitted(grid: Grid, line: GridLine, limit: f32, sigma: vec3<f32>, emission: vec3<f32>) -> vec3<f32> {
    var sum = vec3(0.0f);
    var optical = grid_zero();
    var at = 0.0f;
    var walk = walk_new(grid, line, limit, false);
    if walk.found {
        loop {
            let s = walk_next(&walk);
            if !s.found { break; }
            sum += flight_transmittance_of(sigma, grid_wide(optical))
                * math_max_number(walk.before + s.begin - at, 0.0f);
            let cell = grid_cell(grid, s.piece);
            let piece = regular_integral(&walk, cell, s.begin, s.end);
            for (var c = 0u; c < 3u; c++) {
                if !(math_component(emission, c) > 0.0f) { continue; }
                let before = grid_channel(optical, c);
                let whole = grid_channel(piece, c);
                let glow = regular_glow(&walk, cell, s, math_component(sigma, c), before, whole, c);
                sum = select(sum, sum + vec3(glow), WALK_AXES == vec3(c));
            }
            optical = optical + piece;
            at = walk.before + s.end;
        }
    }
    if limit <= MAX_FLOAT {
        sum += flight_transmittance_of(sigma, grid_wide(optical)) * math_max_number(limit - at, 0.0f);
    }
    return emission * sum;
}
