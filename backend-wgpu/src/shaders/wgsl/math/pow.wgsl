// x^y = 2^(y log2 x), the logarithm and the product kept in two floats.
//: use math::exp_ln
//: use math::rounding

fn math_log2_in_two(x: f32, shift: i32) -> vec2<f32> {
    let split = math_split_around_one(x);
    let k = f32(split.k + shift);
    let m = split.m;
    let f = m - 1.0f;
    let divisor = m + 1.0f;
    let inverse = 1.0f / divisor;
    let s = math_kept(f * inverse);
    let s_upper = math_upper12(s);
    let divisor_upper = math_upper12(divisor);
    let divisor_lower = m - math_kept(divisor_upper - 1.0f);
    let rest_of_s = math_kept(math_kept(f - math_kept(s_upper * divisor_upper)) - s_upper * divisor_lower);
    let s_lower = rest_of_s * inverse;

    let square_upper = math_kept(s_upper * s_upper);
    let square = s * s;
    let q = 0.6000023f + square * (0.42820632f + square * 0.35129592f);
    let rest = math_kept(square * square * q + s_lower * (s_upper + s));
    let bracket_upper = math_upper12(3.0f + square_upper + rest);
    let bracket_lower = rest - math_kept(math_kept(bracket_upper - 3.0f) - square_upper);

    let large = math_kept(s_upper * bracket_upper);
    let small = math_kept(s_lower * bracket_upper + bracket_lower * s);
    let product_upper = math_upper12(large + small);
    let product_lower = small - math_kept(product_upper - large);

    let large2 = math_kept(0.9616699f * product_upper);
    let small2 = math_kept(math_kept(1.2677205e-4f * product_upper) + product_lower * 0.9617967f);
    let upper = math_upper12((large2 + small2) + k);
    return vec2(upper, small2 - math_kept(math_kept(upper - k) - large2));
}

fn math_pow_normal(x: f32, shift: i32, y_in: f32) -> f32 {
    let l = math_log2_in_two(x, shift);
    let y = math_clamp(y_in, -1.0995116e12f, 1.0995116e12f);
    let y_upper = math_upper12(y);
    var product = math_kept(y_upper * l.x);
    var small = math_kept(math_kept(y - y_upper) * l.x + y * l.y);
    if math_abs(product + small) > 151.0f {
        product = math_clamp(product, -151.0f, 151.0f);
        small = 0.0f;
    }
    let n = math_nearest(product + small);
    let difference = math_kept(product - n.kf);
    let r = math_kept(difference + small);
    let lost = small - math_kept(r - difference);
    return math_scale(1.0f + math_exp2_minus_one(r, lost), n.k);
}

fn math_pow(x: f32, y: f32) -> f32 {
    if math_is_positive_normal(x) && !math_is_nan(y) { return math_pow_normal(x, 0, y); }
    if y == 0.0f { return 1.0f; }
    if math_is_nan(x) || math_is_nan(y) { return math_nan(); }
    if x > 0.0f && x < MIN_POSITIVE { return math_pow_normal(math_normalised(x), -23, y); }
    if (x <= 0.0f) == (y > 0.0f) { return 0.0f; }
    return math_infinity();
}
