// Logarithmic codes: the numbers at levels between codes. Thresholds and tables of codes are arrays, which their readers look into.
//: use math::bits
//: use math::rounding
//: use math::exp_ln

// max e^a, a = -width (255 - level) / 255; the root of a small power is taken twice, since alone the power may be subnormal.
fn log_offset_decayed(largest: f32, width: f32, level: f32) -> f32 {
    let a = math_min((level - 255.0f) * width / 255.0f, 0.0f);
    let twice = a < -86.0f;
    let e = math_exp(select(a, 0.5f * a, twice));
    return largest * e * select(1.0f, e, twice);
}

// (1 - e^-d) / d by Taylor's series.
fn log_offset_mean_exp_negative(d: f32) -> f32 {
    var sum = 1.0f / 362880.0f;
    sum = 1.0f / 40320.0f - d * sum;
    sum = 1.0f / 5040.0f - d * sum;
    sum = 1.0f / 720.0f - d * sum;
    sum = 1.0f / 120.0f - d * sum;
    sum = 1.0f / 24.0f - d * sum;
    sum = 1.0f / 6.0f - d * sum;
    sum = 0.5f - d * sum;
    return 1.0f - d * sum;
}

fn log_offset_value_at(width: f32, largest: f32, level: f32) -> f32 {
    if level >= 0.5f { return log_offset_decayed(largest, width, level); }
    return 0.0f;
}

fn log_offset_mean_at(width: f32, largest: f32, level_in: f32) -> f32 {
    if !(level_in >= 0.5f) { return 0.0f; }
    let level = math_min(level_in, 255.0f);
    let upper = math_min(level + 0.5f, 255.0f);
    let d = math_clamp((upper - (level - 0.5f)) * (width / 255.0f), 0.0f, 0.7f);
    return log_offset_decayed(largest, width, upper) * log_offset_mean_exp_negative(d);
}
