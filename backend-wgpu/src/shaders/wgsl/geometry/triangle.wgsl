// The watertight test of a triangle (Woop, Benthin and Wald 2013), in core's order.
//: use geometry::ray

struct TriangleHit { hit: bool, t: f32, b1: f32, b2: f32 }

fn geometry_sheared(v: vec3<f32>, s: vec2<f32>) -> vec2<f32> {
    return vec2(v.x - math_kept(s.x * v.z), v.y - math_kept(s.y * v.z));
}

fn geometry_intersect_triangle(
    ray: PreparedRay,
    v0: vec3<f32>,
    v1: vec3<f32>,
    v2: vec3<f32>,
    t_max: f32,
) -> TriangleHit {
    let a = geometry_rotate(ray.axis, v0 - ray.origin);
    let b = geometry_rotate(ray.axis, v1 - ray.origin);
    let c = geometry_rotate(ray.axis, v2 - ray.origin);
    let s = ray.shear.xy;
    // Neighbours must see a common edge alike: no product of theirs is fused.
    let p = geometry_sheared(a, s);
    let q = geometry_sheared(b, s);
    let r = geometry_sheared(c, s);
    let e0 = math_kept(r.x * q.y) - math_kept(r.y * q.x);
    let e1 = math_kept(p.x * r.y) - math_kept(p.y * r.x);
    let e2 = math_kept(q.x * p.y) - math_kept(q.y * p.x);
    let negative = (e0 < 0.0f) | (e1 < 0.0f) | (e2 < 0.0f);
    let positive = (e0 > 0.0f) | (e1 > 0.0f) | (e2 > 0.0f);
    let det = e0 + e1 + e2;
    let sz = ray.shear.z;
    var t = (e0 * (a.z * sz) + e1 * (b.z * sz) + e2 * (c.z * sz)) / det;
    let lo = math_min3(math_min3(v0, v1), v2);
    let hi = math_max3(math_max3(v0, v1), v2);
    let own = geometry_slab_interval(ray, lo, hi);
    // A compiler may make `min` and `max` of the next lines, and a number of NaN.
    let number = !math_is_nan(t);
    t = select(t, own.y, t > own.y);
    t = select(t, own.x, t < own.x);
    let b1 = e1 / det;
    let b2 = math_min_number(e2 / det, 1.0f - b1);
    // Infinity and NaN end here, by their bits. There is one way out: SwiftShader takes hours over several within a loop.
    let inside = !(negative & positive) & math_is_finite(det) & (det != 0.0f);
    let hit = inside & number & (t >= 0.0f) & (t <= t_max) & math_is_finite(t) & (own.x <= own.y);
    return TriangleHit(hit, math_positive_zero(t), math_positive_zero(b1), math_positive_zero(b2));
}
