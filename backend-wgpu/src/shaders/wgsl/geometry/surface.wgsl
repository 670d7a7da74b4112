// Points on surfaces, and rays that leave them without meeting what they leave.
//: use geometry::ray
//: use geometry::shape

// 2^-24
const UNIT_ROUNDOFF: f32 = 5.9604645e-8f;
const SEGMENT_END: f32 = 1.0f - 8.0f * 1.1920929e-7f;

struct SurfacePoint { position: vec3<f32>, extent: f32 }

struct Scaled { v: vec3<f32>, n: i32 }

fn geometry_any_nan(v: vec3<f32>) -> bool {
    return math_is_nan(v.x) || math_is_nan(v.y) || math_is_nan(v.z);
}

// A vector whose largest component is in [1, 2), and the power of two that made it so; the zero vector where there is none.
fn geometry_scaled(v: vec3<f32>) -> Scaled {
    let largest = math_max_element(abs(v));
    if !(largest > 0.0f && math_is_finite(largest)) || geometry_any_nan(v) { return Scaled(vec3(0.0f), 0); }
    var first = 0;
    if largest < 1e-30f {
        first = 100;
    } else if largest > 1e30f {
        first = -100;
    }
    let w = v * math_pow2(first);
    let second = geometry_power_of_two_scale(math_max_element(abs(w)));
    return Scaled(w * second, first + i32(bitcast<u32>(second) >> 23u) - 127);
}

// Zero where there is none.
fn geometry_unit(v: vec3<f32>) -> vec3<f32> {
    let s = geometry_scaled(v).v;
    if all(s == vec3(0.0f)) { return s; }
    return s / sqrt(math_dot(s, s));
}

fn geometry_scaled_edge(a: vec3<f32>, b: vec3<f32>) -> vec3<f32> {
    let e = b - a;
    if math_is_finite(e.x) && math_is_finite(e.y) && math_is_finite(e.z) { return geometry_scaled(e).v; }
    return geometry_scaled(b * 0.5f - a * 0.5f).v;
}

fn geometry_half_size(a: vec3<f32>, b: vec3<f32>) -> f32 {
    return math_max_element(abs(b * 0.5f - a * 0.5f));
}

// Zero for a triangle without area.
fn geometry_normal(v0: vec3<f32>, v1: vec3<f32>, v2: vec3<f32>) -> vec3<f32> {
    let s0 = geometry_half_size(v1, v2);
    let s1 = geometry_half_size(v2, v0);
    let s2 = geometry_half_size(v0, v1);
    var a = v2;
    var b = v0;
    var c = v1;
    if s0 >= s1 && s0 >= s2 {
        a = v0;
        b = v1;
        c = v2;
    } else if s1 >= s2 {
        a = v1;
        b = v2;
        c = v0;
    }
    let e1 = geometry_scaled_edge(a, b);
    let e2 = geometry_scaled_edge(a, c);
    if all(e1 == vec3(0.0f)) || all(e2 == vec3(0.0f)) { return vec3(0.0f); }
    return geometry_unit(math_cross(e1, e2));
}

fn geometry_interpolate(v0: vec3<f32>, v1: vec3<f32>, v2: vec3<f32>, b1: f32, b2: f32) -> vec3<f32> {
    return v0 + ((v1 - v0) * b1 + (v2 - v0) * b2);
}

fn geometry_sliver_factor(v0: vec3<f32>, v1: vec3<f32>, v2: vec3<f32>) -> f32 {
    let e1 = v1 - v0;
    let e2 = v2 - v0;
    let e3 = v2 - v1;
    let n = math_cross(e1, e2);
    let longest = math_max_number(math_max_number(math_dot(e1, e1), math_dot(e2, e2)), math_dot(e3, e3));
    let sliver = 0.2f * longest / sqrt(math_dot(n, n));
    if sliver < 32.0f { return math_max_number(sliver, 1.0f); }
    return 32.0f;
}

fn geometry_hit_point_with(
    v0: vec3<f32>,
    v1: vec3<f32>,
    v2: vec3<f32>,
    b1: f32,
    b2: f32,
    factor: f32,
) -> SurfacePoint {
    let p = geometry_interpolate(v0, v1, v2, b1, b2);
    let q0 = v0 - p;
    let q1 = v1 - p;
    let q2 = v2 - p;
    let reach = math_max_number(math_max_number(math_dot(q0, q0), math_dot(q1, q1)), math_dot(q2, q2));
    return SurfacePoint(p, sqrt(reach) * factor);
}

fn geometry_shape_point(shape: RoundShape, p: vec3<f32>) -> SurfacePoint {
    let c = shape.center;
    var position = p;
    if shape.kind == SPHERE {
        let n = geometry_unit(p - c);
        if any(n != vec3(0.0f)) { position = c + n * shape.radius; }
    } else {
        let n = geometry_unit(shape.normal);
        if any(n != vec3(0.0f)) { position = p - n * math_dot(n, p - c); }
    }
    return SurfacePoint(position, 2.0f * math_max_number(shape.radius, 0.0f));
}

fn geometry_offset_origin(p: SurfacePoint, ng: vec3<f32>, toward: vec3<f32>) -> vec3<f32> {
    let side = select(ng, -ng, math_dot(toward, ng) < 0.0f);
    let height =
        UNIT_ROUNDOFF * (6.0f * math_dot(abs(ng), abs(p.position)) + 8.0f * p.extent);
    return p.position + side * math_min_number(height, UNIT_ROUNDOFF * MAX_FLOAT);
}

fn geometry_segment(start: vec3<f32>, end: vec3<f32>) -> Ray { return Ray(start, end - start, SEGMENT_END); }
