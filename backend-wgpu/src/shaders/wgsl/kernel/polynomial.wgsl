//: use kernel::words
//: use radiosity::polynomial

// A float of the constants; 0 beyond their end.
fn kernel_polynomial_constant(i: u32) -> f32 {
    if i < arrayLength(&constants) { return bitcast<f32>(constants[i]); }
    return 0.0f;
}

fn kernel_polynomial_matrix(first: u32) -> array<f32, 64> {
    var a = array<f32, 64>();
    for (var i = 0u; i < 64u; i++) { a[i] = kernel_polynomial_constant(first + i); }
    return a;
}

fn kernel_polynomial_vector() -> array<f32, 8> {
    var x = array<f32, 8>();
    for (var i = 0u; i < 8u; i++) { x[i] = float(); }
    return x;
}

fn kernel_polynomial_put(y_in: array<f32, 8>) {
    var y = y_in;
    for (var i = 0u; i < 8u; i++) { put(y[i]); }
}

fn kernel_polynomial_dot() {
    var a = array<f32, 32>();
    for (var i = 0u; i < 32u; i++) { a[i] = float(); }
    var lanes = array<f32, 16>();
    for (var i = 0u; i < 32u; i++) { lanes[i & 15u] = lanes[i & 15u] + a[i] * float(); }
    put(lanes_fold(lanes));
}

fn kernel_polynomial_apply() {
    let n = min(constants[0], 8u);
    let a = kernel_polynomial_matrix(1u);
    kernel_polynomial_put(polynomial_small_apply(n, a, kernel_polynomial_vector()));
}

fn kernel_polynomial_apply_half() {
    let n = min(constants[0], 8u);
    var areas = array<f32, 8>();
    var half = array<f32, 36>();
    for (var i = 0u; i < 8u; i++) { areas[i] = kernel_polynomial_constant(1u + i); }
    for (var i = 0u; i < 36u; i++) { half[i] = kernel_polynomial_constant(1u + n + i); }
    kernel_polynomial_put(polynomial_small_apply_half(n, areas, half, kernel_polynomial_vector()));
}

fn kernel_polynomial_series() {
    let n = min(constants[0], 8u);
    let k = constants[1];
    let a = kernel_polynomial_matrix(2u);
    kernel_polynomial_put(polynomial_small_series(n, a, kernel_polynomial_vector(), k));
}
