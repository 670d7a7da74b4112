// States of photons: what of them is behind which rows, and the rays that they ask for.
//: use transport::photon
//: use tree::walk
//: use wavefront::photons::job
//: use wavefront::states::rays
//: if VOLUME
//: use transport::photon::through
//: use wavefront::states::media
//: end

fn element_word(i: u32) -> u32 { return states[job.elements_at + i]; }

fn wave_photon(slot: u32) -> Photon {
    let flags = wave_get(slot, ROW_FLAGS);
    return Photon(
        wave_triple(slot, ROW_FLUX),
        wave_ray(slot),
        wave_get(slot, ROW_HITS),
        wave_get(slot, ROW_LIGHT),
        (flags & 1u) != 0u,
        (flags & 2u) != 0u,
        (flags & 4u) != 0u,
        //: if VOLUME
        PhotonWay(
            wave_inside(slot, ROW_INSIDE),
            wave_inside(slot, ROW_BEYOND),
            wave_float(slot, ROW_LEAD),
            wave_get(slot, ROW_EVENT),
            wave_float(slot, ROW_CHANCE),
            wave_get(slot, ROW_CHANNEL),
            wave_get(slot, ROW_CROSSED),
        ),
        //: end
    );
}

fn wave_put_photon(slot: u32, photon: Photon) {
    wave_put_triple(slot, ROW_FLUX, photon.flux);
    wave_put_ray(slot, photon.ray);
    wave_put(slot, ROW_HITS, photon.hits);
    wave_put(slot, ROW_LIGHT, photon.light);
    let caustic = select(0u, 2u, photon.caustic);
    wave_put(slot, ROW_FLAGS, u32(photon.registers_first) | caustic | select(0u, 4u, photon.survives_first));
    //: if VOLUME
    wave_put_inside(slot, ROW_INSIDE, photon.way.inside);
    wave_put_inside(slot, ROW_BEYOND, photon.way.beyond);
    wave_put_float(slot, ROW_LEAD, photon.way.lead);
    wave_put(slot, ROW_EVENT, photon.way.event);
    wave_put_float(slot, ROW_CHANCE, photon.way.chance);
    wave_put(slot, ROW_CHANNEL, photon.way.channel);
    wave_put(slot, ROW_CROSSED, photon.way.crossed);
    //: end
}

fn wave_numbers(index: u32) -> Numbers {
    if photons_has(PHOTONS_RANDOM) { return numbers_with_index(numbers_random(job.seed, job.replicate), index); }
    return numbers_with_index(numbers_sobol(job.seed, job.replicate), index);
}

fn wave_sphere() -> vec4<f32> { return vec4(job.sphere_x, job.sphere_y, job.sphere_z, job.sphere_radius); }

// How a photon begins: it flies from entry `entry` of what emits, or has landed straight from that light. Where it `looks`, its flux is multiplied by what
// the way along `look` leaves of the light.
struct PhotonBegins {
    found: bool,
    lands: bool,
    looks: bool,
    photon: Photon,
    entry: u32,
    hit: Hit,
    look: Ray,
    chance: f32,
    // Densities of starts there, and of photons straight from the light; both 0 where starts are not weighted exactly.
    densities: vec2<f32>,
    colour: vec3<f32>,
}

//: if VOLUME
// A photon in the box of a medium that emits.
fn photon_glow(index: u32, u: vec4<f32>) -> Emission {
    let at = job.glows_at + 10u * index;
    let low = vec3(job_float(at + 1u), job_float(at + 2u), job_float(at + 3u));
    let high = vec3(job_float(at + 4u), job_float(at + 5u), job_float(at + 6u));
    let flux = vec3(job_float(at + 7u), job_float(at + 8u), job_float(at + 9u));
    return Emission(Ray(low + (high - low) * u.xyz, vec3(0.0f), MAX_FLOAT), flux);
}
//: end

// The photon of a slot has landed.
fn wave_lands(slot: u32) {
    wave_put(slot, ROW_QUERY, PHOTON_LANDED);
    //: if not SORTED
    let place = atomicAdd(&sums[HEAD_LANDED], 1u);
    atomicStore(&sums[list_at(LIST_LANDED) + place], slot);
    //: end
}

@compute @workgroup_size(64)
fn trace(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = wave_slot(id.x);
    if slot == job.slots { return; }
    let shadow = wave_get(slot, ROW_QUERY) == PHOTON_SHADOW;
    let hit = tree_walk(wave_ray(slot), shadow);
    if shadow {
        // Where the photon is stays as it is.
        wave_put(slot, ROW_QUERY, select(PHOTON_BLOCKED, PHOTON_CLEAR, hit.primitive == TREE_NOTHING));
        return;
    }
    wave_put_hit(slot, ROW_HIT, hit);
}
