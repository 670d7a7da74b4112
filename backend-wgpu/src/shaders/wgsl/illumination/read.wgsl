// The irradiance at a hit by a map's numbers: `map_value(i)` reads that of element `i`, where the shader that uses this file has it.
//: use illumination::elements

fn elements_read(map: ElementMap, values: u32, primitive: u32, b1: f32, b2: f32, from_front: bool) -> vec3<f32> {
    let first = element_word(ELEMENT_PLACE_WORDS * primitive);
    let divisions = element_word(ELEMENT_PLACE_WORDS * primitive + 1u);
    let side = select(map.per_side, 0u, from_front || !map.sides_apart);
    if divisions == 0u || (!map.linear && divisions == 1u) { return map_value(values, side + first); }
    let cell = lattice_cell(divisions, b1, b2);
    if !map.linear { return map_value(values, side + first + cell.index); }
    let at = map.nodes + first;
    var sum = vec3(0.0f);
    sum += map_value(values, side + element_word(at + cell.corners.x)) * cell.bary.x;
    sum += map_value(values, side + element_word(at + cell.corners.y)) * cell.bary.y;
    sum += map_value(values, side + element_word(at + cell.corners.z)) * cell.bary.z;
    return sum;
}
