// Boundaries that light passes: smooth dielectrics, and panes.
//: use bsdf::fresnel
//: use bsdf::phong

const INTERFACE_OPAQUE: u32 = 0u;
const INTERFACE_DIELECTRIC: u32 = 1u;
const INTERFACE_PANE: u32 = 2u;

// `first`: the ratio of indices of a dielectric, what a pane reflects; `second`: what a pane lets through.
struct Interface { kind: u32, schlick: bool, first: vec3<f32>, second: vec3<f32> }

struct Passage { found: bool, through: bool, wi: vec3<f32>, weight: vec3<f32> }

fn interface_opaque() -> Interface { return Interface(INTERFACE_OPAQUE, false, vec3(0.0f), vec3(0.0f)); }

fn interface_dielectric(ratio: vec3<f32>, schlick: bool) -> Interface {
    return Interface(INTERFACE_DIELECTRIC, schlick, ratio, vec3(0.0f));
}

fn interface_pane(reflect: vec3<f32>, transmit: vec3<f32>) -> Interface {
    return Interface(INTERFACE_PANE, false, reflect, transmit);
}

fn interface_plate_one(cos: f32, ior: f32, schlick: bool) -> f32 {
    let r = fresnel_reflectance(cos, ior, schlick);
    return 2.0f * r / (1.0f + r);
}

fn interface_plate(cos: f32, ior: vec3<f32>, schlick: bool) -> Interface {
    let reflect = vec3(
        interface_plate_one(cos, ior.x, schlick),
        interface_plate_one(cos, ior.y, schlick),
        interface_plate_one(cos, ior.z, schlick),
    );
    return interface_pane(reflect, vec3(1.0f) - reflect);
}

fn interface_disperses(interface_: Interface) -> bool {
    let ratio = interface_.first;
    return interface_.kind == INTERFACE_DIELECTRIC && (ratio.x != ratio.y || ratio.x != ratio.z);
}

// What passes straight on, and the chance to choose that.
struct Straight { found: bool, transmit: vec3<f32>, chance: f32 }

fn interface_straight(interface_: Interface) -> Straight {
    if interface_.kind != INTERFACE_PANE { return Straight(false, vec3(0.0f), 0.0f); }
    let r = math_mean(interface_.first);
    let t = math_mean(interface_.second);
    var chance = 0.0f;
    if t > 0.0f { chance = t / (r + t); }
    return Straight(true, interface_.second, chance);
}

fn interface_pass(interface_: Interface, n: vec3<f32>, wo: vec3<f32>, channel: u32, u: f32) -> Passage {
    let nothing = Passage(false, false, vec3(0.0f), vec3(0.0f));
    if interface_.kind == INTERFACE_DIELECTRIC {
        let ratio = math_component(interface_.first, channel % 3u);
        let cos = math_clamp_number(math_dot(wo, n), 0.0f, 1.0f);
        if u < fresnel_reflectance(cos, ratio, interface_.schlick) {
            return Passage(true, false, phong_mirror_direction(n, wo), vec3(1.0f));
        }
        let refracted = fresnel_refract(n, wo, ratio);
        if !refracted.found { return nothing; }
        return Passage(true, true, refracted.wi, vec3(1.0f / (ratio * ratio)));
    }
    if interface_.kind == INTERFACE_PANE {
        let r = math_mean(interface_.first);
        let t = math_mean(interface_.second);
        if r + t <= 0.0f { return nothing; }
        let chance = r / (r + t);
        if u < chance { return Passage(true, false, phong_mirror_direction(n, wo), interface_.first / chance); }
        return Passage(true, true, -wo, interface_.second / (1.0f - chance));
    }
    return nothing;
}
