// What tracers that go back from the sensor share: what is asked, the roulette, emission that is met, colours that part.
//: use transport::surface
//: use transport::mis
//: use light
//: use sampling::sobol
//: use math::consts

const QUERY_DONE: u32 = 0u;
const QUERY_CLOSEST: u32 = 1u;
const QUERY_SHADOW: u32 = 2u;
// Another step without a ray.
const QUERY_NOTHING: u32 = 4u;

const ROULETTE_FROM: u32 = 5u;
const SURVIVAL_MAX: f32 = 0.95f;

struct Played { survives: bool, throughput: vec3<f32> }

// Throughput after a scattering that multiplies it by `weight`, if the path survives. `depth`: edges before it.
fn back_play(throughput: vec3<f32>, weight: vec3<f32>, depth: u32, survive: f32) -> Played {
    let after = throughput * weight;
    if depth + 1u < ROULETTE_FROM { return Played(!math_is_zero3(after), after); }
    let q = math_min_number(math_max_component(weight), SURVIVAL_MAX);
    return Played(survive < q, after / q);
}

// A front that is part of a light.
fn back_is_lit(surface: Surface) -> bool {
    return surface.light < scene_at.light_count && surface.from_front;
}

struct MetEmission { met: vec3<f32>, weight: f32 }

// Radiance that a lit surface sends back along a ray, and its weight against light sampling at `vertex`, where the direction was drawn
// with density `pdf` (0: nothing competed with it); `t` is counted from there, and `share` is by how much that sampling picks its light more often.
fn back_emission(
    surface: Surface, direction: vec3<f32>, t: f32, vertex: vec3<f32>, pdf: f32, share: f32,
) -> MetEmission {
    let light = scene_at.lights + LIGHT_WORDS * surface.light;
    var weight = 1.0f;
    if pdf > 0.0f {
        let other = light_pdf_solid_angle(light, vertex, direction, t, surface.front);
        weight = mis_power_heuristic(pdf, other * share);
    }
    return MetEmission(light_float3(light + LIGHT_RADIANCE), weight);
}

// What a path carries from where its colours part: one of them, which stands for all three.
fn back_one_colour(carried: vec3<f32>, channel: u32) -> vec3<f32> {
    return select(vec3(0.0f), 3.0f * carried, vec3(0u, 1u, 2u) == vec3(channel));
}
