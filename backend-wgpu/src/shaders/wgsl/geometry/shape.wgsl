// Spheres and disks.
//: use geometry::ray
//: use geometry::surface

const SPHERE: u32 = 0u;
const DISK: u32 = 1u;

struct RoundShape { kind: u32, radius: f32, center: vec3<f32>, normal: vec3<f32> }

struct Box { lo: vec3<f32>, hi: vec3<f32> }

fn geometry_next_up(x: f32) -> f32 {
    let bits = bitcast<u32>(x);
    if math_is_nan(x) || bits == 0x7f800000u { return x; }
    if (bits & 0x7fffffffu) == 0u { return bitcast<f32>(1u); }
    return bitcast<f32>(select(bits + 1u, bits - 1u, bits >= 0x80000000u));
}

fn geometry_next_down(x: f32) -> f32 { return -geometry_next_up(-x); }

fn geometry_down(c: f32, h: f32) -> f32 {
    if h > 0.0f { return geometry_next_down(c - h); }
    return c;
}

fn geometry_up(c: f32, h: f32) -> f32 {
    if h > 0.0f { return geometry_next_up(c + h); }
    return c;
}

fn geometry_shape_bounds(shape: RoundShape) -> Box {
    let inf = math_infinity();
    let empty = Box(vec3(inf), vec3(-inf));
    let r = shape.radius;
    let c = shape.center;
    if !(r > 0.0f && math_is_finite(r)) { return empty; }
    var h = vec3(r);
    if shape.kind == DISK {
        let n = shape.normal;
        let len2 = math_dot(n, n);
        if !(len2 > 0.0f && math_is_finite(len2)) { return empty; }
        let grow = r * (1.0f + 4.0f * 1.1920929e-7f);
        let s = n * n;
        h = vec3(
            grow * sqrt((s.y + s.z) / len2),
            grow * sqrt((s.z + s.x) / len2),
            grow * sqrt((s.x + s.y) / len2),
        );
    } else if shape.kind != SPHERE {
        return empty;
    }
    return Box(
        vec3(geometry_down(c.x, h.x), geometry_down(c.y, h.y), geometry_down(c.z, h.z)),
        vec3(geometry_up(c.x, h.x), geometry_up(c.y, h.y), geometry_up(c.z, h.z)),
    );
}

fn geometry_power_of_two_scale(x: f32) -> f32 {
    let exponent = (bitcast<u32>(x) >> 23u) & 0xffu;
    return bitcast<f32>((254u - clamp(exponent, 1u, 253u)) << 23u);
}

// First root at or above 0, or NaN.
fn geometry_sphere(f: vec3<f32>, d: vec3<f32>, r: f32) -> f32 {
    let a = math_dot(d, d);
    let b = -math_dot(f, d);
    let line = f + d * (b / a);
    let distance = sqrt(math_dot(line, line));
    let discriminant = (r - distance) * (r + distance);
    if discriminant < 0.0f { return math_nan(); }
    let root = sqrt(a * discriminant);
    let q = select(b + root, b - root, b < 0.0f);
    let len = sqrt(math_dot(f, f));
    let c = (len - r) * (len + r);
    if q == 0.0f { return 0.0f; }
    let u = q / a;
    let v = c / q;
    let t0 = select(v, u, u < v);
    let t1 = select(u, v, u < v);
    return select(t1, t0, t0 >= 0.0f);
}

fn geometry_disk(f: vec3<f32>, d: vec3<f32>, n: vec3<f32>, radius: f32) -> f32 {
    let t = -math_dot(n, f) / math_dot(n, d);
    let q = f + d * t;
    if math_dot(q, q) <= radius * radius { return t; }
    return math_nan();
}

// The ray's parameter, or -1.
fn geometry_intersect_shape(ray: PreparedRay, shape: RoundShape, t_max: f32) -> f32 {
    let own = geometry_shape_bounds(shape);
    let interval = geometry_slab_interval(ray, own.lo, own.hi);
    let enter = interval.x;
    if !(enter <= interval.y && interval.y >= 0.0f && enter <= t_max && math_abs(ray.shear.z) > 0.0f) {
        return -1.0f;
    }
    let scale = geometry_power_of_two_scale(math_max_element(abs(ray.direction)));
    let d = ray.direction * scale;
    let f = ray.origin - shape.center;
    var t: f32;
    if shape.kind == SPHERE {
        t = geometry_sphere(f, d, shape.radius);
    } else {
        t = geometry_disk(f, d, shape.normal, shape.radius);
    }
    t = t * scale;
    // A compiler may make `max` of the next line, and a number of NaN.
    if math_is_nan(t) { return -1.0f; }
    if t < enter { t = enter; }
    if t >= 0.0f && t <= t_max && math_is_finite(t) { return math_positive_zero(t); }
    return -1.0f;
}

// Away from the centre of a sphere, the disk's own normal; zero where there is none.
fn geometry_shape_normal(shape: RoundShape, p: vec3<f32>) -> vec3<f32> {
    if shape.kind == SPHERE { return geometry_unit(p - shape.center); }
    if shape.kind == DISK { return geometry_unit(shape.normal); }
    return vec3(0.0f);
}
