//: use kernel::words
//: use math::bits

fn kernel_sampling_u32_to_unit() { put(math_u32_to_unit(word())); }
