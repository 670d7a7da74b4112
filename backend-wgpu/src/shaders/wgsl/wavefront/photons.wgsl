// Waves of photons: `start` sends them out, `trace` answers what they ask, `arrive` says who has landed, and `scatter` registers these and sends them on.
// One by one, a photon that survives its scattering asks at once; in order (`SORTED`) all wait for each other, and `order` lets them.
//: use illumination::sums
//: use sampling::discrete
//: use scene::counts
//: use wavefront::photons::slots
//: if SURFACES
//: use wavefront::photons::shot
//: end
//: if SORTED
//: use transport::photon::replicate
//: end
//: if VOLUME
//: use wavefront::photons::begin
//: end

var<workgroup> hits_of_group: atomic<u32>;

fn wave_pick(index: u32, numbers: Numbers) -> u32 {
    if photons_has(PHOTONS_RANDOM) { return numbers_bits4(numbers, PHOTON_PICK_GROUP).x; }
    return discrete_even_word(index, job.shift, job.bits);
}

//: if not SURFACES
// A photon from a light that the word `pick` chooses.
fn wave_from_light(pick: u32, u: vec4<f32>) -> PhotonBegins {
    var begins: PhotonBegins;
    counts_at = COUNTS_OF_JOB + job.plan_at;
    let entry = discrete_pick_in(job.plan_count, pick);
    let emitted = photon_emit_entry(entry.index, wave_sphere(), u);
    begins.found = true;
    begins.entry = entry.index;
    begins.photon = photon_new(emitted.emission.ray, emitted.emission.flux / entry.pmf);
    begins.photon.registers_first = photons_has(PHOTONS_REGISTER_DIRECT) || !emitted.point_like;
    begins.photon.caustic = emitted.point_like;
    begins.photon.survives_first = photons_has(PHOTONS_SURVIVE_FIRST);
    return begins;
}
//: end

//: if not VOLUME
// The first step of a photon.
fn wave_begin(slot: u32, begins: PhotonBegins) {
    var photon = begins.photon;
    var hit = begins.hit;
    wave_put(slot, ROW_QUERY, PHOTON_OVER);
    if !begins.found { return; }
    let asks = begins.lands && begins.looks;
    if asks {
        // While it asks, the light's number and the chance stand where they are not needed yet.
        hit.t = begins.chance;
        photon.light = begins.entry;
        photon.ray = begins.look;
    }
    wave_put_hit(slot, ROW_HIT, hit);
    wave_put_photon(slot, photon);
    if begins.lands && !asks {
        if !math_is_zero3(photon.flux) { wave_lands(slot); }
    } else {
        wave_ask(slot, select(PHOTON_CLOSEST, PHOTON_SHADOW, asks));
    }
}
//: end

@compute @workgroup_size(64)
fn start(@builtin(global_invocation_id) id: vec3<u32>) {
    //: if REORDERED
    math_opaque = job.zero;
    //: end
    let slot = job.window + id.x;
    if slot >= job.count { return; }
    //: if SORTED
    atomicStore(&sums[list_at(LIST_LANDED) + slot], slot);
    //: end
    let index = job.first + slot;
    let numbers = wave_numbers(index);
    let u = numbers_group4(numbers, PHOTON_START_GROUP);
    //: if SURFACES
    wave_begin(slot, shot_begin(wave_pick(index, numbers), u));
    //: else
    var pick = 0u;
    if photons_has(PHOTONS_CHOICE) { pick = wave_pick(index, numbers); }
    wave_begin(slot, wave_from_light(pick, u));
    //: end
}

@compute @workgroup_size(64)
fn arrive(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = wave_slot(id.x);
    if slot == job.slots { return; }
    //: if VOLUME
    var photon = wave_photon(slot);
    var hit = wave_hit(slot);
    let random = numbers_with_index(numbers_random(job.seed, job.replicate), job.first + slot);
    let came = photon_arrive(&photon, &hit, random, job.max_hits);
    wave_put_photon(slot, photon);
    wave_put_hit(slot, ROW_HIT, hit);
    wave_put(slot, ROW_QUERY, PHOTON_OVER);
    if came == PHOTON_GOES { wave_ask(slot, PHOTON_CLOSEST); }
    let lands = came == PHOTON_LANDS;
    //: else
    //: if SURFACES
    if wave_get(slot, ROW_QUERY) != PHOTON_CLOSEST {
        if shot_looked(slot) { wave_lands(slot); }
        return;
    }
    //: end
    wave_put(slot, ROW_QUERY, PHOTON_OVER);
    let lands = wave_get(slot, ROW_HIT + 1u) != TREE_NOTHING;
    //: end
    if lands {
        //: if SURFACES
        if wave_get(slot, ROW_LIGHT) != NO_INDEX { shot_weigh(slot); }
        //: end
        wave_lands(slot);
    }
}

fn wave_register(hit: Hit, from_front: bool, photon: Photon) {
    let map = ElementMap(job.nodes, job.per_side, photons_has(PHOTONS_LINEAR), photons_has(PHOTONS_APART));
    let deposit = elements_deposit(map, hit.primitive, hit.b1, hit.b2, from_front);
    let at = list_at(0u) + job.lists;
    sums_deposit(deposit, at, job.elements, photon.flux, job.power);
    if photons_has(PHOTONS_CAUSTICS) && photon.caustic {
        sums_deposit(deposit, at + 6u * job.elements, job.elements, photon.flux, job.power);
    }
}

// Registers a photon that has landed and sends it on; whether that was an arrival that counts.
fn wave_scatter(slot: u32, rank: u32) -> bool {
    var photon = wave_photon(slot);
    let hit = wave_hit(slot);
    wave_put(slot, ROW_QUERY, PHOTON_OVER);
    //: if SORTED
    // What it hit is past: its chance lies there, of those that end 0.
    wave_put(slot, ROW_HIT, 0u);
    //: end
    if photon.hits >= job.max_hits { return false; }
    let surface = surface_at(photon.ray, hit);
    if !surface.found { return false; }
    let counts = photon.hits > 0u || photon.registers_first;
    if counts { wave_register(hit, surface.from_front, photon); }
    //: if SORTED
    let u = numbers_group4(wave_numbers(job.first + rank), job.group);
    let chance = photon_scatter(&photon, surface, u.xy, u.z, job.max_hits);
    wave_put_photon(slot, photon);
    wave_put(slot, ROW_HIT, photon_chance_count(chance));
    //: else
    let u = numbers_group4(wave_numbers(job.first + slot), PHOTON_WALK_GROUP + photon.hits);
    let chance = photon_scatter(&photon, surface, u.xy, u.z, job.max_hits);
    if !(u.w >= chance) {
        photon.flux = photon.flux / chance;
        wave_put_photon(slot, photon);
        wave_ask(slot, PHOTON_CLOSEST);
    }
    //: end
    return counts;
}

@compute @workgroup_size(64)
fn scatter(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    //: if REORDERED
    math_opaque = job.zero;
    //: end
    let i = job.window + id.x;
    //: if SORTED
    let list = LIST_LANDED + atomicLoad(&sums[HEAD_PARITY]);
    let count = atomicLoad(&sums[HEAD_ORDERED]);
    //: else
    let list = LIST_LANDED;
    let count = atomicLoad(&sums[HEAD_LANDED]);
    //: end
    if i < count {
        if wave_scatter(atomicLoad(&sums[list_at(list) + i]), i) { atomicAdd(&hits_of_group, 1u); }
    }
    workgroupBarrier();
    if local == 0u { sums_add(HEAD_HITS, vec2(atomicLoad(&hits_of_group), 0u)); }
}
