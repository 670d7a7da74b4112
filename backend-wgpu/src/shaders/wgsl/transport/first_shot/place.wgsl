// Where on a piece photons start, and with which density.
//: use direct::subdivide::bary
//: use math::bits
//: use math::rounding
//: use sampling::linear_triangle

const FIRST_SHOT_SLACK: f32 = 1e-4f;

fn first_shot_on_triangle(corners: array<vec2<u32>, 3>, local: vec3<f32>) -> vec3<f32> {
    var b = vec3(0.0f);
    b += local.x * subdivide_bary_to_f32(corners[0]);
    b += local.y * subdivide_bary_to_f32(corners[1]);
    b += local.z * subdivide_bary_to_f32(corners[2]);
    return b;
}

// Not `ok` for a piece without area or turned over.
struct FirstShotWithin { ok: bool, local: vec3<f32> }

fn first_shot_within(corners: array<vec2<u32>, 3>, at: vec2<f32>) -> FirstShotWithin {
    let a = subdivide_bary_to_f32(corners[0]).yz;
    let u = subdivide_bary_to_f32(corners[1]).yz - a;
    let v = subdivide_bary_to_f32(corners[2]).yz - a;
    let p = at - a;
    let all = u.x * v.y - u.y * v.x;
    if math_is_nan(all) || all <= 0.0f { return FirstShotWithin(false, vec3(0.0f)); }
    let l1 = (p.x * v.y - p.y * v.x) / all;
    let l2 = (u.x * p.y - u.y * p.x) / all;
    return FirstShotWithin(true, vec3(1.0f - l1 - l2, l1, l2));
}

fn first_shot_density(pmf: f32, weights: vec3<f32>, area: f32, local: vec3<f32>) -> f32 {
    if !(local.x >= -FIRST_SHOT_SLACK && local.y >= -FIRST_SHOT_SLACK && local.z >= -FIRST_SHOT_SLACK) {
        return 0.0f;
    }
    let inside = vec3(math_max(local.x, 0.0f), math_max(local.y, 0.0f), math_max(local.z, 0.0f));
    let density = pmf * linear_triangle_pdf(weights, inside) / area;
    if area > 0.0f && density >= 0.0f { return math_min(density, MAX_FLOAT); }
    return 0.0f;
}
