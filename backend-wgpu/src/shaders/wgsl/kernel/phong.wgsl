//: use kernel::words
//: use bsdf::phong

fn kernel_phong_eval() {
    let specular = triple();
    let exponent = float();
    let n = triple();
    let wo = triple();
    put3(phong_eval(specular, exponent, n, wo, triple()));
}

fn kernel_phong_pdf_solid_angle() {
    let exponent = float();
    let n = triple();
    let wo = triple();
    put(phong_pdf_solid_angle(exponent, n, wo, triple()));
}

fn kernel_phong_sample() {
    let exponent = float();
    let n = triple();
    let wo = triple();
    put3(phong_sample(exponent, n, wo, pair()));
}
