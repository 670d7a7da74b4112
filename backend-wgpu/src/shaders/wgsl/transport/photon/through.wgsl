// Photons on their way through media and through surfaces that light passes.
//: use transport::photon

//: if VOLUME
// The first of the groups of numbers for what happens between hits, two an event; and that of the direction of a photon that starts in a medium.
const PHOTON_EVENT_GROUP: u32 = 1048576u;
const PHOTON_GLOW_GROUP: u32 = PHOTON_EVENT_GROUP - 1u;

// What a flight came to.
const PHOTON_ENDS: u32 = 0u;
const PHOTON_GOES: u32 = 1u;
const PHOTON_LANDS: u32 = 5u;

// A photon that was sent on goes on, if it may, with the share that it has left of the flux before.
fn photon_on(photon: ptr<function, Photon>, before: vec3<f32>, survive: f32, max_hits: u32) -> u32 {
    (*photon).hits += 1u;
    (*photon).light = NO_INDEX;
    (*photon).way.crossed = 0u;
    if (*photon).hits >= max_hits { return PHOTON_ENDS; }
    let had = math_max_number(math_mean(before), MIN_POSITIVE);
    let chance = math_min_number(math_mean((*photon).flux) / had, PHOTON_SURVIVAL_MAX);
    if !(survive < chance) { return PHOTON_ENDS; }
    (*photon).flux = (*photon).flux / chance;
    return PHOTON_GOES;
}

// Straight on, beyond a boundary.
fn photon_pass(photon: ptr<function, Photon>, surface: Surface, beyond: Inside) -> u32 {
    (*photon).way.inside = beyond;
    let direction = (*photon).ray.direction;
    let origin = geometry_offset_origin(surface.point, surface.geometric, direction);
    (*photon).ray.origin = origin;
    (*photon).way.lead = way_lead(surface.point.position, surface.geometric, origin, direction);
    (*photon).way.crossed += 1u;
    if math_is_zero3((*photon).flux) || (*photon).way.crossed > CROSSINGS_MAX { return PHOTON_ENDS; }
    return PHOTON_GOES;
}

//: if LOBES
// Reflected at a dielectric or a pane, or on through it.
fn photon_meet_interface(
    photon: ptr<function, Photon>, surface: Surface, beyond: Inside, numbers: vec3<f32>, max_hits: u32,
) -> u32 {
    var channel = max((*photon).way.channel, 1u) - 1u;
    if interface_disperses(surface.interface_) { channel = photon_choose_colour(photon, numbers.y); }
    let passage = interface_pass(surface.interface_, surface.shading, surface.wo, channel, numbers.x);
    let there = math_dot(passage.wi, surface.geometric);
    let here = math_dot(surface.wo, surface.geometric);
    // An interpolated normal would send it to the wrong side.
    if !passage.found || (there < 0.0f) != passage.through { return PHOTON_ENDS; }
    let straight = interface_straight(surface.interface_);
    if passage.through && straight.found {
        (*photon).way.chance *= straight.chance;
        (*photon).flux *= passage.weight;
        return photon_pass(photon, surface, beyond);
    }
    let before = (*photon).flux;
    if passage.through {
        (*photon).way.inside = beyond;
    } else {
        (*photon).flux *= passage.weight;
    }
    let origin = geometry_offset_origin(surface.point, surface.geometric, passage.wi);
    (*photon).way.lead = way_lead(surface.point.position, surface.geometric, origin, passage.wi);
    let turned = math_dot(surface.wo, surface.shading) * there / (here * math_dot(passage.wi, surface.shading));
    (*photon).flux *= math_min_number(math_abs(turned), 16.0f);
    (*photon).ray = Ray(origin, passage.wi, MAX_FLOAT);
    return photon_on(photon, before, numbers.z, max_hits);
}
//: end

// A photon has flown up to a surface, or has met nothing; where it lands, `hit` is that.
fn photon_arrive(photon: ptr<function, Photon>, hit: ptr<function, Hit>, random: Numbers, max_hits: u32) -> u32 {
    let ray = (*photon).ray;
    let before = (*photon).flux;
    let group = PHOTON_EVENT_GROUP + 2u * (*photon).way.event;
    (*photon).way.event += 1u;
    let u = numbers_group4(random, group);
    let more = numbers_group4(random, group + 1u);
    let missed = (*hit).primitive == TREE_NOTHING;
    let record = inside_current((*photon).way.inside);
    if record != MEDIUM_NONE {
        let medium = medium_new(record);
        let lead = (*photon).way.lead;
        var limit = lead + (*hit).t;
        if missed { limit = math_infinity(); }
        let flown = medium_fly(medium, ray, lead, limit, before, u.xy);
        (*photon).way.chance *= math_mean(flown.left);
        (*photon).flux *= flown.weight;
        if flown.collided {
            let position = ray.origin + ray.direction * (flown.length - lead);
            (*photon).way.lead = 0.0f;
            (*photon).flux *= medium_sigma_s_at(medium, position);
            (*photon).ray = Ray(position, phase_sample(medium.g, -ray.direction, u.zw), MAX_FLOAT);
            (*photon).caustic = false;
            return photon_on(photon, before, more.z, max_hits);
        }
    }
    if missed { return PHOTON_ENDS; }
    let resolved = boundaries_resolve(ray, *hit, (*photon).way.inside);
    *hit = resolved.hit;
    let surface = surface_at(ray, resolved.hit);
    if !surface.found { return PHOTON_ENDS; }
    if (surface_flags(resolved.hit.primitive) & MATERIAL_NULL) != 0u {
        return photon_pass(photon, surface, resolved.inside);
    }
    //: if LOBES
    if surface.interface_.kind != INTERFACE_OPAQUE {
        return photon_meet_interface(photon, surface, resolved.inside, more.xyz, max_hits);
    }
    //: end
    (*photon).way.beyond = resolved.inside;
    return PHOTON_LANDS;
}
//: end
