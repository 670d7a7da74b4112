//: use kernel::words
//: use sampling::counter

fn kernel_counter_bits4() {
    let seed = vec2(constants[0], constants[1]);
    let stream = word();
    let sample = word();
    put_words4(counter_bits4(seed, stream, sample, word()));
}
