// Vectors of three floats, in scalar operations of a fixed order.
//: use math::bits
//: use math::rounding

fn math_dot(a: vec3<f32>, b: vec3<f32>) -> f32 { return a.x * b.x + a.y * b.y + a.z * b.z; }

fn math_cross(a: vec3<f32>, b: vec3<f32>) -> vec3<f32> {
    return vec3(a.y * b.z - b.y * a.z, a.z * b.x - b.z * a.x, a.x * b.y - b.x * a.y);
}

// The larger; the other one where one is NaN.
fn math_max_number(a: f32, b: f32) -> f32 { return select(b, a, (a >= b) | math_is_nan(b)); }

fn math_min_number(a: f32, b: f32) -> f32 { return select(b, a, (a <= b) | math_is_nan(b)); }

fn math_max_component(v: vec3<f32>) -> f32 { return math_max_number(math_max_number(v.x, v.y), v.z); }

fn math_min_component(v: vec3<f32>) -> f32 { return math_min_number(math_min_number(v.x, v.y), v.z); }

fn math_mean(rgb: vec3<f32>) -> f32 {
    let third = 0.333333343f;
    // Their sum may be beyond the largest float.
    return math_kept(rgb.x * third) + math_kept(rgb.y * third) + math_kept(rgb.z * third);
}

fn math_normalize_or(v: vec3<f32>, fallback: vec3<f32>) -> vec3<f32> {
    let square = math_dot(v, v);
    if square > 1.0e-24f && square < 1.0e36f {
        let len = sqrt(square);
        return vec3(v.x / len, v.y / len, v.z / len);
    }
    let largest = math_max_number(math_max_number(math_abs(v.x), math_abs(v.y)), math_abs(v.z));
    if !(math_is_finite(v.x) && math_is_finite(v.y) && math_is_finite(v.z)) || largest == 0.0f {
        return fallback;
    }
    let k = -math_exponent(largest);
    let f1 = math_pow2(k >> 1u);
    let f2 = math_pow2(k - (k >> 1u));
    let w = vec3(v.x * f1 * f2, v.y * f1 * f2, v.z * f1 * f2);
    let len = sqrt(math_dot(w, w));
    return vec3(w.x / len, w.y / len, w.z / len);
}

struct Basis { t: vec3<f32>, b: vec3<f32> }

fn math_orthonormal_basis(n: vec3<f32>) -> Basis {
    let s = math_copysign(1.0f, n.z);
    let a = -1.0f / (s + n.z);
    let b = n.x * n.y * a;
    return Basis(vec3(1.0f + s * n.x * n.x * a, s * b, -s * n.x), vec3(b, s + n.y * n.y * a, -n.y));
}

fn math_to_local(v: vec3<f32>, t: vec3<f32>, b: vec3<f32>, n: vec3<f32>) -> vec3<f32> {
    return vec3(math_dot(v, t), math_dot(v, b), math_dot(v, n));
}

fn math_from_local(v: vec3<f32>, t: vec3<f32>, b: vec3<f32>, n: vec3<f32>) -> vec3<f32> {
    return vec3(
        t.x * v.x + b.x * v.y + n.x * v.z,
        t.y * v.x + b.y * v.y + n.y * v.z,
        t.z * v.x + b.z * v.y + n.z * v.z,
    );
}

fn math_reflect(w: vec3<f32>, n: vec3<f32>) -> vec3<f32> {
    let twice = 2.0f * math_dot(w, n);
    return vec3(twice * n.x - w.x, twice * n.y - w.y, twice * n.z - w.z);
}
