//: use kernel::words
//: use sensor

fn kernel_camera_sample_ray() {
    let position = constant_triple();
    let lens_radius = constant_float();
    let forward = constant_triple();
    let focus_distance = constant_float();
    let right = constant_triple();
    let width = constant_word();
    let up = constant_triple();
    let height = constant_word();
    let camera = Camera(position, lens_radius, forward, focus_distance, right, width, up, height);
    let x = word();
    let y = word();
    let u = pair();
    let ray = camera_sample_ray(camera, x, y, u, pair());
    put3(ray.origin);
    put3(ray.direction);
}
