//: use kernel::words
//: use codec::log_offset

// search_in over the constants, which are the thresholds.
fn kernel_log_offset_encode() {
    let x = float();
    var count = 0u;
    for (var step = 128u; step > 0u; step >>= 1u) {
        if x >= bitcast<f32>(constants[count + step - 1u]) { count += step; }
    }
    put_word(count);
}

fn kernel_log_offset_look_up() { put_word(constants[word() & 255u]); }

fn kernel_log_offset_decode() {
    let width = constant_float();
    let largest = constant_float();
    put(log_offset_value_at(width, largest, float()));
}

fn kernel_log_offset_decode_mean() {
    let width = constant_float();
    let largest = constant_float();
    put(log_offset_mean_at(width, largest, float()));
}
