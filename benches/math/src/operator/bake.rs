//! Seconds of a bake.

use super::{Outcome, open, scenes, target};
use cpu_time::ProcessTime;
use etendue::core::backend::{FormFactorJob, NoControl, Session};
use etendue::core::radiosity::patches::PatchSettings;
use etendue::core::radiosity::tiles::Kind;
use etendue::driver::Silent;
use etendue::driver::radiosity::{BakeSettings, Codec, Transport, bake};
use std::time::Instant;

/// CPU seconds of another program for the form factors below.
const RCONTRIB: f64 = 1.2;

/// A bake of a scene at a size: seconds by stage.
///
/// # Errors
/// Of the driver.
pub fn stages(case: &scenes::Case, count: u32, threads: usize) -> Outcome<String> {
    let session = open(&case.scene, threads)?;
    let settings = BakeSettings {
        patches: PatchSettings { count, seed: 0 },
        codec: Codec::Auto { max_error: 0.01 },
        ..BakeSettings::default()
    };
    let (start, cpu) = (Instant::now(), ProcessTime::now());
    let made = bake(&session, &settings, &Silent)?;
    let (all, cpu) = (start.elapsed().as_secs_f64(), cpu.elapsed().as_secs_f64());
    let mut out = format!(
        "{}: {} patches, {:.1} M rays, {threads} threads.\n\n| stage | s | share, % |\n|---|---:|---:|\n",
        case.name,
        made.operator.map.patches.len(),
        1e-6 * made.rays as f64
    );
    for (name, seconds) in &made.stages {
        out += &format!("| {name} | {seconds:.2} | {:.1} |\n", 100.0 * seconds / all);
    }
    out += &format!("| all | {all:.2} | {cpu:.2} CPU s |\n\n");
    let order = made.stages.iter().find(|s| s.0 == "order").map_or(0.0, |s| s.1);
    out += &format!(
        "The order takes {:.2} % of the bake. {} bytes, {:.3} a pair, {:.2} % error in {} passes.",
        100.0 * order / all,
        made.operator.bytes(),
        made.operator.bytes() as f64 / (made.operator.map.patches.len() as f64).powi(2),
        100.0 * made.error.rms,
        made.operator.passes
    );
    if let Transport::Tiles(tiles) = &made.operator.transport {
        let census = tiles.tiles().census();
        let all: u64 = census.iter().sum();
        let shares: Vec<String> = Kind::ALL
            .iter()
            .zip(census)
            .filter(|(_, count)| *count > 0)
            .map(|(kind, count)| format!("{kind:?} {:.1} %", 100.0 * count as f64 / all as f64))
            .collect();
        out += &format!(" Tiles: {}.", shares.join(", "));
    }
    out += "\n\n";
    out += &target("under 60 s with two threads", &format!("{all:.1} s"), all < 60.0);
    Ok(out)
}

/// Form factors of the closed box on one thread.
///
/// # Errors
/// Of the backend.
pub fn form_factors() -> Outcome<String> {
    const PATCHES: u32 = 1024;
    const TURNS: usize = 5;
    let session = open(&scenes::cornell()?, 1)?;
    let map = session.patches(&PatchSettings { count: PATCHES, seed: 0 })?;
    let patches = map.patches.len() as u32;
    let job = FormFactorJob { seed: 0, rays: 1024, patches: 0..patches };
    let mut seconds = Vec::new();
    let mut rays = 0;
    for _ in 0..TURNS {
        let start = ProcessTime::now();
        let rows = session.form_factors(&map, &job, &NoControl)?;
        seconds.push(start.elapsed().as_secs_f64());
        rays = rows.iter().map(|r| u64::from(r.rays)).sum::<u64>();
    }
    let seconds = crate::timing::median(seconds);
    Ok(format!(
        "Form factors of {patches} patches of scenes/cornell/closed.toml at {} rays a patch of mean area: {seconds:.3} CPU s on one thread (median of {TURNS}), {:.2} M rays, {:.2} M rays/s. \
         Radiance's `rcontrib` takes about {RCONTRIB} CPU s for as many rays from as many patches of such a box; that number was measured elsewhere, not by this program. Ours is {:.1} times less.\n",
        job.rays,
        1e-6 * rays as f64,
        1e-6 * rays as f64 / seconds,
        RCONTRIB / seconds
    ))
}
