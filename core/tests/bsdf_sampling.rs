//! Samples of lobes against their densities and values.
//!
//! Joint level of the chi-square tests: alpha = 0.001 (Sidak over the cases), seeds fixed.
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

#[path = "bsdf_support.rs"]
mod lobes;
#[path = "sampling_support.rs"]
mod support;

use core::f64::consts::PI;
use etendue_core::bsdf::{Facets, Finish, Lobes, Rough};
use etendue_core::math::Vec3;
use etendue_core::sampling::counter::Counter;
use etendue_core::sampling::u32_to_unit;
use lobes::*;
use support::{chi2_p, sidak};

const ALPHA: f64 = 0.001;
const SAMPLES: u32 = 60_000;
const ROWS: usize = 24;
const COLUMNS: usize = 24;

/// Cosines of wo, both sides for what transmits.
const COSINES: [f64; 4] = [0.97, 0.5, 0.1, -0.6];

fn numbers(stream: u32, i: u32) -> ([f32; 2], f32) {
    let [a, b, c, _] = Counter::new(0x10be5).bits4(stream, i, 0).map(u32_to_unit);
    ([a, b], c)
}

/// Midpoints of cells over the sphere: direction, solid angle, and the row and column of the coarse cell.
fn sphere(fine: usize) -> impl Iterator<Item = (Vec3, f64, usize)> {
    let (rows, columns) = (ROWS * fine, COLUMNS * fine);
    (0..rows * columns).map(move |k| {
        let (i, j) = (k / columns, k % columns);
        let h = 1.0 - 2.0 * (i as f64 + 0.5) / rows as f64;
        let w = at(h.acos(), 2.0 * PI * (j as f64 + 0.5) / columns as f64);
        (f32s(w), 4.0 * PI / (rows * columns) as f64, i / fine * COLUMNS + j / fine)
    })
}

fn cell(w: Vec3) -> usize {
    let [x, y, z] = f64s(w);
    let row = (((1.0 - z) * 0.5 * ROWS as f64) as usize).min(ROWS - 1);
    let turn = (y.atan2(x) / (2.0 * PI)).rem_euclid(1.0);
    row * COLUMNS + ((turn * COLUMNS as f64) as usize).min(COLUMNS - 1)
}

#[test]
fn samples_have_their_density_and_weigh_their_value() {
    let list = all();
    let level = sidak(ALPHA, list.len() * COSINES.len());
    let mut stream = 0;
    for (name, lobes) in &list {
        for cos in COSINES.into_iter().filter(|c| *c > 0.0 || lobes.transmits()) {
            stream += 1;
            let n = f32s([0.3, -0.5, 0.8]);
            let (t, b) = etendue_core::math::orthonormal_basis(n);
            let w = f32s(at(cos.acos(), 0.9));
            let wo = (t * w.x + b * w.y + n * w.z).normalize();
            let case = format!("{name} at {cos}");

            let mut expected = vec![0.0; ROWS * COLUMNS];
            let mut albedo = [0.0; 3];
            for (wi, area, k) in sphere(12) {
                let pdf = f64::from(lobes.pdf_solid_angle(n, wo, wi));
                expected[k] += pdf * area;
                let f = lobes.eval(n, wo, wi);
                for c in 0..3 {
                    albedo[c] += f64::from(f[c]) * f64::from(wi.dot(n)).abs() * area;
                }
                assert!(pdf.is_finite() && f.is_finite() && f.min_element() >= 0.0, "{case}");
            }
            let whole: f64 = expected.iter().sum();
            assert!(whole <= 1.01, "{case}: density {whole}");

            let mut observed = vec![0_u64; ROWS * COLUMNS + 1];
            let (mut sums, mut delta) = ([[0.0; 2]; 3], 0.0);
            for i in 0..SAMPLES {
                let (u, lobe) = numbers(stream, i);
                let Some(s) = lobes.sample(n, wo, u, lobe) else {
                    observed[ROWS * COLUMNS] += 1;
                    continue;
                };
                assert!((s.wi.length() - 1.0).abs() < 1e-5 && s.weight.is_finite(), "{case}: {s:?}");
                if s.pdf == 0.0 {
                    assert!(lobes.has_delta(), "{case}");
                    delta += 1.0;
                    observed[ROWS * COLUMNS] += 1;
                    continue;
                }
                let pdf = lobes.pdf_solid_angle(n, wo, s.wi);
                assert!((pdf - s.pdf).abs() <= 0.02 * s.pdf, "{case}: {pdf} {s:?}");
                let cos = s.wi.dot(n).abs();
                let weight = lobes.eval(n, wo, s.wi) * (cos / pdf);
                let off = (weight - s.weight).abs().max_element();
                assert!(off <= 2e-3 * s.weight.max_element() + 1e-6, "{case}: {weight} {s:?}");
                observed[cell(s.wi)] += 1;
                for (sum, x) in sums.iter_mut().zip(f64s(s.weight)) {
                    sum[0] += x;
                    sum[1] += x * x;
                }
            }
            assert!(delta == 0.0 || lobes.has_delta(), "{case}");
            // The rest of the samples are absorbed, or have no density.
            expected.push((1.0 - whole).max(1e-9));
            let total: f64 = expected.iter().sum();
            let expected: Vec<f64> = expected.iter().map(|e| e / total * f64::from(SAMPLES)).collect();
            let p = chi2_p(&observed, &expected);
            assert!(p >= level, "{case}: p = {p:e}, density {whole}");
            for c in 0..3 {
                let mean = sums[c][0] / f64::from(SAMPLES);
                let variance = sums[c][1] / f64::from(SAMPLES) - mean * mean;
                let stderr = (variance.max(0.0) / f64::from(SAMPLES)).sqrt();
                let error = (mean - albedo[c]).abs();
                assert!(error <= 4.5 * stderr + 4e-3 * albedo[c], "{case}: {mean} against {}", albedo[c]);
            }
        }
    }
}

/// Share of the light that goes on, squared indices put back, mean of samples.
fn kept(lobes: &Lobes, wo: Vec3) -> f64 {
    let count = 1 << 14;
    let sum: f64 = (0..count)
        .filter_map(|i| {
            let (u, lobe) = numbers(7, i);
            let s = lobes.sample(Vec3::Z, wo, u, lobe)?;
            Some(f64::from(s.weight.x * lobes.index_ratio_squared(Vec3::Z, wo, s.wi)))
        })
        .sum();
    sum / f64::from(count)
}

#[test]
fn furnaces_lose_what_is_known() {
    for beckmann in [false, true] {
        for cos in [1.0, 0.7, 0.4] {
            let wo = f32s(at(f64::acos(cos), 2.0));
            for alpha in [1e-4, 0.02, 0.1] {
                let rough = facets(alpha, beckmann);
                for (what, x) in [
                    ("metal", kept(&silver(rough), wo)),
                    ("glass", kept(&glass(rough, 1.5), wo)),
                    ("from glass", kept(&glass(rough, 1.0 / 1.5), wo)),
                ] {
                    let least = if alpha < 0.05 { 0.985 } else { 0.94 };
                    assert!(x >= least && x <= 1.003, "{what} {alpha} {beckmann} at {cos}: {x}");
                }
            }
            // Rougher surfaces lose what their facets reflect to each other.
            let rough = facets(1.0, beckmann);
            let x = kept(&silver(rough), wo);
            assert!(x > 0.25 && x < 0.95, "{x}");
            // A smooth plastic with a white body keeps all, a rough one nearly.
            let x = kept(&plastic(None, Vec3::ONE, false), wo);
            assert!((x - 1.0).abs() < 0.01, "{x}");
            let x = kept(&plastic(Some(facets(0.1, beckmann)), Vec3::ONE, false), wo);
            assert!(x > 0.88 && x < 1.01, "{x}");
        }
    }
    let x = kept(&film(), f32s(at(1.0, 0.0)));
    assert!((x - 0.4).abs() < 0.01, "{x}");
}

#[test]
fn everything_is_a_number_everywhere() {
    let edges = [0.0, 1e-7, 0.25, 0.5, 0.75, 0.999_999, 1.0 - 1.0 / 16_777_216.0_f32];
    let grazing = [0.0, 1e-20, 1e-7, 1e-4, 0.02, 0.5, 1.0 - 1e-7, 1.0];
    let mut list = all();
    for alpha in [0.0, 1e-4, 0.01, 10.0] {
        for beckmann in [false, true] {
            let rough = facets(alpha, beckmann);
            for ratio in [1.5, 1.0 / 1.5, 1.001, 1.0, 1000.0, 0.001] {
                list.push((format!("glass {alpha} {beckmann} {ratio}"), glass(rough, ratio)));
            }
            list.push((format!("metal {alpha} {beckmann}"), metal(rough)));
            list.push((format!("plastic {alpha} {beckmann}"), plastic(Some(rough), Vec3::ONE, true)));
        }
    }
    for exponent in [0.0, 1e6] {
        list.push((format!("glass phong {exponent}"), glass(Rough::Phong(exponent), 1.5)));
        list.push((format!("metal phong {exponent}"), metal(Rough::Phong(exponent))));
    }
    let directions: Vec<Vec3> = grazing
        .iter()
        .flat_map(|c| {
            let s: f32 = (1.0_f32 - c) * (1.0 + c);
            let s = s.sqrt();
            [Vec3::new(s, 0.0, *c), Vec3::new(-0.6 * s, 0.8 * s, -c), Vec3::new(0.0, s, *c)]
        })
        .collect();
    for (name, lobes) in &list {
        for wo in &directions {
            for wi in &directions {
                let (f, pdf) = (lobes.eval(Vec3::Z, *wo, *wi), lobes.pdf_solid_angle(Vec3::Z, *wo, *wi));
                assert!(f.is_finite() && f.min_element() >= 0.0, "{name}: {wo} {wi} {f}");
                assert!(pdf.is_finite() && pdf >= 0.0, "{name}: {wo} {wi} {pdf}");
            }
            for u in edges {
                for v in edges {
                    for lobe in edges {
                        let Some(s) = lobes.sample(Vec3::Z, *wo, [u, v], lobe) else { continue };
                        assert!(s.weight.is_finite() && s.weight.min_element() >= 0.0, "{name}: {wo} {s:?}");
                        assert!(s.pdf.is_finite() && s.pdf >= 0.0, "{name}: {wo} {s:?}");
                        assert!((s.wi.length() - 1.0).abs() < 1e-5, "{name}: {wo} {s:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn visible_normals_have_their_density() {
    let cases: Vec<(f32, bool, f64)> = [0.05, 0.4, 1.0]
        .into_iter()
        .flat_map(|alpha| [false, true].map(|b| (alpha, b)))
        .flat_map(|(alpha, b)| [0.02, 0.3, 0.9, 1.0].map(|cos| (alpha, b, cos)))
        .collect();
    let level = sidak(ALPHA, cases.len());
    for (stream, (alpha, beckmann, cos)) in cases.into_iter().enumerate() {
        let f = if beckmann { Facets::beckmann(alpha) } else { Facets::ggx(alpha) };
        let wo = f32s(at(cos.acos(), 0.4));
        // Cells in slopes over alpha, so that narrow and wide distributions are met alike; r / (1 + r) as the radius.
        let (rings, turns, fine) = (16, 16, 24);
        let mut expected = vec![0.0; rings * turns];
        for i in 0..rings * fine {
            let x = (i as f64 + 0.5) / (rings * fine) as f64;
            let (r, dr) = (x / (1.0 - x), 1.0 / (1.0 - x).powi(2) / (rings * fine) as f64);
            let tan = f64::from(alpha) * r;
            let m_cos = 1.0 / (1.0 + tan * tan).sqrt();
            for j in 0..turns * fine {
                let phi = 2.0 * PI * (j as f64 + 0.5) / (turns * fine) as f64;
                let m = f32s(at(tan.atan(), phi));
                // d omega = cos^3 d(slopes).
                let area = f64::from(alpha).powi(2) * r * dr * 2.0 * PI / (turns * fine) as f64;
                expected[i / fine * turns + j / fine] +=
                    f64::from(f.pdf_visible(Vec3::Z, wo, m)) * m_cos.powi(3) * area;
            }
        }
        let whole: f64 = expected.iter().sum();
        assert!((whole - 1.0).abs() < 4e-3, "alpha {alpha} {beckmann} at {cos}: density {whole}");
        let mut observed = vec![0_u64; rings * turns];
        for i in 0..SAMPLES {
            let (u, _) = numbers(1000 + stream as u32, i);
            let m = f64s(f.sample_visible(Vec3::Z, wo, u));
            let r = (m[0] * m[0] + m[1] * m[1]).sqrt() / (m[2].max(1e-12) * f64::from(alpha));
            let turn = (m[1].atan2(m[0]) / (2.0 * PI)).rem_euclid(1.0);
            let ring = ((r / (1.0 + r) * rings as f64) as usize).min(rings - 1);
            observed[ring * turns + ((turn * turns as f64) as usize).min(turns - 1)] += 1;
        }
        let expected: Vec<f64> = expected.iter().map(|e| e / whole * f64::from(SAMPLES)).collect();
        let p = chi2_p(&observed, &expected);
        assert!(p >= level, "alpha {alpha} {beckmann} at {cos}: p = {p:e}");
    }
}

#[test]
fn phong_lobes_keep_what_the_source_says() {
    // At normal incidence (n+1)/(n+2) of what Fresnel leaves.
    for exponent in [1.0, 20.0, 200.0_f32] {
        let x = kept(&silver(Rough::Phong(exponent)), Vec3::Z);
        let truth = f64::from((exponent + 1.0) / (exponent + 2.0));
        assert!((x - truth).abs() < 0.01, "{exponent}: {x}");
    }
    assert!(matches!(metal(Rough::Phong(3.0)).finish, Finish::Metal(_)));
}
