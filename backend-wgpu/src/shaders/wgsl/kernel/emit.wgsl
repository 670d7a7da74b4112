//: use kernel::one_light
//: use light::emit

fn kernel_emit_sphere(at: u32) -> vec4<f32> { return vec4(light_float3(at), scene_float(at + 3u)); }

fn kernel_emit_put(e: Emission) {
    put3(e.ray.origin);
    put3(e.ray.direction);
    put3(e.flux);
}

fn kernel_emit_emit() {
    let place = pair();
    kernel_emit_put(emit_emit(0u, kernel_emit_sphere(LIGHT_WORDS), vec4(place, pair())));
}

fn kernel_emit_emit_environment() {
    let place = pair();
    kernel_emit_put(emit_emit_environment(light_float3(0u), kernel_emit_sphere(3u), vec4(place, pair())));
}
