// What lies where a boundary is crossed. Words of the tree of crossings: of each node its lower corner, a leaf's first entry or an inner
// node's right child, the upper corner, and a leaf's count; the left child follows its node.
//: use medium::inside
//: use transport::surface

const TOGETHER_MAX: u32 = 8u;
const CROSSING_NODE_WORDS: u32 = 8u;
// Levels that a tree of 2^32 boxes has at most.
const CROSSINGS_STACK: u32 = 34u;

fn boundaries_media(primitive: u32) -> u32 { return scene_word(scene_at.surfaces + SURFACE_WORDS * primitive + 2u); }

fn boundaries_passes(primitive: u32) -> bool {
    return (surface_flags(primitive) & (MATERIAL_NULL | MATERIAL_THIN)) != 0u;
}

// Surfaces before films, films before boundaries.
fn boundaries_rank(primitive: u32) -> u32 {
    let flags = surface_flags(primitive);
    if (flags & MATERIAL_NULL) != 0u { return 0u; }
    return select(2u, 1u, (flags & MATERIAL_THIN) != 0u);
}

fn boundaries_is_corner(p: vec3<f32>, triangle: vec3<u32>) -> bool {
    return all(p == surface_position(triangle.x)) || all(p == surface_position(triangle.y))
        || all(p == surface_position(triangle.z));
}

fn boundaries_share_a_corner(a: u32, b: u32) -> bool {
    if max(a, b) >= scene_at.triangle_count { return false; }
    let first = surface_vertices(a);
    let second = surface_vertices(b);
    return boundaries_is_corner(surface_position(first.x), second)
        || boundaries_is_corner(surface_position(first.y), second)
        || boundaries_is_corner(surface_position(first.z), second);
}

// A crossing's own test of a ray, of any primitive.
fn boundaries_intersect(ray: PreparedRay, primitive: u32, t_max: f32) -> Hit {
    let miss = Hit(0.0f, TREE_NOTHING, 0.0f, 0.0f);
    if primitive < scene_at.triangle_count {
        let v = surface_vertices(primitive);
        let a = surface_position(v.x);
        let found = geometry_intersect_triangle(ray, a, surface_position(v.y), surface_position(v.z), t_max);
        if found.hit { return Hit(found.t, primitive, found.b1, found.b2); }
        return miss;
    }
    let t = geometry_intersect_shape(ray, tree_shape(primitive - scene_at.triangle_count), t_max);
    if t < 0.0f { return miss; }
    return Hit(t, primitive, 0.0f, 0.0f);
}

fn boundaries_enters(ray: PreparedRay, node: u32) -> f32 {
    let at = scene_at.crossings + CROSSING_NODE_WORDS * node;
    return geometry_slab_entry(ray, scene_triple(at), scene_triple(at + 4u), 1.0f);
}

// All that a ray meets within the step that it takes off a surface: what is met, and primitive and media of each crossing, with bits of those that
// were met from the front.
struct Here { met: Hit, crossed: array<vec2<u32>, TOGETHER_MAX>, fronts: u32, count: u32 }

// At a hit; what lies with it is looked for where `together`, in the order of core's tree.
fn boundaries_here(ray: Ray, hit: Hit, together: bool) -> Here {
    var here: Here;
    here.met = hit;
    let first = surface_place(ray, hit);
    if !first.found { return here; }
    here.crossed[0] = vec2(hit.primitive, boundaries_media(hit.primitive));
    here.fronts = select(0u, 1u, first.from_front);
    here.count = 1u;
    if !together || scene_at.crossing_count == 0u { return here; }
    let near = geometry_offset_origin(first.point, first.geometric, -ray.direction);
    let far = geometry_offset_origin(first.point, first.geometric, ray.direction);
    let gap = geometry_prepare(Ray(near, far - near, 1.0f));
    var stack: array<u32, CROSSINGS_STACK>;
    var waiting = 0u;
    var node = 0u;
    if boundaries_enters(gap, 0u) < 0.0f { return here; }
    loop {
        let at = scene_at.crossings + CROSSING_NODE_WORDS * node;
        let begin = scene_word(at + 3u);
        let leaf = scene_word(at + 7u);
        if leaf == 0u {
            let left = boundaries_enters(gap, node + 1u);
            let right = boundaries_enters(gap, begin);
            if left >= 0.0f && right >= 0.0f {
                stack[waiting] = select(node + 1u, begin, left <= right);
                waiting += 1u;
                node = select(begin, node + 1u, left <= right);
                continue;
            }
            if left >= 0.0f || right >= 0.0f {
                node = select(begin, node + 1u, left >= 0.0f);
                continue;
            }
        }
        for (var i = 0u; i < leaf; i++) {
            let id = scene_word(scene_at.crossing_order + begin + i);
            let met = boundaries_intersect(gap, id, 1.0f);
            if met.primitive == TREE_NOTHING || id == hit.primitive || here.count >= TOGETHER_MAX { continue; }
            let other = Hit(hit.t, id, met.b1, met.b2);
            if boundaries_rank(id) > boundaries_rank(here.met.primitive) { here.met = other; }
            let place = surface_place(ray, other);
            if !place.found { continue; }
            // Neighbours at an edge of one boundary are one crossing.
            let its_media = boundaries_media(id);
            var same = false;
            for (var k = 0u; k < here.count; k++) {
                let c = here.crossed[k];
                let front = ((here.fronts >> k) & 1u) != 0u;
                if c.y == its_media && front == place.from_front && boundaries_share_a_corner(c.x, id) {
                    same = true;
                    break;
                }
            }
            if same { continue; }
            here.crossed[here.count] = vec2(id, its_media);
            here.fronts |= select(0u, 1u, place.from_front) << here.count;
            here.count += 1u;
        }
        if waiting == 0u { break; }
        waiting -= 1u;
        node = stack[waiting];
    }
    return here;
}

// What is met, and the media beyond it.
struct Resolved { hit: Hit, inside: Inside }

// What a straight way goes through at a hit.
fn boundaries_resolve(ray: Ray, hit: Hit, inside: Inside) -> Resolved {
    var out = Resolved(hit, inside);
    let passes = boundaries_passes(hit.primitive);
    if boundaries_media(hit.primitive) == 0u && !passes { return out; }
    let here = boundaries_here(ray, hit, passes);
    out.hit = here.met;
    for (var k = 0u; k < here.count; k++) {
        out.inside = inside_across(out.inside, here.crossed[k].y, ((here.fronts >> k) & 1u) != 0u);
    }
    return out;
}
