// Error-free sums and products, and a sum that keeps what rounding loses.
//: use math::bits

// The rounded result and its error.
struct Exact { value: f32, error: f32 }

fn math_two_sum(a: f32, b: f32) -> Exact {
    let sum = math_kept(a + b);
    let b_in_sum = math_kept(sum - a);
    return Exact(sum, (a - math_kept(sum - b_in_sum)) + (b - b_in_sum));
}

fn math_two_prod(a: f32, b: f32) -> Exact {
    let product = math_kept(a * b);
    let a1 = math_upper12(a);
    let b1 = math_upper12(b);
    let a2 = math_kept(a - a1);
    let b2 = math_kept(b - b1);
    let rest = math_kept(math_kept(product - math_kept(a1 * b1)) - math_kept(a2 * b1));
    return Exact(product, math_kept(a2 * b2) - math_kept(rest - math_kept(a1 * b2)));
}

struct Compensated { sum: f32, lost: f32 }

fn math_compensated(value: f32) -> Compensated { return Compensated(value, 0.0f); }

fn math_compensated_add(c: Compensated, x: f32) -> Compensated {
    let total = math_kept(c.sum + x);
    var lost = 0.0f;
    if math_abs(c.sum) >= math_abs(x) {
        lost = math_kept(c.sum - total) + x;
    } else {
        lost = math_kept(x - total) + c.sum;
    }
    return Compensated(total, c.lost + lost);
}

fn math_compensated_merge(c: Compensated, other: Compensated) -> Compensated {
    let both = math_compensated_add(c, other.sum);
    return Compensated(both.sum, both.lost + other.lost);
}

fn math_compensated_value(c: Compensated) -> f32 {
    if math_is_finite(c.sum) { return c.sum + c.lost; }
    return c.sum;
}
