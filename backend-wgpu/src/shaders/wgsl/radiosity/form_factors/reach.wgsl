// Diffuse walks from where light and eyes are: what they meet, light can get to.
//: use bsdf::diffuse
//: use illumination::elements
//: use light::emit
//: use math::rounding
//: use sampling::numbers
//: use scene::camera
//: use transport::surface
//: use tree::walk

const REACH_START_GROUP: u32 = 0u;
const REACH_PICK_GROUP: u32 = 1u;
const REACH_WALK_GROUP: u32 = 2u;

// Where a walk begins: all around the scene, or at one of its lights or its camera (of which `begins` is the number), each alike.
fn reach_start(numbers: Numbers, from_infinity: bool, begins: u32, sphere: vec4<f32>) -> Ray {
    let u = numbers_group4(numbers, REACH_START_GROUP);
    if from_infinity { return emit_from_infinity(warp_sample_sphere(u.xy), sphere, u.zw); }
    let pick = math_wide_mul(numbers_bits4(numbers, REACH_PICK_GROUP).x, begins).x;
    if pick < scene_at.light_count { return emit_ray(scene_at.lights + LIGHT_WORDS * pick, sphere, u); }
    let camera = scene_camera(scene_at.camera);
    let x = math_to_u32(u.x * f32(camera.width));
    let y = math_to_u32(u.y * f32(camera.height));
    return camera_sample_ray(camera, x, y, u.zw, vec2(0.5f));
}

// The next ray of a walk: a diffuse one.
fn reach_next(numbers: Numbers, hits: u32, surface: Surface) -> Ray {
    let u = numbers_group4(numbers, REACH_WALK_GROUP + hits).xy;
    let direction = diffuse_sample(surface.geometric, u);
    let origin = geometry_offset_origin(surface.point, surface.geometric, direction);
    return Ray(origin, direction, MAX_FLOAT);
}
