// Media in states: three words.
//: use medium::inside
//: use wavefront::states

fn wave_inside(slot: u32, row: u32) -> Inside {
    return vec3(wave_get(slot, row), wave_get(slot, row + 1u), wave_get(slot, row + 2u));
}

fn wave_put_inside(slot: u32, row: u32, inside: Inside) {
    wave_put(slot, row, inside.x);
    wave_put(slot, row + 1u, inside.y);
    wave_put(slot, row + 2u, inside.z);
}
