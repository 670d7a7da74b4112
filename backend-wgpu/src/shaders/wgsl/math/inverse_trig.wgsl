// Arc sine, arc cosine, arc tangent.
//: use math::bits
//: use math::consts

fn math_asin_tail(z: f32) -> f32 {
    let z2 = z * z;
    let a = 0.1666666f + z * 0.07500522f;
    let b = 0.044513382f + z * 0.031838845f;
    let c = 0.014316901f + z * 0.037691906f;
    return z * (a + z2 * (b + z2 * c));
}

fn math_clamp_to_unit(x_in: f32) -> f32 {
    var x = x_in;
    if x > 1.0f { x = 1.0f; }
    if x < -1.0f { x = -1.0f; }
    return x;
}

fn math_acos(x_in: f32) -> f32 {
    let x = math_clamp_to_unit(x_in);
    let a = math_abs(x);
    if a <= 0.5f {
        let tail = x * math_asin_tail(x * x);
        return HALF_PI - math_kept(x - math_kept(HALF_PI_LOW - tail));
    }
    let z = 0.5f - 0.5f * a;
    let s = sqrt(z);
    let tail = s * math_asin_tail(z);
    if x > 0.0f { return 2.0f * (s + tail); }
    return PI - math_kept(2.0f * s - math_kept(PI_LOW - 2.0f * tail));
}

fn math_asin(x_in: f32) -> f32 {
    let x = math_clamp_to_unit(x_in);
    let a = math_abs(x);
    if a <= 0.5f { return x + x * math_asin_tail(x * x); }
    let z = 0.5f - 0.5f * a;
    let s = sqrt(z);
    let tail = s * math_asin_tail(z);
    let difference = math_kept(HALF_PI - 2.0f * s);
    let lost = math_kept(HALF_PI - difference) - 2.0f * s;
    let y = difference - math_kept(math_kept(2.0f * tail - HALF_PI_LOW) - lost);
    return math_copysign(y, x);
}

fn math_atan_tail(z: f32) -> f32 {
    let z2 = z * z;
    let z4 = z2 * z2;
    let a = -0.333333f + z * 0.1999853f;
    let b = -0.14264016f + z * 0.109508775f;
    let c = -0.08399278f + z * 0.057880387f;
    let d = -0.031095307f + z * 0.010867341f;
    return z * ((a + z2 * b) + z4 * ((c + z2 * d) + z4 * -0.0017824059f));
}

fn math_lost_in_quotient(q: f32, small: f32, large: f32) -> f32 {
    let q_upper = math_upper12(q);
    let l_upper = math_upper12(large);
    let first = math_kept(small - math_kept(q_upper * l_upper));
    let second = math_kept(first - math_kept(math_kept(q - q_upper) * l_upper));
    let remainder = second - math_kept(q * math_kept(large - l_upper));
    if small > 1.0e-24f && math_is_finite(large) { return remainder / large; }
    return 0.0f;
}

fn math_atan2(y: f32, x: f32) -> f32 {
    let ay = math_abs(y);
    let ax = math_abs(x);
    let steep = ay > ax;
    let small = select(ay, ax, steep);
    let large = select(ax, ay, steep);
    var q = math_kept(small / large);
    if small == large { q = select(1.0f, 0.0f, large == 0.0f); }
    var tail = q * math_atan_tail(q * q) + math_lost_in_quotient(q, small, large);
    let left = x < 0.0f;
    var base = 0.0f;
    var base_low = 0.0f;
    if steep {
        base = HALF_PI;
        base_low = HALF_PI_LOW;
    } else if left {
        base = PI;
        base_low = PI_LOW;
    }
    if steep != left {
        q = -q;
        tail = -tail;
    }
    let sum = math_kept(base + q);
    let lost = math_kept(math_kept(base - sum) + q);
    let angle = sum + math_kept(lost + math_kept(tail + base_low));
    return math_copysign(angle, y);
}

fn math_atan(x: f32) -> f32 { return math_atan2(x, 1.0f); }
