//: use kernel::one_light
//: use light

fn kernel_light_sample() {
    let p = triple();
    let s = light_sample(0u, p, pair());
    if !s.found { return; }
    put_word(1u);
    put3(s.wi);
    put3(s.contribution);
    put(s.pdf);
    put3(s.point);
    put3(s.normal);
    put(s.extent);
    put_word(u32(s.distant));
}

fn kernel_light_pdf_solid_angle() {
    let p = triple();
    let wi = triple();
    let distance = float();
    put(light_pdf_solid_angle(0u, p, wi, distance, triple()));
}
