//: use kernel::words
//: use codec::bc4

fn kernel_bc4_decode() {
    let low = word();
    var texels = bc4_decode(vec2(low, word()));
    for (var i = 0u; i < 16u; i++) { put_word(texels[i]); }
}

fn kernel_bc4_encode_range_fit() {
    var texels = array<u32, 16>();
    for (var i = 0u; i < 16u; i++) { texels[i] = word() & 255u; }
    let block = bc4_encode_range_fit(texels, word());
    put_word(block.x);
    put_word(block.y);
}
