// The error function and its inverse.
//: use math::exp_ln
//: use math::rounding

const INV_SQRT_PI: f32 = 0.5641896f;

fn erf_erf(x: f32) -> f32 {
    let t = 1.0f / (1.0f + 0.3275911f * math_abs(x));
    var sum = 1.0614054f * t;
    sum = (sum + -1.453152f) * t;
    sum = (sum + 1.4214137f) * t;
    sum = (sum + -0.28449674f) * t;
    sum = (sum + 0.2548296f) * t;
    return math_copysign(1.0f - sum * math_exp(-x * x), x);
}

fn erf_inverse(y_in: f32) -> f32 {
    let y = math_clamp(y_in, -ONE_MINUS_EPSILON, ONE_MINUS_EPSILON);
    var w = -math_ln((1.0f - y) * (1.0f + y));
    if w < 5.0f {
        w = w - 2.5f;
        var sum = 2.8102264e-8f;
        sum = sum * w + 3.4327394e-7f;
        sum = sum * w + -3.5233877e-6f;
        sum = sum * w + -4.3915065e-6f;
        sum = sum * w + 2.1858087e-4f;
        sum = sum * w + -1.253725e-3f;
        sum = sum * w + -4.1776816e-3f;
        sum = sum * w + 0.24664073f;
        sum = sum * w + 1.5014094f;
        return sum * y;
    }
    w = sqrt(w) - 3.0f;
    var sum = -2.0021426e-4f;
    sum = sum * w + 1.0095056e-4f;
    sum = sum * w + 1.3493432e-3f;
    sum = sum * w + -3.6734284e-3f;
    sum = sum * w + 5.7395077e-3f;
    sum = sum * w + -7.6224613e-3f;
    sum = sum * w + 9.4388705e-3f;
    sum = sum * w + 1.001674f;
    sum = sum * w + 2.8329768f;
    return sum * y;
}
