//! FLIP against the authors' own program (crate `nv-flip`), and against what follows from the paper by hand.
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use etendue::metrics::MetricsError;
use etendue::metrics::flip::{DEFAULT_PIXELS_PER_DEGREE, flip_map};

/// Per pixel and on the mean. Theirs computes in f32 throughout, with tabulated white and inverse matrix.
/// Found: 1.1e-4 (where features nearly vanish, under the square root) and 1.2e-5.
const PIXEL: f32 = 5e-4;
const MEAN: f32 = 5e-5;

type Bytes = Vec<[u8; 3]>;

fn noise(i: usize) -> u32 {
    let mut v = (i as u32).wrapping_mul(0x9E37_79B9).wrapping_add(0x7F4A_7C15);
    v = (v ^ (v >> 16)).wrapping_mul(0x85EB_CA6B);
    v = (v ^ (v >> 13)).wrapping_mul(0xC2B2_AE35);
    v ^ (v >> 16)
}

fn image(width: usize, height: usize, f: impl Fn(usize, usize) -> [u8; 3]) -> Bytes {
    (0..width * height).map(|i| f(i % width, i / width)).collect()
}

fn ours(width: usize, height: usize, r: &Bytes, x: &Bytes, ppd: f64) -> Vec<f32> {
    let float = |b: &Bytes| -> Vec<[f32; 3]> { b.iter().map(|p| p.map(|v| f32::from(v) / 255.0)).collect() };
    flip_map(width, height, &float(r), &float(x), ppd).expect("sizes fit")
}

fn theirs(width: usize, height: usize, r: &Bytes, x: &Bytes, ppd: f64) -> Vec<f32> {
    let wrap = |b: &Bytes| nv_flip::FlipImageRgb8::with_data(width as u32, height as u32, b.as_flattened());
    nv_flip::flip(wrap(r), wrap(x), ppd as f32).to_vec()
}

fn mean(v: &[f32]) -> f32 {
    (v.iter().map(|v| f64::from(*v)).sum::<f64>() / v.len() as f64) as f32
}

#[track_caller]
fn agree(name: &str, width: usize, height: usize, r: &Bytes, x: &Bytes, ppd: f64) -> f32 {
    let (a, b) = (ours(width, height, r, x, ppd), theirs(width, height, r, x, ppd));
    let worst = a.iter().zip(&b).map(|(a, b)| (a - b).abs()).fold(0.0_f32, f32::max);
    let mean_error = (mean(&a) - mean(&b)).abs();
    println!("{name} {width}x{height} ppd {ppd}: mean {} pixel {worst:e} mean {mean_error:e}", mean(&a));
    assert!(a.iter().all(|v| (0.0..=1.0).contains(v)));
    assert!(worst <= PIXEL, "{name}: a pixel differs by {worst}");
    assert!(mean_error <= MEAN, "{name}: the mean differs by {mean_error}");
    mean(&a)
}

#[test]
fn agrees_with_the_authors_program() {
    let gradient = |w: usize, h: usize| {
        image(w, h, move |x, y| [(x * 255 / w) as u8, (y * 255 / h) as u8, ((x + y) * 127 / (w + h)) as u8])
    };
    let (w, h) = (90, 61);
    let base = gradient(w, h);
    let noisy: Bytes = (base.iter().enumerate())
        .map(|(i, p)| [0, 1, 2].map(|c| p[c].saturating_add((noise(3 * i + c) % 64) as u8)))
        .collect();
    let brighter: Bytes = base.iter().map(|p| p.map(|v| v.saturating_add(8))).collect();
    let faint: Bytes = base.iter().map(|p| [p[0].saturating_add(1), p[1], p[2]]).collect();
    let checker = image(w, h, |x, y| if (x / 5 + y / 7) % 2 == 0 { [250, 240, 30] } else { [20, 30, 220] });
    let shifted =
        image(w, h, |x, y| if ((x + 1) / 5 + y / 7) % 2 == 0 { [250, 240, 30] } else { [20, 30, 220] });
    let wild: Bytes = (0..w * h).map(|i| [0, 1, 2].map(|c| noise(3 * i + c + 99) as u8)).collect();
    let lines = image(w, h, |x, y| if x % 20 == 3 || y % 16 == 2 { [255; 3] } else { [40, 90, 60] });
    let flat = image(w, h, |_, _| [40, 90, 60]);
    let mut means = vec![];
    for (name, r, x) in [
        ("noise", &base, &noisy),
        ("brighter", &base, &brighter),
        ("faint", &base, &faint),
        ("shifted edges", &checker, &shifted),
        ("all noise", &base, &wild),
        ("lines", &flat, &lines),
        ("gone lines", &lines, &flat),
    ] {
        for ppd in [DEFAULT_PIXELS_PER_DEGREE, 20.0, 110.0] {
            means.push(agree(name, w, h, r, x, ppd));
        }
    }
    // The cases reach over the scale, so that agreement says something.
    assert!(means.iter().any(|m| *m < 0.1) && means.iter().any(|m| *m > 0.8), "{means:?}");
}

#[test]
fn agrees_on_images_smaller_than_the_filters() {
    for (w, h) in [(1, 1), (1, 9), (13, 1), (4, 3), (21, 22)] {
        let r = image(w, h, |x, y| [(40 * x) as u8, (30 * y) as u8, 128]);
        let x = image(w, h, |x, y| [(37 * x + 20) as u8, (31 * y + 9) as u8, 90]);
        agree("small", w, h, &r, &x, DEFAULT_PIXELS_PER_DEGREE);
    }
}

#[test]
fn flat_images_by_hand() {
    // Blurring and features leave flat images alone: green against blue is the greatest distance, 1;
    // black against white is the lightness distance 100, and HyAB^0.7 of green and blue bends at 0.4.
    let (w, h) = (8, 8);
    let flat = |c: [f32; 3]| vec![c; w * h];
    let at = |a, b| flip_map(w, h, &flat(a), &flat(b), 67.0).expect("sizes fit")[27];
    assert!((at([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]) - 1.0).abs() <= 1e-5);
    // Grays have no chroma: L of 0.5 is 53.3890 and of 0.6 is 63.2223 (CIE L* of linear 0.214041, 0.318547).
    // Green is L 87.7351, a -86.1829, b 83.1797; blue L 32.2970, a 79.1875, b -107.8602; Hunt scales a, b by
    // L / 100: HyAB = 55.4381 + hypot(-75.6127 - 25.5752, 72.9776 + 34.8357) = 203.3, to the 0.7: 41.27.
    let hyab: f64 = 55.4381 + (-75.6127_f64 - 25.5752).hypot(72.9776 + 34.8357);
    let lightness = |v: f64| 116.0 * (((v + 0.055) / 1.055).powf(2.4)).cbrt() - 16.0;
    let expected = (lightness(0.6) - lightness(0.5)).powf(0.7) / (0.4 * hyab.powf(0.7)) * 0.95;
    let got = f64::from(at([0.5; 3], [0.6; 3]));
    assert!((got - expected).abs() <= 2e-4, "{got} {expected}");
    assert_eq!(at([0.3, 0.7, 0.1], [0.3, 0.7, 0.1]), 0.0);
}

#[test]
fn symmetric_local_and_total() {
    let (w, h) = (64, 48);
    let r: Vec<[f32; 3]> = (0..w * h).map(|i| [(i % w) as f32 / 64.0, (i / w) as f32 / 48.0, 0.4]).collect();
    let mut x = r.clone();
    x[24 * w + 32] = [1.0; 3];
    let ab = flip_map(w, h, &r, &x, 67.0).expect("sizes fit");
    assert_eq!(ab, flip_map(w, h, &x, &r, 67.0).expect("sizes fit"));
    for (i, v) in ab.iter().enumerate() {
        let reach = (i % w).abs_diff(32).max((i / w).abs_diff(24));
        assert!(if reach > 10 { *v == 0.0 } else { *v >= 0.0 }, "{i}: {v}");
    }
    assert!(ab[24 * w + 32] > 0.1);
    for bad in [f32::NAN, f32::INFINITY, -1.0, 7.0] {
        x[5] = [bad; 3];
        assert!(flip_map(w, h, &r, &x, 67.0).expect("sizes fit").iter().all(|v| (0.0..=1.0).contains(v)));
    }
    for ppd in [1.0, 1000.0] {
        assert!(flip_map(4, 4, &r[..16], &x[..16], ppd).expect("in range").iter().all(|v| v.is_finite()));
    }
    for ppd in [0.0, -1.0, 0.9, 1001.0, f64::NAN, f64::INFINITY] {
        let error = flip_map(w, h, &r, &x, ppd).expect_err("out of range");
        assert!(matches!(error, MetricsError::PixelsPerDegree { .. }));
    }
    assert!(matches!(
        flip_map(w, h, &r[1..], &x, 67.0),
        Err(MetricsError::SizeMismatch { what: "r", found, .. }) if found == w * h - 1
    ));
}
