// What the rays of a patch meet.
//: use bsdf::diffuse
//: use math::bits
//: use radiosity::patches
//: use sampling::sobol
//: use tree::walk

const RAYS_LOST: u32 = 0xffffffffu;
const RAYS_ESCAPED: u32 = 0xfffffffeu;

// The ray of a patch with this number among `rays`, a power of two.
fn rays_ray(
    map: ElementMap,
    lists: PatchLists,
    seed: vec2<u32>,
    patch_: u32,
    number: u32,
    rays: u32,
) -> Ray {
    let first = sobol_block_sampler(seed, patch_, 0u, 0u);
    let shift = sobol_bits2(first, 1u).x;
    let u = sobol_group4(sobol_with_index(first, number), 0u);
    let word = discrete_even_word(number, shift, firstTrailingBit(rays));
    let start = patches_sample(map, lists, patch_, word, u.xy);
    let direction = diffuse_sample(start.normal, u.zw);
    return Ray(geometry_offset_origin(start.point, start.normal, direction), direction, MAX_FLOAT);
}

// The patch that a ray meets with this hit, or what it is that is none.
fn rays_met(map: ElementMap, lists: PatchLists, ray: Ray, hit: Hit) -> u32 {
    if hit.primitive == TREE_NOTHING { return RAYS_ESCAPED; }
    // Shapes have no normal here, and no patches either.
    if hit.primitive >= scene_at.triangle_count { return RAYS_LOST; }
    let front = surface_front(hit.primitive);
    let from_front = math_dot(ray.direction, front) <= 0.0f;
    let element = elements_deposit(map, hit.primitive, hit.b1, hit.b2, from_front).elements.x;
    return element_word(lists.of_element + element);
}
