//! Irradiance at probes against the references of another renderer.

use super::{Outcome, open, scenes, target};
use etendue::core::backend::Probe;
use etendue::core::radiosity::patches::PatchSettings;
use etendue::driver::radiosity::{BakeSettings, Codec, RadiosityView, bake, map_probes, relit};
use etendue::driver::{Budget, Settings, Silent};
use etendue::io::read_points;
use std::path::Path;
use std::time::Instant;

/// Rays that a probe gathers its light by.
const SAMPLES: u64 = 1024;
/// Mesh, references, whether under a sky.
const SETS: [(&str, &str, bool); 3] = [
    ("sponza_dabrovic/sponza.obj", "sponza_sky_probes", true),
    ("cornell_mcguire/CornellBox-Original.obj", "cornell_original_probes", false),
    ("cornell_mcguire/CornellBox-Empty-White.obj", "cornell_empty_white_probes", false),
];

/// Shares of channels of probes by size.
///
/// # Errors
/// Of the driver; a file that is missing.
pub fn table(data: &Path, sizes: &[u32]) -> Outcome<String> {
    let mut out = String::from(
        "| probes | patches | within 3 %, % of channels | within 10 % | median difference, % | largest | bake, s | direct light and relighting, s | gathering, s |\n|---|---:|---:|---:|---:|---:|---:|---:|---:|\n",
    );
    let mut targets = String::new();
    for (mesh, reference, sky) in SETS {
        let session = open(&scenes::mesh(&data.join(mesh), sky)?, 2)?;
        let points = read_points(&data.join("probes").join(reference).with_extension("json"))?;
        let probes: Vec<Probe> =
            points.iter().map(|p| Probe { position: p.position, normal: p.normal }).collect();
        for count in sizes {
            let settings = BakeSettings {
                patches: PatchSettings { count: *count, seed: 0 },
                codec: Codec::Auto { max_error: 0.01 },
                ..BakeSettings::default()
            };
            let start = Instant::now();
            let made = bake(&session, &settings, &Silent)?;
            let baked = start.elapsed().as_secs_f64();
            let start = Instant::now();
            let light = relit(&session, &made.operator, 1, &Silent)?;
            let lit = start.elapsed().as_secs_f64();
            let elements = *made.operator.map.elements.settings();
            let view = RadiosityView { elements, values: &light.values, gather: true };
            let settings = Settings { budget: Budget::Samples(SAMPLES), ..Settings::default() };
            let start = Instant::now();
            let found = map_probes(&session, &probes, &settings, &view, &Silent)?;
            let gathered = start.elapsed().as_secs_f64();
            let mut differences = Vec::new();
            for (i, p) in points.iter().enumerate() {
                let Some(truth) = p.irradiance else { continue };
                let mean = found.film.mean(i);
                differences.extend((0..3).map(|c| (mean[c] / f64::from(truth[c]) - 1.0).abs()));
            }
            differences.sort_by(f64::total_cmp);
            let all = differences.len().max(1) as f64;
            let share = |limit: f64| 100.0 * differences.iter().filter(|d| **d <= limit).count() as f64 / all;
            let name = reference.replace("_probes", "").replace('_', " ");
            let row = format!(
                "| {name} | {} | {:.0} | {:.0} | {:.2} | {:.1} | {baked:.1} | {lit:.2} | {gathered:.2} |\n",
                made.operator.map.patches.len(),
                share(0.03),
                share(0.1),
                100.0 * differences.get(differences.len() / 2).copied().unwrap_or(0.0),
                100.0 * differences.last().copied().unwrap_or(0.0)
            );
            eprint!("{row}");
            out += &row;
            if *count == 8000 {
                targets += &target(
                    &format!("{name}: 90 % of channels within 3 % at 8000 patches"),
                    &format!("{:.0} %", share(0.03)),
                    share(0.03) >= 90.0,
                );
            }
        }
    }
    Ok(format!("{out}\n{targets}"))
}
