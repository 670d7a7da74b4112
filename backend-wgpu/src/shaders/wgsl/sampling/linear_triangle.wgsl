// Points of linear density over a triangle: core's robust form. A weight's or coordinate's place is about the apex, the
// lightest vertex.
//: use math::bits
//: use math::rounding
//: use math::sums

// 2^48, 2^-48, 2^-40, 2^-60.
const LINEAR_TRIANGLE_UP: f32 = 281474976710656.0f;
const LINEAR_TRIANGLE_DOWN: f32 = 1.0f / 281474976710656.0f;
const LINEAR_TRIANGLE_SMALL: f32 = 1.0f / 1099511627776.0f;
const LINEAR_TRIANGLE_TINY: f32 = 1.0f / 1152921504606846976.0f;
const LINEAR_TRIANGLE_EDGE: f32 = 0.875f;

// Weights by place, and which vertex the apex is.
struct LinearTriangleRotated { w: vec3<f32>, apex: u32 }

fn linear_triangle_scale_of(x: f32) -> f32 {
    let field = 0x7f000000 - bitcast<i32>(bitcast<u32>(x) & 0x7f800000u);
    return bitcast<f32>(max(field, 0x00800000));
}

fn linear_triangle_valid(w: vec3<f32>) -> vec3<f32> {
    return vec3(
        math_min(math_max(w.x, 0.0f), MAX_FLOAT),
        math_min(math_max(w.y, 0.0f), MAX_FLOAT),
        math_min(math_max(w.z, 0.0f), MAX_FLOAT),
    );
}

fn linear_triangle_scaled_valid(w: vec3<f32>) -> vec3<f32> {
    let largest = math_max(math_max(w.x, w.y), w.z);
    let lift = select(1.0f, 16777216.0f, largest < MIN_POSITIVE);
    let scale = linear_triangle_scale_of(largest * lift);
    let flat = select(1.0f, 0.0f, largest > 0.0f);
    return vec3(w.x * lift * scale + flat, w.y * lift * scale + flat, w.z * lift * scale + flat);
}

fn linear_triangle_scaled(weights: vec3<f32>) -> vec3<f32> {
    return linear_triangle_scaled_valid(linear_triangle_valid(weights));
}

// Values by vertex as values by place.
fn linear_triangle_forth(apex: u32, x: vec3<f32>) -> vec3<f32> {
    return select(select(x.zxy, x.yzx, apex == 1u), x, apex == 0u);
}

// Values by place as values by vertex.
fn linear_triangle_back(apex: u32, x: vec3<f32>) -> vec3<f32> {
    return select(select(x.yzx, x.zxy, apex == 1u), x, apex == 0u);
}

fn linear_triangle_rotated(weights: vec3<f32>) -> LinearTriangleRotated {
    let v = linear_triangle_valid(weights);
    let apex = select(select(2u, 1u, v.y <= v.z), 0u, v.x <= v.y && v.x <= v.z);
    return LinearTriangleRotated(linear_triangle_forth(apex, linear_triangle_scaled_valid(v)), apex);
}

fn linear_triangle_unit(x: f32) -> f32 { return math_min(math_max(x, 0.0f), 1.0f); }

fn linear_triangle_twelve_bits(x: f32) -> f32 {
    return bitcast<f32>((bitcast<u32>(x) + 0x800u) & 0xfffff000u);
}

fn linear_triangle_third(x: i32) -> i32 {
    var y = x >> 2u;
    y += y >> 2u;
    y += y >> 4u;
    return y + (y >> 8u);
}

fn linear_triangle_guess(al: f32, be: f32, xi: f32) -> f32 {
    let square = (bitcast<i32>(xi) - bitcast<i32>(al)) >> 1u;
    let cube = linear_triangle_third(bitcast<i32>(xi) - bitcast<i32>(be));
    let apart = abs(square - cube);
    // 0.44 * 2^23.
    let dip = max(3690987 - (apart >> 2u) - (apart >> 4u), 0);
    return bitcast<f32>(min(square, cube) + 0x3f800000 - dip);
}

fn linear_triangle_halley(r: f32, p: f32, q: f32) -> f32 { return (r * p) / (p * p + r * q); }

// Distance from the apex and its complement.
fn linear_triangle_distance(w: vec3<f32>, xi: f32) -> vec2<f32> {
    let w0 = w.x;
    let vv = math_two_sum(w.y, w.z);
    let v = vv.value;
    let v_low = vv.error;
    let sum = math_kept(v + w0);
    let sum_low = math_kept(math_kept(v - sum) + w0) + v_low;
    let t = math_kept(v - 2.0f * w0);
    let t_low = math_kept(math_kept(v - t) - 2.0f * w0) + v_low;
    let w3 = math_kept(3.0f * w0);
    let w3_low = math_kept(2.0f * w0 - w3) + w0;
    let v3 = math_kept(3.0f * v);
    let v3_low = math_kept(math_kept(2.0f * v - v3) + v) + 3.0f * v_low;
    let less = 3.0f * (v - w0);

    let edge = LINEAR_TRIANGLE_EDGE;
    let far = xi * sum > (edge * edge) * (w3 + t * edge);

    let is_small = xi < LINEAR_TRIANGLE_SMALL;
    let up = select(1.0f, LINEAR_TRIANGLE_UP, is_small);
    let down = select(1.0f, LINEAR_TRIANGLE_DOWN, is_small);
    let scaled_xi = xi * up * up;
    let rhs = scaled_xi * sum;
    let z0 = linear_triangle_guess(w3, t * down, rhs);
    let tz = t * (z0 * down);
    let better = z0
        + linear_triangle_halley(rhs - z0 * z0 * (w3 + tz), z0 * (2.0f * w3 + 3.0f * tz), w3 + 3.0f * tz);
    let z = linear_triangle_twelve_bits(better);
    let x = z * down;
    let t_high = math_upper12(t);
    let gg = math_two_sum(w3, math_kept(t_high * x));
    let g_low = gg.error + (w3_low + math_kept(t - t_high) * x + t_low * x);
    let tx = t * x;

    let rest = 1.0f - xi;
    let c_rhs = rest * sum;
    let c = linear_triangle_twelve_bits((c_rhs * v3) / (v3 * v3 - 1.05f * (less * c_rhs)));
    let kc = math_kept((t * c - less) * c);
    let h = math_kept(v3 + kc);
    let h_low = math_kept(math_kept(v3 - h) + kc) + v3_low;
    let tc = t * c;

    let start = select(x, c, far);
    let back = select(down, 1.0f, far);
    let share = select(scaled_xi, rest, far);
    let r = math_two_prod(share, sum);
    let power = math_kept(select(z * z, c, far));
    let m = math_two_prod(power, select(gg.value, h, far));
    let residual = math_kept(r.value - m.value)
        + ((r.error - m.error) + (share * sum_low - power * select(g_low, h_low, far)));
    let slope = select(z * (2.0f * w3 + 3.0f * tx), v3 - c * (2.0f * less - 3.0f * tc), far);
    let curve = select(w3 + 3.0f * tx, 3.0f * tc - less, far);
    let step = linear_triangle_halley(residual, slope, curve) * back;
    let near = start + step;
    let other = (1.0f - start) - step;
    if xi <= 0.0f { return vec2(0.0f, 1.0f); }
    return select(vec2(near, other), vec2(other, near), far);
}

fn linear_triangle_root(x: f32) -> f32 {
    let half = 0.5f * x;
    var y = bitcast<f32>(0x5f375a86u - (bitcast<u32>(x) >> 1u));
    y = y * (1.5f - half * y * y);
    y = y * (1.5f - half * y * y);
    let r = x * y;
    return r + (0.5f * y) * (x - r * r);
}

fn linear_triangle_along(w: vec3<f32>, s: f32, c: f32, eta: f32) -> vec2<f32> {
    let apex = w.x * c;
    var a = apex + w.y * s;
    var b = apex + w.z * s;
    let scale = linear_triangle_scale_of(math_max(a, b));
    a = a * scale * LINEAR_TRIANGLE_UP;
    b = b * scale * LINEAR_TRIANGLE_UP;
    let rest = 1.0f - eta;
    let whole = a + b;
    let d = linear_triangle_root(a * a * rest + b * b * eta);
    let early = 4.0f * (eta * whole) <= 3.0f * a + b;
    let bottom = select(b, a, early) + d;
    let share = select(rest, eta, early) * whole / math_max(bottom, LINEAR_TRIANGLE_TINY);
    let small = s * math_min(share, 1.0f);
    let large = s - small;
    return select(vec2(small, large), vec2(large, small), early);
}

fn linear_triangle_sample(weights: vec3<f32>, u: vec2<f32>) -> vec3<f32> {
    let r = linear_triangle_rotated(weights);
    let d = linear_triangle_distance(r.w, linear_triangle_unit(u.x));
    let b = linear_triangle_along(r.w, d.x, d.y, linear_triangle_unit(u.y));
    return linear_triangle_back(r.apex, vec3(d.y, b.x, b.y));
}

fn linear_triangle_pdf(weights: vec3<f32>, bary: vec3<f32>) -> f32 {
    let w = linear_triangle_scaled(weights);
    let value = 3.0f
        * (w.x * linear_triangle_unit(bary.x) + w.y * linear_triangle_unit(bary.y) + w.z * linear_triangle_unit(bary.z))
        / (w.x + w.y + w.z);
    if bary.x >= 0.0f && bary.y >= 0.0f && bary.z >= 0.0f { return math_min(value, 3.0f); }
    return 0.0f;
}

fn linear_triangle_invert(weights: vec3<f32>, bary: vec3<f32>) -> vec2<f32> {
    let r = linear_triangle_rotated(weights);
    let w0 = r.w.x;
    let w1 = r.w.y;
    let w2 = r.w.z;
    let inside = vec3(linear_triangle_unit(bary.x), linear_triangle_unit(bary.y), linear_triangle_unit(bary.z));
    let b = linear_triangle_forth(r.apex, inside);
    let v = w1 + w2;
    let t = (w1 - w0) + (w2 - w0);
    let sum = w0 + v;
    let rest = b.y + b.z;
    let whole = math_max(b.x + rest, MIN_POSITIVE);
    let s = rest / whole;
    let c = b.x / whole;
    let share = s * (s * (3.0f * w0 + t * s) / sum);
    let other = c * (3.0f * v + c * (t * c - 3.0f * (v - w0))) / sum;
    let xi = select(1.0f - other, share, share <= 0.5f);
    let along = math_max(rest, MIN_POSITIVE);
    let early = b.y / along;
    let late = b.z / along;
    let apex = w0 * c;
    let first = apex + w1 * s;
    let last = apex + w2 * s;
    let ends = math_max(first + last, LINEAR_TRIANGLE_TINY * LINEAR_TRIANGLE_TINY);
    let from_start = late * ((first * (1.0f + early) + last * late) / ends);
    let from_end = early * ((last * (1.0f + late) + first * early) / ends);
    let eta = select(1.0f - from_end, from_start, from_start <= 0.5f);
    let second = math_min(math_max(eta, 0.0f), ONE_MINUS_EPSILON);
    return vec2(math_min(math_max(xi, 0.0f), ONE_MINUS_EPSILON), select(second, 0.0f, rest <= 0.0f));
}

struct ApexDistance { apex: u32, distance: f32, complement: f32 }

fn linear_triangle_apex_distance(weights: vec3<f32>, u: f32) -> ApexDistance {
    let r = linear_triangle_rotated(weights);
    let d = linear_triangle_distance(r.w, linear_triangle_unit(u));
    return ApexDistance(r.apex, d.x, d.y);
}
