// Walks of the eight-wide tree (etendue-tree, `layout`): the box test is core's, the triangle test too, so hits have core's bits.
// What is unused is known by its word or number; nothing relies on infinities or NaN.
//: use geometry::triangle
//: use geometry::shape
//: use tree::arrays

const TREE_NOTHING: u32 = 0xffffffffu;
const TREE_LEAF: u32 = 0x80000000u;
const TREE_SHAPE: u32 = 6u;
const TREE_PLACE: u32 = 0x0fffffffu;

struct Hit { t: f32, primitive: u32, b1: f32, b2: f32 }

// Entries of four children, -1 where the ray misses.
fn tree_four(ray: PreparedRay, node: u32, part: u32, t_max: f32) -> vec4<f32> {
    let at = node * 16u + part;
    let lx = bitcast<vec4<f32>>(nodes[at]);
    let hx = bitcast<vec4<f32>>(nodes[at + 2u]);
    let ly = bitcast<vec4<f32>>(nodes[at + 4u]);
    let hy = bitcast<vec4<f32>>(nodes[at + 6u]);
    let lz = bitcast<vec4<f32>>(nodes[at + 8u]);
    let hz = bitcast<vec4<f32>>(nodes[at + 10u]);
    let up = ray.near > vec3(0.0f);
    let nx = (select(hx, lx, up.x) - ray.origin.x) * ray.near.x;
    let ny = (select(hy, ly, up.y) - ray.origin.y) * ray.near.y;
    let nz = (select(hz, lz, up.z) - ray.origin.z) * ray.near.z;
    let fx = (select(lx, hx, up.x) - ray.origin.x) * ray.far.x;
    let fy = (select(ly, hy, up.y) - ray.origin.y) * ray.far.y;
    let fz = (select(lz, hz, up.z) - ray.origin.z) * ray.far.z;
    let xy = select(ny, nx, nx > ny);
    let xyz = select(nz, xy, xy > nz);
    let enter = select(vec4(0.0f), xyz, xyz > vec4(0.0f));
    let uv = select(fy, fx, fx < fy);
    let uvw = select(fz, uv, uv < fz);
    let leave = select(vec4(t_max), uvw, uvw < vec4(t_max));
    return select(vec4(-1.0f), enter, enter <= leave);
}

// Bits of the lanes of a block whose edge functions do not have both signs.
fn tree_candidates(ray: PreparedRay, block: u32) -> u32 {
    let kx = select(select(0u, 2u, ray.axis == 1u), 1u, ray.axis == 0u);
    let ky = select(select(1u, 0u, ray.axis == 1u), 2u, ray.axis == 0u);
    let o = geometry_rotate(ray.axis, ray.origin);
    var bits = 0u;
    for (var part = 0u; part < 2u; part++) {
        let az = tree_row(block, ray.axis, part) - o.z;
        let bz = tree_row(block, 3u + ray.axis, part) - o.z;
        let cz = tree_row(block, 6u + ray.axis, part) - o.z;
        let ax = (tree_row(block, kx, part) - o.x) - math_kept4(ray.shear.x * az);
        let ay = (tree_row(block, ky, part) - o.y) - math_kept4(ray.shear.y * az);
        let bx = (tree_row(block, 3u + kx, part) - o.x) - math_kept4(ray.shear.x * bz);
        let by = (tree_row(block, 3u + ky, part) - o.y) - math_kept4(ray.shear.y * bz);
        let cx = (tree_row(block, 6u + kx, part) - o.x) - math_kept4(ray.shear.x * cz);
        let cy = (tree_row(block, 6u + ky, part) - o.y) - math_kept4(ray.shear.y * cz);
        let e0 = math_kept4(cx * by) - math_kept4(cy * bx);
        let e1 = math_kept4(ax * cy) - math_kept4(ay * cx);
        let e2 = math_kept4(bx * ay) - math_kept4(by * ax);
        let zero = vec4(0.0f);
        let negative = (e0 < zero) | (e1 < zero) | (e2 < zero);
        let positive = (e0 > zero) | (e1 > zero) | (e2 > zero);
        let used = tree_ids(block, part) != vec4(TREE_NOTHING);
        let kept = select(vec4(0u), vec4(1u, 2u, 4u, 8u), !(negative & positive) & used);
        bits |= (kept.x | kept.y | kept.z | kept.w) << (4u * part);
    }
    return bits;
}

fn tree_lane(block: u32, row: u32, lane: u32) -> f32 { return tree_row(block, row, lane >> 2u)[lane & 3u]; }

fn tree_vertex(block: u32, vertex: u32, lane: u32) -> vec3<f32> {
    let row = 3u * vertex;
    return vec3(
        tree_lane(block, row, lane),
        tree_lane(block, row + 1u, lane),
        tree_lane(block, row + 2u, lane),
    );
}

// The best of what is known and the triangles of a leaf.
fn tree_leaf(ray: PreparedRay, word: u32, known: Hit, any_hit: bool) -> Hit {
    var best = known;
    let kind = (word >> 28u) & 7u;
    let first = word & TREE_PLACE;
    if kind == TREE_SHAPE {
        let t = geometry_intersect_shape(ray, tree_shape(first), best.t);
        let hit = Hit(t, tree_first_shape() + first, 0.0f, 0.0f);
        if t >= 0.0f && tree_before(hit, best) { best = hit; }
    } else {
        var end = first + kind + 1u;
        for (var block = first; block < end; block++) {
            var bits = tree_candidates(ray, block);
            while bits != 0u {
                let lane = firstTrailingBit(bits);
                bits &= bits - 1u;
                let a = tree_vertex(block, 0u, lane);
                let b = tree_vertex(block, 1u, lane);
                let found = geometry_intersect_triangle(ray, a, b, tree_vertex(block, 2u, lane), best.t);
                let hit = Hit(found.t, tree_ids(block, lane >> 2u)[lane & 3u], found.b1, found.b2);
                if found.hit & tree_before(hit, best) { best = hit; }
                // Any one will do.
                if found.hit & any_hit {
                    bits = 0u;
                    end = 0u;
                }
            }
        }
    }
    return best;
}

// Smaller t, then the lower number; what is nothing has the highest.
fn tree_before(a: Hit, b: Hit) -> bool { return (a.t < b.t) | ((a.t == b.t) & (a.primitive < b.primitive)); }

// The hit with the smallest t; the number TREE_NOTHING where there is none.
fn tree_closest(ray: Ray) -> Hit { return tree_walk(ray, false); }

fn tree_occluded(ray: Ray) -> bool { return tree_walk(ray, true).primitive != TREE_NOTHING; }

fn tree_walk(given: Ray, any_hit: bool) -> Hit {
    var best = Hit(given.t_max, TREE_NOTHING, 0.0f, 0.0f);
    // NaN is refused with the rest.
    if !(given.t_max >= 0.0f) { return best; }
    let ray = geometry_prepare(given);
    // Entry and word of what waits.
    var stack: array<vec2<u32>, TREE_STACK>;
    var waiting = 0u;
    var word = tree_root();
    loop {
        if word != TREE_NOTHING && (word & TREE_LEAF) == 0u {
            var next = TREE_NOTHING;
            var nearest = 0.0f;
            for (var part = 0u; part < 2u; part++) {
                let enter = tree_four(ray, word, part, best.t);
                let child = nodes[word * 16u + 12u + part];
                for (var lane = 0u; lane < 4u; lane++) {
                    let e = enter[lane];
                    let c = child[lane];
                    if e < 0.0f || c == TREE_NOTHING { continue; }
                    var wait_word = c;
                    var wait_entry = e;
                    if next == TREE_NOTHING || e < nearest {
                        wait_word = next;
                        wait_entry = nearest;
                        next = c;
                        nearest = e;
                    }
                    if wait_word != TREE_NOTHING {
                        stack[waiting] = vec2(bitcast<u32>(wait_entry), wait_word);
                        waiting += 1u;
                    }
                }
            }
            if next != TREE_NOTHING {
                word = next;
                continue;
            }
        } else if word != TREE_NOTHING {
            best = tree_leaf(ray, word, best, any_hit);
            if any_hit && best.primitive != TREE_NOTHING { return best; }
        }
        // Never skipped when equal: the lower number may lie there.
        word = TREE_NOTHING;
        while waiting > 0u {
            waiting -= 1u;
            let e = stack[waiting];
            if bitcast<f32>(e.x) <= best.t {
                word = e.y;
                break;
            }
        }
        if word == TREE_NOTHING { return best; }
    }
    return best;
}
