// Exponential and logarithm, base e and 2.
//: use math::bits

const LN2_UPPER: f32 = 0.69314575f;
const LN2_LOWER: f32 = 1.4286068e-6f;
const LN_2_UPPER12: f32 = 0.69311523f;
const LN_2_REST: f32 = 3.1946183e-05f;
const INV_LN2: f32 = 1.44269502f;
const INV_LN2_UPPER: f32 = 1.4423828f;
const INV_LN2_LOWER: f32 = 3.122284e-4f;

fn math_ln_tail(f: f32, f2: f32) -> f32 {
    let f4 = f2 * f2;
    let a = 0.33333313f + f * -0.25000167f;
    let b = 0.20002224f + f * -0.16659358f;
    let c = 0.14209557f + f * -0.12549964f;
    let d = 0.121092886f + f * -0.10914571f;
    return (a + f2 * b) + f4 * ((c + f2 * d) + f4 * 0.05335215f);
}

fn math_ln_normal(x: f32, shift: i32) -> f32 {
    let s = math_split_around_one(x);
    let k = f32(s.k + shift);
    let f = s.m - 1.0f;
    let f2 = f * f;
    let tail = f * f2 * math_ln_tail(f, f2) + k * LN2_LOWER;
    return k * LN2_UPPER + (f - (0.5f * f2 - tail));
}

fn math_ln(x: f32) -> f32 {
    if math_is_positive_normal(x) { return math_ln_normal(x, 0); }
    if x <= 0.0f { return -math_infinity(); }
    if x < MIN_POSITIVE { return math_ln_normal(math_normalised(x), -23); }
    return x;
}

fn math_log2_normal(x: f32, shift: i32) -> f32 {
    let s = math_split_around_one(x);
    let f = s.m - 1.0f;
    let f2 = f * f;
    let half_square = 0.5f * f2;
    let tail = f * f2 * math_ln_tail(f, f2);
    let upper = math_upper12(f - half_square);
    let lower = (math_kept(f - upper) - half_square) + tail;
    let small = (lower + upper) * INV_LN2_LOWER + lower * INV_LN2_UPPER;
    let large = upper * INV_LN2_UPPER;
    let k = f32(s.k + shift);
    let sum = math_kept(k + large);
    let lost = select(large - math_kept(sum - k), 0.0f, k == 0.0f);
    return sum + (lost + small);
}

fn math_log2(x: f32) -> f32 {
    if math_is_positive_normal(x) { return math_log2_normal(x, 0); }
    if x <= 0.0f { return -math_infinity(); }
    if x < MIN_POSITIVE { return math_log2_normal(math_normalised(x), -23); }
    return x;
}

fn math_exp(x_in: f32) -> f32 {
    if math_is_nan(x_in) { return x_in; }
    var x = x_in;
    if x > 89.0f { x = 89.0f; }
    if x < -104.0f { x = -104.0f; }
    let n = math_nearest(x * INV_LN2);
    let upper = math_kept(x - math_kept(n.kf * LN2_UPPER));
    let lower = math_kept(n.kf * LN2_LOWER);
    let r = math_kept(upper - lower);
    let r2 = r * r;
    let q = (0.49999994f + r * 0.16666517f) + r2 * ((0.04166828f + r * 0.008369248f) + r2 * 0.0013820744f);
    return math_scale(1.0f + (upper + (r2 * q - lower)), n.k);
}

fn math_exp2_minus_one(r: f32, lower: f32) -> f32 {
    let r2 = r * r;
    let q = (0.24022648f + r * 0.055503584f) + r2 * ((0.009618455f + r * 0.0013392338f) + r2 * 1.5354928e-4f);
    let upper = math_upper12(r);
    let rest = math_kept((math_kept(r - upper) + lower) * LN_2_UPPER12);
    return math_kept(upper * LN_2_UPPER12) + (r2 * q + (r * LN_2_REST + rest));
}

fn math_exp2(x_in: f32) -> f32 {
    if math_is_nan(x_in) { return x_in; }
    var x = x_in;
    if x > 129.0f { x = 129.0f; }
    if x < -151.0f { x = -151.0f; }
    let n = math_nearest(x);
    return math_scale(1.0f + math_exp2_minus_one(math_kept(x - n.kf), 0.0f), n.k);
}
