// A place where a walk was scattered: on a surface or in a medium.
//: use light
//: use transport::bidirectional::weight
//: use transport::surface
//: if VOLUME
//: use medium::inside
//: use medium::phase
//: use transport::volume::way
//: end

// In a medium there is no normal and no extent, and lobes are unused.
struct WalkVertex {
    point: SurfacePoint,
    // Back to where the walk came from.
    wo: vec3<f32>,
    geometric: vec3<f32>,
    // The interpolated normal on the side of the geometric one.
    shading: vec3<f32>,
    lobes: Lobes,
    // What the walk carries on arriving; in a medium times its scattering coefficient.
    carried: vec3<f32>,
    chain: Chain,
    edges: u32,
    index: u32,
    coloured: bool,
    //: if VOLUME
    in_medium: bool,
    g: f32,
    extinction: f32,
    // The media on the side of `wo`, and beyond the surface.
    inside: Inside,
    beyond: Inside,
    //: end
}

fn walk_vertex_at_surface(surface: Surface, chain: Chain) -> WalkVertex {
    var v: WalkVertex;
    v.point = surface.point;
    v.wo = surface.wo;
    v.geometric = surface.geometric;
    v.shading = surface.geometric;
    //: if SHADING
    v.shading = surface.interpolated;
    //: end
    v.lobes = surface.lobes;
    v.chain = chain;
    return v;
}

//: if VOLUME
fn walk_vertex_in_medium(position: vec3<f32>, wo: vec3<f32>, g: f32, extinction: f32, chain: Chain) -> WalkVertex {
    var v: WalkVertex;
    v.point = SurfacePoint(position, 0.0f);
    v.wo = wo;
    v.chain = chain;
    v.in_medium = true;
    v.g = g;
    v.extinction = extinction;
    return v;
}
//: end

// What turns a density of directions at a point in direction `wi`, at the squared distance `d2`, into one of this vertex.
fn walk_vertex_facing(v: WalkVertex, wi: vec3<f32>, d2: f32) -> f32 {
    //: if VOLUME
    if v.in_medium { return v.extinction / d2; }
    //: end
    return math_abs(math_dot(v.geometric, wi)) / d2;
}

// f cos, or the phase function, and the densities of a direction and of the way back.
struct Scattered { f: vec3<f32>, forward: f32, backward: f32 }

// The normal that lobes are seen about from a direction: an interpolated one that points away from it does not count.
fn walk_vertex_about(v: WalkVertex, w: vec3<f32>) -> vec3<f32> {
    //: if DETAIL
    let side = select(1.0f, -1.0f, math_dot(w, v.geometric) < 0.0f);
    if !(side * math_dot(w, v.shading) > 0.0f) { return v.geometric; }
    //: end
    return v.shading;
}

fn walk_vertex_scattering(v: WalkVertex, from_light: bool, wi: vec3<f32>) -> Scattered {
    //: if VOLUME
    if v.in_medium {
        let p = phase_eval(v.g, v.wo, wi);
        return Scattered(vec3(p), p, p);
    }
    //: end
    var out = Scattered(vec3(0.0f), 0.0f, 0.0f);
    let there = math_dot(wi, v.geometric);
    if there <= 0.0f && !lobes_transmits(v.lobes) { return out; }
    let here = math_dot(v.wo, v.geometric);
    // There and back, so that lobes are in the shader once.
    for (var turn = 0u; turn < 2u; turn++) {
        let back = turn == 1u;
        let first = select(v.wo, wi, back);
        let second = select(wi, v.wo, back);
        let n = walk_vertex_about(v, first);
        let value = lobes_value(v.lobes, n, first, second);
        if back { out.backward = value.pdf; } else { out.forward = value.pdf; }
        // From the sensor to the light.
        if back == from_light {
            //: if DETAIL
            let cos = math_dot(second, n);
            out.f = value.f * math_abs(select(cos, cos * there / here, from_light));
            //: else
            out.f = value.f * math_abs(there);
            //: end
        }
    }
    return out;
}

struct WalkSample { found: bool, wi: vec3<f32>, weight: vec3<f32>, left: Left }

fn walk_vertex_sample(v: WalkVertex, from_light: bool, u: vec2<f32>, lobe: f32) -> WalkSample {
    //: if VOLUME
    if v.in_medium {
        let wi = phase_sample(v.g, v.wo, u);
        let pdf = phase_eval(v.g, v.wo, wi);
        return WalkSample(true, wi, vec3(1.0f), Left(true, pdf, pdf));
    }
    //: end
    var n = v.shading;
    //: if DETAIL
    if !(math_dot(v.wo, v.shading) > 0.0f) { n = v.geometric; }
    //: end
    let s = lobes_sample(v.lobes, n, v.wo, u, lobe);
    var out = WalkSample(s.found, s.wi, s.weight, Left(false, 1.0f, 1.0f));
    //: if DETAIL
    // An interpolated normal can send light to the wrong side.
    let there = math_dot(s.wi, v.geometric);
    if (there > 0.0f) != (math_dot(s.wi, n) > 0.0f) { out.found = false; }
    //: end
    if !out.found { return out; }
    if s.pdf <= 0.0f {
        //: if DETAIL
        let here = math_dot(v.wo, v.geometric);
        if from_light {
            out.weight = s.weight * math_abs(math_dot(v.wo, n) * there / (here * math_dot(s.wi, n)));
        }
        //: end
        return out;
    }
    let scattered = walk_vertex_scattering(v, from_light, s.wi);
    out.left = Left(true, s.pdf, scattered.backward);
    //: if DETAIL
    out.weight = scattered.f / s.pdf;
    //: else
    if lobes_transmits(v.lobes) { out.weight = scattered.f / s.pdf; }
    //: end
    return out;
}

// What radiance is divided by where the sensor's walk goes on in another medium, which the index squeezes; importance keeps its measure.
fn walk_vertex_index_ratio_squared(v: WalkVertex, from_light: bool, wi: vec3<f32>) -> f32 {
    if from_light { return 1.0f; }
    //: if VOLUME
    if v.in_medium { return 1.0f; }
    //: end
    return lobes_index_ratio_squared(v.lobes, v.shading, v.wo, wi);
}

// Start of a ray into a direction, to a place at a distance or (0) to wherever.
fn walk_vertex_leave(v: WalkVertex, wi: vec3<f32>, distance: f32) -> vec3<f32> {
    //: if VOLUME
    if v.in_medium { return v.point.position; }
    //: end
    return geometry_offset_origin(light_within(v.point, distance), v.geometric, wi);
}

//: if VOLUME
// What lies between the vertex and the start of a ray from it.
fn walk_vertex_lead(v: WalkVertex, origin: vec3<f32>, wi: vec3<f32>) -> f32 {
    if v.in_medium { return 0.0f; }
    return way_lead(v.point.position, v.geometric, origin, wi);
}

// The media on the side of a direction.
fn walk_vertex_media(v: WalkVertex, wi: vec3<f32>) -> Inside {
    if !v.in_medium && math_dot(wi, v.geometric) < 0.0f { return v.beyond; }
    return v.inside;
}
//: end
