// The scene is that of the kernels of bitmaps.
//: use kernel::words
//: use kernel::bitmap
//: use math::bits
//: use direct::emission
//: use direct::emission::cut
//: use direct::emission::scan

const KERNEL_EMISSION_MAX_CELLS: f32 = 4096.0f;

// A bitmap that cannot be is one of its first texel alone.
fn kernel_emission_size() -> vec2<u32> {
    let size = vec2(constants[0], constants[1]);
    let sides = size.x >= 1u && size.x <= EMISSION_MAX_SIDE && size.y >= 1u && size.y <= EMISSION_MAX_SIDE;
    let texels = math_wide_mul(size.x, size.y);
    let there = constant_count - 2u;
    if sides && texels.x == 0u && texels.y <= there { return size; }
    return vec2(1u, 1u);
}

fn kernel_emission_points() -> array<vec2<f32>, 3> {
    let a = pair();
    let b = pair();
    return array(a, b, pair());
}

fn kernel_emission_put(albedo: EmissionAlbedo) {
    if albedo.ok {
        put_word(1u);
        put3(albedo.at[0]);
        put3(albedo.at[1]);
        put3(albedo.at[2]);
    }
}

fn kernel_emission_coefficient() {
    let a = triple();
    let b = triple();
    let area = emission_piece_area(a, b, triple());
    let albedo = triple();
    let e0 = triple();
    let e1 = triple();
    put3(emission_emission(albedo, area, array(e0, e1, triple())));
    put(area);
}

fn kernel_emission_overlap() {
    let overlap = emission_overlap_unit(kernel_emission_points());
    put(overlap.share);
    put3(overlap.bary);
}

fn kernel_emission_scan() {
    let uv = kernel_emission_points();
    kernel_emission_put(emission_scan(kernel_emission_size(), 0u, uv, KERNEL_EMISSION_MAX_CELLS));
}

fn kernel_emission_scan_texels() {
    let uv = kernel_emission_points();
    kernel_emission_put(emission_scan_texels(kernel_emission_size(), 0u, uv, KERNEL_EMISSION_MAX_CELLS));
}

fn kernel_emission_brightest_in() { put3(emission_brightest_in(kernel_emission_size(), 0u, kernel_emission_points())); }
