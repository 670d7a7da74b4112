//: use kernel::words
//: use transport::first_shot::place
//: use transport::first_shot::weight

// Corners of a piece; not `ok` where one lies outside the triangle.
struct KernelFirstShotCorners { ok: bool, corners: array<vec2<u32>, 3> }

fn kernel_first_shot_corners() -> KernelFirstShotCorners {
    var r: KernelFirstShotCorners;
    r.ok = true;
    for (var i = 0u; i < 3u; i++) {
        let x = word();
        let corner = vec2(x, word());
        r.ok = r.ok && subdivide_bary_is_valid(corner);
        r.corners[i] = corner;
    }
    return r;
}

fn kernel_first_shot_place() {
    let piece = kernel_first_shot_corners();
    if !piece.ok { return; }
    let weights = triple();
    put3(first_shot_on_triangle(piece.corners, linear_triangle_sample(weights, pair())));
}

fn kernel_first_shot_within() {
    let piece = kernel_first_shot_corners();
    if !piece.ok { return; }
    let within = first_shot_within(piece.corners, pair());
    if within.ok {
        put_word(1u);
        put3(within.local);
    }
}

fn kernel_first_shot_density() {
    let piece = kernel_first_shot_corners();
    if !piece.ok { return; }
    let weights = triple();
    let area = float();
    let pmf = float();
    let within = first_shot_within(piece.corners, pair());
    if within.ok { put(first_shot_density(pmf, weights, area, within.local)); }
}

fn kernel_first_shot_start_flux() {
    let e = triple();
    let density = float();
    put3(first_shot_start_flux(e, density, float()));
}

fn kernel_first_shot_light_share() {
    let e = triple();
    let density = float();
    put(first_shot_light_share(e, density, float()));
}

fn kernel_first_shot_look_factor() {
    let chance = float();
    put(first_shot_look_factor(chance, word() != 0u));
}

fn kernel_first_shot_piece_flux() {
    let colour = triple();
    let weights = triple();
    let area = float();
    put3(first_shot_piece_flux(colour, weights, area, float()));
}
