//: use kernel::words
//: use sampling::sobol
//: use sampling::sobol::set

fn kernel_sobol_bits4() {
    let seed = vec2(constants[0], constants[1]);
    let stream = word();
    let block = word();
    let sampler = sobol_block_sampler(seed, stream, block, word());
    put_words4(sobol_bits4(sampler, word()));
}

fn kernel_sobol_set_dimension() {
    let points = sobol_set(vec2(constants[0], constants[1]));
    let index = word();
    put_word(sobol_set_dimension(points, index, word()));
}
