//! Irradiance at probes against the references of another renderer.

use super::{Outcome, open, scenes, target};
use etendue::core::backend::{GivenMap, Probe};
use etendue::core::radiosity::patches::PatchSettings;
use etendue::driver::radiosity::{BakeSettings, Codec, bake, map_probes, relit};
use etendue::driver::{self, Budget, Outcome as Found, Settings, Silent};
use etendue::io::{Probe as Point, read_points};
use std::path::Path;
use std::time::Instant;

/// Rays that a probe gathers its light by: as few as one would take, and so many that their noise is gone.
const SAMPLES: [u64; 2] = [1024, 1 << 16];
/// Mesh, references, whether under a sky.
const SETS: [(&str, &str, bool); 3] = [
    ("sponza_dabrovic/sponza.obj", "sponza_sky_probes", true),
    ("cornell_mcguire/CornellBox-Original.obj", "cornell_original_probes", false),
    ("cornell_mcguire/CornellBox-Empty-White.obj", "cornell_empty_white_probes", false),
];

/// Differences of all channels, relative, in order.
fn differences(found: &Found, points: &[Point]) -> Vec<f64> {
    let mut all = Vec::new();
    for (i, p) in points.iter().enumerate() {
        let Some(truth) = p.irradiance else { continue };
        let mean = found.film.mean(i);
        all.extend((0..3).map(|c| (mean[c] / f64::from(truth[c]) - 1.0).abs()));
    }
    all.sort_by(f64::total_cmp);
    all
}

/// Per cent of them within a limit.
fn share(differences: &[f64], limit: f64) -> f64 {
    let within = differences.iter().filter(|d| **d <= limit).count();
    100.0 * within as f64 / differences.len().max(1) as f64
}

/// Shares within 3 and 10 %, the median and the largest.
fn cells(all: &[f64]) -> String {
    format!(
        "{:.0} | {:.0} | {:.2} | {:.1}",
        share(all, 0.03),
        share(all, 0.1),
        100.0 * all.get(all.len() / 2).copied().unwrap_or(0.0),
        100.0 * all.last().copied().unwrap_or(0.0)
    )
}

/// Shares of channels of probes by size.
///
/// # Errors
/// Of the driver; a file that is missing.
pub fn table(data: &Path, sizes: &[u32]) -> Outcome<String> {
    let mut out = String::from(
        "| probes | patches | within 3 %, % of channels | within 10 % | median difference, % | largest | within 3 % with 65536 rays | within 10 % | median difference, % | largest | bake, s | direct light and relighting, s | gathering, s |\n|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n",
    );
    let mut targets = String::new();
    for (mesh, reference, sky) in SETS {
        let session = open(&scenes::mesh(&data.join(mesh), sky)?, 2)?;
        let points = read_points(&data.join("probes").join(reference).with_extension("json"))?;
        let probes: Vec<Probe> =
            points.iter().map(|p| Probe { position: p.position, normal: p.normal }).collect();
        let name = reference.replace("_probes", "").replace('_', " ");
        let settings = SAMPLES.map(|s| Settings { budget: Budget::Samples(s), ..Settings::default() });
        for count in sizes {
            let plan = BakeSettings {
                patches: PatchSettings { count: *count, seed: 0 },
                codec: Codec::Auto { max_error: 0.01 },
                ..BakeSettings::default()
            };
            let start = Instant::now();
            let made = bake(&session, &plan, &Silent)?;
            let baked = start.elapsed().as_secs_f64();
            let start = Instant::now();
            let light = relit(&session, &made.operator, 1, &Silent)?;
            let lit = start.elapsed().as_secs_f64();
            let elements = *made.operator.map.elements.settings();
            let view = GivenMap { elements, values: &light.values, gather: true };
            let start = Instant::now();
            let few = map_probes(&session, &probes, &settings[0], &view, &Silent)?;
            let gathered = start.elapsed().as_secs_f64();
            let many = map_probes(&session, &probes, &settings[1], &view, &Silent)?;
            let [few, many] = [few, many].map(|found| differences(&found, &points));
            let row = format!(
                "| {name} | {} | {} | {} | {baked:.1} | {lit:.2} | {gathered:.3} |\n",
                made.operator.map.patches.len(),
                cells(&few),
                cells(&many)
            );
            eprint!("{row}");
            out += &row;
            if *count == 8000 {
                targets += &target(
                    &format!("{name}: 90 % of channels within 3 % at 8000 patches"),
                    &format!("{:.0} %", share(&few, 0.03)),
                    share(&few, 0.03) >= 90.0,
                );
            }
        }
        let mut paths = Vec::new();
        for settings in &settings {
            paths.push(cells(&differences(&driver::probes(&session, &probes, settings, &Silent)?, &points)));
        }
        out += &format!("| {name} | paths | {} | - | - | - |\n", paths.join(" | "));
    }
    Ok(format!("{out}\n{targets}"))
}
