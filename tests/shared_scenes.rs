//! Shared scenes against the references of another renderer, where `ETENDUE_SCENES` names their folder.
//!
//! Each comparison exists twice: with few samples, always; and with many, ignored. The seeds are fixed, so a test that
//! passes once passes always; its alpha says how often another seed would fail.
#![cfg(all(feature = "io", feature = "cpu"))]
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

mod common;
#[cfg(feature = "wgpu")]
#[path = "shared_scenes/device.rs"]
mod device;
#[path = "shared_scenes/media.rs"]
mod media;
#[path = "shared_scenes/photons.rs"]
mod photons;
#[path = "shared_scenes/tungsten.rs"]
mod tungsten;

use common::shared_scenes;
use etendue::core::backend::{Backend, Probe, Session};
use etendue::core::film::Film;
use etendue::core::scene::compile;
use etendue::driver::{self, Budget, Outcome, Settings, Silent};
use etendue::engine::{BackendKind, open_backend};
use etendue::io::{RenderImage, load_scene, read_exr, read_points};
use etendue::metrics::{Metrics, MetricsInput, compare, rel_error, statistics};
use std::path::Path;
use std::sync::Arc;

type Rgb = [f64; 3];

fn wide(v: [f32; 3]) -> Rgb {
    v.map(f64::from)
}

fn open(path: &Path) -> Box<dyn Session> {
    open_on(&*open_backend(BackendKind::Cpu, None).unwrap(), path)
}

fn open_on(backend: &dyn Backend, path: &Path) -> Box<dyn Session> {
    let loaded = load_scene(path).unwrap();
    let (scene, _) = compile(&loaded.desc).unwrap();
    backend.open(Arc::new(scene)).unwrap()
}

/// Opens a scene file that refers to a mesh by its absolute path.
fn open_mesh(mesh: &Path, rest: &str) -> Box<dyn Session> {
    open_mesh_on(&*open_backend(BackendKind::Cpu, None).unwrap(), mesh, rest)
}

fn open_mesh_on(backend: &dyn Backend, mesh: &Path, rest: &str) -> Box<dyn Session> {
    assert!(mesh.is_file(), "{} is missing", mesh.display());
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.toml");
    let text =
        format!("[[mesh]]\nfile = '{}'\nnormals = \"geometric\"\ntextures = false\n{rest}", mesh.display());
    std::fs::write(&scene, text).unwrap();
    open_on(backend, &scene)
}

const UNIT_SKY: &str = "\n[[light]]\nkind = \"environment\"\nradiance = [1, 1, 1]\n";

fn settings(samples: u64) -> Settings {
    Settings { seed: 20, max_depth: u32::MAX, budget: Budget::Samples(samples) }
}

fn tell(what: &str, outcome: &Outcome) {
    println!(
        "{what}: {} samples, {:.1} M rays, {:.1} s, estimated rel_error {:.3} %",
        outcome.film.samples(),
        outcome.stats.rays as f64 * 1e-6,
        outcome.seconds,
        100.0 * outcome.error.map_or(f64::NAN, |e| e.rel_error)
    );
    assert_eq!((outcome.film.saturated(), outcome.film.invalid()), (0, 0));
}

/// How many samples probes get.
#[derive(Clone, Copy)]
enum Effort {
    /// Each so many.
    Samples(u64),
    /// Each as many as bring its standard error below this part of every channel, by the word of a pilot run with
    /// another seed, whose results are not used.
    Error(f64),
}

/// Mean and standard error at each probe.
fn irradiance(session: &dyn Session, probes: &[Probe], effort: Effort) -> Vec<(Rgb, Rgb)> {
    let run = |probes: &[Probe], settings: Settings| -> Vec<(Rgb, Rgb)> {
        let outcome = driver::probes(session, probes, &settings, &Silent).unwrap();
        tell(&format!("  {} probes", probes.len()), &outcome);
        (0..probes.len()).map(|i| (outcome.film.mean(i), outcome.film.standard_error(i).unwrap())).collect()
    };
    let limit = match effort {
        Effort::Samples(n) => return run(probes, settings(n)),
        Effort::Error(limit) => limit,
    };
    const PILOT: u64 = 1 << 16;
    let pilot = run(probes, Settings { seed: 19, ..settings(PILOT) });
    let mut all = Vec::new();
    for (i, probe) in probes.iter().enumerate() {
        let worst = |(x, s): (Rgb, Rgb)| (0..3).map(|c| s[c] / x[c]).fold(0.0, f64::max);
        // Four thirds of what the pilot asks for: its errors have errors. Dark corners have long tails; where even this
        // was not enough, once more with twice the samples and another seed.
        let mut samples = PILOT as f64 * (worst(pilot[i]) / limit).powi(2) * 4.0 / 3.0;
        // A seed each: as the only probe of its run each is probe 0 and would draw the same points.
        let mut seed = 20 + i as u64;
        let value = loop {
            let value = run(&[*probe], Settings { seed, ..settings((samples as u64).max(4096)) })[0];
            if worst(value) <= limit || samples > 1e8 {
                break value;
            }
            (samples, seed) = (2.0 * samples, seed + 1000);
        };
        all.push(value);
    }
    all
}

/// Irradiance at the reference's points, and the largest relative standard error of ours.
///
/// Every channel lies within 3 combined standard errors of the reference; of all channels of a set one may lie
/// between 3 and 4. With 24 probes of three (correlated) channels another seed fails with a probability of about 2 %.
fn check_probes(session: &dyn Session, reference: &Path, effort: Effort) -> f64 {
    let points = read_points(reference).unwrap();
    let probes: Vec<Probe> =
        points.iter().map(|p| Probe { position: p.position, normal: p.normal }).collect();
    println!("{}", reference.file_stem().unwrap().to_str().unwrap());
    let found = irradiance(session, &probes, effort);
    let mut all = Vec::new();
    let (mut ours, mut theirs) = (0.0_f64, 0.0_f64);
    for (i, p) in points.iter().enumerate() {
        let (x, s) = found[i];
        let (r, t) = (wide(p.irradiance.unwrap()), wide(p.stderr.unwrap()));
        for c in 0..3 {
            ours = ours.max(s[c] / x[c]);
            theirs = theirs.max(t[c] / r[c]);
            let z = (x[c] - r[c]) / s[c].hypot(t[c]);
            assert!(
                z.is_finite(),
                "probe {i} channel {c}: {} +- {} against {} +- {}",
                x[c],
                s[c],
                r[c],
                t[c]
            );
            if z.abs() > 2.5 {
                println!(
                    "  probe {i} channel {c}: {} +- {} against {} +- {}: z {z:.2}",
                    x[c], s[c], r[c], t[c]
                );
            }
            all.push(z);
        }
    }
    let worst = all.iter().fold(0.0_f64, |m, z| m.max(z.abs()));
    let mean_z2 = all.iter().map(|z| z * z).sum::<f64>() / all.len() as f64;
    let mean_z = all.iter().sum::<f64>() / all.len() as f64;
    println!(
        "  worst |z| {worst:.2}, mean z {mean_z:.2}, mean z^2 {mean_z2:.2}; largest standard error: ours {:.3} %, theirs {:.3} %",
        100.0 * ours,
        100.0 * theirs
    );
    let beyond = all.iter().filter(|z| z.abs() > 3.0).count();
    assert!(worst <= 4.0 && beyond <= 1, "worst |z| {worst}, {beyond} above 3");
    ours
}

fn sponza_probes(effort: Effort) -> Option<f64> {
    let root = shared_scenes()?;
    let session = open_mesh(&root.join("sponza_dabrovic/sponza.obj"), UNIT_SKY);
    Some(check_probes(&*session, &root.join("probes/sponza_sky_probes.json"), effort))
}

/// Here 0.5 % is cheap.
fn cornell_probes(name: &str, reference: &str) {
    let Some(root) = shared_scenes() else { return };
    let session = open_mesh(&root.join(format!("cornell_mcguire/{name}.obj")), "");
    let reference = root.join(format!("probes/{reference}.json"));
    let ours = check_probes(&*session, &reference, Effort::Samples(1 << 18));
    assert!(ours <= 0.005, "{ours}");
}

#[test]
fn shared_sponza_sky_probes() {
    sponza_probes(Effort::Samples(1 << 16));
}

#[test]
#[ignore = "minutes, perhaps more than nextest allows: ETENDUE_SCENES=../shared/scenes cargo test -p etendue --test shared_scenes -- --ignored --nocapture shared_full_sponza_sky_probes"]
fn shared_full_sponza_sky_probes() {
    let Some(ours) = sponza_probes(Effort::Error(0.005)) else { return };
    assert!(ours <= 0.005, "{ours}");
}

#[test]
fn shared_cornell_original_probes() {
    cornell_probes("CornellBox-Original", "cornell_original_probes");
}

#[test]
fn shared_cornell_empty_white_probes() {
    cornell_probes("CornellBox-Empty-White", "cornell_empty_white_probes");
}

/// Means over square tiles and the variances of these means (pixels err independently: each has its own scramble).
fn tiles(image: &RenderImage, variance: &[[f32; 3]], side: usize) -> Vec<(Rgb, Rgb)> {
    let (width, height) = (image.width as usize, image.height as usize);
    let across = width.div_ceil(side);
    let mut sums = vec![(0.0, [0.0; 3], [0.0; 3]); across * height.div_ceil(side)];
    for i in 0..width * height {
        let (n, mean, var) = &mut sums[i / width / side * across + i % width / side];
        *n += 1.0;
        for c in 0..3 {
            mean[c] += f64::from(image.radiance[i][c]);
            var[c] += f64::from(variance[i][c]);
        }
    }
    sums.into_iter().map(|(n, mean, var)| (mean.map(|x| x / n), var.map(|x| x / (n * n)))).collect()
}

/// Asserts that the means of tiles agree at alpha = 0.01 with Sidak's correction over tiles and channels.
fn check_tiles(x: &RenderImage, r: &RenderImage, var_r: &[[f32; 3]], side: usize) {
    let ours = tiles(x, x.variance.as_deref().unwrap(), side);
    let theirs = tiles(r, var_r, side);
    let limit = statistics::normal_two_sided(statistics::sidak(0.01, 3 * ours.len() as u64));
    let (mut worst, mut squares, mut sum) = (0.0_f64, 0.0, 0.0);
    for (i, ((x, vx), (r, vr))) in ours.iter().zip(&theirs).enumerate() {
        for c in 0..3 {
            let z = (x[c] - r[c]) / (vx[c] + vr[c]).sqrt();
            assert!(z.is_finite(), "tile {i}");
            if z.abs() > 3.0 {
                println!("  tile {i} channel {c}: {} against {}, z {z:.2}", x[c], r[c]);
            }
            worst = worst.max(z.abs());
            squares += z * z;
            sum += z;
        }
    }
    let n = 3.0 * ours.len() as f64;
    println!(
        "  tiles of {side}: worst |z| {worst:.2} (limit {limit:.2}), mean z {:.2}, mean z^2 {:.2}",
        sum / n,
        squares / n
    );
    assert!(worst <= limit, "tiles of {side}: {worst} > {limit}");
}

fn image_of(film: &Film) -> RenderImage {
    let narrow = |v: Rgb| v.map(|x| x as f32);
    RenderImage {
        width: film.settings().width,
        height: film.settings().height,
        radiance: (0..film.len()).map(|i| narrow(film.mean(i))).collect(),
        variance: (0..film.len()).map(|i| film.variance(i).map(narrow)).collect(),
        ..RenderImage::default()
    }
}

fn measure(x: &RenderImage, r: &RenderImage, var_r: Option<&[[f32; 3]]>, mask: Option<&[bool]>) -> Metrics {
    let metrics = compare(&MetricsInput {
        var_x: x.variance.as_deref(),
        var_r,
        mask,
        ..MetricsInput::new(r.width as usize, r.height as usize, &x.radiance, &r.radiance)
    })
    .unwrap();
    println!(
        "  rel_error {:.4}, rel_mse {:.3e}, bias {:.5?}, interval {:.5?}, block_ratio {:.4?}, z_pass {:?}, mean_z2 {:?}",
        metrics.rel_error,
        metrics.rel_mse,
        metrics.bias,
        metrics.bias_interval.unwrap(),
        metrics.block_ratio,
        metrics.z_pass,
        metrics.mean_z2
    );
    assert_eq!((metrics.non_finite_x, metrics.non_finite_r), (0, 0));
    metrics
}

fn mirrored(image: &RenderImage) -> RenderImage {
    let mut image = image.clone();
    for row in image.radiance.chunks_mut(image.width as usize) {
        row.reverse();
    }
    image
}

/// The median ratio of 32-pixel blocks and the mean of each channel are within half a per cent of the reference's, or
/// the mean's 99 % interval says that noise explains the rest.
fn check_means(metrics: &Metrics) {
    assert!((metrics.block_ratio[1] - 1.0).abs() <= 0.005, "{:?}", metrics.block_ratio);
    let intervals = metrics.bias_interval.unwrap();
    for (bias, [low, high]) in metrics.bias.iter().zip(intervals) {
        assert!(bias.abs() <= 0.005 || (low <= 0.0 && 0.0 <= high), "{bias} in {low}..{high}");
    }
}

/// The reference has 192 samples per pixel and the variance of its mean.
fn sponza_view(samples: u64) {
    let Some(root) = shared_scenes() else { return };
    let camera = "\n[camera]\nposition = [-9, 4, 0]\nlook_at = [9, 4.5, -0.5]\nup = [0, 1, 0]\nfov_x_deg = 70.0\n\
                  resolution = [320, 240]\n";
    let session = open_mesh(&root.join("sponza_dabrovic/sponza.obj"), &format!("{UNIT_SKY}{camera}"));
    let r = read_exr(&root.join("probes/sponza_sky_view.exr")).unwrap();
    let var_r = read_exr(&root.join("probes/sponza_sky_view_var.exr")).unwrap().radiance;
    let outcome = driver::image(&*session, &settings(samples), &Silent).unwrap();
    tell("sponza_sky_view", &outcome);
    let x = image_of(&outcome.film);
    let metrics = measure(&x, &r, Some(&var_r), None);
    // Mitsuba's screen x is left-handed in camera space, which cancels: its image is not mirrored against ours.
    let [same, other] = [&x, &mirrored(&x)].map(|x| {
        let (x, r) = (tiles(x, &var_r, 16), tiles(&r, &var_r, 16));
        let narrow =
            |tiles: &[(Rgb, Rgb)]| -> Vec<_> { tiles.iter().map(|t| t.0.map(|v| v as f32)).collect() };
        rel_error(&narrow(&x), &narrow(&r), None).unwrap()
    });
    println!("  rel_error of tiles {same:.4}, mirrored {other:.4}");
    assert!(same < 0.2 * other);
    check_means(&metrics);
    for side in [16, 32] {
        check_tiles(&x, &r, &var_r, side);
    }
}

#[test]
fn shared_sponza_sky_view() {
    sponza_view(64);
}

#[test]
#[ignore = "minutes: ETENDUE_SCENES=../shared/scenes cargo nextest run -p etendue -E 'test(shared_full_sponza_sky_view)' --run-ignored only"]
fn shared_full_sponza_sky_view() {
    sponza_view(256);
}

/// False at pixels that see the lamp of radiance `lamp` (first channel), and at their neighbours: half a pixel of lamp
/// outshines all else.
fn without_lamp(r: &RenderImage, lamp: f32) -> Vec<bool> {
    let (width, height) = (r.width as usize, r.height as usize);
    let mut keep = vec![true; width * height];
    for i in (0..width * height).filter(|i| r.radiance[*i][0] > 0.5 * lamp) {
        let (column, row) = (i % width, i / width);
        for y in row.saturating_sub(1)..(row + 2).min(height) {
            for x in column.saturating_sub(1)..(column + 2).min(width) {
                keep[y * width + x] = false;
            }
        }
    }
    keep
}

fn closed_cornell(name: &str, lamp: f32, samples: u64) -> Option<Metrics> {
    let root = shared_scenes()?.join("closed_cornell");
    let session = open(&root.join(format!("{name}.toml")));
    let r = read_exr(&root.join(format!("{name}_ref.exr"))).unwrap();
    let keep = without_lamp(&r, lamp);
    let outcome = driver::image(&*session, &settings(samples), &Silent).unwrap();
    tell(name, &outcome);
    println!("  {} pixels left out", keep.iter().filter(|k| !**k).count());
    let metrics = measure(&image_of(&outcome.film), &r, None, Some(&keep));
    check_means(&metrics);
    Some(metrics)
}

#[test]
fn shared_closed_cornell_area() {
    closed_cornell("area", 17.0, 64);
}

#[test]
#[ignore = "minutes: ETENDUE_SCENES=../shared/scenes cargo nextest run -p etendue -E 'test(shared_full_closed_cornell_area)' --run-ignored only"]
fn shared_full_closed_cornell_area() {
    let Some(metrics) = closed_cornell("area", 17.0, 512) else { return };
    assert!(metrics.rel_mse <= 1e-3, "{}", metrics.rel_mse);
}

/// Fog behind a null boundary, lamp and eye outside it; the reference has 256 samples per pixel and no variance.
#[test]
fn shared_closed_cornell_fog() {
    closed_cornell("fog", 17.0, 32);
}

#[test]
#[ignore = "minutes: ETENDUE_SCENES=../shared/scenes cargo nextest run -p etendue -E 'test(shared_full_closed_cornell_fog)' --run-ignored only"]
fn shared_full_closed_cornell_fog() {
    let Some(metrics) = closed_cornell("fog", 17.0, 512) else { return };
    assert!((metrics.block_ratio[1] - 1.0).abs() <= 0.002, "{:?}", metrics.block_ratio);
}

#[test]
fn shared_closed_cornell_point() {
    closed_cornell("point", f32::INFINITY, 64);
}

#[test]
#[ignore = "minutes: ETENDUE_SCENES=../shared/scenes cargo nextest run -p etendue -E 'test(shared_full_closed_cornell_point)' --run-ignored only"]
fn shared_full_closed_cornell_point() {
    let Some(metrics) = closed_cornell("point", f32::INFINITY, 512) else { return };
    assert!(metrics.rel_mse <= 1e-3, "{}", metrics.rel_mse);
}

/// The reference took 65536 rays per point and does not state its errors.
fn cornell_points(samples: u64) -> Option<f64> {
    let root = shared_scenes()?.join("closed_cornell");
    let session = open(&root.join("area.toml"));
    let points = read_points(&root.join("area_points.json")).unwrap();
    assert_eq!(points.len(), 1024);
    let probes: Vec<Probe> =
        points.iter().map(|p| Probe { position: p.position, normal: p.normal }).collect();
    let outcome = driver::probes(&*session, &probes, &settings(samples), &Silent).unwrap();
    tell("area_points", &outcome);
    let (mut rel_mse, mut noise, mut sums) = (0.0, 0.0, [[0.0; 2]; 3]);
    for (i, p) in points.iter().enumerate() {
        let (x, v) = (outcome.film.mean(i), outcome.film.variance(i).unwrap());
        let r = wide(p.irradiance.unwrap());
        for c in 0..3 {
            rel_mse += (x[c] - r[c]).powi(2) / (r[c] * r[c] + 0.01) / 3072.0;
            noise += v[c] / (r[c] * r[c] + 0.01) / 3072.0;
            sums[c][0] += x[c];
            sums[c][1] += r[c];
        }
    }
    let ratios = sums.map(|[x, r]| x / r);
    println!("  rel_mse {rel_mse:.3e}, of which our noise {noise:.3e}; mean ratios {ratios:.5?}");
    for ratio in ratios {
        assert!((ratio - 1.0).abs() <= 0.005, "{ratios:?}");
    }
    Some(rel_mse)
}

#[test]
fn shared_closed_cornell_points() {
    let Some(rel_mse) = cornell_points(1024) else { return };
    assert!(rel_mse <= 1e-3, "{rel_mse}");
}

#[test]
#[ignore = "minutes: ETENDUE_SCENES=../shared/scenes cargo nextest run -p etendue -E 'test(shared_full_closed_cornell_points)' --run-ignored only"]
fn shared_full_closed_cornell_points() {
    let Some(rel_mse) = cornell_points(1 << 14) else { return };
    assert!(rel_mse <= 3e-4, "{rel_mse}");
}
