//: use kernel::words
//: use tone

fn kernel_tone_display() {
    let map = constant_word();
    let exposure = constant_float();
    let a = constant_float();
    let c = constant_float();
    put3(tone_display(ToneSettings(map, exposure, a, c, constant_float()), triple()));
}
