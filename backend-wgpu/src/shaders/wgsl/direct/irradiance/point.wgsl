// Places at which direct irradiance is asked for.
//: use illumination::elements
//: use transport::surface

struct DirectPoint { found: bool, b1: f32, b2: f32, point: SurfacePoint, normal: vec3<f32> }

// A point of a primitive from two numbers in [0, 1), for a triangle of one of its divisions.
fn irradiance_point_on(primitive: u32, cell: u32, u: vec2<f32>) -> DirectPoint {
    var found: DirectPoint;
    if primitive < scene_at.triangle_count {
        let b = elements_in_cell(primitive, cell, warp_sample_triangle(u).yz);
        found.b1 = b.x;
        found.b2 = b.y;
        found.point = surface_on(primitive, b.x, b.y);
        found.normal = surface_front(primitive);
        found.found = true;
        return found;
    }
    let shape = tree_shape(primitive - scene_at.triangle_count);
    var near: vec3<f32>;
    if shape.kind == SPHERE {
        near = shape.center + warp_sample_sphere(u) * shape.radius;
    } else {
        let basis = math_orthonormal_basis(shape.normal);
        let d = warp_sample_disk(u);
        near = shape.center + (basis.t * d.x + basis.b * d.y) * shape.radius;
    }
    found.point = geometry_shape_point(shape, near);
    found.normal = geometry_shape_normal(shape, found.point.position);
    found.found = !math_is_zero3(found.normal);
    return found;
}
