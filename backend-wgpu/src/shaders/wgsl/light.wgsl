// Lights as seen from a point. A light is `LIGHT_WORDS` words of the arena (core's `LightRecord`); functions take where they begin.
// Those that ask the scene read `scene_at.lights`, `scene_at.light_count`, `scene_at.light_cumulative`, `scene_at.environment` (three
// floats) and, with `ENVIRONMENT_MAP`, the picture (see its file).
//: use geometry::surface
//: use math::bits
//: use math::choice
//: use math::consts
//: use math::roots
//: use math::vector
//: use sampling::discrete
//: use sampling::warp
//: use scene::counts
//: if ENVIRONMENT_MAP
//: use light::environment
//: use transport::mis
//: end

const LIGHT_WORDS: u32 = 24u;
const LIGHT_PMF: u32 = 2u;
const LIGHT_AREA: u32 = 3u;
const LIGHT_PLACE: u32 = 4u;
const LIGHT_PARAMS: u32 = 7u;
const LIGHT_RADIANCE: u32 = 12u;
const LIGHT_EDGE1: u32 = 15u;
const LIGHT_EDGE2: u32 = 18u;
const LIGHT_NORMAL: u32 = 21u;

const LIGHT_POINT: u32 = 0u;
const LIGHT_SPOT: u32 = 1u;
const LIGHT_DIRECTIONAL: u32 = 2u;
const LIGHT_TRIANGLE: u32 = 3u;
const LIGHT_PARALLELOGRAM: u32 = 4u;
const LIGHT_SPHERE: u32 = 5u;
const LIGHT_DISK: u32 = 6u;
const LIGHT_ENVIRONMENT: u32 = 7u;

fn light_float3(at: u32) -> vec3<f32> {
    return vec3(scene_float(at), scene_float(at + 1u), scene_float(at + 2u));
}

// Where a light of the scene begins.
fn light_record(index: u32) -> u32 { return scene_at.lights + LIGHT_WORDS * index; }

fn light_radiance(light: u32) -> vec3<f32> { return light_float3(light + LIGHT_RADIANCE); }

fn light_params(light: u32) -> vec2<f32> {
    return vec2(scene_float(light + LIGHT_PARAMS), scene_float(light + LIGHT_PARAMS + 1u));
}

// A density of 0 marks a light without size; `found` is false where the light sends nothing.
struct LightSample {
    found: bool,
    distant: bool,
    pdf: f32,
    extent: f32,
    wi: vec3<f32>,
    contribution: vec3<f32>,
    point: vec3<f32>,
    normal: vec3<f32>,
}

fn light_nothing() -> LightSample {
    let zero = vec3(0.0f);
    return LightSample(false, false, 0.0f, 0.0f, zero, zero, zero, zero);
}

fn light_spot_falloff(cos: f32, params: vec2<f32>) -> f32 {
    let cone = params.x;
    let full = params.y;
    if cos >= full { return 1.0f; }
    if cos <= cone { return 0.0f; }
    let x = (cos - cone) / (full - cone);
    return x * x * (3.0f - 2.0f * x);
}

fn light_extent(light: u32) -> f32 {
    let kind = scene_word(light);
    if kind == LIGHT_SPHERE || kind == LIGHT_DISK { return light_params(light).x; }
    let e1 = math_abs3(light_float3(light + LIGHT_EDGE1));
    let e2 = math_abs3(light_float3(light + LIGHT_EDGE2));
    return math_max_number(math_max_component(e1), math_max_component(e2));
}

fn light_surface_sample(light: u32, p: vec3<f32>, point: vec3<f32>, normal: vec3<f32>) -> LightSample {
    let to = point - p;
    let d2 = math_dot(to, to);
    if !(d2 >= MIN_POSITIVE && d2 <= MAX_FLOAT) { return light_nothing(); }
    let wi = to / sqrt(d2);
    let cos = -math_dot(wi, normal);
    if cos <= 0.0f { return light_nothing(); }
    let pmf = scene_float(light + LIGHT_PMF);
    let area = scene_float(light + LIGHT_AREA);
    let pdf = pmf * d2 / (area * cos);
    let contribution = light_radiance(light) * (area * cos / (d2 * pmf));
    let found = pdf > 0.0f && pdf <= MAX_FLOAT && math_is_finite3(contribution);
    return LightSample(found, false, pdf, light_extent(light), wi, contribution, point, normal);
}

fn light_cone_of_sphere(r: f32, d2: f32) -> f32 {
    return warp_one_minus_cos_of_sin_squared(math_min_number(r * r / d2, 1.0f));
}

fn light_cone_density(one_minus_cos_max: f32) -> f32 { return 1.0f / (TAU * one_minus_cos_max); }

fn light_sample_sphere(light: u32, p: vec3<f32>, u: vec2<f32>) -> LightSample {
    let center = light_float3(light + LIGHT_PLACE);
    let r = light_params(light).x;
    let to = center - p;
    let d2 = math_dot(to, to);
    if !(d2 > r * r && d2 <= MAX_FLOAT) { return light_nothing(); }
    let one_minus_cos_max = light_cone_of_sphere(r, d2);
    let local = warp_sample_cone(u, one_minus_cos_max);
    let axis = to / sqrt(d2);
    let basis = math_orthonormal_basis(axis);
    let wi = basis.t * local.x + basis.b * local.y + axis * local.z;
    let foot = math_dot(to, wi);
    let off = to - wi * foot;
    let half = sqrt(math_max_number(r * r - math_dot(off, off), 0.0f));
    let point = p + wi * math_max_number(foot - half, 0.0f);
    let normal = math_normalize_or(point - center, vec3(0.0f));
    let pdf = scene_float(light + LIGHT_PMF) * light_cone_density(one_minus_cos_max);
    let contribution = light_radiance(light) * (1.0f / pdf);
    return LightSample(pdf > 0.0f && pdf <= MAX_FLOAT, false, pdf, r, wi, contribution, point, normal);
}

// A place on one light as seen from `p`; the density includes the light's pick probability.
fn light_sample(light: u32, p: vec3<f32>, u: vec2<f32>) -> LightSample {
    let kind = scene_word(light);
    if kind == LIGHT_SPHERE { return light_sample_sphere(light, p, u); }
    if kind == LIGHT_ENVIRONMENT { return light_nothing(); }
    let radiance = light_radiance(light);
    let at = light_float3(light + LIGHT_PLACE);
    let normal = light_float3(light + LIGHT_NORMAL);
    let pmf = scene_float(light + LIGHT_PMF);
    if kind == LIGHT_PARALLELOGRAM || kind == LIGHT_TRIANGLE || kind == LIGHT_DISK {
        var point: vec3<f32>;
        if kind == LIGHT_DISK {
            let d = warp_sample_disk(u);
            let basis = math_orthonormal_basis(normal);
            point = at + (basis.t * d.x + basis.b * d.y) * light_params(light).x;
        } else {
            var b = u;
            if kind == LIGHT_TRIANGLE { b = warp_sample_triangle(u).yz; }
            point = at + light_float3(light + LIGHT_EDGE1) * b.x + light_float3(light + LIGHT_EDGE2) * b.y;
        }
        return light_surface_sample(light, p, point, normal);
    }
    if kind == LIGHT_DIRECTIONAL {
        return LightSample(true, true, 0.0f, 0.0f, -normal, radiance * (1.0f / pmf), p, vec3(0.0f));
    }
    let to = at - p;
    let d2 = math_dot(to, to);
    if !(d2 >= MIN_POSITIVE && d2 <= MAX_FLOAT) { return light_nothing(); }
    let wi = to / sqrt(d2);
    var falloff = 1.0f;
    if kind == LIGHT_SPOT {
        falloff = light_spot_falloff(-math_dot(wi, light_float3(light + LIGHT_EDGE1)), light_params(light));
    }
    let contribution = radiance * (falloff / (d2 * pmf));
    let found = falloff > 0.0f && math_is_finite3(contribution);
    return LightSample(found, false, 0.0f, 0.0f, wi, contribution, at, vec3(0.0f));
}

// Density with which `light_sample_lights` draws a direction that meets a surface light at a distance, where its normal is `normal`.
fn light_pdf_solid_angle(light: u32, p: vec3<f32>, wi: vec3<f32>, distance: f32, normal: vec3<f32>) -> f32 {
    let pmf = scene_float(light + LIGHT_PMF);
    if scene_word(light) == LIGHT_SPHERE {
        let to = light_float3(light + LIGHT_PLACE) - p;
        let r = light_params(light).x;
        let d2 = math_dot(to, to);
        if d2 > r * r { return pmf * light_cone_density(light_cone_of_sphere(r, d2)); }
        return 0.0f;
    }
    let area = scene_float(light + LIGHT_AREA);
    let cos = -math_dot(wi, normal);
    if cos > 0.0f && area > 0.0f {
        return math_min_number(pmf * distance * distance / (area * cos), MAX_FLOAT);
    }
    return 0.0f;
}

//: if ENVIRONMENT_MAP
fn light_sample_environment(light: u32, p: vec3<f32>, words: vec2<u32>) -> LightSample {
    if !environment_is_there() { return light_nothing(); }
    let s = environment_sample(words);
    let pdf = s.pdf * scene_float(light + LIGHT_PMF);
    let contribution = s.radiance / pdf;
    let found = pdf > 0.0f && pdf <= MAX_FLOAT && math_is_finite3(contribution);
    return LightSample(found, true, pdf, 0.0f, s.wi, contribution, p, vec3(0.0f));
}

fn light_pictured(direction: vec3<f32>, pdf: f32, share: f32) -> vec3<f32> {
    let met = environment_meet(direction);
    if pdf > 0.0f {
        let pmf = scene_float(light_record(scene_at.environment_light) + LIGHT_PMF);
        return met.radiance * mis_power_heuristic(pdf, met.pdf * pmf * share);
    }
    return met.radiance;
}
//: end

// As `light_sample`, by two full words, and pictures of environments too.
fn light_sample_light(light: u32, p: vec3<f32>, words: vec2<u32>) -> LightSample {
    //: if ENVIRONMENT_MAP
    if scene_word(light) == LIGHT_ENVIRONMENT { return light_sample_environment(light, p, words); }
    //: end
    return light_sample(light, p, vec2(math_u32_to_unit(words.x), math_u32_to_unit(words.y)));
}

// Picks a light of the scene, and a place on it.
fn light_sample_lights(p: vec3<f32>, words: vec3<u32>) -> LightSample {
    if scene_at.light_count == 0u { return light_nothing(); }
    var index = 0u;
    if scene_at.light_count > 1u {
        counts_at = scene_at.light_cumulative;
        index = discrete_pick_in(scene_at.light_count, words.x).index;
    }
    return light_sample_light(light_record(index), p, words.yz);
}

// Radiance that arrives along a ray that leaves the scene, drawn with density `pdf` (0: nothing competed with it).
fn light_escaped(direction: vec3<f32>, pdf: f32, share: f32) -> vec3<f32> {
    let uniform_ = light_float3(scene_at.environment);
    //: if ENVIRONMENT_MAP
    if environment_is_there() { return uniform_ + light_pictured(direction, pdf, share); }
    //: end
    return uniform_;
}

fn light_within(p: SurfacePoint, distance: f32) -> SurfacePoint {
    return SurfacePoint(p.position, math_max_number(p.extent, distance));
}

fn light_shadow_ray(s: LightSample, start: SurfacePoint, ng: vec3<f32>) -> Ray {
    if s.distant { return Ray(geometry_offset_origin(start, ng, s.wi), s.wi, MAX_FLOAT); }
    let to = s.point - start.position;
    let distance = sqrt(math_dot(to, to));
    let origin = geometry_offset_origin(light_within(start, distance), ng, s.wi);
    var end = s.point;
    if !math_is_zero3(s.normal) {
        end = geometry_offset_origin(light_within(SurfacePoint(s.point, s.extent), distance), s.normal, -s.wi);
    }
    return geometry_segment(origin, end);
}
