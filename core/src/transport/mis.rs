//! Multiple importance sampling: the weight of a sample that several techniques could have drawn.
//! Source: Veach and Guibas, "Optimally combining sampling techniques", SIGGRAPH 1995, eq. 9 and 12.

/// Power heuristic with exponent 2 for one sample each: a^2 / (a^2 + b^2), `a` the density of the technique that drew
/// the sample. By the ratio of the two, so that no square overflows. In \[0, 1\]; both 0: 0.
#[inline(always)]
pub fn power_heuristic(a: f32, b: f32) -> f32 {
    if a >= b {
        if a > 0.0 {
            let r = b / a;
            1.0 / (1.0 + r * r)
        } else {
            0.0
        }
    } else {
        let r = a / b;
        let r2 = r * r;
        r2 / (1.0 + r2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_definition_and_sums_to_one() {
        for i in 0..200 {
            for j in 0..200 {
                let (a, b) = (0.01 * i as f32, 3.0 * j as f32);
                let (x, y) = (f64::from(a), f64::from(b));
                let truth = if x + y > 0.0 { x * x / (x * x + y * y) } else { 0.0 };
                assert!((f64::from(power_heuristic(a, b)) - truth).abs() <= 2e-7);
                if x + y > 0.0 {
                    assert!((power_heuristic(a, b) + power_heuristic(b, a) - 1.0).abs() <= 2e-7);
                }
            }
        }
    }

    #[test]
    fn extreme_densities_do_not_overflow() {
        assert_eq!(power_heuristic(f32::MAX, f32::MAX), 0.5);
        assert_eq!(power_heuristic(1e-38, f32::MAX), 0.0);
        assert_eq!(power_heuristic(f32::MAX, 1e-38), 1.0);
        assert_eq!(power_heuristic(1e-40, 1e-40), 0.5);
        assert_eq!(power_heuristic(0.0, 0.0), 0.0);
    }
}
