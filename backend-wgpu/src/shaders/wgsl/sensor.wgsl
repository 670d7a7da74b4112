// The camera: from a pixel to a ray. The struct has the layout of core's record.
//: use geometry::ray
//: use math::roots
//: use math::vector
//: use sampling::warp

struct Camera {
    position: vec3<f32>,
    lens_radius: f32,
    forward: vec3<f32>,
    focus_distance: f32,
    right: vec3<f32>,
    width: u32,
    up: vec3<f32>,
    height: u32,
}

fn camera_lens_shift(camera: Camera, lens: vec2<f32>) -> vec3<f32> {
    let d = warp_sample_disk(lens);
    let right = math_normalize_or(camera.right, vec3(0.0f));
    let up = math_normalize_or(camera.up, vec3(0.0f));
    return (right * d.x + up * d.y) * camera.lens_radius;
}

fn camera_sample_ray(camera: Camera, x: u32, y: u32, u: vec2<f32>, lens: vec2<f32>) -> Ray {
    let sx = 2.0f * ((f32(x) + u.x) / f32(camera.width)) - 1.0f;
    let sy = 1.0f - 2.0f * ((f32(y) + u.y) / f32(camera.height));
    let toward = camera.forward + camera.right * sx + camera.up * sy;
    if camera.lens_radius > 0.0f {
        let shift = camera_lens_shift(camera, lens);
        let direction = math_normalize_or(toward * camera.focus_distance - shift, vec3(0.0f));
        return Ray(camera.position + shift, direction, MAX_FLOAT);
    }
    return Ray(camera.position, math_normalize_or(toward, vec3(0.0f)), MAX_FLOAT);
}

fn camera_film_area(camera: Camera) -> f32 {
    return 4.0f * sqrt(math_dot(camera.right, camera.right) * math_dot(camera.up, camera.up));
}

fn camera_pdf_solid_angle(camera: Camera, direction: vec3<f32>) -> f32 {
    let cos = math_dot(direction, camera.forward);
    if cos > 0.0f { return 1.0f / (camera_film_area(camera) * (cos * cos * cos)); }
    return 0.0f;
}

fn camera_sample_lens(camera: Camera, u: vec2<f32>) -> vec3<f32> {
    if camera.lens_radius <= 0.0f { return camera.position; }
    return camera.position + camera_lens_shift(camera, u);
}

struct CameraPixel { found: bool, x: u32, y: u32 }

fn camera_pixel(camera: Camera, lens: vec3<f32>, p: vec3<f32>) -> CameraPixel {
    let nothing = CameraPixel(false, 0u, 0u);
    let to = p - lens;
    let along = math_dot(to, camera.forward);
    if math_is_nan(along) || along <= 0.0f { return nothing; }
    var toward = to / along;
    if camera.lens_radius > 0.0f {
        let shift = lens - camera.position;
        toward = to / along + shift / camera.focus_distance;
    }
    let column = (math_dot(toward, camera.right) / math_dot(camera.right, camera.right) + 1.0f)
        * (0.5f * f32(camera.width));
    let row = (1.0f - math_dot(toward, camera.up) / math_dot(camera.up, camera.up)) * (0.5f * f32(camera.height));
    let within = column >= 0.0f && row >= 0.0f && column < f32(camera.width) && row < f32(camera.height);
    if !within { return nothing; }
    return CameraPixel(true, u32(column), u32(row));
}
