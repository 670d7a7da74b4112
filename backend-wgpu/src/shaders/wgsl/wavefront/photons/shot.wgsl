// Starts on surfaces that lights without size light: core's density, in tables behind the states. They begin with where the ranges of pieces, the ranks of
// triangles, the slots of lights, their chances per watt, the pieces, the entries and the counts are; how many triangles and lights there are; and whether starts are weighted exactly.
//: use direct::irradiance
//: use sampling::discrete
//: use sampling::linear_triangle
//: use scene::counts
//: use transport::first_shot::place
//: use transport::first_shot::weight
//: use wavefront::photons::slots

// Words of a piece: triangle, light, three corners, weights, area, chance to look.
const PIECE_WORDS: u32 = 13u;

fn shot_word(i: u32) -> u32 { return job_word(job.shot_at + i); }

fn shot_ranges(i: u32) -> u32 { return shot_word(shot_word(0u) + i); }

fn shot_rank(triangle: u32) -> u32 { return shot_word(shot_word(1u) + triangle); }

fn shot_slot(light: u32) -> u32 { return shot_word(shot_word(2u) + light); }

fn shot_per_watt(light: u32) -> f32 { return bitcast<f32>(shot_word(shot_word(3u) + light)); }

fn shot_is_exact() -> bool { return shot_word(9u) != 0u; }

fn shot_counts() { counts_at = COUNTS_OF_JOB + job.shot_at + shot_word(6u); }

struct ShotPiece {
    triangle: u32,
    light: u32,
    corners: array<vec2<u32>, 3>,
    weights: vec3<f32>,
    area: f32,
    looks: f32,
}

fn shot_float(i: u32) -> f32 { return bitcast<f32>(shot_word(i)); }

fn shot_piece(index: u32) -> ShotPiece {
    let at = shot_word(4u) + PIECE_WORDS * index;
    return ShotPiece(
        shot_word(at),
        shot_word(at + 1u),
        array(
            vec2(shot_word(at + 2u), shot_word(at + 3u)),
            vec2(shot_word(at + 4u), shot_word(at + 5u)),
            vec2(shot_word(at + 6u), shot_word(at + 7u)),
        ),
        vec3(shot_float(at + 8u), shot_float(at + 9u), shot_float(at + 10u)),
        shot_float(at + 11u),
        shot_float(at + 12u),
    );
}

// A light's colour: its radiance over its mean.
fn shot_colour(light: u32) -> vec3<f32> {
    let brightest = light_radiance(light);
    let mean = math_mean(brightest);
    if mean > 0.0f { return brightest / mean; }
    return vec3(0.0f);
}

// A photon from an entry after the pieces.
fn shot_fly(entry: u32, pmf: f32, u: vec4<f32>) -> Photon {
    let at = shot_word(5u) + 2u * entry;
    let light = shot_word(at);
    let emitted = photon_emit_entry(light, wave_sphere(), u);
    var photon = photon_new(emitted.emission.ray, emitted.emission.flux / pmf);
    let paired = shot_word(at + 1u) != 0u;
    photon.registers_first = !paired && !emitted.point_like;
    photon.caustic = paired || emitted.point_like;
    photon.survives_first = paired;
    if paired { photon.light = light; }
    return photon;
}

// A start: `pick` chooses the entry, `u` the place and whether it looks, or the light's photon.
fn shot_begin(pick: u32, u: vec4<f32>) -> PhotonBegins {
    var begins: PhotonBegins;
    shot_counts();
    let picked = discrete_pick_in(job.pieces + job.entries, pick);
    if picked.index >= job.pieces {
        let entry = picked.index - job.pieces;
        if entry < job.entries {
            begins.found = true;
            begins.photon = shot_fly(entry, picked.pmf, u);
            begins.entry = shot_word(shot_word(5u) + 2u * entry);
        }
        return begins;
    }
    let piece = shot_piece(picked.index);
    let light = light_record(piece.light);
    let on_piece = linear_triangle_sample(piece.weights, u.xy);
    let b = first_shot_on_triangle(piece.corners, on_piece);
    let point = surface_on(piece.triangle, b.y, b.z);
    let normal = surface_front(piece.triangle);
    let to_light = emit_toward(light, point.position);
    begins.entry = piece.light;
    begins.lands = true;
    begins.hit = Hit(0.0f, piece.triangle, b.y, b.z);
    begins.photon = photon_new(Ray(point.position, -to_light, MAX_FLOAT), vec3(0.0f));
    begins.photon.registers_first = false;
    begins.photon.caustic = true;
    begins.photon.survives_first = true;
    begins.chance = piece.looks;
    begins.colour = shot_colour(light);
    let direct = irradiance_from_light(light, point, normal);
    begins.found = true;
    begins.look = direct.ray;
    if shot_is_exact() {
        begins.found = direct.found;
        let density = first_shot_density(picked.pmf, piece.weights, piece.area, on_piece);
        let per_watt = shot_per_watt(piece.light);
        begins.photon.flux = first_shot_start_flux(direct.irradiance, density, per_watt);
        begins.looks = u.w < piece.looks;
        begins.densities = vec2(density, first_shot_light_density(direct.irradiance, per_watt));
    } else {
        begins.photon.flux = first_shot_piece_flux(begins.colour, piece.weights, piece.area, picked.pmf);
        //: if VOLUME
        begins.looks = true;
        // To where the light is, should it send nothing here.
        if !direct.found {
            begins.look = geometry_segment(
                geometry_offset_origin(point, normal, to_light),
                light_float3(light + LIGHT_PLACE),
            );
        }
        //: end
    }
    return begins;
}

//: if not VOLUME
// Whether a start has landed with something, now that it is known whether it is lit.
fn shot_looked(slot: u32) -> bool {
    let blocked = wave_get(slot, ROW_QUERY) == PHOTON_BLOCKED;
    var photon = wave_photon(slot);
    var hit = wave_hit(slot);
    let point = surface_on(hit.primitive, hit.b1, hit.b2);
    photon.ray = Ray(point.position, -emit_toward(light_record(photon.light), point.position), MAX_FLOAT);
    photon.light = NO_INDEX;
    photon.flux *= first_shot_look_factor(hit.t, blocked);
    hit.t = 0.0f;
    wave_put_hit(slot, ROW_HIT, hit);
    wave_put_photon(slot, photon);
    wave_put(slot, ROW_QUERY, PHOTON_OVER);
    return !math_is_zero3(photon.flux);
}
//: end

// Density per area of starts on the pieces of one light at a hit.
fn shot_density_at(light: u32, hit: Hit) -> f32 {
    let slot = shot_slot(light);
    if slot == NO_INDEX { return 0.0f; }
    let pair = slot * shot_word(7u) + shot_rank(hit.primitive);
    let end = shot_ranges(pair + 1u);
    var best = 0.0f;
    var index = NO_INDEX;
    var local = vec3(0.0f);
    var done = false;
    for (var i = shot_ranges(pair); i < end && !done; i++) {
        let within = first_shot_within(shot_piece(i).corners, vec2(hit.b1, hit.b2));
        let least = math_min(within.local.x, math_min(within.local.y, within.local.z));
        if within.ok && (index == NO_INDEX || least > best) {
            best = least;
            index = i;
            local = within.local;
        }
        done = within.ok && least >= 0.0f;
    }
    if index == NO_INDEX || !(best >= -FIRST_SHOT_SLACK) { return 0.0f; }
    let piece = shot_piece(index);
    shot_counts();
    let pmf = discrete_pmf_in(job.pieces + job.entries, index);
    return first_shot_density(pmf, piece.weights, piece.area, local);
}

// Weighs a photon that has come straight from a light with pieces against a start where it has landed.
fn shot_weigh(slot: u32) {
    let light = wave_get(slot, ROW_LIGHT);
    wave_put(slot, ROW_LIGHT, NO_INDEX);
    if !shot_is_exact() {
        wave_put_triple(slot, ROW_FLUX, vec3(0.0f));
        return;
    }
    let hit = wave_hit(slot);
    let point = surface_on(hit.primitive, hit.b1, hit.b2);
    let direct = irradiance_from_light(light_record(light), point, surface_front(hit.primitive));
    if !direct.found { return; }
    var e = direct.irradiance;
    //: if VOLUME
    e = e * wave_float(slot, ROW_CHANCE);
    //: end
    let share = first_shot_light_share(e, shot_density_at(light, hit), shot_per_watt(light));
    wave_put_triple(slot, ROW_FLUX, wave_triple(slot, ROW_FLUX) * share);
}
