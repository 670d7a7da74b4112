// The first step of a photon where there are media: which ones it starts in, and what its way has left of a light that it comes straight from.
//: use illumination::sums
//: if FOLLOWS
//: use transport::volume::lights
//: end
//: use wavefront::photons::slots

//: if VOLUME
fn wave_inside_at(at: u32) -> Inside { return vec3(job_word(at), job_word(at + 1u), job_word(at + 2u)); }

//: if FOLLOWS
// What is multiplied into a start's flux where this is left of the light.
fn wave_seen(begins: PhotonBegins, straight: FromLight) -> vec3<f32> {
    let here = begins.densities.x;
    let there = begins.densities.y;
    if here + there > 0.0f { return straight.left * ((here + there) / (here + there * straight.chance)); }
    let mean = math_mean(begins.colour * straight.left);
    if mean > 0.0f { return straight.left / mean; }
    return vec3(1.0f);
}
//: end

fn wave_begin(slot: u32, begins: PhotonBegins) {
    var photon = begins.photon;
    wave_put(slot, ROW_QUERY, PHOTON_OVER);
    if !begins.found || (begins.lands && !begins.looks) { return; }
    // Media of lights: outside, then of each whether they are the same all over it, and which.
    let outside = wave_inside_at(job.media_at);
    let known = job.media_at + 3u + 4u * begins.entry;
    let is_glow = begins.entry > scene_at.light_count;
    var inside = outside;
    if begins.entry < job.media_count { inside = wave_inside_at(known + 1u); }
    //: if FOLLOWS
    let searches = is_glow || (begins.entry < job.media_count && job_word(known) == 0u);
    if begins.lands || searches {
        let phase = select(LIGHTS_OUT, LIGHTS_BACK, begins.lands);
        let normal = surface_front(begins.hit.primitive);
        var ray = photon.ray;
        if begins.lands { ray = begins.look; }
        let followed = lights_follow(phase, ray, inside, outside, photon.ray.origin, normal, true);
        inside = followed.inside;
        if begins.lands {
            photon.flux *= wave_seen(begins, followed);
            sums_add(HEAD_RAYS, vec2(followed.rays, 0u));
        }
    }
    //: end
    photon.way.inside = inside;
    if is_glow {
        // Only where the medium counts does it emit.
        let glow = job.glows_at + 10u * (begins.entry - scene_at.light_count - 1u);
        let medium = scene_at.media + MEDIUM_WORDS * (job_word(glow) - 1u);
        if inside_current(inside) != medium { photon.flux = vec3(0.0f); }
        let random = numbers_with_index(numbers_random(job.seed, job.replicate), job.first + slot);
        photon.ray.direction = warp_sample_sphere(numbers_group4(random, PHOTON_GLOW_GROUP).xy);
    }
    if begins.lands { photon.way.beyond = boundaries_resolve(photon.ray, begins.hit, inside).inside; }
    wave_put_hit(slot, ROW_HIT, begins.hit);
    wave_put_photon(slot, photon);
    if math_is_zero3(photon.flux) { return; }
    if begins.lands {
        wave_lands(slot);
    } else {
        wave_ask(slot, PHOTON_CLOSEST);
    }
}
//: end
