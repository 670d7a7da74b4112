// No finishes: coats are not read.
//: use kernel::words
//: use bsdf::lobes

fn scene_word(i: u32) -> u32 { return 0u; }

fn scene_float(i: u32) -> f32 { return 0.0f; }

fn kernel_lobes_lobes() -> Lobes {
    let albedo = triple();
    let specular = triple();
    let exponent = float();
    return lobes_plain(albedo, specular, exponent, word() != 0u);
}

fn kernel_lobes_eval() {
    let lobes = kernel_lobes_lobes();
    let n = triple();
    let wo = triple();
    put3(lobes_eval(lobes, n, wo, triple()));
}

fn kernel_lobes_pdf_solid_angle() {
    let lobes = kernel_lobes_lobes();
    let n = triple();
    let wo = triple();
    put(lobes_pdf_solid_angle(lobes, n, wo, triple()));
}

fn kernel_lobes_sample() {
    let lobes = kernel_lobes_lobes();
    let n = triple();
    let wo = triple();
    let u = pair();
    let s = lobes_sample(lobes, n, wo, u, float());
    if !s.found { return; }
    put_word(1u);
    put3(s.wi);
    put3(s.weight);
    put(s.pdf);
}
