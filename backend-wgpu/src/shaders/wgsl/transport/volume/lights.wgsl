// What comes straight from a light to a place, and which media a point lies in: ways that are followed within one invocation.
//: use medium::crossed
//: use transport::volume::boundaries
//: use transport::volume::way
//: use tree::walk
//: if LOBES
//: use bsdf::interface
//: end

// Back to the light, for the media that the way starts in; along the way, for what is left of the light; out of the scene, for the media of a point.
const LIGHTS_BACK: u32 = 0u;
const LIGHTS_FORWARD: u32 = 1u;
const LIGHTS_OUT: u32 = 2u;

// `left` is 0 where the light is hidden; `chance`: that of a walk to have come through; the media in which it arrives; rays that it took.
struct FromLight { left: vec3<f32>, chance: f32, inside: Inside, rays: u32 }

fn lights_out_direction() -> vec3<f32> {
    return math_normalize_or(vec3(0.35271f, 0.80311f, -0.48017f), vec3(0.0f, 1.0f, 0.0f));
}

// `phase`: LIGHTS_BACK along the ray from a place with this normal to a light in these media; or LIGHTS_OUT, the media at the ray's origin alone. Hidden
// places look for their media where `looks_out`.
fn lights_follow(
    phase_in: u32, given: Ray, at_light: Inside, outside: Inside, position: vec3<f32>, normal: vec3<f32>, looks_out: bool,
) -> FromLight {
    var out = FromLight(vec3(0.0f), 0.0f, vec3(0u), 0u);
    var phase = phase_in;
    let way = way_with_unit_direction(given);
    let before = way_lead(position, normal, way.origin, way.direction);
    var ray = way;
    if phase == LIGHTS_OUT { ray = Ray(given.origin, lights_out_direction(), MAX_FLOAT); }
    var crossings = crossed_nothing();
    var lead = before;
    var left = 0.0f;
    var through = vec3(1.0f);
    var chance = 1.0f;
    var crossed = 0u;
    var inside = vec3(0u);
    var free = false;
    var going = true;
    while going {
        var hit = Hit(0.0f, TREE_NOTHING, 0.0f, 0.0f);
        if !free {
            hit = tree_closest(ray);
            if phase != LIGHTS_OUT { out.rays += 1u; }
        }
        free = false;
        let missed = hit.primitive == TREE_NOTHING;
        var length = left;
        if phase == LIGHTS_FORWARD {
            if !missed { length = lead + hit.t; }
            let record = inside_current(inside);
            if record != MEDIUM_NONE {
                let part = medium_transmittance(medium_new(record), ray, lead, length);
                through *= part;
                chance *= math_mean(part);
            }
        }
        // What is met, and whether it lets the way go on.
        var here: Here;
        var surface: Surface;
        var goes_on = false;
        if !missed {
            here = boundaries_here(ray, hit, true);
            let passes = boundaries_passes(here.met.primitive);
            if phase == LIGHTS_OUT {
                surface = surface_at(ray, hit);
                goes_on = surface.found;
            } else {
                surface = surface_at(ray, here.met);
                goes_on = surface.found && passes;
                if phase == LIGHTS_FORWARD {
                    goes_on = goes_on && boundaries_passes(hit.primitive) && crossed < CROSSINGS_MAX;
                } else {
                    goes_on = goes_on && out.rays <= CROSSINGS_MAX;
                }
            }
        }
        if goes_on {
            let origin = geometry_offset_origin(surface.point, surface.geometric, ray.direction);
            crossed += 1u;
            if phase == LIGHTS_FORWARD {
                //: if LOBES
                let straight = interface_straight(surface.interface_);
                if straight.found {
                    through *= straight.transmit;
                    chance *= straight.chance;
                }
                //: end
                if ray.t_max < MAX_FLOAT { ray.t_max = ray.t_max - math_dot(origin - ray.origin, ray.direction); }
                lead = way_lead(surface.point.position, surface.geometric, origin, ray.direction);
                left = math_max(left - length, 0.0f);
                going = !math_is_zero3(through);
            } else {
                if ray.t_max < MAX_FLOAT {
                    ray.t_max = math_max(ray.t_max - math_dot(origin - ray.origin, ray.direction), 0.0f);
                }
                going = phase != LIGHTS_OUT || crossed < CROSSINGS_MAX;
            }
            for (var k = 0u; k < here.count; k++) {
                let front = ((here.fronts >> k) & 1u) != 0u;
                if phase == LIGHTS_FORWARD {
                    inside = inside_across(inside, here.crossed[k].y, front);
                } else {
                    crossings = crossed_before(crossings, here.crossed[k].y, !front);
                }
            }
            ray.origin = origin;
            if going { continue; }
        }
        if phase == LIGHTS_OUT {
            out.inside = crossed_by(crossings, outside);
            going = false;
        } else if phase == LIGHTS_FORWARD {
            if missed {
                out.left = through;
                out.chance = chance;
            }
            going = false;
        } else if missed {
            // One ray has found nothing on the way: it need not be asked again.
            free = out.rays == 1u;
            out.inside = crossed_by(crossings, at_light);
            inside = out.inside;
            phase = LIGHTS_FORWARD;
            crossed = 0u;
            ray = way;
            left = math_infinity();
            if way.t_max < MAX_FLOAT { left = before + way.t_max; }
        } else {
            going = looks_out;
            phase = LIGHTS_OUT;
            crossed = 0u;
            crossings = crossed_nothing();
            ray = Ray(way.origin, lights_out_direction(), MAX_FLOAT);
        }
    }
    return out;
}
