// Photons between two hits, and at one.
//: use light::emit
//: use math::choice
//: use sampling::numbers
//: use transport::surface

const PHOTON_SURVIVAL_MAX: f32 = 0.95f;
const PHOTON_START_GROUP: u32 = 0u;
const PHOTON_PICK_GROUP: u32 = 1u;
const PHOTON_WALK_GROUP: u32 = 2u;

struct Photon {
    flux: vec3<f32>,
    ray: Ray,
    hits: u32,
    // The light from which it comes straight, where its first hit must be weighed.
    light: u32,
    registers_first: bool,
    caustic: bool,
    survives_first: bool,
}

fn photon_new(ray: Ray, flux: vec3<f32>) -> Photon {
    return Photon(flux, ray, 0u, NO_INDEX, true, false, false);
}

// What entry `index` of what emits sends out, and whether that is a light without size.
struct PhotonEmitted { emission: Emission, point_like: bool }

fn photon_emit_entry(index: u32, sphere: vec4<f32>, u: vec4<f32>) -> PhotonEmitted {
    if index >= scene_at.light_count {
        return PhotonEmitted(emit_emit_environment(light_float3(scene_at.environment), sphere, u), false);
    }
    let light = light_record(index);
    //: if ENVIRONMENT_MAP
    if scene_word(light) == LIGHT_ENVIRONMENT { return PhotonEmitted(emit_picture(sphere, u), false); }
    //: end
    return PhotonEmitted(emit_emit(light, sphere, u), emit_is_point_like(light));
}

// A direction in which flux leaves, what it is multiplied by, and whether a mirror sends it there.
struct PhotonLeaves { found: bool, wi: vec3<f32>, weight: vec3<f32>, mirrored: bool }

fn photon_leave(surface: Surface, u: vec2<f32>, lobe: f32) -> PhotonLeaves {
    let s = lobes_sample(surface.lobes, surface.shading, surface.wo, u, lobe);
    var leaves = PhotonLeaves(s.found, s.wi, s.weight, s.pdf == 0.0f);
    //: if SHADING
    let before = math_dot(surface.wo, surface.geometric);
    let after = math_dot(s.wi, surface.geometric);
    let down = before * math_dot(s.wi, surface.shading);
    var factor = 0.0f;
    if down > 0.0f {
        factor = math_clamp_number(math_dot(surface.wo, surface.shading) * after / down, 0.0f, 16.0f);
    }
    leaves.weight = s.weight * factor;
    leaves.found = s.found && !(after <= 0.0f);
    //: end
    return leaves;
}

// Sends a photon on from a surface; the chance with which it should survive. 0: it ends.
fn photon_scatter(photon: ptr<function, Photon>, surface: Surface, u: vec2<f32>, lobe: f32, max_hits: u32) -> f32 {
    (*photon).hits += 1u;
    if (*photon).hits >= max_hits { return 0.0f; }
    let leaves = photon_leave(surface, u, lobe);
    if !leaves.found { return 0.0f; }
    //: if LOBES
    (*photon).caustic = (*photon).caustic && leaves.mirrored;
    //: else
    (*photon).caustic = false;
    //: end
    let before = math_abs(math_mean((*photon).flux));
    let after = (*photon).flux * leaves.weight;
    (*photon).flux = after;
    let origin = geometry_offset_origin(surface.point, surface.geometric, leaves.wi);
    (*photon).ray = Ray(origin, leaves.wi, MAX_FLOAT);
    let carried = math_abs(math_mean(after));
    if (*photon).hits == 1u && (*photon).survives_first { return select(0.0f, 1.0f, carried > 0.0f); }
    return math_min_number(carried / math_max_number(before, MIN_POSITIVE), PHOTON_SURVIVAL_MAX);
}
