//: use kernel::words
//: use medium::phase

fn kernel_phase_eval() {
    let g = float();
    let wo = triple();
    put(phase_eval(g, wo, triple()));
}

fn kernel_phase_sample() {
    let g = float();
    let wo = triple();
    put3(phase_sample(g, wo, pair()));
}
