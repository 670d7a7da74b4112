//: use kernel::words
//: use sampling::warp

fn kernel_warp_sample_sphere() { put3(warp_sample_sphere(pair())); }

fn kernel_warp_pdf_solid_angle_sphere() { put(warp_pdf_solid_angle_sphere(triple())); }

fn kernel_warp_invert_sphere() { put2(warp_invert_sphere(triple())); }

fn kernel_warp_sample_hemisphere() { put3(warp_sample_hemisphere(pair())); }

fn kernel_warp_pdf_solid_angle_hemisphere() { put(warp_pdf_solid_angle_hemisphere(triple())); }

fn kernel_warp_invert_hemisphere() { put2(warp_invert_hemisphere(triple())); }

fn kernel_warp_sample_cosine_hemisphere() { put3(warp_sample_cosine_hemisphere(pair())); }

fn kernel_warp_pdf_solid_angle_cosine_hemisphere() { put(warp_pdf_solid_angle_cosine_hemisphere(triple())); }

fn kernel_warp_invert_cosine_hemisphere() { put2(warp_invert_cosine_hemisphere(triple())); }

fn kernel_warp_sample_cone() {
    let u = pair();
    put3(warp_sample_cone(u, float()));
}

fn kernel_warp_pdf_solid_angle_cone() {
    let w = triple();
    put(warp_pdf_solid_angle_cone(float(), w));
}

fn kernel_warp_invert_cone() {
    let w = triple();
    put2(warp_invert_cone(float(), w));
}

fn kernel_warp_sample_power_cosine() {
    let u = pair();
    put3(warp_sample_power_cosine(u, float()));
}

fn kernel_warp_pdf_solid_angle_power_cosine() {
    let w = triple();
    put(warp_pdf_solid_angle_power_cosine(float(), w));
}

fn kernel_warp_invert_power_cosine() {
    let w = triple();
    put2(warp_invert_power_cosine(float(), w));
}

fn kernel_warp_sample_disk() { put2(warp_sample_disk(pair())); }

fn kernel_warp_pdf_area_disk() { put(warp_pdf_area_disk(pair())); }

fn kernel_warp_invert_disk() { put2(warp_invert_disk(pair())); }

fn kernel_warp_sample_triangle() { put3(warp_sample_triangle(pair())); }

fn kernel_warp_pdf_area_triangle() {
    let edge0 = triple();
    put(warp_pdf_area_triangle(edge0, triple()));
}

fn kernel_warp_invert_triangle() { put2(warp_invert_triangle(triple())); }

fn kernel_warp_sample_parallelogram() {
    let origin = constant_triple();
    let edge0 = constant_triple();
    let edge1 = constant_triple();
    put3(warp_sample_parallelogram(pair(), origin, edge0, edge1));
}

fn kernel_warp_pdf_area_parallelogram() {
    let edge0 = triple();
    put(warp_pdf_area_parallelogram(edge0, triple()));
}

fn kernel_warp_invert_parallelogram() {
    let origin = constant_triple();
    let edge0 = constant_triple();
    let edge1 = constant_triple();
    put2(warp_invert_parallelogram(origin, edge0, edge1, triple()));
}
