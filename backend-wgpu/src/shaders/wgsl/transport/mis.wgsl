// Weights of multiple importance sampling.

fn mis_power_heuristic(a: f32, b: f32) -> f32 {
    if a >= b {
        if a > 0.0f {
            let r = b / a;
            return 1.0f / (1.0f + r * r);
        }
        return 0.0f;
    }
    let r = a / b;
    let r2 = r * r;
    return r2 / (1.0f + r2);
}
