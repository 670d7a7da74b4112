// Joints of a wave: sent on their way, followed, and what they bring.
//: use transport::bidirectional::connect
//: use transport::bidirectional::splats
//: use transport::bidirectional::weight
//: use wavefront::bidirectional::rows

fn queue_add(at: u32, x: u32) -> u32 {
    if x == 0u { return 0u; }
    let old = atomicAdd(&queue[at], x);
    return u32(old + x < old);
}

// Adds a number of three words to another.
fn wave_add(at: u32, x: vec3<u32>) {
    let first = queue_add(at, x.x);
    // Both together may be beyond a word: all ones, and one that is carried.
    let middle = x.y + first;
    let second = select(queue_add(at + 1u, middle), 1u, middle < first);
    queue_add(at + 2u, x.z + second);
}

// A joint has come through: what it brings lands.
fn wave_land(slot: u32, value: vec3<f32>) {
    let pixel = wave_get(slot, ROW_PIXEL);
    if pixel == NO_INDEX {
        wave_put_triple(slot, ROW_RADIANCE, wave_triple(slot, ROW_RADIANCE) + value);
        return;
    }
    let block = job.first_block + (job.first_element + slot / job.samples) / job.elements;
    let at = job.splats + 9u * ((block % job.splat_blocks) * job.elements + pixel);
    wave_add(at, splat_units(value.x, job.per_unit));
    wave_add(at + 3u, splat_units(value.y, job.per_unit));
    wave_add(at + 6u, splat_units(value.z, job.per_unit));
}

//: if VOLUME
fn wave_way(slot: u32) -> Followed {
    return Followed(
        wave_ray(slot),
        wave_float(slot, ROW_WAY_LEAD),
        wave_float(slot, ROW_WAY_LENGTH),
        wave_inside(slot, ROW_WAY_INSIDE),
        wave_get(slot, ROW_WAY_CROSSED),
        wave_triple(slot, ROW_JOINT),
        wave_float(slot, ROW_WAY_THROUGH),
    );
}

fn wave_put_way(slot: u32, way: Followed) {
    wave_put_float(slot, ROW_WAY_LEAD, way.lead);
    wave_put_float(slot, ROW_WAY_LENGTH, way.length);
    wave_put_inside(slot, ROW_WAY_INSIDE, way.inside);
    wave_put(slot, ROW_WAY_CROSSED, way.crossed);
    wave_put_triple(slot, ROW_JOINT, way.carried);
    wave_put_float(slot, ROW_WAY_THROUGH, way.through);
}

//: if CUTOFF
fn wave_end(slot: u32, row: u32) -> End {
    let index = wave_get(slot, row);
    let chain = Chain(
        wave_float(slot, row + 1u),
        wave_float(slot, row + 2u),
        wave_float(slot, row + 3u),
        wave_float(slot, row + 4u),
    );
    return End(index != NO_INDEX, index, chain, wave_float(slot, row + 5u), wave_float(slot, row + 6u));
}

fn wave_put_end(slot: u32, row: u32, end: End) {
    wave_put(slot, row, select(NO_INDEX, end.index, end.is_there));
    wave_put_float(slot, row + 1u, end.chain.pdf);
    wave_put_float(slot, row + 2u, end.chain.back);
    wave_put_float(slot, row + 3u, end.chain.open);
    wave_put_float(slot, row + 4u, end.chain.sum);
    wave_put_float(slot, row + 5u, end.forward);
    wave_put_float(slot, row + 6u, end.backward);
}
//: end
//: end

// The answer to a joint: whether it goes on.
fn wave_joined(slot: u32, phase: u32) -> bool {
    let met = wave_hit(slot);
    //: if VOLUME
    var way = wave_way(slot);
    let kind = connect_follow(&way, met);
    if kind == FOLLOWED_PART {
        wave_put_way(slot, way);
        wave_query(slot, phase, QUERY_CLOSEST, way.ray);
        return true;
    }
    if kind == FOLLOWED_WHOLE {
        var weight = 1.0f;
        if job.only_s == JOB_ALL {
            //: if CUTOFF
            weight = weight_weigh(slot, wave_end(slot, ROW_ENDS), wave_end(slot, ROW_ENDS + 7u), way.through);
            //: else
            weight = weight_by_sum(wave_float(slot, ROW_SUM), way.through);
            //: end
        }
        wave_land(slot, way.carried * weight);
    }
    //: else
    if met.primitive == TREE_NOTHING { wave_land(slot, wave_triple(slot, ROW_JOINT)); }
    //: end
    return false;
}

// Sends a joint on its way, if it can bring anything.
fn wave_launch(slot: u32, phase: u32, given: Joint, sampler: BlockSampler, eye: u32) -> bool {
    if !given.goes { return false; }
    var joint = given;
    var weight = 1.0f;
    //: if CUTOFF
    //: if not VOLUME
    // Where the way is not known weights may be nothing now and something then.
    if job.only_s == JOB_ALL { weight = weight_weigh(slot, joint.light, joint.sensor, 1.0f); }
    //: end
    //: else
    let sum = weight_others(joint.light) + weight_others(joint.sensor);
    if job.only_s == JOB_ALL { weight = weight_by_sum(sum, 1.0f); }
    //: end
    connect_by_chance(&joint, weight, wave_triple(slot, ROW_RADIANCE), sampler, eye);
    if !joint.goes { return false; }
    wave_put(slot, ROW_PIXEL, select(NO_INDEX, joint.pixel.y * job.width + joint.pixel.x, joint.to_camera));
    //: if VOLUME
    //: if CUTOFF
    wave_put_end(slot, ROW_ENDS, joint.light);
    wave_put_end(slot, ROW_ENDS + 7u, joint.sensor);
    //: else
    wave_put_float(slot, ROW_SUM, sum);
    //: end
    wave_put_way(slot, Followed(joint.ray, joint.lead, joint.length, joint.inside, 0u, joint.carried, 1.0f));
    wave_query(slot, phase, QUERY_CLOSEST, joint.ray);
    //: else
    // Nothing on the way changes what it brings.
    wave_put_triple(slot, ROW_JOINT, joint.carried * weight);
    wave_query(slot, phase, QUERY_SHADOW, joint.ray);
    //: end
    return true;
}
