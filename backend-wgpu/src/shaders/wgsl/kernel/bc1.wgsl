//: use kernel::words
//: use codec::bc1

fn kernel_bc1_put(rule: u32, alpha: u32) {
    let ends = word();
    let indices = word();
    var texels = bc1_decode_with(ends, indices, rule);
    for (var i = 0u; i < 16u; i++) { put_word(texels[i] & alpha); }
}

fn kernel_bc1_decode() { kernel_bc1_put(BC1_NEAREST, 0x00ffffffu); }

fn kernel_bc1_decode_with() { kernel_bc1_put(constant_word(), 0xffffffffu); }

fn kernel_bc1_encode_range_fit() {
    var texels = array<u32, 16>();
    for (var i = 0u; i < 16u; i++) { texels[i] = word(); }
    let block = bc1_encode_range_fit(texels, word());
    put_word(block.x);
    put_word(block.y);
}
