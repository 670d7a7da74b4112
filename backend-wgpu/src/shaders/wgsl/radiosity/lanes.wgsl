// Sums of products in sixteen lanes: the fold.
//: use math::bits

// A sum that has no value counts as 0.
fn lanes_value_or_zero(sum: f32) -> f32 {
    if math_is_nan(sum) { return 0.0f; }
    return sum;
}

// Lane l takes l + 8, then l + 4, l + 2, l + 1.
fn lanes_fold(lanes: array<f32, 16>) -> f32 {
    var s = lanes;
    for (var l = 0u; l < 8u; l++) { s[l] = s[l] + s[l + 8u]; }
    for (var l = 0u; l < 4u; l++) { s[l] = s[l] + s[l + 4u]; }
    return lanes_value_or_zero((s[0] + s[2]) + (s[1] + s[3]));
}
