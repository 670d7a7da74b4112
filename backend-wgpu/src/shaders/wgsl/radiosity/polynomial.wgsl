// Operators of up to eight patches and their powers.
//: use radiosity::lanes

// Sums of a row of n <= 8 entries: what is beyond n adds nothing.
fn polynomial_small_dot(n: u32, row: array<f32, 8>, x_in: array<f32, 8>) -> f32 {
    var a = row;
    var x = x_in;
    var lanes = array<f32, 16>();
    for (var j = 0u; j < n; j++) { lanes[j] = lanes[j] + a[j] * x[j]; }
    return lanes_fold(lanes);
}

fn polynomial_small_apply(n: u32, matrix: array<f32, 64>, x: array<f32, 8>) -> array<f32, 8> {
    var a = matrix;
    var y = array<f32, 8>();
    for (var i = 0u; i < n; i++) {
        var row = array<f32, 8>();
        for (var j = 0u; j < n; j++) { row[j] = a[i * n + j]; }
        y[i] = polynomial_small_dot(n, row, x);
    }
    return y;
}

fn polynomial_small_apply_half(n: u32, areas_in: array<f32, 8>, half_in: array<f32, 36>, x_in: array<f32, 8>) -> array<f32, 8> {
    var areas = areas_in;
    var half = half_in;
    var x = x_in;
    var y = array<f32, 8>();
    var columns = array<f32, 8>();
    for (var i = 0u; i < n; i++) {
        var row = array<f32, 8>();
        for (var j = 0u; j <= i; j++) { row[j] = half[i * (i + 1u) / 2u + j]; }
        y[i] = polynomial_small_dot(i + 1u, row, x);
        for (var j = 0u; j < i; j++) { columns[j] = columns[j] + row[j] * x[i]; }
    }
    for (var i = 0u; i < n; i++) {
        let area = areas[i];
        if area > 0.0f {
            y[i] = lanes_value_or_zero((y[i] + columns[i]) / area);
        } else {
            y[i] = 0.0f;
        }
    }
    return y;
}

fn polynomial_small_series(n: u32, a: array<f32, 64>, b_in: array<f32, 8>, k: u32) -> array<f32, 8> {
    var b = b_in;
    var x = array<f32, 8>();
    for (var h = 0u; h < min(k, 64u); h++) {
        var sent = array<f32, 8>();
        for (var i = 0u; i < 8u; i++) { sent[i] = lanes_value_or_zero(b[i] + x[i]); }
        x = polynomial_small_apply(n, a, sent);
    }
    return x;
}
