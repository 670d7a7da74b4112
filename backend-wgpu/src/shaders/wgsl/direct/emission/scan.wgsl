// Visiting the texels that a piece covers. Texels are those of `bitmap_texel`, the bitmap's first one at `first`.
//: use direct::emission::cut
//: use direct::emission::frame
//: use math::rounding
//: use math::sums
//: use scene::bitmap

fn emission_wrap(x: u32, n: u32) -> u32 {
    if x < n { return x; }
    return x % n;
}

// Sums per vertex and channel, and the brightest value met.
struct EmissionSums {
    total: array<Compensated, 9>,
    row: array<vec3<f32>, 3>,
    at: u32,
    brightest: vec3<f32>,
}

fn emission_sums_close(sums: ptr<function, EmissionSums>) {
    for (var k = 0u; k < 3u; k++) {
        let row = (*sums).row[k];
        for (var c = 0u; c < 3u; c++) {
            let i = 3u * k + c;
            (*sums).total[i] = math_compensated_add((*sums).total[i], row[c]);
        }
        (*sums).row[k] = vec3(0.0f);
    }
}

fn emission_sums_enter(sums: ptr<function, EmissionSums>, row: u32) {
    if row != (*sums).at {
        emission_sums_close(sums);
        (*sums).at = row;
    }
}

fn emission_brighter(a: vec3<f32>, b: vec3<f32>) -> vec3<f32> {
    return vec3(math_max(a.x, b.x), math_max(a.y, b.y), math_max(a.z, b.z));
}

fn emission_sums_add(sums: ptr<function, EmissionSums>, weights: vec3<f32>, color: vec3<f32>) {
    for (var k = 0u; k < 3u; k++) { (*sums).row[k] += weights[k] * color; }
    if weights.x + weights.y + weights.z > 0.0f {
        (*sums).brightest = emission_brighter((*sums).brightest, color);
    }
}

// Albedo at the vertices; not `ok` where the piece meets too many cells.
struct EmissionAlbedo { ok: bool, at: array<vec3<f32>, 3> }

fn emission_sums_finish(sums: ptr<function, EmissionSums>) -> EmissionAlbedo {
    emission_sums_close(sums);
    var albedo: EmissionAlbedo;
    albedo.ok = true;
    for (var k = 0u; k < 3u; k++) {
        for (var c = 0u; c < 3u; c++) {
            let mean = math_compensated_value((*sums).total[3u * k + c]) * 3.0f;
            albedo.at[k][c] = math_min(mean, (*sums).brightest[c]);
        }
    }
    return albedo;
}

// What a piece is integrated over: bilinearly filtered texels, or constant ones.
struct EmissionField { filtered: bool, size: vec2<u32>, first: u32, base: vec2<u32> }

fn emission_visit(
    field: EmissionField,
    column: u32,
    row: u32,
    part: ptr<function, EmissionPart>,
    sums: ptr<function, EmissionSums>,
) {
    emission_sums_enter(sums, row);
    let size = field.size;
    let x = emission_wrap(field.base.x + column, size.x);
    let y = emission_wrap(field.base.y + row, size.y);
    if !field.filtered {
        emission_sums_add(sums, emission_part_constant(part), bitmap_texel(size.x, field.first, x, y));
        return;
    }
    let weights = emission_part_bilinear(part, vec2(f32(column), f32(row)));
    let x1 = emission_wrap(x + 1u, size.x);
    let y1 = emission_wrap(y + 1u, size.y);
    emission_sums_add(sums, weights[0], bitmap_texel(size.x, field.first, x, y));
    emission_sums_add(sums, weights[1], bitmap_texel(size.x, field.first, x1, y));
    emission_sums_add(sums, weights[2], bitmap_texel(size.x, field.first, x, y1));
    emission_sums_add(sums, weights[3], bitmap_texel(size.x, field.first, x1, y1));
}

// Core's `cells` and the sums over them.
fn emission_scan_cells(field: EmissionField, points: array<vec2<f32>, 3>) -> EmissionAlbedo {
    var sums: EmissionSums;
    var rest = emission_part_whole(points);
    var strip: EmissionPart;
    var part: EmissionPart;
    var beyond: EmissionPart;
    let range = emission_part_range(&rest, 1u);
    var row = math_floor(range.x);
    loop {
        let last = range.y <= row + 1.0f;
        if last {
            strip = rest;
        } else {
            emission_part_split(&rest, 1u, row + 1.0f, &strip, &beyond);
            rest = beyond;
        }
        let across = emission_part_range(&strip, 0u);
        if across.x <= across.y {
            var column = math_floor(across.x);
            while across.y > column + 1.0f {
                emission_part_split(&strip, 0u, column + 1.0f, &part, &beyond);
                emission_visit(field, u32(column), u32(row), &part, &sums);
                strip = beyond;
                column += 1.0f;
            }
            emission_visit(field, u32(column), u32(row), &strip, &sums);
        }
        if last { break; }
        row += 1.0f;
    }
    return emission_sums_finish(&sums);
}

fn emission_scan_field(
    filtered: bool,
    size: vec2<u32>,
    first: u32,
    uv: array<vec2<f32>, 3>,
    max_cells: f32,
) -> EmissionAlbedo {
    let frame = emission_frame(size, uv, select(0.0f, 0.5f, filtered));
    if !(frame.ok && emission_cells(frame) <= max_cells) {
        return EmissionAlbedo(false, array(vec3(0.0f), vec3(0.0f), vec3(0.0f)));
    }
    return emission_scan_cells(EmissionField(filtered, size, first, frame.base), frame.points);
}

fn emission_scan(size: vec2<u32>, first: u32, uv: array<vec2<f32>, 3>, max_cells: f32) -> EmissionAlbedo {
    return emission_scan_field(true, size, first, uv, max_cells);
}

fn emission_scan_texels(size: vec2<u32>, first: u32, uv: array<vec2<f32>, 3>, max_cells: f32) -> EmissionAlbedo {
    return emission_scan_field(false, size, first, uv, max_cells);
}

const EMISSION_FILTER_ROUNDING: f32 = 1.0f + 4.0f / 16777216.0f;

fn emission_brightest_in(size: vec2<u32>, first: u32, uv: array<vec2<f32>, 3>) -> vec3<f32> {
    let columns = emission_touched(vec3(uv[0].x, uv[1].x, uv[2].x), size.x);
    let rows = emission_touched(vec3(-uv[0].y, -uv[1].y, -uv[2].y), size.y);
    var brightest = vec3(0.0f);
    for (var j = 0u; j < rows.count; j++) {
        let y = emission_wrap(rows.first + j, size.y);
        for (var i = 0u; i < columns.count; i++) {
            let x = emission_wrap(columns.first + i, size.x);
            brightest = emission_brighter(brightest, bitmap_texel(size.x, first, x, y));
        }
    }
    return brightest * EMISSION_FILTER_ROUNDING;
}
