//! Image metrics: closed forms by hand, noise with a known spread, and mutants that must be seen.
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use etendue::metrics::flip::flip_map;
use etendue::metrics::{
    MetricValue, Metrics, MetricsError, MetricsInput, auto_exposure, compare, rel_error, statistics,
};
use etendue_core::tone::{ToneMap, ToneSettings, display};

type Image = Vec<[f32; 3]>;

/// A counter-based generator: independent of order, fixed for ever.
fn uniform(seed: u64, i: u64) -> f64 {
    let mut z = (seed << 40).wrapping_add(i.wrapping_mul(0x9E37_79B9_7F4A_7C15)).wrapping_add(0x1234_5678);
    for k in [0xBF58_476D_1CE4_E5B9_u64, 0x94D0_49BB_1331_11EB] {
        z = (z ^ (z >> 29)).wrapping_mul(k);
    }
    ((z ^ (z >> 32)) >> 11) as f64 / (1_u64 << 53) as f64
}

fn normal(seed: u64, i: u64) -> f64 {
    statistics::normal_quantile(uniform(seed, i).max(1e-12))
}

const W: usize = 128;
const H: usize = 96;
const SIGMA: f64 = 0.05;

/// A smooth scene with a dark and a bright side, in all channels different.
fn scene(width: usize, height: usize) -> Image {
    (0..width * height)
        .map(|i| {
            let (x, y) = ((i % width) as f32 / width as f32, (i / width) as f32 / height as f32);
            [0.2 + x, 0.1 + 2.0 * y * y, 0.3 + 0.5 * x * y]
        })
        .collect()
}

/// The scene times `gain` with normal noise of `SIGMA` times each value.
fn noisy(seed: u64, r: &Image, gain: f64, sigma: f64) -> Image {
    (r.iter().enumerate())
        .map(|(i, p)| {
            [0, 1, 2].map(|c| (f64::from(p[c]) * (gain + sigma * normal(seed, (3 * i + c) as u64))) as f32)
        })
        .collect()
}

fn variance(r: &Image, sigma: f64) -> Image {
    r.iter().map(|p| p.map(|v| (f64::from(v) * sigma).powi(2) as f32)).collect()
}

#[track_caller]
fn measure(input: &MetricsInput<'_>) -> Metrics {
    compare(input).expect("input fits")
}

#[track_caller]
fn close(got: f64, truth: f64, tolerance: f64) {
    assert!((got - truth).abs() <= tolerance, "{got} is not {truth}");
}

#[test]
fn an_image_agrees_with_itself() {
    let r = scene(W, H);
    let zero = vec![[0.0; 3]; W * H];
    let m = measure(&MetricsInput { var_x: Some(&zero), ..MetricsInput::new(W, H, &r, &r) });
    assert_eq!((m.rel_error, m.rel_mse, m.bias, m.energy_error), (0.0, 0.0, [0.0; 3], 0.0));
    assert_eq!((m.bias_interval, m.block_ratio, m.worst_block), (Some([[0.0; 2]; 3]), [1.0; 3], 0.0));
    assert_eq!((m.z_pass, m.mean_z2, m.flip, m.agrees()), (Some(1.0), Some(0.0), 0.0, Some(true)));
    for name in ["rel_error", "rel_mse", "bias", "bias_interval", "block_ratio", "worst_block"] {
        assert_eq!(m.exceeds(name, 0.0), Ok(false), "{name}");
    }
    for name in ["energy_error", "z_fail", "mean_z2", "flip"] {
        assert_eq!(m.exceeds(name, 0.0), Ok(false), "{name}");
    }
}

#[test]
fn one_percent_more_light_is_seen_by_every_metric() {
    let r = scene(W, H);
    let x: Image = r.iter().map(|p| p.map(|v| v * 1.01)).collect();
    let zero = vec![[0.0; 3]; W * H];
    let m = measure(&MetricsInput { var_x: Some(&zero), ..MetricsInput::new(W, H, &x, &r) });
    close(m.rel_error, 0.01, 1e-6);
    close(m.energy_error, 0.01, 1e-6);
    close(m.worst_block, 0.01, 1e-6);
    for c in 0..3 {
        close(m.bias[c], 0.01, 1e-6);
        close(m.block_ratio[c], 1.01, 1e-6);
        let [low, high] = m.bias_interval.expect("variance is given")[c];
        assert!(low == high && low > 0.0099);
    }
    let relative: f64 = (r.iter().flatten())
        .map(|v| f64::from(*v).powi(2))
        .map(|square| 1e-4 * square / (square + 0.01))
        .sum::<f64>()
        / (3 * W * H) as f64;
    close(m.rel_mse, relative, 1e-9);
    assert_eq!((m.z_pass, m.agrees()), (Some(0.0), Some(false)));
    assert!(m.flip > 0.001, "{}", m.flip);
    for (name, limit) in [
        ("rel_error", 0.0099),
        ("bias", 0.0099),
        ("bias_interval", 0.0099),
        ("block_ratio", 0.0099),
        ("worst_block", 0.0099),
        ("energy_error", 0.0099),
        ("z_fail", 0.0025),
        ("flip", 0.001),
    ] {
        assert_eq!(m.exceeds(name, limit), Ok(true), "{name}");
        assert_eq!(m.exceeds(name, 2.0), Ok(false), "{name}");
    }
}

#[test]
fn two_pixels_by_hand() {
    let r = vec![[1.0, 2.0, 2.0], [0.0, 4.0, 0.0]];
    let x = vec![[1.0, 2.5, 2.0], [1.0, 3.0, 0.0]];
    // |x - r|^2 = 1/4, 2; |r|^2 = 9, 16.
    let var_x = vec![[0.0, 0.25, 0.0], [1.0, 0.5, 0.0]];
    let var_r = vec![[0.0, 0.0, 0.0], [0.0, 0.5, 0.0]];
    let input = MetricsInput { var_x: Some(&var_x), var_r: Some(&var_r), ..MetricsInput::new(2, 1, &x, &r) };
    let m = measure(&input);
    close(m.rel_error, (2.25_f64 / 25.0).sqrt(), 1e-12);
    close(m.rel_mse, (0.25 / 4.01 + 1.0 / 0.01 + 1.0 / 16.01) / 6.0, 1e-12);
    assert_eq!(m.bias, [1.0, 5.5 / 6.0 - 1.0, 0.0]);
    close(m.energy_error, 9.5 / 9.0 - 1.0, 1e-12);
    close(m.block_ratio[0], 9.5 / 9.0, 1e-12);
    // Means of the one block: x 1, 2.75, 1; r 1/2, 3, 1.
    close(m.worst_block, (0.25_f64 + 0.0625).sqrt() / (0.25_f64 + 9.0 + 1.0).sqrt(), 1e-12);
    // z^2: 1 (0.25 / 0.25), 1, 1 (1 / (0.5 + 0.5)); the others have no variance and are equal.
    assert_eq!((m.z_pass, m.mean_z2), (Some(1.0), Some(1.0)));
    // Bias of green: mean x 2.75, r 3, var x 0.75/4, var r 0.5/4.
    let q = 5.5_f64 / 6.0;
    let half = 2.575_829_303_548_9 * (0.75 + q * q * 0.5).sqrt() / 6.0;
    let [low, high] = m.bias_interval.expect("variance is given")[1];
    close(low, q - 1.0 - half, 1e-9);
    close(high, q - 1.0 + half, 1e-9);

    // Without variance a difference fails, equality passes: red of the second pixel.
    let none = vec![[0.0, 0.25, 0.0], [0.0, 0.5, 0.0]];
    let m = measure(&MetricsInput { var_x: Some(&none), ..input });
    assert_eq!((m.z_pass, m.mean_z2), (Some(0.5), Some(1.0)));
    // Sidak over two pixels at 0.01: 0.0050126, |z| <= 2.8062. Red differs by 1.
    for (sigma, pass) in [(1.0 / 2.805, 1.0), (1.0 / 2.8075, 0.5)] {
        let v = vec![[0.0, 0.25, 0.0], [(sigma * sigma) as f32, 0.5, 0.0]];
        assert_eq!(measure(&MetricsInput { var_x: Some(&v), ..input }).z_pass, Some(pass));
    }
}

#[test]
fn elements_count_by_area() {
    let (x, r) = (vec![[1.0; 3], [3.0; 3]], vec![[2.0; 3], [3.0; 3]]);
    // (3 A0) / (12 A0 + 27 A1).
    close(rel_error(&x, &r, Some(&[2.0, 1.0])).expect("lengths fit"), (6.0_f64 / 51.0).sqrt(), 1e-12);
    close(rel_error(&x, &r, None).expect("lengths fit"), (3.0_f64 / 39.0).sqrt(), 1e-12);
    assert_eq!(rel_error(&r, &r, None), Ok(0.0));
    assert_eq!(rel_error(&[[0.0; 3]], &[[0.0; 3]], None), Ok(0.0));
    assert_eq!(rel_error(&[[1.0; 3]], &[[0.0; 3]], None), Ok(f64::INFINITY));
    assert_eq!(rel_error(&[[f32::NAN; 3]], &[[1.0; 3]], None), Ok(f64::INFINITY));
    assert_eq!(
        rel_error(&x, &r, Some(&[1.0])),
        Err(MetricsError::SizeMismatch { what: "areas", found: 1, expected: 2 })
    );
}

#[test]
fn noise_alone_agrees_and_one_percent_of_bias_does_not() {
    let r = scene(W, H);
    let v = variance(&r, SIGMA);
    // The z test errs with probability 0.01 per channel and image in a single pixel of 12288 and asks for
    // 0.9975 of them; a 99 % interval misses in one of 100 channels: 36 here, at most 3 misses (P > 0.999).
    let (mut missed, mut seen) = (0, 0);
    for seed in 0..12 {
        let x = noisy(seed, &r, 1.0, SIGMA);
        let m = measure(&MetricsInput { var_x: Some(&v), ..MetricsInput::new(W, H, &x, &r) });
        assert_eq!(m.agrees(), Some(true));
        // Mean of 36864 squared normals: 1 with standard deviation sqrt(2 / 36864) = 0.0074; 5 of them.
        close(m.mean_z2.expect("variance is given"), 1.0, 0.037);
        close(m.rel_error, SIGMA, 0.002);
        missed += m.bias_interval.expect("given").iter().filter(|[l, h]| *l > 0.0 || *h < 0.0).count();
        assert!(m.block_ratio.iter().all(|q| (q - 1.0).abs() <= 0.005), "{:?}", m.block_ratio);

        let x = noisy(seed, &r, 1.01, SIGMA);
        let m = measure(&MetricsInput { var_x: Some(&v), ..MetricsInput::new(W, H, &x, &r) });
        seen += m.bias_interval.expect("given").iter().filter(|[l, _]| *l > 0.0).count();
        assert_eq!(m.exceeds("bias_interval", 0.005), Ok(true));
        assert!(m.block_ratio.iter().all(|q| (q - 1.01).abs() <= 0.005), "{:?}", m.block_ratio);
        assert!(m.block_ratio[0] > 1.0);
        // The z test per pixel cannot see 1 % under 5 % of noise; its mean square does not either.
        assert_eq!(m.agrees(), Some(true));
    }
    assert!(missed <= 3, "{missed} of 36 intervals miss 0");
    assert_eq!(seen, 36);
}

#[test]
fn z_test_sees_outliers_and_understated_variance() {
    let r = scene(W, H);
    let v = variance(&r, SIGMA);
    let mut x = noisy(3, &r, 1.0, SIGMA);
    for i in 0..62 {
        // 0.5 % of the pixels in one channel by 8 standard deviations.
        x[i * 197][1] += 8.0 * SIGMA as f32 * r[i * 197][1];
    }
    let m = measure(&MetricsInput { var_x: Some(&v), ..MetricsInput::new(W, H, &x, &r) });
    assert_eq!(m.agrees(), Some(false));
    let x = noisy(4, &r, 1.0, SIGMA);
    let quarter = variance(&r, 0.5 * SIGMA);
    let m = measure(&MetricsInput { var_x: Some(&quarter), ..MetricsInput::new(W, H, &x, &r) });
    close(m.mean_z2.expect("given"), 4.0, 0.15);
    assert_eq!(m.agrees(), Some(false));
    // The reference's variance adds: half of it each.
    let half = variance(&r, SIGMA / 2.0_f64.sqrt());
    let both = MetricsInput { var_x: Some(&half), var_r: Some(&half), ..MetricsInput::new(W, H, &x, &r) };
    close(measure(&both).mean_z2.expect("given"), 1.0, 0.037);
}

#[test]
fn replicates_see_noise_that_pixels_share() {
    // One factor per replicate over the whole image, 2 %: pixel variances know nothing of its correlation.
    let r = scene(32, 32);
    let v = vec![[1e-8; 3]; r.len()];
    let (mut missed, mut missed_by_pixels) = (0, 0);
    for seed in 0..100_u64 {
        let images: Vec<Image> = (0..8)
            .map(|k| {
                let gain = (1.0 + 0.02 * normal(77, 8 * seed + k)) as f32;
                r.iter().map(|p| p.map(|v| v * gain)).collect()
            })
            .collect();
        let x: Image = (0..r.len())
            .map(|i| [0, 1, 2].map(|c| images.iter().map(|m| m[i][c]).sum::<f32>() / 8.0))
            .collect();
        let replicates: Vec<&[[f32; 3]]> = images.iter().map(Vec::as_slice).collect();
        let input = MetricsInput { var_x: Some(&v), ..MetricsInput::new(32, 32, &x, &r) };
        let misses = |m: Metrics| usize::from(m.exceeds("bias_interval", 0.0) == Ok(true));
        missed += misses(measure(&MetricsInput { replicates: &replicates, ..input }));
        missed_by_pixels += misses(measure(&input));
    }
    // 100 intervals at 99 % (channels move together): at most 5 misses with probability 0.999.
    assert!(missed <= 5, "{missed}");
    assert!(missed_by_pixels > 90, "{missed_by_pixels}");

    // By hand: replicates at -1 %, 0, +4 %: mean 1 %, s = 0.0264575, t(0.995, 2) = 9.9248432.
    let one = vec![[1.0; 3]; 4];
    let images: Vec<Image> = [0.99, 1.0, 1.04].map(|g| vec![[g; 3]; 4]).to_vec();
    let replicates: Vec<&[[f32; 3]]> = images.iter().map(Vec::as_slice).collect();
    let x = vec![[1.01; 3]; 4];
    let m = measure(&MetricsInput { replicates: &replicates, ..MetricsInput::new(2, 2, &x, &one) });
    let half = 9.924_843_2 * 0.026_457_513 / 3.0_f64.sqrt();
    let [low, high] = m.bias_interval.expect("replicates are given")[0];
    close(low, 0.01 - half, 1e-6);
    close(high, 0.01 + half, 1e-6);
    assert_eq!(m.z_pass, None);
}

#[test]
fn blocks_at_the_edge_and_behind_the_mask() {
    // 40 x 32: one full block, one of 8 x 32 = 256 pixels, a quarter, which counts; of 7 x 32 it does not.
    for (width, low) in [(40, 0.0), (39, 1.0)] {
        let r = vec![[1.0; 3]; width * 32];
        let mut x = r.clone();
        for (i, p) in x.iter_mut().enumerate() {
            if i % width >= 32 {
                *p = [0.0; 3];
            }
        }
        let m = measure(&MetricsInput::new(width, 32, &x, &r));
        // Two blocks 0 and 1: the 5 percentile is 0.05, the median 0.5.
        let expected = if low == 0.0 { [0.05, 0.5, 0.95] } else { [1.0; 3] };
        for (got, e) in m.block_ratio.into_iter().zip(expected) {
            close(got, e, 1e-12);
        }
        close(m.worst_block, 1.0 - low, 1e-12);
        // The mask cuts the difference out of everything.
        let mask: Vec<bool> = (0..width * 32).map(|i| i % width < 32).collect();
        let m = measure(&MetricsInput { mask: Some(&mask), ..MetricsInput::new(width, 32, &x, &r) });
        assert_eq!((m.rel_error, m.flip, m.worst_block, m.block_ratio), (0.0, 0.0, 0.0, [1.0; 3]));
        assert_eq!((m.bias, m.pixels), ([0.0; 3], 1024));
    }
    // A black block cannot decide: worst_block measures against 1 % of the image.
    let mut r = vec![[1.0; 3]; 64 * 32];
    for (i, p) in r.iter_mut().enumerate() {
        if i % 64 < 32 {
            *p = [0.0; 3];
        }
    }
    let mut x = r.clone();
    x[0] = [1.024e-3; 3];
    // Mean of the block 1e-6, floor 0.01 * 0.5.
    close(measure(&MetricsInput::new(64, 32, &x, &r)).worst_block, 2e-4, 1e-8);
}

#[test]
fn nothing_but_rel_mse_depends_on_the_unit() {
    let r = scene(W, H);
    let (x, v) = (noisy(9, &r, 1.03, SIGMA), variance(&r, SIGMA));
    let a = measure(&MetricsInput { var_x: Some(&v), ..MetricsInput::new(W, H, &x, &r) });
    for scale in [1e-4_f32, 3.7e5] {
        let by = |image: &Image, s: f32| -> Image { image.iter().map(|p| p.map(|v| v * s)).collect() };
        let (xs, rs, vs) = (by(&x, scale), by(&r, scale), by(&v, scale * scale));
        let b = measure(&MetricsInput { var_x: Some(&vs), ..MetricsInput::new(W, H, &xs, &rs) });
        for name in
            ["rel_error", "bias", "bias_interval", "block_ratio", "worst_block", "energy_error", "z_fail"]
        {
            close(b.limit_value(name).expect("known"), a.limit_value(name).expect("known"), 1e-6);
        }
        close(b.mean_z2.expect("given"), a.mean_z2.expect("given"), 1e-5);
        close(b.flip, a.flip, 1e-5);
        assert!((b.rel_mse - a.rel_mse).abs() > 1e-4);
    }
}

#[test]
fn flip_sees_the_tone_mapped_images() {
    let r = scene(W, H);
    let x = noisy(5, &r, 1.0, SIGMA);
    for map in [ToneMap::Reinhard, ToneMap::Gamma, ToneMap::None] {
        let tone = ToneSettings { map, exposure: -0.5, ..ToneSettings::default() };
        let show = |image: &Image| -> Image { image.iter().map(|p| display(tone, *p)).collect() };
        let map = flip_map(W, H, &show(&r), &show(&x), 50.0).expect("sizes fit");
        let mean = map.iter().map(|v| f64::from(*v)).sum::<f64>() / map.len() as f64;
        let input =
            MetricsInput { tone: Some(tone), pixels_per_degree: 50.0, ..MetricsInput::new(W, H, &x, &r) };
        let m = measure(&input);
        assert!(mean > 0.01);
        close(m.flip, mean, 1e-5);
        assert_eq!(m.flip_exposure, -0.5);
    }
}

#[test]
fn exposure_follows_the_median() {
    let mut r = vec![[2.0; 3]; 101];
    r[3] = [1e9; 3];
    r[4] = [0.0; 3];
    close(f64::from(auto_exposure(&r, None)), (0.18 / 0.82 / 2.0_f64).log2(), 1e-6);
    assert_eq!(auto_exposure(&[[0.0; 3]; 4], None), 0.0);
    assert_eq!(auto_exposure(&[[f32::NAN; 3]; 4], None), 0.0);
    assert_eq!(auto_exposure(&r, Some(&[])), 0.0);
}

#[test]
fn a_pixel_that_is_no_number_never_passes() {
    let r = scene(W, H);
    let zero = vec![[0.0; 3]; W * H];
    for bad in [f32::NAN, f32::INFINITY] {
        for in_x in [true, false] {
            let (mut a, b) = (r.clone(), r.clone());
            a[777][1] = bad;
            let (x, reference) = if in_x { (&a, &b) } else { (&b, &a) };
            let input = MetricsInput { var_x: Some(&zero), ..MetricsInput::new(W, H, x, reference) };
            let m = measure(&input);
            assert_eq!((m.non_finite_x, m.non_finite_r), (u64::from(in_x), u64::from(!in_x)));
            assert_eq!(m.rel_error, 0.0);
            close(m.z_pass.expect("given"), 1.0 - 1.0 / (W * H) as f64, 1e-12);
            assert!(m.flip.is_finite());
            for name in ["rel_error", "bias", "flip", "z_fail", "mean_z2"] {
                assert_eq!(m.exceeds(name, 1e9), Ok(true), "{name}");
            }
            // Masked out on purpose, it is no longer in the way.
            let mut mask = vec![true; W * H];
            mask[777] = false;
            let m = measure(&MetricsInput { mask: Some(&mask), ..input });
            assert_eq!((m.non_finite_x, m.non_finite_r), (0, 0));
            assert_eq!(m.exceeds("rel_error", 0.0), Ok(false));
        }
    }
}

#[test]
fn black_references_have_values() {
    let black = vec![[0.0; 3]; 64];
    let zero = black.clone();
    let m = measure(&MetricsInput { var_x: Some(&zero), ..MetricsInput::new(8, 8, &black, &black) });
    assert_eq!((m.rel_error, m.bias, m.energy_error), (0.0, [0.0; 3], 0.0));
    assert_eq!((m.block_ratio, m.worst_block, m.flip), ([1.0; 3], 0.0, 0.0));
    assert_eq!(m.bias_interval, Some([[0.0; 2]; 3]));
    let light = vec![[1.0; 3]; 64];
    let m = measure(&MetricsInput { var_x: Some(&zero), ..MetricsInput::new(8, 8, &light, &black) });
    assert_eq!((m.rel_error, m.energy_error), (f64::INFINITY, f64::INFINITY));
    assert_eq!(
        (m.bias, m.block_ratio, m.worst_block),
        ([f64::INFINITY; 3], [f64::INFINITY; 3], f64::INFINITY)
    );
    assert!(m.fields().iter().all(|(_, v)| !matches!(v, MetricValue::Number(v) if v.is_nan())));
    assert_eq!(m.exceeds("rel_error", 1e300), Ok(true));
}

#[test]
fn errors_carry_the_numbers() {
    let r = scene(4, 4);
    let short = scene(4, 3);
    let fit = MetricsInput::new(4, 4, &r, &r);
    let wrong = |what| Err(MetricsError::SizeMismatch { what, found: 12, expected: 16 });
    assert_eq!(compare(&MetricsInput { x: &short, ..fit }), wrong("x"));
    assert_eq!(compare(&MetricsInput { r: &short, ..fit }), wrong("r"));
    assert_eq!(compare(&MetricsInput { var_x: Some(&short), ..fit }), wrong("var_x"));
    assert_eq!(compare(&MetricsInput { var_r: Some(&short), ..fit }), wrong("var_r"));
    assert_eq!(compare(&MetricsInput { mask: Some(&[true; 12]), ..fit }), wrong("mask"));
    assert_eq!(compare(&MetricsInput { replicates: &[&r, &short], ..fit }), wrong("replicates"));
    assert_eq!(compare(&MetricsInput { replicates: &[&r], ..fit }), Err(MetricsError::SingleReplicate));
    assert_eq!(
        compare(&MetricsInput { mask: Some(&[false; 16]), ..fit }),
        Err(MetricsError::EmptyMask { pixels: 16 })
    );
    for (width, height) in [(0, 4), (usize::MAX, 2)] {
        assert_eq!(
            compare(&MetricsInput { width, height, ..fit }),
            Err(MetricsError::BadDimensions { width, height })
        );
    }
    let nan = vec![[f32::NAN; 3]; 16];
    assert_eq!(
        compare(&MetricsInput { x: &nan, ..fit }),
        Err(MetricsError::NothingFinite { pixels: 16, non_finite_x: 16, non_finite_r: 0 })
    );
    for bad in [f32::NAN, -1e-20, f32::INFINITY] {
        let mut v = vec![[0.0; 3]; 16];
        v[6][2] = bad;
        v[9][0] = bad;
        let error = compare(&MetricsInput { var_x: Some(&v), ..fit }).expect_err("bad variance");
        assert!(matches!(error, MetricsError::BadValues { what: "var_x", count: 2, x: 2, y: 1, .. }));
        assert!(error.to_string().contains("column 2, row 1"), "{error}");
    }
    let error = compare(&MetricsInput { replicates: &[&r, &nan], ..fit }).expect_err("bad replicate");
    assert!(matches!(error, MetricsError::BadValues { what: "replicates", count: 16, .. }));
    let error = compare(&MetricsInput { pixels_per_degree: 0.0, ..fit }).expect_err("bad distance");
    assert_eq!(error, MetricsError::PixelsPerDegree { value: 0.0 });
}

#[test]
fn names_are_the_interface() {
    let r = scene(4, 4);
    let zero = vec![[0.0; 3]; 16];
    let all = measure(&MetricsInput { var_x: Some(&zero), ..MetricsInput::new(4, 4, &r, &r) });
    let names: Vec<_> = all.fields().into_iter().map(|f| f.0).collect();
    let first =
        ["rel_error", "rel_mse", "bias", "bias_interval", "block_ratio", "worst_block", "energy_error"];
    assert_eq!(names[..7], first);
    assert_eq!(names[7..11], ["z_pass", "z_fail", "mean_z2", "flip"]);
    assert_eq!(names[11..], ["flip_exposure", "pixels", "non_finite_x", "non_finite_r"]);
    let few = measure(&MetricsInput::new(4, 4, &r, &r));
    assert!(few.fields().iter().all(|f| !["bias_interval", "z_pass", "z_fail", "mean_z2"].contains(&f.0)));
    assert_eq!((few.agrees(), few.z_pass), (None, None));
    for name in ["bias_interval", "z_fail", "mean_z2"] {
        assert!(matches!(few.exceeds(name, 1.0), Err(MetricsError::NotMeasured { .. })));
    }
    for name in ["z_pass", "nonsense", "pixels"] {
        let error = few.exceeds(name, 1.0).expect_err("no limit");
        assert!(error.to_string().contains("z_fail"), "{error}");
    }
    assert_eq!(few.exceeds("flip", f64::NAN), Ok(true));
}

#[test]
#[ignore = "timing: cargo nextest run -p etendue --no-default-features --test metrics_image --run-ignored only --no-capture"]
fn a_megapixel_takes_seconds() {
    let r = scene(1024, 1024);
    let (x, v) = (noisy(1, &r, 1.0, SIGMA), variance(&r, SIGMA));
    let start = std::time::Instant::now();
    let m =
        measure(&MetricsInput { var_x: Some(&v), var_r: Some(&v), ..MetricsInput::new(1024, 1024, &x, &r) });
    let seconds = start.elapsed().as_secs_f64();
    println!("{seconds} s: {m:?}");
    assert!(seconds <= 5.0, "{seconds} s");
}
