// The elements of an illumination map: what an arrival counts for. `element_word` reads what the host lays down: four words for each
// primitive (first element or node, divisions of an edge, first division among those of all, area), then the nodes of the lattices.
//: use illumination::lattice
//: use sampling::warp

const ELEMENT_PLACE_WORDS: u32 = 4u;

// How a map is divided: where nodes begin among the words, and elements of one side.
struct ElementMap { nodes: u32, per_side: u32, linear: bool, sides_apart: bool }

// Elements with the factor of each.
struct Deposit { count: u32, elements: vec3<u32>, factors: vec3<f32> }

fn elements_divisions(primitive: u32) -> u32 {
    return max(element_word(ELEMENT_PLACE_WORDS * primitive + 1u), 1u);
}

fn elements_deposit(map: ElementMap, primitive: u32, b1: f32, b2: f32, from_front: bool) -> Deposit {
    let first = element_word(ELEMENT_PLACE_WORDS * primitive);
    let divisions = element_word(ELEMENT_PLACE_WORDS * primitive + 1u);
    let side = select(map.per_side, 0u, from_front || !map.sides_apart);
    if divisions == 0u || (!map.linear && divisions == 1u) {
        return Deposit(1u, vec3(side + first, 0u, 0u), vec3(1.0f, 0.0f, 0.0f));
    }
    let cell = lattice_cell(divisions, b1, b2);
    if !map.linear { return Deposit(1u, vec3(side + first + cell.index, 0u, 0u), vec3(1.0f, 0.0f, 0.0f)); }
    let at = map.nodes + first;
    let nodes = vec3(
        element_word(at + cell.corners.x),
        element_word(at + cell.corners.y),
        element_word(at + cell.corners.z),
    );
    return Deposit(3u, vec3(side) + nodes, 12.0f * cell.bary - 3.0f);
}

// The barycentrics of vertices 1 and 2 of a point of a division, from those on the division.
fn elements_in_cell(primitive: u32, cell: u32, local: vec2<f32>) -> vec2<f32> {
    let n = elements_divisions(primitive);
    if n == 1u { return local; }
    return lattice_in_cell(n, cell, local);
}

// The barycentrics of vertices 1 and 2 of a point of an element (of either side) of the constant basis, from two numbers in [0, 1). Elements that are not the
// primitive's count as its first.
fn elements_bary_on(map: ElementMap, primitive: u32, element: u32, u: vec2<f32>) -> vec2<f32> {
    let n = elements_divisions(primitive);
    let of_side = select(element, element - map.per_side, element >= map.per_side);
    let cell = of_side - element_word(ELEMENT_PLACE_WORDS * primitive);
    return elements_in_cell(primitive, select(0u, cell, cell < n * n), warp_sample_triangle(u).yz);
}
