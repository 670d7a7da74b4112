// The ray that a slot asks for, and what it met, behind ROW_ORIGIN, ROW_DIRECTION, ROW_T_MAX and ROW_HIT of whoever uses this.
//: use geometry::ray
//: use tree::walk
//: use wavefront::states

fn wave_ray(slot: u32) -> Ray {
    return Ray(wave_triple(slot, ROW_ORIGIN), wave_triple(slot, ROW_DIRECTION), wave_float(slot, ROW_T_MAX));
}

fn wave_put_ray(slot: u32, ray: Ray) {
    wave_put_triple(slot, ROW_ORIGIN, ray.origin);
    wave_put_triple(slot, ROW_DIRECTION, ray.direction);
    wave_put_float(slot, ROW_T_MAX, ray.t_max);
}

// The answer to what a slot asked.
fn wave_hit(slot: u32) -> Hit { return wave_hit_at(slot, ROW_HIT); }

fn wave_hit_at(slot: u32, row: u32) -> Hit {
    return Hit(
        wave_float(slot, row),
        wave_get(slot, row + 1u),
        wave_float(slot, row + 2u),
        wave_float(slot, row + 3u),
    );
}

fn wave_put_hit(slot: u32, row: u32, hit: Hit) {
    wave_put_float(slot, row, hit.t);
    wave_put(slot, row + 1u, hit.primitive);
    wave_put_float(slot, row + 2u, hit.b1);
    wave_put_float(slot, row + 3u, hit.b2);
}
