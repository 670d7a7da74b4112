//: use kernel::words
//: use bsdf::fresnel

fn kernel_fresnel_dielectric() {
    let cos = float();
    put(fresnel_dielectric(cos, float()));
}

fn kernel_fresnel_conductor() {
    let cos = float();
    let eta = float();
    put(fresnel_conductor(cos, eta, float()));
}
