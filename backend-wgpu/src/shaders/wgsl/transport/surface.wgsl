// What a ray finds at a hit: point, normals, lobes.
//: use geometry::surface
//: use bsdf::lobes
//: use scene::arrays
//: use tree::walk
//: if TEXTURES
//: use scene::bitmap
//: end
//: if VOLUME
//: use bsdf::interface
//: end

const MATERIAL_TWO_SIDED: u32 = 1u;
const MATERIAL_MIRROR: u32 = 2u;
const MATERIAL_NULL: u32 = 8u;
const MATERIAL_SHADING_NORMALS: u32 = 16u;
const MATERIAL_DIELECTRIC: u32 = 32u;
const MATERIAL_THIN: u32 = 64u;
const MATERIAL_FILM: u32 = 128u;
const MATERIAL_CONDUCTOR: u32 = 256u;
const MATERIAL_SCHLICK: u32 = 512u;
const MATERIAL_ROUGH: u32 = 1024u;
const MATERIAL_BECKMANN: u32 = 2048u;
const MATERIAL_PHONG: u32 = 4096u;
const MATERIAL_PLASTIC: u32 = 8192u;
const MATERIAL_NONLINEAR: u32 = 16384u;
const MATERIAL_SCATTERS: u32 = 32768u;

// Words of the records.
const SURFACE_WORDS: u32 = 8u;
const MATERIAL_WORDS: u32 = 20u;

struct Surface {
    found: bool,
    point: SurfacePoint,
    front: vec3<f32>,
    geometric: vec3<f32>,
    shading: vec3<f32>,
    //: if SHADING
    // The interpolated normal on the side of the geometric one, whether or not it points away from `wo`.
    interpolated: vec3<f32>,
    //: end
    wo: vec3<f32>,
    lobes: Lobes,
    light: u32,
    from_front: bool,
    //: if VOLUME
    interface_: Interface,
    //: end
}

fn surface_material(primitive: u32) -> u32 {
    return scene_at.materials + MATERIAL_WORDS * scene_word(scene_at.surfaces + SURFACE_WORDS * primitive);
}

fn surface_flags(primitive: u32) -> u32 { return scene_word(surface_material(primitive) + 11u); }

fn surface_vertices(primitive: u32) -> vec3<u32> {
    let at = scene_at.triangles + 3u * primitive;
    return vec3(scene_word(at), scene_word(at + 1u), scene_word(at + 2u));
}

fn surface_position(vertex: u32) -> vec3<f32> { return scene_triple(scene_at.positions + 3u * vertex); }

// A point of a triangle by its second and third barycentric, and the unit normal of a triangle's front.
fn surface_on(triangle: u32, b1: f32, b2: f32) -> SurfacePoint {
    let v = surface_vertices(triangle);
    return geometry_hit_point_with(
        surface_position(v.x),
        surface_position(v.y),
        surface_position(v.z),
        b1,
        b2,
        scene_float(scene_at.surfaces + SURFACE_WORDS * triangle + 7u),
    );
}

fn surface_front(triangle: u32) -> vec3<f32> {
    return scene_triple(scene_at.surfaces + SURFACE_WORDS * triangle + 4u);
}

//: if TEXTURES
fn surface_texcoord(vertex: u32) -> vec2<f32> {
    let at = scene_at.texcoords + 2u * vertex;
    if vertex >= scene_at.texcoord_count { return vec2(0.0f); }
    return vec2(scene_float(at), scene_float(at + 1u));
}

// What the bitmap and the pattern of a material multiply its albedo by.
fn surface_textured(material: u32, vertex: vec3<u32>, hit: Hit) -> vec3<f32> {
    let b0 = 1.0f - hit.b1 - hit.b2;
    let a = surface_texcoord(vertex.x);
    let b = surface_texcoord(vertex.y);
    let c = surface_texcoord(vertex.z);
    let uv = b0 * a + hit.b1 * b + hit.b2 * c;
    var color = vec3(1.0f);
    let texture = scene_word(material + 3u);
    if texture < scene_at.texture_count {
        color *= bitmap_sample_record(scene_at.textures + 4u * texture, uv);
    }
    let checker = scene_word(material + 16u);
    if checker < scene_at.checker_count {
        color *= bitmap_checker_color(scene_at.checkers + 8u * checker, uv);
    }
    return color;
}
//: end

//: if SHADING
fn surface_vertex_normal(vertex: u32) -> vec3<f32> {
    if vertex >= scene_at.normal_count { return vec3(0.0f); }
    return scene_triple(scene_at.normals + 3u * vertex);
}
//: end

//: if LOBES
fn surface_rough(material: u32, flags: u32) -> Rough {
    if (flags & MATERIAL_ROUGH) == 0u { return Rough(ROUGH_SMOOTH, 0.0f); }
    if (flags & MATERIAL_PHONG) != 0u { return Rough(ROUGH_PHONG, scene_float(material + 7u)); }
    let size = scene_float(material + 15u);
    if (flags & MATERIAL_BECKMANN) != 0u { return Rough(ROUGH_BECKMANN, size); }
    return Rough(ROUGH_GGX, size);
}

//: if VOLUME
// What a smooth boundary, a plate or a film lets through.
fn surface_interface(surface: Surface, material: u32, flags: u32) -> Interface {
    let ior = scene_triple(material + 12u);
    if (flags & MATERIAL_FILM) != 0u {
        return interface_pane(scene_triple(material), scene_triple(material + 4u));
    }
    let schlick = (flags & MATERIAL_SCHLICK) != 0u;
    if (flags & MATERIAL_THIN) != 0u {
        let cos = math_clamp_number(math_dot(surface.wo, surface.shading), 0.0f, 1.0f);
        return interface_plate(cos, ior, schlick);
    }
    return interface_dielectric(select(vec3(1.0f) / ior, ior, surface.from_front), schlick);
}
//: end

// What depends on the angle and on the side, and what has a finish.
fn surface_refine(surface_in: Surface, material: u32, flags: u32) -> Surface {
    var surface = surface_in;
    let ior = scene_triple(material + 12u);
    let second = scene_triple(material + 4u);
    let rough = surface_rough(material, flags);
    if (flags & (MATERIAL_ROUGH | MATERIAL_PLASTIC | MATERIAL_SCATTERS)) == 0u {
        if (flags & MATERIAL_CONDUCTOR) != 0u {
            let cos = math_clamp_number(math_dot(surface.wo, surface.shading), 0.0f, 1.0f);
            if surface.lobes.mirror { surface.lobes.albedo = fresnel_conductor_rgb(cos, ior, second); }
            surface.lobes.specular = vec3(0.0f);
        } else if (flags & (MATERIAL_DIELECTRIC | MATERIAL_FILM)) != 0u {
            surface.lobes = lobes_diffuse(vec3(0.0f));
            //: if VOLUME
            surface.interface_ = surface_interface(surface, material, flags);
            //: end
        }
        return surface;
    }
    let albedo = surface.lobes.albedo;
    surface.lobes = lobes_diffuse(vec3(0.0f));
    if (flags & MATERIAL_SCATTERS) != 0u {
        surface.lobes = lobes_of_film(scene_triple(material), second);
    } else if (flags & MATERIAL_DIELECTRIC) != 0u {
        let ratio = select(vec3(1.0f) / ior, ior, surface.from_front);
        if rough.kind != ROUGH_SMOOTH {
            surface.lobes = lobes_of_boundary(rough, ratio, (flags & MATERIAL_SCHLICK) != 0u);
        }
    } else if (flags & MATERIAL_TWO_SIDED) == 0u && !surface.from_front {
        // Black from behind where it has one side.
    } else if (flags & MATERIAL_PLASTIC) != 0u {
        let coat = scene_word(material + 17u);
        if coat < scene_at.coat_count {
            let record = scene_at.coats + scene_at.coat_words * coat;
            let nonlinear = (flags & MATERIAL_NONLINEAR) != 0u;
            let body = plastic_body(scene_float(record), ior.x, albedo, nonlinear);
            surface.lobes = lobes_of_plastic(body, rough, ior.x, record);
        }
    } else if rough.kind != ROUGH_SMOOTH {
        surface.lobes = lobes_of_metal(rough, ior, second);
    }
    return surface;
}
//: end

// Where a hit is, and which side was met: a surface without lobes.
fn surface_place(ray: Ray, hit: Hit) -> Surface {
    var surface: Surface;
    let record = scene_at.surfaces + SURFACE_WORDS * hit.primitive;
    let wo = -ray.direction;
    var front: vec3<f32>;
    if hit.primitive < scene_at.triangle_count {
        let vertex = surface_vertices(hit.primitive);
        surface.point = geometry_hit_point_with(
            surface_position(vertex.x),
            surface_position(vertex.y),
            surface_position(vertex.z),
            hit.b1,
            hit.b2,
            scene_float(record + 7u),
        );
        front = scene_triple(record + 4u);
    } else {
        let shape = tree_shape(hit.primitive - scene_at.triangle_count);
        surface.point = geometry_shape_point(shape, ray.origin + ray.direction * hit.t);
        front = geometry_shape_normal(shape, surface.point.position);
        if math_is_zero3(front) { return surface; }
    }
    surface.found = true;
    surface.from_front = math_dot(wo, front) >= 0.0f;
    surface.front = front;
    surface.geometric = select(-front, front, surface.from_front);
    surface.shading = surface.geometric;
    surface.wo = wo;
    surface.light = scene_word(record + 1u);
    return surface;
}

fn surface_at(ray: Ray, hit: Hit) -> Surface {
    var surface = surface_place(ray, hit);
    if !surface.found { return surface; }
    let record = scene_at.surfaces + SURFACE_WORDS * hit.primitive;
    let material = surface_material(hit.primitive);
    let flags = scene_word(material + 11u);
    let is_triangle = hit.primitive < scene_at.triangle_count;
    let wo = surface.wo;
    var albedo = scene_triple(material);
    //: if TEXTURES
    if is_triangle && (scene_word(material + 3u) != NO_INDEX || scene_word(material + 16u) != NO_INDEX) {
        albedo *= surface_textured(material, surface_vertices(hit.primitive), hit);
    }
    //: end
    surface.lobes = lobes_diffuse(albedo);
    //: if LOBES
    if (flags & MATERIAL_TWO_SIDED) == 0u && !surface.from_front {
        surface.lobes = lobes_diffuse(vec3(0.0f));
    } else {
        let mirror = (flags & MATERIAL_MIRROR) != 0u;
        surface.lobes = lobes_plain(albedo, scene_triple(material + 4u), scene_float(material + 7u), mirror);
    }
    //: end
    //: if SHADING
    surface.interpolated = surface.geometric;
    if is_triangle && (scene_word(record + 3u) & MATERIAL_SHADING_NORMALS) != 0u {
        let vertex = surface_vertices(hit.primitive);
        let sum = surface_vertex_normal(vertex.x) * (1.0f - hit.b1 - hit.b2)
            + surface_vertex_normal(vertex.y) * hit.b1
            + surface_vertex_normal(vertex.z) * hit.b2;
        let n = math_normalize_or(sum, vec3(0.0f));
        let interpolated = select(-n, n, surface.from_front);
        if !math_is_zero3(n) { surface.interpolated = interpolated; }
        if !math_is_zero3(n) && math_dot(interpolated, wo) > 0.0f { surface.shading = interpolated; }
    }
    //: end
    //: if LOBES
    surface = surface_refine(surface, material, flags);
    //: end
    return surface;
}

// A white Lambert surface: pi times what it reflects is the irradiance there.
fn surface_white(point: SurfacePoint, n: vec3<f32>) -> Surface {
    var surface: Surface;
    surface.found = true;
    surface.point = point;
    surface.front = n;
    surface.geometric = n;
    surface.shading = n;
    //: if SHADING
    surface.interpolated = n;
    //: end
    surface.wo = n;
    surface.lobes = lobes_diffuse(vec3(1.0f));
    surface.light = NO_INDEX;
    surface.from_front = true;
    return surface;
}
