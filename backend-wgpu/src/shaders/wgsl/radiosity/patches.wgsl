// Points of patches. What patches are made of lies among the words of elements, where the host says.
//: use illumination::elements
//: use sampling::discrete
//: use transport::surface

// Where core's lists begin: the patch of each element, members of patch p at first[p] .. first[p + 1], elements, primitives and counts of members.
struct PatchLists { of_element: u32, first: u32, members: u32, primitives: u32, cumulative: u32 }

var<private> counts_at: u32;

fn discrete_count(i: u32) -> u32 { return element_word(counts_at + i); }

struct PatchPoint { point: SurfacePoint, normal: vec3<f32> }

// A uniform point of a patch, with the unit normal of its side there.
fn patches_sample(map: ElementMap, lists: PatchLists, patch_: u32, pick: u32, u: vec2<f32>) -> PatchPoint {
    let first = element_word(lists.first + patch_);
    counts_at = lists.cumulative + first;
    let member = first + discrete_pick_in(element_word(lists.first + patch_ + 1u) - first, pick).index;
    let element = element_word(lists.members + member);
    let primitive = element_word(lists.primitives + member);
    let is_back = element >= map.per_side;
    let b = elements_bary_on(map, primitive, element, u);
    let front = surface_front(primitive);
    return PatchPoint(surface_on(primitive, b.x, b.y), select(front, -front, is_back));
}
