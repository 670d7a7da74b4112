// Photons as they leave a light. `sphere` is the scene's bounding sphere: its centre, and its radius.
//: use light
//: use math::consts
//: use math::roots
//: use math::trig

struct Emission { ray: Ray, flux: vec3<f32> }

fn emit_is_point_like(light: u32) -> bool { return scene_word(light) <= LIGHT_DIRECTIONAL; }

fn emit_toward(light: u32, p: vec3<f32>) -> vec3<f32> {
    if scene_word(light) == LIGHT_DIRECTIONAL { return -light_float3(light + LIGHT_NORMAL); }
    return math_normalize_or(light_float3(light + LIGHT_PLACE) - p, vec3(0.0f));
}

fn emit_spot_solid_angle(params: vec2<f32>) -> f32 {
    return TAU * ((1.0f - params.y) + 0.5f * (params.y - params.x));
}

fn emit_flux(light: u32, radius: f32) -> vec3<f32> {
    let kind = scene_word(light);
    let radiance = light_float3(light + LIGHT_RADIANCE);
    if kind == LIGHT_POINT { return radiance * (2.0f * TAU); }
    if kind == LIGHT_SPOT { return radiance * emit_spot_solid_angle(light_params(light)); }
    if kind == LIGHT_DIRECTIONAL { return radiance * (PI * radius * radius); }
    if kind == LIGHT_ENVIRONMENT { return light_float3(light + LIGHT_EDGE1) * (PI * radius * radius); }
    return radiance * (PI * scene_float(light + LIGHT_AREA));
}

fn emit_environment_flux(radiance: vec3<f32>, radius: f32) -> vec3<f32> {
    return radiance * (PI * (2.0f * TAU * radius * radius));
}

fn emit_invert_smoothstep(y: f32) -> f32 {
    var x = math_cbrt(y);
    for (var i = 0u; i < 4u; i++) {
        let x2 = x * x;
        let slope = x2 * (6.0f - 4.0f * x);
        let over = x2 * x * (2.0f - x) - y;
        if slope > 0.0f { x -= over / slope; }
    }
    return math_clamp_number(x, 0.0f, 1.0f);
}

fn emit_sample_spot(axis: vec3<f32>, params: vec2<f32>, u: vec2<f32>) -> vec3<f32> {
    let cone = params.x;
    let full = params.y;
    let inner = 1.0f - full;
    let ring = 0.5f * (full - cone);
    let at = u.x * (inner + ring);
    var one_minus_cos = math_min_number(at, inner);
    if !(at < inner || ring <= 0.0f) {
        let rest = ((inner + ring) - at) / ring;
        one_minus_cos = (1.0f - cone)
            - (full - cone) * emit_invert_smoothstep(math_clamp_number(rest, 0.0f, 1.0f));
    }
    let sin = sqrt(math_max_number(one_minus_cos * (2.0f - one_minus_cos), 0.0f));
    let turn = math_sin_cos(TAU * u.y);
    let basis = math_orthonormal_basis(axis);
    return basis.t * (sin * turn.c) + basis.b * (sin * turn.s) + axis * (1.0f - one_minus_cos);
}

fn emit_pdf_direction(light: u32, out: vec3<f32>, normal: vec3<f32>) -> f32 {
    let kind = scene_word(light);
    if kind == LIGHT_POINT { return 1.0f / (2.0f * TAU); }
    if kind == LIGHT_SPOT {
        let params = light_params(light);
        let axis = light_float3(light + LIGHT_EDGE1);
        return light_spot_falloff(math_dot(out, axis), params) / emit_spot_solid_angle(params);
    }
    return math_max_number(math_dot(out, normal), 0.0f) * (1.0f / PI);
}

fn emit_from_infinity(travel: vec3<f32>, sphere: vec4<f32>, u: vec2<f32>) -> Ray {
    let d = warp_sample_disk(u);
    let basis = math_orthonormal_basis(travel);
    let radius = sphere.w;
    let origin = sphere.xyz + (basis.t * d.x + basis.b * d.y) * radius
        - travel * (radius * (1.0f + 1.0f / 1024.0f));
    return Ray(origin, travel, MAX_FLOAT);
}

fn emit_from_surface(light: u32, position: vec3<f32>, normal: vec3<f32>, u: vec2<f32>) -> Ray {
    let local = warp_sample_cosine_hemisphere(u);
    let basis = math_orthonormal_basis(normal);
    let direction = basis.t * local.x + basis.b * local.y + normal * local.z;
    let start = SurfacePoint(position, light_extent(light));
    return Ray(geometry_offset_origin(start, normal, direction), direction, MAX_FLOAT);
}

fn emit_ray(light: u32, sphere: vec4<f32>, u: vec4<f32>) -> Ray {
    let kind = scene_word(light);
    let at = light_float3(light + LIGHT_PLACE);
    let normal = light_float3(light + LIGHT_NORMAL);
    let place = u.xy;
    let way = u.zw;
    if kind == LIGHT_POINT { return Ray(at, warp_sample_sphere(place), MAX_FLOAT); }
    if kind == LIGHT_SPOT {
        let axis = light_float3(light + LIGHT_EDGE1);
        return Ray(at, emit_sample_spot(axis, light_params(light), place), MAX_FLOAT);
    }
    if kind == LIGHT_DIRECTIONAL { return emit_from_infinity(normal, sphere, place); }
    if kind == LIGHT_ENVIRONMENT { return emit_from_infinity(warp_sample_sphere(place), sphere, way); }
    if kind == LIGHT_TRIANGLE || kind == LIGHT_PARALLELOGRAM {
        var b = place;
        if kind == LIGHT_TRIANGLE { b = warp_sample_triangle(place).yz; }
        let point = at + light_float3(light + LIGHT_EDGE1) * b.x + light_float3(light + LIGHT_EDGE2) * b.y;
        return emit_from_surface(light, point, normal, way);
    }
    let radius = light_params(light).x;
    if kind == LIGHT_DISK {
        let d = warp_sample_disk(place);
        let basis = math_orthonormal_basis(normal);
        return emit_from_surface(light, at + (basis.t * d.x + basis.b * d.y) * radius, normal, way);
    }
    let out = warp_sample_sphere(place);
    return emit_from_surface(light, at + out * radius, out, way);
}

fn emit_emit(light: u32, sphere: vec4<f32>, u: vec4<f32>) -> Emission {
    return Emission(emit_ray(light, sphere, u), emit_flux(light, sphere.w));
}

fn emit_emit_environment(radiance: vec3<f32>, sphere: vec4<f32>, u: vec4<f32>) -> Emission {
    let travel = warp_sample_sphere(u.xy);
    return Emission(emit_from_infinity(travel, sphere, u.zw), emit_environment_flux(radiance, sphere.w));
}

//: if ENVIRONMENT_MAP
// A photon of the picture of an environment, which there must be.
fn emit_picture(sphere: vec4<f32>, u: vec4<f32>) -> Emission {
    let s = environment_sample_units(u.xy, u.zw);
    var flux = vec3(0.0f);
    if s.pdf > 0.0f { flux = s.radiance * (PI * sphere.w * sphere.w / s.pdf); }
    return Emission(emit_from_infinity(-s.wi, sphere, u.zw), flux);
}
//: end
