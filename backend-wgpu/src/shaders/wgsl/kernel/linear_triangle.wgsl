//: use kernel::words
//: use sampling::linear_triangle

fn kernel_linear_triangle_sample() {
    let weights = triple();
    put3(linear_triangle_sample(weights, pair()));
}

fn kernel_linear_triangle_pdf() {
    let weights = triple();
    put(linear_triangle_pdf(weights, triple()));
}

fn kernel_linear_triangle_invert() {
    let weights = triple();
    put2(linear_triangle_invert(weights, triple()));
}

fn kernel_linear_triangle_apex_distance() {
    let weights = triple();
    let d = linear_triangle_apex_distance(weights, float());
    put_word(d.apex);
    put(d.distance);
    put(d.complement);
}
