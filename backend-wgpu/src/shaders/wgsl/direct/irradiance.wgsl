// Direct irradiance of lights without size.
//: use light::emit
//: use transport::surface

struct DirectLight { found: bool, irradiance: vec3<f32>, ray: Ray }

// What a light brings to a point where nothing is in the way, and the ray that must be free.
fn irradiance_from_light(light: u32, point: SurfacePoint, n: vec3<f32>) -> DirectLight {
    var direct: DirectLight;
    if !emit_is_point_like(light) { return direct; }
    let s = light_sample(light, point.position, vec2(0.0f));
    if !s.found { return direct; }
    let cos = math_dot(s.wi, n);
    let side = select(n, -n, cos < 0.0f);
    direct.irradiance = s.contribution * (scene_float(light + LIGHT_PMF) * math_abs(cos));
    if math_is_zero3(direct.irradiance) { return direct; }
    direct.found = true;
    direct.ray = light_shadow_ray(s, point, side);
    return direct;
}
