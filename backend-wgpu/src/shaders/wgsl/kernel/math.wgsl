//: use kernel::words
//: use math::bits
//: use math::rounding
//: use math::exp_ln
//: use math::pow
//: use math::roots
//: use math::inverse_trig
//: use math::trig
//: use math::vector

fn kernel_math_ln() { put(math_ln(float())); }

fn kernel_math_log2() { put(math_log2(float())); }

fn kernel_math_exp() { put(math_exp(float())); }

fn kernel_math_exp2() { put(math_exp2(float())); }

fn kernel_math_pow() {
    let x = float();
    put(math_pow(x, float()));
}

fn kernel_math_sin_cos() {
    let r = math_sin_cos(float());
    put(r.s);
    put(r.c);
}

fn kernel_math_acos() { put(math_acos(float())); }

fn kernel_math_asin() { put(math_asin(float())); }

fn kernel_math_atan2() {
    let y = float();
    put(math_atan2(y, float()));
}

fn kernel_math_cbrt() { put(math_cbrt(float())); }

fn kernel_math_sqrt() { put(math_sqrt(float())); }

fn kernel_math_normalize_or() {
    let v = triple();
    put3(math_normalize_or(v, triple()));
}

fn kernel_math_orthonormal_basis() {
    let basis = math_orthonormal_basis(triple());
    put3(basis.t);
    put3(basis.b);
}
