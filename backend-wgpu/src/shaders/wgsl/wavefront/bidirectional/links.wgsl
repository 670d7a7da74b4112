// What the cutoff heuristic has to know of both walks (0: the light's, 1: the sensor's): of each vertex its density as the other walk
// would draw it over its own, and whether it can be connected.
//: use wavefront::bidirectional::rows

fn links_at(slot: u32, list: u32, i: u32) -> u32 {
    if i < BASE { return (ROW_LINKS + BASE * list + i) * job.slots + slot; }
    return wave_annex(slot) + ANNEX_LINKS + ANNEX * list + i - BASE;
}

fn links_ratio(slot: u32, side: u32, i: u32) -> f32 { return bitcast<f32>(states[links_at(slot, 2u * side, i)]); }

fn links_open(slot: u32, side: u32, i: u32) -> f32 { return bitcast<f32>(states[links_at(slot, 2u * side + 1u, i)]); }

// Notes how a vertex was left.
fn links_leave(slot: u32, from_light: bool, index: u32, chain: Chain, left: Left) {
    let side = select(1u, 0u, from_light);
    if index > 0u {
        let ratio = weight_at_most(left.backward * chain.back, WEIGHT_RATIO_MAX);
        states[links_at(slot, 2u * side, index - 1u)] = bitcast<u32>(ratio);
    }
    states[links_at(slot, 2u * side + 1u, index)] = bitcast<u32>(select(0.0f, chain.open, left.opens));
}
