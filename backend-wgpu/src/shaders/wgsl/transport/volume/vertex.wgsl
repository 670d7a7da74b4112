// A place where light is scattered: on a surface or in a medium.
//: use light
//: use medium::inside
//: use medium::phase
//: use transport::surface
//: use transport::volume::way

// In a medium `surface` has a point without extent, no normal, and the direction back along the ray.
struct Vertex { in_medium: bool, g: f32, beyond: Inside, surface: Surface }

fn vertex_on(surface: Surface, beyond: Inside) -> Vertex { return Vertex(false, 0.0f, beyond, surface); }

fn vertex_in(position: vec3<f32>, wo: vec3<f32>, g: f32) -> Vertex {
    var surface: Surface;
    surface.point = SurfacePoint(position, 0.0f);
    surface.wo = wo;
    return Vertex(true, g, vec3(0u), surface);
}

// Light can leave a surface in this direction: above both of its normals, or below both where it transmits.
fn vertex_goes(s: Surface, wi: vec3<f32>) -> bool {
    let flat_ = math_dot(wi, s.geometric);
    let shading = math_dot(wi, s.shading);
    return (flat_ > 0.0f && shading > 0.0f) || (flat_ < 0.0f && shading < 0.0f && lobes_transmits(s.lobes));
}

// What a direction that leaves is in; `here`: what the arriving ray was in.
fn vertex_media(vertex: Vertex, here: Inside, wi: vec3<f32>) -> Inside {
    if !vertex.in_medium && math_dot(wi, vertex.surface.geometric) < 0.0f { return vertex.beyond; }
    return here;
}

fn vertex_index_ratio_squared(vertex: Vertex, wi: vec3<f32>) -> f32 {
    if vertex.in_medium { return 1.0f; }
    return lobes_index_ratio_squared(vertex.surface.lobes, vertex.surface.shading, vertex.surface.wo, wi);
}

// f cos, or the phase function, and the density of a direction.
fn vertex_scattering(vertex: Vertex, wi: vec3<f32>) -> BsdfValue {
    let s = vertex.surface;
    if vertex.in_medium {
        let p = phase_eval(vertex.g, s.wo, wi);
        return BsdfValue(vec3(p), p);
    }
    if !vertex_goes(s, wi) { return BsdfValue(vec3(0.0f), 0.0f); }
    let value = lobes_value(s.lobes, s.shading, s.wo, wi);
    return BsdfValue(value.f * math_abs(math_dot(wi, s.shading)), value.pdf);
}

fn vertex_sample(vertex: Vertex, u: vec2<f32>, lobe: f32) -> BsdfSample {
    let s = vertex.surface;
    if vertex.in_medium {
        let wi = phase_sample(vertex.g, s.wo, u);
        return BsdfSample(true, wi, vec3(1.0f), phase_eval(vertex.g, s.wo, wi));
    }
    var found = lobes_sample(s.lobes, s.shading, s.wo, u, lobe);
    // An interpolated normal can send light to the wrong side; such directions carry nothing.
    found.found = found.found && vertex_goes(s, found.wi);
    return found;
}

// Start of a ray into a direction.
fn vertex_leave(vertex: Vertex, wi: vec3<f32>) -> vec3<f32> {
    if vertex.in_medium { return vertex.surface.point.position; }
    return geometry_offset_origin(vertex.surface.point, vertex.surface.geometric, wi);
}

// What lies between the vertex and the start of a ray from it.
fn vertex_lead(vertex: Vertex, origin: vec3<f32>, wi: vec3<f32>) -> f32 {
    if vertex.in_medium { return 0.0f; }
    return way_lead(vertex.surface.point.position, vertex.surface.geometric, origin, wi);
}

// The ray to a place on a light, its parameter in metres.
fn vertex_towards(vertex: Vertex, sample: LightSample) -> Ray {
    return way_with_unit_direction(light_shadow_ray(sample, vertex.surface.point, vertex.surface.geometric));
}

// How far that place is.
fn vertex_distance(vertex: Vertex, sample: LightSample) -> f32 {
    if sample.distant { return math_infinity(); }
    let to = sample.point - vertex.surface.point.position;
    return sqrt(math_dot(to, to));
}
