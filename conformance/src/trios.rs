//! Property tests of the `sample_ / pdf_ / invert_` trios through `Backend::map`: round trip, integral of the density,
//! chi-square of samples against the density, and nothing that is not a number at the ends of the unit interval.
//!
//! Samples use pseudo-random `u` with a fixed seed (not a net: the chi-square test needs independence). The joint level
//! of all chi-square tests is [`ALPHA`], by Sidak's rule.

mod first_shot;
mod linear_triangle;

use crate::inputs::HARD_UNITS;
use crate::statistics::{Random, chi2_p, sidak};
use etendue_core::backend::{Backend, BackendError};
use etendue_core::kernel::Kernel;
use std::f64::consts::PI;

/// Probability that a right backend fails any of the chi-square tests, for a random seed.
pub const ALPHA: f64 = 0.001;
/// Relative error allowed to an integral by quadrature: the grid's, at a discontinuous rim.
const INTEGRAL: f64 = 2e-3;

/// A density of directions that depends on the angle to +z alone.
struct Trio {
    name: &'static str,
    sample: Kernel,
    pdf: Kernel,
    invert: Option<Kernel>,
    parameter: Option<f32>,
    /// Height 1 - cos below which a share x of the samples lies.
    quantile: fn(f64, f64) -> f64,
    /// Round trip in units of 2^-24, as the function's doc states.
    round_trip: f64,
}

fn trios() -> Vec<Trio> {
    use Kernel as K;
    let trio = |name, sample, pdf, invert, parameter, quantile, round_trip| Trio {
        name,
        sample,
        pdf,
        invert: Some(invert),
        parameter,
        quantile,
        round_trip,
    };
    let mut list = vec![
        trio("sphere", K::SampleSphere, K::PdfSphere, K::InvertSphere, None, |x, _| 2.0 * x, 4.0),
        trio("hemisphere", K::SampleHemisphere, K::PdfHemisphere, K::InvertHemisphere, None, |x, _| x, 4.0),
        trio(
            "cosine_hemisphere",
            K::SampleCosineHemisphere,
            K::PdfCosineHemisphere,
            K::InvertCosineHemisphere,
            None,
            |x, _| 1.0 - (1.0 - x).sqrt(),
            4.0,
        ),
    ];
    for size in [2.0, 1.0, 0.1, 1.1e-5] {
        list.push(trio("cone", K::SampleCone, K::PdfCone, K::InvertCone, Some(size), |x, s| x * s, 8.0));
    }
    for n in [0.0, 1.0, 20.0, 5000.0] {
        list.push(trio(
            "power_cosine",
            K::SamplePowerCosine,
            K::PdfPowerCosine,
            K::InvertPowerCosine,
            Some(n),
            |x, n| -((-x).ln_1p() / (n + 1.0)).exp_m1(),
            16.0,
        ));
    }
    list
}

/// One finding: its name, whether it is as it should be, and the numbers.
pub type Finding = (String, bool, String);

fn floats(words: &[u32]) -> Vec<f32> {
    words.iter().map(|w| f32::from_bits(*w)).collect()
}

fn map(backend: &dyn Backend, kernel: Kernel, items: &[f32]) -> Result<Vec<f32>, BackendError> {
    let words: Vec<u32> = items.iter().map(|x| x.to_bits()).collect();
    let shape = kernel.shape();
    let mut out = vec![0; words.len() / shape.item * shape.out];
    backend.map(kernel, &[], &words, &mut out)?;
    Ok(floats(&out))
}

/// Rows of `values` (of `width` floats), each with the trio's parameter behind it.
fn with_parameter(values: &[f32], width: usize, parameter: Option<f32>) -> Vec<f32> {
    values.chunks(width).flat_map(|row| row.iter().copied().chain(parameter)).collect()
}

fn units(count: usize, seed: u64) -> Vec<f32> {
    let mut r = Random::new(seed);
    let hard = HARD_UNITS.iter().flat_map(|u| HARD_UNITS.iter().flat_map(move |v| [*u, *v]));
    hard.chain((0..2 * count).map(|_| r.unit())).collect()
}

fn at_height(h: f64, phi: f64) -> [f32; 3] {
    let sin = (h * (2.0 - h)).max(0.0).sqrt();
    [(sin * phi.cos()) as f32, (sin * phi.sin()) as f32, (1.0 - h) as f32]
}

/// All trios of a backend, `count` samples each.
///
/// # Errors
/// The backend's own.
pub fn check(backend: &dyn Backend, count: usize) -> Result<Vec<Finding>, BackendError> {
    let mut out = Vec::new();
    let trios = trios();
    let scatterers = scatterers();
    let pieces = linear_triangle::WEIGHTS.len() + first_shot::CASES.len();
    let level = sidak(ALPHA, trios.len() + scatterers.len() + 3 + pieces);
    for (i, t) in trios.iter().enumerate() {
        let label = |what: &str| match t.parameter {
            Some(p) => format!("trio/{}({p})/{what}", t.name),
            None => format!("trio/{}/{what}", t.name),
        };
        let u = units(count, 0x7210 + i as u64);
        let w = map(backend, t.sample, &with_parameter(&u, 2, t.parameter))?;
        let pdf = map(backend, t.pdf, &with_parameter(&w, 3, t.parameter))?;
        let bad = w.iter().filter(|x| !x.is_finite()).count();
        let zero = pdf.iter().filter(|p| !(p.is_finite() && **p > 0.0)).count();
        out.push((
            label("total"),
            bad == 0 && zero == 0,
            format!("{bad} values not finite, {zero} samples without a density, of {}", pdf.len()),
        ));
        if let Some(invert) = t.invert {
            let back = map(backend, invert, &with_parameter(&w, 3, t.parameter))?;
            out.push(round_trip(label("round_trip"), t, &u, &back));
        }
        out.push(integral(backend, label("integral"), t)?);
        let skip = 2 * HARD_UNITS.len() * HARD_UNITS.len();
        out.push(chi_square(backend, label("chi_square"), t, &w[skip / 2 * 3..], level)?);
    }
    flat(backend, count, level, &mut out)?;
    linear_triangle::check(backend, count, level, &mut out)?;
    first_shot::check(backend, count, level, &mut out)?;
    for s in &scatterers {
        scatter(backend, s, count, level, &mut out)?;
    }
    Ok(out)
}

fn round_trip(name: String, t: &Trio, u: &[f32], back: &[f32]) -> Finding {
    let mut worst = 0.0_f64;
    for (u, b) in u.chunks(2).zip(back.chunks(2)) {
        let d = [0, 1].map(|i| (f64::from(u[i]) - f64::from(b[i])).abs() * 16_777_216.0);
        let azimuthal = t.sample != Kernel::SampleCosineHemisphere;
        // At the axis there is no azimuth.
        let second = if azimuthal && u[0] == 0.0 {
            0.0
        } else if azimuthal {
            d[1].min((16_777_216.0 - d[1]).abs())
        } else {
            d[1]
        };
        let here = d[0].max(second);
        worst = worst.max(if here.is_nan() { f64::INFINITY } else { here });
    }
    (name, worst <= t.round_trip, format!("worst {worst:.2} u, allowed {}", t.round_trip))
}

fn integral(backend: &dyn Backend, name: String, t: &Trio) -> Result<Finding, BackendError> {
    // Midpoints in ln(1 - cos), so that narrow and wide densities are met alike; four azimuths.
    const STEPS: usize = 20_000;
    let (low, high) = ((1e-11_f64).ln(), 2.0_f64.ln());
    let step = (high - low) / STEPS as f64;
    let heights: Vec<f64> = (0..STEPS).map(|i| (low + (i as f64 + 0.5) * step).exp()).collect();
    let w: Vec<f32> =
        heights.iter().enumerate().flat_map(|(i, h)| at_height(*h, 0.3 + 1.7 * (i % 4) as f64)).collect();
    let pdf = map(backend, t.pdf, &with_parameter(&w, 3, t.parameter))?;
    let sum: f64 = pdf.iter().zip(&heights).map(|(p, h)| f64::from(*p) * h * step * 2.0 * PI).sum();
    Ok((name, (sum - 1.0).abs() <= INTEGRAL, format!("integral {sum:.6}, allowed error {INTEGRAL}")))
}

fn chi_square(
    backend: &dyn Backend,
    name: String,
    t: &Trio,
    samples: &[f32],
    level: f64,
) -> Result<Finding, BackendError> {
    const ROWS: usize = 16;
    const COLUMNS: usize = 16;
    const FINE: usize = 16;
    let parameter = f64::from(t.parameter.unwrap_or(0.0));
    let edges: Vec<f64> = (0..=ROWS).map(|i| (t.quantile)(i as f64 / ROWS as f64, parameter)).collect();
    // The backend's density over each row, by midpoints.
    let mut w = Vec::new();
    let mut weights = Vec::new();
    for k in 0..ROWS * FINE {
        let at = |k: f64| (t.quantile)(k / (ROWS * FINE) as f64, parameter);
        w.extend(at_height(at(k as f64 + 0.5), 1.0 + k as f64));
        weights.push((at(k as f64 + 1.0) - at(k as f64)) * 2.0 * PI / COLUMNS as f64);
    }
    let pdf = map(backend, t.pdf, &with_parameter(&w, 3, t.parameter))?;
    let n = samples.len() / 3;
    let mut rows: Vec<f64> = (0..ROWS)
        .map(|r| {
            (0..FINE).map(|k| f64::from(pdf[r * FINE + k]) * weights[r * FINE + k]).sum::<f64>() * n as f64
        })
        .collect();
    // The last row of a narrow density is a long tail; the integral is checked by itself, so this is what is left.
    rows[ROWS - 1] = (n as f64 / COLUMNS as f64 - rows[..ROWS - 1].iter().sum::<f64>()).max(0.0);
    let mut observed = vec![0_u64; ROWS * COLUMNS];
    for s in samples.chunks(3) {
        let [x, y, z] = [0, 1, 2].map(|i| f64::from(s[i]));
        let h = if z > 0.0 { (x * x + y * y) / (1.0 + z) } else { 1.0 - z };
        let row = edges[1..ROWS].partition_point(|e| *e <= h);
        let turn = (y.atan2(x) / (2.0 * PI)).rem_euclid(1.0);
        observed[row * COLUMNS + ((turn * COLUMNS as f64) as usize).min(COLUMNS - 1)] += 1;
    }
    let expected: Vec<f64> = (0..ROWS * COLUMNS).map(|i| rows[i / COLUMNS]).collect();
    let p = chi2_p(&observed, &expected);
    Ok((name, p >= level, format!("p = {p:.3e}, level {level:.2e}, {n} samples")))
}

/// Trios of flat shapes: uniform, so that cells of the shape get equal counts.
fn flat(backend: &dyn Backend, count: usize, level: f64, out: &mut Vec<Finding>) -> Result<(), BackendError> {
    let u = units(count, 0xf1a7);
    for (name, sample, invert, width) in [
        ("disk", Kernel::SampleDisk, Kernel::InvertDisk, 2),
        ("triangle", Kernel::SampleTriangle, Kernel::InvertTriangle, 3),
    ] {
        let x = map(backend, sample, &u)?;
        let back = map(backend, invert, &x)?;
        let mut worst = 0.0_f64;
        for (a, b) in u.iter().zip(&back) {
            let d = (f64::from(*a) - f64::from(*b)).abs() * 16_777_216.0;
            worst = worst.max(if d.is_nan() { f64::INFINITY } else { d });
        }
        let allowed = if width == 2 { 4.0 } else { 1.0 };
        out.push((
            format!("trio/{name}/round_trip"),
            worst <= allowed,
            format!("worst {worst:.2} u, allowed {allowed}"),
        ));
        let mut observed = vec![0_u64; 256];
        let skip = HARD_UNITS.len() * HARD_UNITS.len();
        for p in x.chunks(width).skip(skip) {
            let v = [0, 1].map(|i| f64::from(p[i]));
            // Equal areas: rings by r^2 and sectors; for a triangle, strips by (1 - b)^2 and shares across.
            let [a, b] = if width == 2 {
                [v[0] * v[0] + v[1] * v[1], (v[1].atan2(v[0]) / (2.0 * PI)).rem_euclid(1.0)]
            } else {
                let rest = 1.0 - v[0];
                [rest * rest, if rest > 0.0 { v[1] / rest } else { 0.0 }]
            };
            let cell = |x: f64| ((x * 16.0) as usize).min(15);
            observed[cell(a) * 16 + cell(b)] += 1;
        }
        let n: u64 = observed.iter().sum();
        let p = chi2_p(&observed, &vec![n as f64 / 256.0; 256]);
        out.push((format!("trio/{name}/chi_square"), p >= level, format!("p = {p:.3e}, level {level:.2e}")));
    }
    // The density of the disk integrates to one over a square around it.
    let side = 1000;
    let grid = |i: usize| (2.0 * (i as f64 + 0.5) / f64::from(side) - 1.0) as f32;
    let points: Vec<f32> =
        (0..side as usize).flat_map(|i| (0..side as usize).flat_map(move |j| [grid(i), grid(j)])).collect();
    let pdf = map(backend, Kernel::PdfDisk, &points)?;
    let sum: f64 = pdf.iter().map(|p| f64::from(*p)).sum::<f64>() * 4.0 / f64::from(side * side);
    out.push(("trio/disk/integral".into(), (sum - 1.0).abs() <= INTEGRAL, format!("integral {sum:.6}")));
    Ok(())
}

/// A surface as the lobe kernels take it.
struct Scatterer {
    name: &'static str,
    albedo: [f32; 3],
    specular: [f32; 3],
    exponent: f32,
    n: [f32; 3],
    wo: [f32; 3],
}

fn scatterers() -> Vec<Scatterer> {
    let up = [0.0, 0.0, 1.0];
    let tilted = [0.6, 0.0, 0.8];
    vec![
        Scatterer {
            name: "diffuse",
            albedo: [0.9, 0.5, 0.1],
            specular: [0.0; 3],
            exponent: 0.0,
            n: tilted,
            wo: up,
        },
        Scatterer {
            name: "phong",
            albedo: [0.0; 3],
            specular: [0.7, 0.8, 0.9],
            exponent: 10.0,
            n: up,
            wo: tilted,
        },
        Scatterer {
            name: "phong_normal",
            albedo: [0.0; 3],
            specular: [1.0; 3],
            exponent: 20.0,
            n: up,
            wo: up,
        },
        Scatterer {
            name: "both",
            albedo: [0.2, 0.3, 0.4],
            specular: [0.5, 0.4, 0.1],
            exponent: 5.0,
            n: tilted,
            wo: up,
        },
    ]
}

/// Samples of lobes against their density over the sphere, and their weights against f cos.
fn scatter(
    backend: &dyn Backend,
    s: &Scatterer,
    count: usize,
    level: f64,
    out: &mut Vec<Finding>,
) -> Result<(), BackendError> {
    const ROWS: usize = 32;
    const COLUMNS: usize = 32;
    const FINE: usize = 8;
    let head: Vec<f32> =
        [s.albedo, s.specular].as_flattened().iter().copied().chain([s.exponent, 0.0]).collect();
    let frame: Vec<f32> = [s.n, s.wo].as_flattened().to_vec();
    let mut r = Random::new(0x5ca7);
    let items: Vec<f32> = (0..count)
        .flat_map(|_| {
            let u = [r.unit(), r.unit(), r.unit()];
            head.iter().chain(&frame).copied().chain(u).collect::<Vec<_>>()
        })
        .collect();
    let samples = map(backend, Kernel::SampleLobes, &items)?;
    // Midpoints of a fine grid over the whole sphere.
    let (rows, columns) = (ROWS * FINE, COLUMNS * FINE);
    let mut grid = Vec::new();
    for i in 0..rows {
        for j in 0..columns {
            let h = 2.0 * (i as f64 + 0.5) / rows as f64;
            let w = at_height(h, 2.0 * PI * (j as f64 + 0.5) / columns as f64);
            grid.extend(head.iter().chain(&frame).chain(&w));
        }
    }
    let pdf = map(backend, Kernel::PdfLobes, &grid)?;
    let f = map(backend, Kernel::EvalLobes, &grid)?;
    let cell_area = 4.0 * PI / (rows * columns) as f64;
    // One cell more for what is absorbed below the horizon.
    let mut expected = vec![0.0; ROWS * COLUMNS + 1];
    let mut reflected = [0.0; 3];
    for i in 0..rows {
        for j in 0..columns {
            let k = i * columns + j;
            let w = &grid[k * 17 + 14..k * 17 + 17];
            let cos: f64 = (0..3).map(|c| f64::from(w[c]) * f64::from(s.n[c])).sum();
            let cell = if cos > 0.0 { i / FINE * COLUMNS + j / FINE } else { ROWS * COLUMNS };
            expected[cell] += f64::from(pdf[k]) * cell_area;
            if cos > 0.0 {
                for c in 0..3 {
                    reflected[c] += f64::from(f[3 * k + c]) * cos * cell_area;
                }
            }
        }
    }
    let mut observed = vec![0_u64; ROWS * COLUMNS];
    let mut sums = [[0.0; 2]; 3];
    let mut bad = 0;
    for sample in samples.chunks(8) {
        bad += sample[1..].iter().filter(|x| !x.is_finite()).count();
        if sample[0].to_bits() == 0 {
            continue;
        }
        let [x, y, z] = [1, 2, 3].map(|i| f64::from(sample[i]));
        let turn = (y.atan2(x) / (2.0 * PI)).rem_euclid(1.0);
        let row = (((1.0 - z) * 0.5 * ROWS as f64) as usize).min(ROWS - 1);
        observed[row * COLUMNS + ((turn * COLUMNS as f64) as usize).min(COLUMNS - 1)] += 1;
        for c in 0..3 {
            let weight = f64::from(sample[4 + c]);
            sums[c][0] += weight;
            sums[c][1] += weight * weight;
        }
    }
    let seen: u64 = observed.iter().sum();
    observed.push(count as u64 - seen);
    let total: f64 = expected.iter().sum();
    out.push((
        format!("trio/lobes({})/integral", s.name),
        (total - 1.0).abs() <= 2.0 * INTEGRAL,
        format!("integral {total:.6}"),
    ));
    // The grid's own error cancels in the ratio.
    let expected: Vec<f64> = expected.iter().map(|e| e * count as f64 / total).collect();
    let p = chi2_p(&observed, &expected);
    out.push((
        format!("trio/lobes({})/chi_square", s.name),
        p >= level && bad == 0,
        format!("p = {p:.3e}, level {level:.2e}, {bad} not finite"),
    ));
    let mut passed = true;
    let mut detail = String::new();
    for c in 0..3 {
        let n = count as f64;
        let mean = sums[c][0] / n;
        let stderr = ((sums[c][1] / n - mean * mean).max(0.0) / n).sqrt();
        // Five standard errors (alpha 6e-7 each) and the grid's error.
        passed &= (mean - reflected[c]).abs() <= 5.0 * stderr + INTEGRAL * reflected[c].max(0.01);
        detail.push_str(&format!("{mean:.5} against {:.5}; ", reflected[c]));
    }
    out.push((format!("trio/lobes({})/weights", s.name), passed, detail));
    Ok(())
}
