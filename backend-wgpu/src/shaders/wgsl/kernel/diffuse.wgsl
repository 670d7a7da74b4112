//: use kernel::words
//: use bsdf::diffuse

fn kernel_diffuse_eval() {
    let albedo = triple();
    let n = triple();
    put3(diffuse_eval(albedo, n, triple()));
}

fn kernel_diffuse_pdf_solid_angle() {
    let n = triple();
    put(diffuse_pdf_solid_angle(n, triple()));
}

fn kernel_diffuse_sample() {
    let n = triple();
    put3(diffuse_sample(n, pair()));
}
