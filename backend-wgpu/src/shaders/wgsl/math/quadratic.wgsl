// Real roots of quadratics: core's math/roots.rs.
//: use math::bits
//: use math::sums

fn math_discriminant(a: f32, b: f32, c: f32) -> f32 {
    let p = math_two_prod(b, b);
    let q = math_two_prod(4.0f * a, c);
    return math_kept(p.value - q.value) + (p.error - q.error);
}

// In ascending order, if there are any.
struct QuadraticRoots { found: bool, low: f32, high: f32 }

fn math_quadratic_ordered(a: f32, b: f32) -> QuadraticRoots {
    if a < b { return QuadraticRoots(true, a, b); }
    return QuadraticRoots(true, b, a);
}

fn math_quadratic_finite(x: f32) -> f32 {
    if x < -MAX_FLOAT { return -MAX_FLOAT; }
    if x > MAX_FLOAT { return MAX_FLOAT; }
    return x;
}

fn math_quadratic_ldexp(x: f32, k: i32) -> f32 { return math_quadratic_finite(math_ldexp(x, k)); }

fn math_quadratic_roots(a_in: f32, b_in: f32, c_in: f32) -> QuadraticRoots {
    if !(math_is_finite(a_in) && math_is_finite(b_in) && math_is_finite(c_in)) {
        return QuadraticRoots(false, 0.0f, 0.0f);
    }
    if a_in == 0.0f {
        if b_in == 0.0f { return QuadraticRoots(false, 0.0f, 0.0f); }
        let x = math_quadratic_finite(-(c_in / b_in));
        return QuadraticRoots(true, x, x);
    }
    if c_in == 0.0f {
        let x = math_quadratic_finite(-(b_in / a_in));
        if x < 0.0f { return QuadraticRoots(true, x, 0.0f); }
        return QuadraticRoots(true, 0.0f, x);
    }
    let ec = math_exponent(c_in);
    let shift = (ec - math_exponent(a_in)) >> 1u;
    let a = math_ldexp(a_in, 2 * shift - ec);
    let b_exponent = math_exponent(b_in) + shift - ec;
    let c = math_ldexp(c_in, -ec);
    if b_in != 0.0f && b_exponent > 14 {
        let b = math_ldexp(b_in, -math_exponent(b_in));
        let large = math_quadratic_ldexp(-b / a, b_exponent + shift);
        let small = math_quadratic_ldexp(-c / b, shift - b_exponent);
        return math_quadratic_ordered(large, small);
    }
    let b = math_ldexp(b_in, shift - ec);
    let d = math_discriminant(a, b, c);
    if d < 0.0f { return QuadraticRoots(false, 0.0f, 0.0f); }
    let q = -0.5f * (b + math_copysign(sqrt(d), b));
    return math_quadratic_ordered(math_quadratic_ldexp(q / a, shift), math_quadratic_ldexp(c / q, shift));
}
