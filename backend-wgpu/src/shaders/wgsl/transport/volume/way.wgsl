// Straight ways through media and through boundaries that light passes.
//: use geometry::surface

const CROSSINGS_MAX: u32 = 4096u;

// Length of way through the step that a ray takes off a surface with this unit normal: a medium is there too.
fn way_lead(position: vec3<f32>, normal: vec3<f32>, origin: vec3<f32>, direction: vec3<f32>) -> f32 {
    let off = origin - position;
    return sqrt(math_dot(off, off)) / math_max(math_abs(math_dot(direction, normal)), 0.1f);
}

// The same way, its parameter in metres.
fn way_with_unit_direction(ray: Ray) -> Ray {
    if ray.t_max == MAX_FLOAT { return ray; }
    let length = sqrt(math_dot(ray.direction, ray.direction));
    if length > 0.0f { return Ray(ray.origin, ray.direction / length, ray.t_max * length); }
    return Ray(vec3(0.0f), vec3(0.0f), 0.0f);
}
