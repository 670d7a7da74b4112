// Words of states, which are in rows: word r of slot s at r * slots + s. Whoever uses this has `states` and a job with `slots`.

fn wave_get(slot: u32, row: u32) -> u32 { return states[row * job.slots + slot]; }

fn wave_float(slot: u32, row: u32) -> f32 { return bitcast<f32>(wave_get(slot, row)); }

fn wave_triple(slot: u32, row: u32) -> vec3<f32> {
    return vec3(wave_float(slot, row), wave_float(slot, row + 1u), wave_float(slot, row + 2u));
}

fn wave_put(slot: u32, row: u32, x: u32) { states[row * job.slots + slot] = x; }

fn wave_put_float(slot: u32, row: u32, x: f32) { wave_put(slot, row, bitcast<u32>(x)); }

fn wave_put_triple(slot: u32, row: u32, v: vec3<f32>) {
    wave_put_float(slot, row, v.x);
    wave_put_float(slot, row + 1u, v.y);
    wave_put_float(slot, row + 2u, v.z);
}
