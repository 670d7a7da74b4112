// The picture of an environment. It lies in the arena: `scene_at.environment_to_world` (nine floats, by rows), `environment_texels`
// (three floats each), `environment_rows` and `environment_columns` (counts), `environment_starts` (where the run of each row of cells
// begins in the columns, and where the last one ends); `environment_width` is 0 where there is none, `environment_row_count` how many
// counts of rows there are.
//: use math::choice
//: use math::consts
//: use math::inverse_trig
//: use math::roots
//: use math::rounding
//: use math::trig
//: use math::vector
//: use sampling::counter
//: use sampling::discrete
//: use scene::counts

struct EnvironmentSample { wi: vec3<f32>, radiance: vec3<f32>, pdf: f32 }

// What comes from a direction, and the density with which it is drawn.
struct EnvironmentMet { radiance: vec3<f32>, pdf: f32 }

struct EnvironmentPlace { column: u32, row: u32, right: f32, down: f32 }

fn environment_is_there() -> bool { return scene_at.environment_width != 0u; }

fn environment_to_world(row: u32) -> vec3<f32> {
    let at = scene_at.environment_to_world + 3u * row;
    return vec3(scene_float(at), scene_float(at + 1u), scene_float(at + 2u));
}

fn environment_cell_rows() -> u32 { return max(scene_at.environment_height, 2u) - 1u; }

fn environment_theta(row: u32) -> f32 { return PI * (f32(row) / f32(environment_cell_rows())); }

fn environment_sin(x: f32) -> f32 { return math_sin_cos(x).s; }

fn environment_height_of(row: u32) -> f32 {
    let a = environment_theta(row);
    let b = environment_theta(row + 1u);
    return 2.0f * environment_sin(0.5f * (a + b)) * environment_sin(0.5f * (b - a));
}

fn environment_solid_angle(row: u32) -> f32 {
    return TAU / f32(scene_at.environment_width) * environment_height_of(row);
}

fn environment_texel(x: u32, y: u32) -> vec3<f32> {
    let at = scene_at.environment_texels + 3u * (y * scene_at.environment_width + x);
    return vec3(scene_float(at), scene_float(at + 1u), scene_float(at + 2u));
}

fn environment_place(direction: vec3<f32>) -> EnvironmentPlace {
    let width = scene_at.environment_width;
    let rows = environment_cell_rows();
    let d = environment_to_world(0u) * direction.x + environment_to_world(1u) * direction.y
        + environment_to_world(2u) * direction.z;
    let u = math_atan2(d.x, -d.z) / TAU + 0.5f;
    let x = u * f32(width) - 0.5f;
    let low = math_floor(x);
    var column = math_to_i32(low);
    if column < 0 { column += i32(width); }
    let theta = math_atan2(sqrt(d.x * d.x + d.z * d.z), d.y);
    let y = theta / PI * f32(rows);
    let row = min(math_to_u32(y), rows - 1u);
    return EnvironmentPlace(
        min(u32(max(column, 0)), width - 1u),
        row,
        math_clamp_number(x - low, 0.0f, 1.0f),
        math_clamp_number(y - f32(row), 0.0f, 1.0f),
    );
}

fn environment_mix(a: vec3<f32>, b: vec3<f32>, t: f32) -> vec3<f32> { return a * (1.0f - t) + b * t; }

fn environment_radiance_at(p: EnvironmentPlace) -> vec3<f32> {
    var next = p.column + 1u;
    if next >= scene_at.environment_width { next = 0u; }
    let below = min(p.row + 1u, scene_at.environment_height - 1u);
    let upper = environment_mix(environment_texel(p.column, p.row), environment_texel(next, p.row), p.right);
    let lower = environment_mix(environment_texel(p.column, below), environment_texel(next, below), p.right);
    return environment_mix(upper, lower, p.down);
}

// Sets `counts_at` to the columns of a row of cells; how many counts they have.
fn environment_run(row: u32) -> u32 {
    let start = scene_word(scene_at.environment_starts + row);
    counts_at = scene_at.environment_columns + start;
    return scene_word(scene_at.environment_starts + row + 1u) - start;
}

fn environment_pdf_at(column: u32, row: u32) -> f32 {
    counts_at = scene_at.environment_rows;
    let of_row = discrete_pmf_in(scene_at.environment_row_count, row);
    let length = environment_run(row);
    return of_row * discrete_pmf_in(length, column) / environment_solid_angle(row);
}

fn environment_radiance(direction: vec3<f32>) -> vec3<f32> {
    return environment_radiance_at(environment_place(direction));
}

fn environment_pdf_solid_angle(direction: vec3<f32>) -> f32 {
    let p = environment_place(direction);
    return environment_pdf_at(p.column, p.row);
}

fn environment_meet(direction: vec3<f32>) -> EnvironmentMet {
    let p = environment_place(direction);
    return EnvironmentMet(environment_radiance_at(p), environment_pdf_at(p.column, p.row));
}

fn environment_versine(theta: f32, north: bool) -> f32 {
    var angle = PI - theta;
    if north { angle = theta; }
    let s = environment_sin(0.5f * angle);
    return 2.0f * s * s;
}

fn environment_sample(words: vec2<u32>) -> EnvironmentSample {
    counts_at = scene_at.environment_rows;
    let row = discrete_pick_in(scene_at.environment_row_count, words.x);
    let length = environment_run(row.index);
    let column = discrete_pick_in(length, words.y);
    let down = math_u32_to_unit(row.remainder);
    let right = math_u32_to_unit(column.remainder);
    let phi = TAU * ((f32(column.index) + 0.5f + right) / f32(scene_at.environment_width) - 0.5f);
    let a = environment_theta(row.index);
    let b = environment_theta(row.index + 1u);
    let north = a + b < PI;
    let above = environment_versine(a, north);
    let v = above + (environment_versine(b, north) - above) * down;
    let sin = math_sqrt_clamped(v * (2.0f - v));
    var cos = v - 1.0f;
    if north { cos = 1.0f - v; }
    let turn = math_sin_cos(phi);
    let local = vec3(sin * turn.s, cos, -sin * turn.c);
    let wi = vec3(
        math_dot(environment_to_world(0u), local),
        math_dot(environment_to_world(1u), local),
        math_dot(environment_to_world(2u), local),
    );
    let pdf = row.pmf * column.pmf / environment_solid_angle(row.index);
    return EnvironmentSample(wi, environment_radiance(wi), pdf);
}

// A random word of 24 known bits, the other 8 from a hash.
fn environment_widen(u: f32, salt: u32) -> u32 {
    return (math_to_u32(u * 16777216.0f) << 8u) | (counter_hash_u32(salt) & 255u);
}

// From numbers of 24 bits; `salt` are any further bits of the same sample.
fn environment_sample_units(u: vec2<f32>, salt: vec2<f32>) -> EnvironmentSample {
    return environment_sample(vec2(
        environment_widen(u.x, bitcast<u32>(salt.x) ^ 0x9E3779B9u),
        environment_widen(u.y, bitcast<u32>(salt.y) ^ 0x85EBCA6Bu),
    ));
}
