//! Distribution functions against tabulated values (computed with 50 digits) and each other.
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use etendue::metrics::statistics::{
    chi_square_survival, mean_and_variance_of_mean, normal_cdf, normal_quantile, normal_survival,
    normal_two_sided, percentile_of_sorted, sidak, student_t_quantile, student_t_two_sided,
};

#[track_caller]
fn close(got: f64, truth: f64, relative: f64) {
    let err = ((got - truth) / truth).abs();
    assert!(err <= relative, "{got} is not {truth}: {err:e}");
}

#[test]
fn normal_values() {
    for (z, truth) in [
        (-8.0, 6.220_960_574_271_784e-16),
        (-5.5, 1.898_956_246_588_772e-8),
        (-2.0, 0.022_750_131_948_179_21),
        (-0.5, 0.308_537_538_725_986_9),
        (0.3, 0.617_911_422_188_952_6),
        (1.0, 0.841_344_746_068_542_9),
        (3.0, 0.998_650_101_968_369_9),
    ] {
        close(normal_cdf(z), truth, 1e-9);
        close(normal_survival(-z), truth, 1e-9);
    }
    for (p, truth) in [
        (1e-300, -37.047_096_299_361_2),
        (1e-100, -21.273_453_560_965_323),
        (5e-9, -5.730_728_868_236_29),
        (1e-6, -4.753_424_308_822_899),
        (0.005, -2.575_829_303_548_901),
        (0.3, -0.524_400_512_708_040_8),
    ] {
        close(normal_quantile(p), truth, 1e-9);
        close(normal_two_sided(2.0 * p), -truth, 1e-9);
    }
}

#[test]
fn chi_square_values() {
    for (x, df, truth) in [
        (3.5, 3.0, 0.320_762_120_805_639),
        (18.307, 10.0, 0.050_000_589_091_398_12),
        (100.0, 10.0, 5.449_701_982_920_53e-17),
        (150.0, 100.0, 9.039_320_423_540_091e-4),
        (1000.0, 1000.0, 0.494_052_853_829_239_64),
        (500.0, 100.0, 1.720_121_005_369_537_5e-54),
        (10_500.0, 10_000.0, 2.479_473_679_893_608_5e-4),
    ] {
        close(chi_square_survival(x, df), truth, 1e-9);
    }
}

#[test]
fn chi_square_with_very_many_degrees_is_normal() {
    for df in [9.9e7, 1.01e8, 1e10, 1e15_f64] {
        for z in [-3.0, -1.0, 0.0, 1.0, 3.0] {
            // Edgeworth's first term: skewness sqrt(8 / df) moves the normal by less than 0.2 of itself.
            let got = chi_square_survival(df + z * (2.0 * df).sqrt(), df);
            assert!((got - normal_survival(z)).abs() <= 0.2 * (8.0 / df).sqrt() + 1e-6, "{df} {z}: {got}");
        }
    }
}

#[test]
fn student_values() {
    for (p, df, truth) in [
        (0.995, 3.0, 5.840_909_309_733_357),
        (0.995, 15.0, 2.946_712_883_475_239),
        (0.995, 63.0, 2.656_145_025_099_861_6),
        (0.975, 10.0, 2.228_138_851_986_275),
        (0.9, 5.0, 1.475_884_048_824_481),
        (0.995, 1000.0, 2.580_754_698_065_951),
    ] {
        close(student_t_quantile(p, df), truth, 1e-9);
        close(student_t_quantile(1.0 - p, df), -truth, 1e-9);
        close(student_t_two_sided(2.0 * (1.0 - p), df), truth, 1e-9);
    }
    close(student_t_quantile(1e-8, 15.0), -10.714_732_022_790_736, 1e-9);
}

#[test]
fn normal_quantile_inverts_the_cdf() {
    for i in -370..=370 {
        let z = f64::from(i) * 0.1;
        // From the nearer tail: the other has no digits left.
        let back =
            if z <= 0.0 { normal_quantile(normal_cdf(z)) } else { -normal_quantile(normal_survival(z)) };
        assert!((back - z).abs() <= 1e-9 * z.abs().max(1.0), "{z}: {back}");
    }
}

#[test]
fn sidak_keeps_the_family() {
    assert_eq!(sidak(0.01, 1), -(-0.01_f64).ln_1p().exp_m1());
    assert_eq!(sidak(0.01, 0), sidak(0.01, 1));
    for n in [1_u64, 2, 10, 1000, 65_536, 1_000_000, 1 << 40] {
        let family = -((n as f64) * (-sidak(0.01, n)).ln_1p()).exp_m1();
        close(family, 0.01, 1e-12);
        // Less strict than Bonferroni, and nearly equal to it.
        assert!(sidak(0.01, n) >= 0.01 / n as f64 && sidak(0.01, n) <= 0.01006 / n as f64);
    }
}

#[test]
fn chi_square_with_two_degrees_is_an_exponential() {
    for i in 1..=400 {
        let x = f64::from(i);
        close(chi_square_survival(x, 2.0), (-0.5 * x).exp(), 1e-10);
        // One degree: a squared normal.
        close(chi_square_survival(x, 1.0), 2.0 * normal_survival(x.sqrt()), 1e-9);
        // Four degrees, in closed form.
        close(chi_square_survival(x, 4.0), (-0.5 * x).exp() * (1.0 + 0.5 * x), 1e-9);
    }
}

#[test]
fn student_in_closed_form() {
    for i in 1..100 {
        let p = f64::from(i) * 0.01;
        if i == 50 {
            continue;
        }
        // One degree is Cauchy's distribution.
        close(student_t_quantile(p, 1.0), (std::f64::consts::PI * (p - 0.5)).tan(), 1e-9);
        // Two degrees: (2p - 1) sqrt(2 / (4p(1 - p))).
        close(student_t_quantile(p, 2.0), (2.0 * p - 1.0) * (2.0 / (4.0 * p * (1.0 - p))).sqrt(), 1e-9);
        close(student_t_quantile(p, 1e12), normal_quantile(p), 1e-9);
    }
}

#[test]
fn degenerate_input_has_a_value() {
    let inf = f64::INFINITY;
    for (got, expected) in [
        (normal_quantile(0.0), -inf),
        (normal_quantile(1.0), inf),
        (normal_quantile(-3.0), -inf),
        (normal_quantile(f64::NAN), inf),
        (normal_two_sided(0.0), inf),
        (normal_two_sided(f64::NAN), inf),
        (normal_cdf(-inf), 0.0),
        (normal_cdf(inf), 1.0),
        (normal_cdf(f64::NAN), 0.5),
        (sidak(f64::NAN, 3), 0.0),
        (sidak(1.0, 3), 1.0),
        (sidak(-1.0, 3), 0.0),
        (chi_square_survival(f64::NAN, 3.0), 0.0),
        (chi_square_survival(1.0, f64::NAN), 0.0),
        (chi_square_survival(1.0, 0.0), 0.0),
        (chi_square_survival(0.0, 0.0), 1.0),
        (chi_square_survival(-1.0, 3.0), 1.0),
        (chi_square_survival(inf, 3.0), 0.0),
        (chi_square_survival(3.0, inf), 1.0),
        (student_t_quantile(0.5, 3.0), 0.0),
        (student_t_quantile(0.9, 0.0), inf),
        (student_t_quantile(0.1, -1.0), -inf),
        (student_t_quantile(0.1, f64::NAN), -inf),
        (student_t_quantile(f64::NAN, 3.0), inf),
        (student_t_quantile(2.0, 3.0), inf),
        (student_t_quantile(0.0, 3.0), -inf),
        (student_t_two_sided(0.01, 0.0), inf),
        (percentile_of_sorted(&[], 0.5), 0.0),
        (percentile_of_sorted(&[1.0, inf], 0.0), 1.0),
        (percentile_of_sorted(&[1.0, inf], 0.5), inf),
        (percentile_of_sorted(&[inf, inf], 0.5), inf),
        (percentile_of_sorted(&[1.0, 2.0], f64::NAN), 1.0),
    ] {
        assert_eq!(got, expected);
    }
    assert!(student_t_quantile(0.1, inf).is_finite());
}

#[test]
fn percentiles_and_means_by_hand() {
    let v: Vec<f64> = (0..=20).map(f64::from).collect();
    assert_eq!(
        [0.0, 0.05, 0.5, 0.95, 1.0].map(|q| percentile_of_sorted(&v, q)),
        [0.0, 1.0, 10.0, 19.0, 20.0]
    );
    assert_eq!(percentile_of_sorted(&[1.0, 3.0], 0.25), 1.5);
    // 1, 2, 3, 6: mean 3, squares 4 + 1 + 0 + 9 = 14, over 3, over 4.
    assert_eq!(mean_and_variance_of_mean(&[1.0, 2.0, 3.0, 6.0]), (3.0, 14.0 / 12.0));
    assert_eq!(mean_and_variance_of_mean(&[5.0]), (5.0, f64::INFINITY));
    assert_eq!(mean_and_variance_of_mean(&[]), (0.0, f64::INFINITY));
}
