// Rays, what is computed once per ray, and the conservative box test.
//: use math::vector
//: use math::choice

const NEAR: f32 = 1.0f - 3.0f * 1.1920929e-7f;
const FAR: f32 = 1.0f + 3.0f * 1.1920929e-7f;

struct Ray { origin: vec3<f32>, direction: vec3<f32>, t_max: f32 }

struct PreparedRay {
    origin: vec3<f32>,
    direction: vec3<f32>,
    near: vec3<f32>,
    far: vec3<f32>,
    shear: vec3<f32>,
    axis: u32,
}

fn geometry_reciprocal(d: f32) -> f32 {
    return 1.0f / select(d, math_copysign(1e-18f, d), math_abs(d) < 1e-18f);
}

// Components with the dominant axis last.
fn geometry_rotate(axis: u32, v: vec3<f32>) -> vec3<f32> {
    return select(select(v, v.zxy, axis == 1u), v.yzx, axis == 0u);
}

fn geometry_prepare(ray: Ray) -> PreparedRay {
    let d = ray.direction;
    let r = vec3(geometry_reciprocal(d.x), geometry_reciprocal(d.y), geometry_reciprocal(d.z));
    let ax = math_abs(d.x);
    let ay = math_abs(d.y);
    let az = math_abs(d.z);
    let first = select(1u, 0u, ax > ay);
    let a = select(ay, ax, ax > ay);
    let axis = select(2u, first, a > az);
    var shear = vec3(math_nan());
    let q = geometry_rotate(axis, d);
    if math_abs(q.z) >= 1e-18f && math_abs(q.z) <= 8e37f {
        shear = vec3(q.x / q.z, q.y / q.z, 1.0f / q.z);
    }
    return PreparedRay(ray.origin, d, r * NEAR, r * FAR, shear, axis);
}

// Entry and exit of the ray's line.
fn geometry_slab_interval(ray: PreparedRay, lo: vec3<f32>, hi: vec3<f32>) -> vec2<f32> {
    let up = ray.near > vec3(0.0f);
    let n = (select(hi, lo, up) - ray.origin) * ray.near;
    let f = (select(lo, hi, up) - ray.origin) * ray.far;
    return vec2(math_max(math_max(n.x, n.y), n.z), math_min(math_min(f.x, f.y), f.z));
}

// The entry where the ray may touch the box, else -1.
fn geometry_slab_entry(ray: PreparedRay, lo: vec3<f32>, hi: vec3<f32>, t_max: f32) -> f32 {
    let interval = geometry_slab_interval(ray, lo, hi);
    let enter = math_max(interval.x, 0.0f);
    if enter <= math_min(interval.y, t_max) { return enter; }
    return -1.0f;
}
