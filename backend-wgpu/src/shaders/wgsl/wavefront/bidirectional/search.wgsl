// Which media a place on a light sends into, where that is not the same all over the light: the boundaries on a way out of the scene, noted
// where the vertices of the walk will be, then crossed back from outside.
//: if VOLUME
//: use medium::inside
//: use transport::volume::boundaries
//: use wavefront::bidirectional::rows

// Boundaries that are noted at most: what there is room for.
const SEARCH_MAX: u32 = BASE * VERTEX_WORDS;

// core's direction, along no axis and no diagonal.
fn search_ray(origin: vec3<f32>) -> Ray {
    return Ray(origin, math_normalize_or(vec3(0.35271f, 0.80311f, -0.48017f), vec3(0.0f, 1.0f, 0.0f)), MAX_FLOAT);
}

fn search_word(slot: u32, i: u32) -> u32 { return (ROW_VERTICES + VERTEX_WORDS + i) * job.slots + slot; }

// Takes the answer to a ray on the way out; its rays are not the sample's.
@compute @workgroup_size(64)
fn search(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = wave_slot(id.x);
    if slot == job.slots { return; }
    if wave_get(slot, ROW_PHASE) != PHASE_SEARCH { return; }
    wave_put(slot, ROW_RAYS, wave_get(slot, ROW_RAYS) - 1u);
    let hit = wave_hit(slot);
    let ray = wave_ray(slot);
    var found = wave_get(slot, ROW_COUNT);
    let crossed = wave_get(slot, ROW_CROSSED);
    if hit.primitive != TREE_NOTHING && crossed < CROSSINGS_MAX {
        let surface = surface_place(ray, hit);
        if surface.found {
            var here = boundaries_here(ray, hit, true);
            for (var k = 0u; k < here.count; k++) {
                let media = here.crossed[k].y;
                if found < SEARCH_MAX && media != 0u {
                    // Its halves as they are crossed on the way back.
                    let from_front = ((here.fronts >> k) & 1u) != 0u;
                    let turned = select(media, (media << 16u) | (media >> 16u), from_front);
                    states[search_word(slot, found)] = turned;
                    found += 1u;
                }
            }
            wave_put(slot, ROW_COUNT, found);
            wave_put(slot, ROW_CROSSED, crossed + 1u);
            let origin = geometry_offset_origin(surface.point, surface.geometric, ray.direction);
            wave_query(slot, PHASE_SEARCH, QUERY_CLOSEST, Ray(origin, ray.direction, MAX_FLOAT));
            return;
        }
    }
    var inside = wave_inside(slot, ROW_INSIDE);
    while found > 0u {
        found -= 1u;
        inside = inside_across(inside, states[search_word(slot, found)], true);
    }
    wave_put_inside(slot, ROW_INSIDE, inside);
    wave_put(slot, ROW_COUNT, 0u);
    wave_put(slot, ROW_CROSSED, 0u);
    let origin = wave_triple(slot, ROW_WALK_ORIGIN);
    wave_query(slot, PHASE_LIGHT, QUERY_CLOSEST, Ray(origin, wave_triple(slot, ROW_WALK_DIRECTION), MAX_FLOAT));
}
//: end
