// Photons between two hits, and at one.
//: use light::emit
//: use math::choice
//: use sampling::numbers
//: use transport::surface
//: if VOLUME
//: use medium
//: use medium::inside
//: use medium::phase
//: use transport::volume::boundaries
//: use transport::volume::way
//: end

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
    //: if VOLUME
    way: PhotonWay,
    //: end
}

//: if VOLUME
// What a photon flies through: the media in which its ray starts, those beyond the surface on which it has landed, what lies between the surface that it left and the
// start of its ray; then a name of its numbers, the chance to have come straight from its light, the channel of one that was refracted by its colour
// (counted from 1, 0 where it has all), and boundaries crossed.
struct PhotonWay {
    inside: Inside,
    beyond: Inside,
    lead: f32,
    event: u32,
    chance: f32,
    channel: u32,
    crossed: u32,
}
//: end

fn photon_new(ray: Ray, flux: vec3<f32>) -> Photon {
    var photon: Photon;
    photon.flux = flux;
    photon.ray = ray;
    photon.light = NO_INDEX;
    photon.registers_first = true;
    //: if VOLUME
    photon.way.chance = 1.0f;
    //: end
    return photon;
}

// What entry `index` of what emits sends out, and whether that is a light without size.
struct PhotonEmitted { emission: Emission, point_like: bool }

fn photon_emit_entry(index: u32, sphere: vec4<f32>, u: vec4<f32>) -> PhotonEmitted {
    //: if VOLUME
    if index > scene_at.light_count { return PhotonEmitted(photon_glow(index - scene_at.light_count - 1u, u), false); }
    //: end
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

//: if VOLUME
// The channel of a photon whose colours part: its own already, or one drawn by `u`, which from here on stands for all three.
fn photon_choose_colour(photon: ptr<function, Photon>, u: f32) -> u32 {
    if (*photon).way.channel == 0u {
        let channel = min(u32(3.0f * u), 2u);
        (*photon).way.channel = channel + 1u;
        (*photon).flux = select(vec3(0.0f), 3.0f * (*photon).flux, vec3(0u, 1u, 2u) == vec3(channel));
    }
    return (*photon).way.channel - 1u;
}

fn photon_leave(photon: ptr<function, Photon>, surface: Surface, u: vec2<f32>, lobe_in: f32) -> PhotonLeaves {
    var lobes = surface.lobes;
    var lobe = lobe_in;
    //: if LOBES
    if lobes_disperses(lobes) {
        // The colour is a third of the number, and what is left of that as good as new.
        let channel = photon_choose_colour(photon, lobe);
        lobe = 3.0f * lobe - f32(u32(3.0f * lobe));
        lobes = lobes_of_channel(lobes, channel);
    }
    //: end
    let n = surface.shading;
    let wo = surface.wo;
    let s = lobes_sample(lobes, n, wo, u, lobe);
    var leaves = PhotonLeaves(s.found, s.wi, s.weight, s.pdf == 0.0f);
    if !s.found { return leaves; }
    let there = math_dot(s.wi, surface.geometric);
    let here = math_dot(wo, surface.geometric);
    // Below both normals, or above both.
    let apart = (there > 0.0f) != (math_dot(s.wi, n) > 0.0f);
    if apart || (there <= 0.0f && !lobes_transmits(lobes)) {
        leaves.found = false;
        return leaves;
    }
    if there < 0.0f { (*photon).way.inside = (*photon).way.beyond; }
    let origin = geometry_offset_origin(surface.point, surface.geometric, s.wi);
    (*photon).way.lead = way_lead(surface.point.position, surface.geometric, origin, s.wi);
    (*photon).way.crossed = 0u;
    let down = here * math_dot(s.wi, n);
    let turned = math_min_number(math_abs(math_dot(wo, n) * there / down), 16.0f);
    leaves.weight = s.weight * lobes_index_ratio_squared(lobes, n, wo, s.wi) * turned;
    return leaves;
}
//: else
fn photon_leave(photon: ptr<function, Photon>, surface: Surface, u: vec2<f32>, lobe: f32) -> PhotonLeaves {
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
//: end

// Sends a photon on from a surface; the chance with which it should survive. 0: it ends.
fn photon_scatter(photon: ptr<function, Photon>, surface: Surface, u: vec2<f32>, lobe: f32, max_hits: u32) -> f32 {
    (*photon).hits += 1u;
    if (*photon).hits >= max_hits { return 0.0f; }
    let leaves = photon_leave(photon, surface, u, lobe);
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
