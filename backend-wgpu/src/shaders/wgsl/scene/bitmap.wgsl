// Bitmaps and patterns. Texels come from `texel`, linear values of codes from the arena at `scene_at.srgb_decode`.
//: use math::bits
//: use math::pow
//: use math::rounding

fn bitmap_srgb_to_linear(code: u32) -> f32 {
    let s = f32(code) / 255.0f;
    if s <= 0.04045f { return s / 12.92f; }
    return math_pow((s + 0.055f) / 1.055f, 2.4f);
}

fn bitmap_texel(width: u32, first: u32, x: u32, y: u32) -> vec3<f32> {
    let code = texel(first + y * width + x);
    let table = scene_at.srgb_decode;
    return vec3(
        scene_float(table + (code & 255u)),
        scene_float(table + ((code >> 8u) & 255u)),
        scene_float(table + ((code >> 16u) & 255u)),
    );
}

struct BitmapCell { lower: u32, upper: u32, fraction: f32 }

fn bitmap_repeat(x_in: f32, n: u32) -> BitmapCell {
    let x = select(0.0f, x_in, math_is_finite(x_in));
    let wrapped = x - math_floor(x);
    let s = wrapped * f32(n) - 0.5f;
    let cell = math_floor(s);
    let fraction = s - cell;
    var lower = n - 1u;
    if cell >= 0.0f { lower = min(u32(cell), n - 1u); }
    let upper = select(lower + 1u, 0u, lower + 1u >= n);
    return BitmapCell(lower, upper, fraction);
}

fn bitmap_sample_bitmap(width: u32, height: u32, first: u32, uv: vec2<f32>) -> vec3<f32> {
    let x = bitmap_repeat(uv.x, width);
    let y = bitmap_repeat(-uv.y, height);
    let fx = x.fraction;
    let fy = y.fraction;
    let top = bitmap_texel(width, first, x.lower, y.lower) * (1.0f - fx)
        + bitmap_texel(width, first, x.upper, y.lower) * fx;
    let low = bitmap_texel(width, first, x.lower, y.upper) * (1.0f - fx)
        + bitmap_texel(width, first, x.upper, y.upper) * fx;
    return top * (1.0f - fy) + low * fy;
}

// Words of a `TextureRecord` at `at`.
fn bitmap_sample_record(at: u32, uv: vec2<f32>) -> vec3<f32> {
    return bitmap_sample_bitmap(scene_word(at), scene_word(at + 1u), scene_word(at + 2u), uv);
}

// Words of a `CheckerRecord` at `at`.
fn bitmap_checker_color(at: u32, uv: vec2<f32>) -> vec3<f32> {
    let first = math_fract(uv.x * scene_float(at + 6u)) >= 0.5f;
    let second = math_fract(uv.y * scene_float(at + 7u)) >= 0.5f;
    let color = at + select(0u, 3u, first != second);
    return vec3(scene_float(color), scene_float(color + 1u), scene_float(color + 2u));
}
