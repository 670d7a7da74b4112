// Warps of the unit square: core's sampling/warp, both files of it.
//: use math::bits
//: use math::consts
//: use math::exp_ln
//: use math::inverse_trig
//: use math::rounding
//: use math::trig
//: use math::vector

// Clamps to the unit numbers; NaN becomes 0, and so does -0, which drivers lose in sums with 0.
fn warp_unit(u: f32) -> f32 {
    if u > 0.0f { return math_min(u, ONE_MINUS_EPSILON); }
    return 0.0f;
}

fn warp_sin_cos_turns(u: f32) -> SinCos {
    let quarters = 4.0f * u;
    let nearest = i32(quarters + 0.5f);
    let r = math_sin_cos_quarter((quarters - f32(nearest)) * (0.5f * PI));
    switch nearest & 3 {
        case 0: { return r; }
        case 1: { return SinCos(r.c, -r.s); }
        case 2: { return SinCos(-r.s, -r.c); }
        default: { return SinCos(-r.c, r.s); }
    }
}

fn warp_turns(x: f32, y: f32) -> f32 {
    if x == 0.0f && y == 0.0f { return 0.0f; }
    let t = math_atan2(y, x) * (0.5f / PI);
    if t < 0.0f { return warp_unit(t + 1.0f); }
    return warp_unit(t);
}

fn warp_one_minus_exp_neg(t: f32) -> f32 {
    if t < 0.5f {
        var sum = 1.0f;
        for (var divisor = 9.0f; divisor >= 2.0f; divisor -= 1.0f) { sum = 1.0f - t / divisor * sum; }
        return t * sum;
    }
    return 1.0f - math_exp(-t);
}

// ---- Flat shapes.

const WARP_HALF_CELL: f32 = 1.0f / 16777216.0f;

struct Concentric { p: vec2<f32>, radius: f32 }

fn warp_concentric(u: vec2<f32>) -> Concentric {
    let a = (2.0f * u.x - 1.0f) + WARP_HALF_CELL;
    let b = (2.0f * u.y - 1.0f) + WARP_HALF_CELL;
    if math_abs(a) > math_abs(b) {
        let r = math_sin_cos_quarter((0.25f * PI) * (b / a));
        return Concentric(vec2(a * r.c, a * r.s), math_abs(a));
    }
    if b != 0.0f {
        let r = math_sin_cos_quarter((0.25f * PI) * (a / b));
        return Concentric(vec2(b * r.s, b * r.c), math_abs(b));
    }
    return Concentric(vec2(0.0f, 0.0f), 0.0f);
}

fn warp_sample_disk(u: vec2<f32>) -> vec2<f32> { return warp_concentric(u).p; }

fn warp_pdf_area_disk(p: vec2<f32>) -> f32 {
    if p.x * p.x + p.y * p.y <= 1.0f + 1.0f / 1048576.0f { return 1.0f / PI; }
    return 0.0f;
}

fn warp_invert_disk(p: vec2<f32>) -> vec2<f32> {
    let r = sqrt(p.x * p.x + p.y * p.y);
    var a = 0.0f;
    var b = 0.0f;
    if r != 0.0f {
        if math_abs(p.x) > math_abs(p.y) {
            a = math_copysign(r, p.x);
            b = r * (math_atan2(p.y, math_abs(p.x)) * (4.0f / PI));
        } else {
            b = math_copysign(r, p.y);
            a = r * (math_atan2(p.x, math_abs(p.y)) * (4.0f / PI));
        }
    }
    return vec2(warp_unit(0.5f * (a - WARP_HALF_CELL) + 0.5f), warp_unit(0.5f * (b - WARP_HALF_CELL) + 0.5f));
}

fn warp_length(v: vec3<f32>) -> f32 {
    let largest = math_max_number(math_max_number(math_abs(v.x), math_abs(v.y)), math_abs(v.z));
    if largest > 0.0f {
        let s = vec3(v.x / largest, v.y / largest, v.z / largest);
        return largest * sqrt(s.x * s.x + s.y * s.y + s.z * s.z);
    }
    return 0.0f;
}

fn warp_per_area(area: f32) -> f32 {
    if area > 0.0f { return math_min_number(1.0f / area, MAX_FLOAT); }
    return 0.0f;
}

fn warp_sample_parallelogram(u: vec2<f32>, origin: vec3<f32>, edge0: vec3<f32>, edge1: vec3<f32>) -> vec3<f32> {
    return origin + edge0 * u.x + edge1 * u.y;
}

fn warp_pdf_area_parallelogram(edge0: vec3<f32>, edge1: vec3<f32>) -> f32 {
    return warp_per_area(warp_length(math_cross(edge0, edge1)));
}

fn warp_invert_parallelogram(origin: vec3<f32>, edge0: vec3<f32>, edge1: vec3<f32>, point: vec3<f32>) -> vec2<f32> {
    let normal = math_cross(edge0, edge1);
    let area = warp_length(normal);
    if area <= 0.0f { return vec2(0.0f, 0.0f); }
    let n = vec3(normal.x / area, normal.y / area, normal.z / area);
    let d = point - origin;
    return vec2(
        warp_unit(math_dot(math_cross(d, edge1), n) / area),
        warp_unit(math_dot(math_cross(edge0, d), n) / area),
    );
}

fn warp_sample_triangle(u: vec2<f32>) -> vec3<f32> {
    if u.x < u.y {
        let b0 = 0.5f * u.x;
        return vec3(b0, u.y - b0, 1.0f - u.y);
    }
    let b1 = 0.5f * u.y;
    return vec3(u.x - b1, b1, 1.0f - u.x);
}

fn warp_pdf_area_triangle(edge0: vec3<f32>, edge1: vec3<f32>) -> f32 {
    return warp_per_area(0.5f * warp_length(math_cross(edge0, edge1)));
}

fn warp_invert_triangle(bary: vec3<f32>) -> vec2<f32> {
    let sum = bary.x + bary.y;
    if bary.x < bary.y { return vec2(warp_unit(2.0f * bary.x), warp_unit(sum)); }
    return vec2(warp_unit(sum), warp_unit(2.0f * bary.y));
}

// ---- Directions.

fn warp_direction(turn: f32, sin_theta: f32, cos_theta: f32) -> vec3<f32> {
    let r = warp_sin_cos_turns(turn);
    return vec3(r.c * sin_theta, r.s * sin_theta, cos_theta);
}

fn warp_sin_squared(w: vec3<f32>) -> f32 { return w.x * w.x + w.y * w.y; }

fn warp_one_minus_cos(w: vec3<f32>) -> f32 {
    if w.z > 0.0f { return warp_sin_squared(w) / (1.0f + w.z); }
    return 1.0f - w.z;
}

fn warp_neg_ln_cos(w: vec3<f32>) -> f32 {
    let s = warp_sin_squared(w);
    if s < 0.25f {
        let y = s / (2.0f - s);
        let q = y * y;
        return y * (1.0f + q * (1.0f / 3.0f + q * (1.0f / 5.0f + q * (1.0f / 7.0f + q * (1.0f / 9.0f)))));
    }
    return -math_ln(w.z);
}

fn warp_sample_sphere(u: vec2<f32>) -> vec3<f32> {
    return warp_direction(u.y, 2.0f * sqrt(u.x * (1.0f - u.x)), 1.0f - 2.0f * u.x);
}

fn warp_pdf_solid_angle_sphere(w: vec3<f32>) -> f32 { return 0.25f / PI; }

fn warp_invert_sphere(w: vec3<f32>) -> vec2<f32> {
    var u0 = 0.5f - 0.5f * w.z;
    if w.z > 0.0f { u0 = 0.5f * warp_one_minus_cos(w); }
    return vec2(warp_unit(u0), warp_turns(w.x, w.y));
}

fn warp_sample_hemisphere(u: vec2<f32>) -> vec3<f32> {
    return warp_direction(u.y, sqrt(u.x * (2.0f - u.x)), 1.0f - u.x);
}

fn warp_pdf_solid_angle_hemisphere(w: vec3<f32>) -> f32 {
    if w.z > 0.0f { return 0.5f / PI; }
    return 0.0f;
}

fn warp_invert_hemisphere(w: vec3<f32>) -> vec2<f32> {
    return vec2(warp_unit(warp_one_minus_cos(w)), warp_turns(w.x, w.y));
}

fn warp_sample_cosine_hemisphere(u: vec2<f32>) -> vec3<f32> {
    let c = warp_concentric(u);
    return vec3(c.p.x, c.p.y, sqrt((1.0f - c.radius) * (1.0f + c.radius)));
}

fn warp_pdf_solid_angle_cosine_hemisphere(w: vec3<f32>) -> f32 {
    return math_max_number(w.z, 0.0f) * (1.0f / PI);
}

fn warp_invert_cosine_hemisphere(w: vec3<f32>) -> vec2<f32> { return warp_invert_disk(w.xy); }

fn warp_one_minus_cos_of_sin_squared(sin_squared: f32) -> f32 {
    var s = sin_squared;
    if s < 0.0f { s = 0.0f; }
    if s > 1.0f { s = 1.0f; }
    return s / (1.0f + sqrt(1.0f - s));
}

fn warp_sample_cone(u: vec2<f32>, one_minus_cos_max: f32) -> vec3<f32> {
    let h = u.x * one_minus_cos_max;
    return warp_direction(u.y, sqrt(h * (2.0f - h)), 1.0f - h);
}

fn warp_pdf_solid_angle_cone(one_minus_cos_max: f32, w: vec3<f32>) -> f32 {
    let inside = warp_one_minus_cos(w) <= one_minus_cos_max * (1.0f + 1.0f / 1048576.0f);
    if inside && one_minus_cos_max > 0.0f {
        return math_min_number(0.5f / PI / one_minus_cos_max, MAX_FLOAT);
    }
    return 0.0f;
}

fn warp_invert_cone(one_minus_cos_max: f32, w: vec3<f32>) -> vec2<f32> {
    var u0 = 0.0f;
    if one_minus_cos_max > 0.0f { u0 = warp_one_minus_cos(w) / one_minus_cos_max; }
    return vec2(warp_unit(u0), warp_turns(w.x, w.y));
}

fn warp_sample_power_cosine(u: vec2<f32>, exponent: f32) -> vec3<f32> {
    let n = math_max_number(exponent, 0.0f);
    let t = -math_ln(1.0f - math_min_number(u.x, ONE_MINUS_EPSILON)) / (n + 1.0f);
    return warp_direction(u.y, sqrt(warp_one_minus_exp_neg(2.0f * t)), math_exp(-t));
}

fn warp_pdf_solid_angle_power_cosine(exponent: f32, w: vec3<f32>) -> f32 {
    if w.z > 0.0f {
        let n = math_max_number(exponent, 0.0f);
        return (n + 1.0f) * (0.5f / PI) * math_exp(-n * warp_neg_ln_cos(w));
    }
    return 0.0f;
}

fn warp_invert_power_cosine(exponent: f32, w: vec3<f32>) -> vec2<f32> {
    var u0 = 1.0f;
    if w.z > 0.0f {
        u0 = warp_one_minus_exp_neg((math_max_number(exponent, 0.0f) + 1.0f) * warp_neg_ln_cos(w));
    }
    return vec2(warp_unit(u0), warp_turns(w.x, w.y));
}
