// Airlight: what lights without size send to the camera by just one scattering in a medium, summed along the camera's rays.
//: use light::emit
//: use medium
//: use medium::inside
//: use sampling::sobol
//: use transport::volume::airlight::rule
//: use transport::volume::boundaries
//: use transport::volume::vertex
//: use transport::volume::way

// The first group of sample dimensions of segments.
const AIRLIGHT_GROUP: u32 = 1u << 28u;
// Golden ratio of 2^32: lights of one segment have their first nodes apart.
const AIRLIGHT_TURN: u32 = 0x9E3779B9u;
const AIRLIGHT_DISTANCE_MIN: f32 = 1.0f / 131072.0f;

// A part of the camera's ray within one medium: where it starts, what is left of light from there to the camera, and boundaries before it.
struct AirRay {
    origin: vec3<f32>,
    direction: vec3<f32>,
    lead: f32,
    inside: Inside,
    left: vec3<f32>,
    crossed: u32,
}

fn airlight_is_summed(light: u32) -> bool { return emit_is_point_like(light) && scene_float(light + LIGHT_PMF) > 0.0f; }

fn airlight_ray(air: AirRay) -> Ray { return Ray(air.origin, air.direction, MAX_FLOAT); }

// What rules see of a segment that ends at `length`.
fn airlight_segment(air: AirRay, length: f32) -> Segment {
    let nothing = Segment(false, 0.0f, 0.0f, 0.0f);
    let record = inside_current(air.inside);
    if record == MEDIUM_NONE { return nothing; }
    let medium = medium_new(record);
    let extent = medium_extent(medium, airlight_ray(air), air.lead, length);
    if extent.y < 0.0f { return nothing; }
    // A grid of albedos may scatter what is said to be absorbed.
    let scatters = select(medium.sigma_t, medium.sigma_s, medium_is_homogeneous(medium));
    var sigma = math_infinity();
    for (var c = 0u; c < 3u; c++) {
        if math_component(scatters, c) > 0.0f && math_component(air.left, c) > 0.0f {
            sigma = math_min_number(sigma, math_component(medium.sigma_t, c));
        }
    }
    if !math_is_finite(sigma) { return nothing; }
    if medium.density != MEDIUM_NO_GRID { sigma = 0.0f; }
    return Segment(true, extent.x, extent.y, sigma);
}

// What comes of the end of a segment: how far from its origin nodes may lie, whether the ray goes on beyond, and from where.
struct AirEnd { found: bool, reach: f32, goes_on: bool, beyond: AirRay }

fn airlight_end(air: AirRay, met: Hit) -> AirEnd {
    var end = AirEnd(true, MAX_FLOAT, false, air);
    if met.primitive == TREE_NOTHING { return end; }
    let ray = airlight_ray(air);
    let resolved = boundaries_resolve(ray, met, air.inside);
    let surface = surface_at(ray, resolved.hit);
    end.found = surface.found;
    if !surface.found { return end; }
    // Short of what is met, or it would be in the way.
    let before = geometry_offset_origin(surface.point, surface.geometric, -ray.direction);
    end.reach = math_max_number(math_dot(before - ray.origin, ray.direction), 0.0f);
    if !boundaries_passes(resolved.hit.primitive) || air.crossed >= CROSSINGS_MAX { return end; }
    let record = inside_current(air.inside);
    if record != MEDIUM_NONE {
        end.beyond.left *= medium_transmittance(medium_new(record), ray, air.lead, air.lead + met.t);
    }
    //: if LOBES
    let straight = interface_straight(surface.interface_);
    if straight.found { end.beyond.left *= straight.transmit; }
    //: end
    end.goes_on = !math_is_zero3(end.beyond.left);
    let origin = geometry_offset_origin(surface.point, surface.geometric, ray.direction);
    end.beyond.origin = origin;
    end.beyond.lead = way_lead(surface.point.position, surface.geometric, origin, ray.direction);
    end.beyond.inside = resolved.inside;
    end.beyond.crossed += 1u;
    return end;
}

fn airlight_foot(light: u32, air: AirRay) -> Foot {
    if scene_word(light) == LIGHT_DIRECTIONAL { return Foot(false, 0.0f, 0.0f); }
    let to = light_float3(light + LIGHT_PLACE) - air.origin;
    let along = math_dot(to, air.direction);
    let beside = to - air.direction * along;
    let off = sqrt(math_dot(beside, beside));
    let far = sqrt(math_dot(to, to));
    let distance = math_max_number(math_max_number(off, far * AIRLIGHT_DISTANCE_MIN), 1e-20f);
    return Foot(true, along + air.lead, distance);
}

// The way from a node to its light, and what it brings; not found where nothing could come.
struct Aim { found: bool, ray: Ray, length: f32, carried: vec3<f32> }

fn airlight_aim(air: AirRay, segment: Segment, reach: f32, shift: u32, number: u32, i: u32) -> Aim {
    var aim: Aim;
    let medium = medium_new(inside_current(air.inside));
    let light = light_record(number);
    let u = math_u32_to_unit(shift + AIRLIGHT_TURN * number);
    let node = rule_node(segment, i, u, airlight_foot(light, air));
    if !node.found { return aim; }
    let position = air.origin + air.direction * math_clamp_number(node.t - air.lead, 0.0f, reach);
    let s = light_sample(light, position, vec2(0.0f));
    if !s.found { return aim; }
    let vertex = vertex_in(position, -air.direction, medium.g);
    let phase = phase_eval(medium.g, -air.direction, s.wi);
    // As if the light had been picked for certain.
    let brings = s.contribution * scene_float(light + LIGHT_PMF);
    let left = air.left * medium_transmittance(medium, airlight_ray(air), air.lead, node.t);
    aim.carried = left * medium_sigma_s_at(medium, position) * phase * brings * node.weight;
    aim.found = !math_is_zero3(aim.carried) && math_is_finite3(aim.carried);
    aim.ray = vertex_towards(vertex, s);
    aim.length = vertex_distance(vertex, s);
    return aim;
}
