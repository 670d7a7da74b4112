//: use kernel::words
//: use geometry::triangle
//: use geometry::shape
//: use geometry::surface

fn kernel_ray() -> Ray {
    let origin = triple();
    let direction = triple();
    return Ray(origin, direction, float());
}

fn kernel_geometry_intersect_triangle() {
    let ray = kernel_ray();
    let a = triple();
    let b = triple();
    let c = triple();
    let hit = geometry_intersect_triangle(geometry_prepare(ray), a, b, c, ray.t_max);
    if !hit.hit { return; }
    put_word(1u);
    put(hit.t);
    put(hit.b1);
    put(hit.b2);
}

fn kernel_geometry_slab_entry() {
    let ray = kernel_ray();
    let lo = triple();
    let hi = triple();
    let entry = geometry_slab_entry(geometry_prepare(ray), lo, hi, ray.t_max);
    if entry < 0.0f { return; }
    put_word(1u);
    put(entry);
}

fn kernel_geometry_intersect_shape() {
    let ray = kernel_ray();
    let kind = word();
    let radius = float();
    let center = triple();
    let shape = RoundShape(kind, radius, center, triple());
    let t = geometry_intersect_shape(geometry_prepare(ray), shape, ray.t_max);
    if t < 0.0f { return; }
    put_word(1u);
    put(t);
}

fn kernel_geometry_offset_origin() {
    let position = triple();
    let extent = float();
    let normal = triple();
    put3(geometry_offset_origin(SurfacePoint(position, extent), normal, triple()));
}
