//! `cargo run --release -p etendue-benches --bin device [-- ADAPTER]`: rays, paths, samples from both ends, form factors, photons, pieces of lit triangles, relighting and bytes per second of an adapter, the CPU beside it.
//!
//! One line for each measurement; both take turns in one run, and medians are told. `ADAPTER` is a part of the adapter's name
//! (`etendue adapters`); without it the best one is taken.
#![allow(clippy::disallowed_methods, reason = "a program that prints")]

use etendue::core::backend::{
    Backend, BidirectionalJob, FormFactorJob, JobStats, NoControl, PathJob, PhotonJob, PhotonStart, Session,
    illumination_film_settings, image_film_settings,
};
use etendue::core::film::Film;
use etendue::core::illumination::ElementSettings;
use etendue::core::radiosity::patches::PatchSettings;
use etendue::core::scene::{CompiledScene, compile};
use etendue::core::transport::first_shot::{Subdivision, Weights};
use etendue::core::transport::photon::Sequence;
use etendue::driver::Silent;
use etendue::driver::radiosity::{BakeSettings, Codec, Rooms, bake};
use etendue::engine::{BackendKind, is_software, open_backend_on};
use etendue::io::load_scene;
use etendue_benches::timing::median;
use etendue_cpu::CpuBackend;
use etendue_wgpu::{Options, Step, WgpuBackend};
use std::error::Error;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// Turns that count; of a device that the processor plays, whose speed says nothing, fewer do.
const TURNS: usize = 5;
const TURNS_OF_SOFTWARE: usize = 1;
/// Pixels a side and samples of a pixel: about ten million rays.
const SIDE: u32 = 128;
const SAMPLES: u32 = 32;
/// Patches of the operator that is relit.
const PATCHES: u32 = 8192;
/// Photons of a map.
const PHOTONS: u32 = 1 << 18;

type Outcome<T> = Result<T, Box<dyn Error>>;

fn scene(file: &str) -> Outcome<Arc<CompiledScene>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes").join(file);
    let (mut scene, _) = compile(&load_scene(&path)?.desc)?;
    scene.camera = scene.camera.map(|c| c.with_resolution(SIDE, SIDE));
    Ok(Arc::new(scene))
}

/// From which end an image is traced.
#[derive(Clone, Copy, Debug)]
enum By {
    Path,
    Bdpt,
}

/// Rays and samples a second of an image.
fn rates(session: &dyn Session, by: By, seed: u64) -> Outcome<([f64; 2], Film)> {
    let samples = match by {
        By::Path => SAMPLES,
        By::Bdpt => SAMPLES / 2,
    };
    let job = PathJob { seed, block_length: 16, blocks: 0..samples / 16, max_depth: u32::MAX };
    let mut film = Film::new(image_film_settings(session.scene(), &job)?);
    let start = Instant::now();
    let JobStats { rays, paths, .. } = match by {
        By::Path => session.path_image(&job, &NoControl, &mut film)?,
        By::Bdpt => session.bidirectional_image(&BidirectionalJob::new(job), &NoControl, &mut film)?,
    };
    let seconds = start.elapsed().as_secs_f64();
    Ok(([rays as f64 / seconds, paths as f64 / seconds], film))
}

fn print(what: &str, unit: &str, [ours, cpu]: [f64; 2], more: &str) {
    println!("{what}: {ours:.2} {unit}, cpu {cpu:.2} {unit}, ratio {:.3}{more}", ours / cpu);
}

fn main() -> Outcome<()> {
    let wanted = std::env::args().nth(1);
    let device = open_backend_on(BackendKind::Wgpu, None, wanted.as_deref())?;
    let cpu = open_backend_on(BackendKind::Cpu, None, None)?;
    println!("{} beside {}", device.info().adapter, cpu.info().adapter);
    let turns = if is_software(&device.info().adapter) { TURNS_OF_SOFTWARE } else { TURNS };
    let pair = [&*device, &*cpu];
    relight(pair, turns)?;
    for file in ["cornell/closed.toml", "colonnade/lamps.toml"] {
        for by in [By::Path, By::Bdpt] {
            image(file, by, pair, turns)?;
        }
        form_factors(file, pair, turns)?;
        photons(file, pair, turns)?;
        // The closed box has no light without size.
        if file != "cornell/closed.toml" {
            pieces(file, wanted.as_deref(), turns)?;
        }
    }
    Ok(())
}

fn image(file: &str, by: By, pair: [&dyn Backend; 2], turns: usize) -> Outcome<()> {
    let scene = scene(file)?;
    let sessions = [pair[0].open(scene.clone())?, pair[1].open(scene)?];
    // Rays and samples, of the device and of the CPU.
    let mut found = [[Vec::new(), Vec::new()], [Vec::new(), Vec::new()]];
    let mut equal = true;
    // The first turn makes pipelines and is not counted.
    for turn in 0..=turns {
        let mut films = Vec::new();
        for (k, session) in sessions.iter().enumerate() {
            let (rates, film) = rates(&**session, by, turn as u64)?;
            films.push(film);
            if turn > 0 {
                for (found, rate) in found.iter_mut().zip(rates) {
                    found[k].push(1e-6 * rate);
                }
            }
        }
        equal &= films[0] == films[1];
    }
    let films = if equal { "; films equal to the last bit" } else { "; films differ in bits" };
    let [rays, samples] = found;
    print(&format!("{by:?}, {file}"), "M rays/s", rays.map(median), films);
    print(&format!("{by:?}, {file}"), "M samples/s", samples.map(median), "");
    Ok(())
}

/// Photons in order, summed on the mesh.
fn photons(file: &str, pair: [&dyn Backend; 2], turns: usize) -> Outcome<()> {
    let scene = scene(file)?;
    let sessions = [pair[0].open(scene.clone())?, pair[1].open(scene.clone())?];
    let mut found = [Vec::new(), Vec::new()];
    let mut equal = true;
    for turn in 0..=turns {
        let job = PhotonJob {
            seed: turn as u64,
            photons: PHOTONS,
            replicates: 0..1,
            max_hits: u32::MAX,
            start: PhotonStart::LIGHTS,
            sequence: Sequence::Sorted,
            elements: ElementSettings::default(),
        };
        let mut films = Vec::new();
        for (session, found) in sessions.iter().zip(&mut found) {
            let elements = session.elements(&job.elements);
            let mut film = Film::new(illumination_film_settings(&scene, &elements, &job)?);
            let start = Instant::now();
            session.illumination(&job, &NoControl, &mut film)?;
            if turn > 0 {
                found.push(1e-6 * f64::from(job.photons) / start.elapsed().as_secs_f64());
            }
            films.push(film);
        }
        equal &= films[0] == films[1];
    }
    let films = if equal { "; maps equal to the last bit" } else { "; maps differ in bits" };
    print(&format!("photons in order, {file}"), "M photons/s", found.map(median), films);
    Ok(())
}

/// The density of starts on lit surfaces: triangles cut into pieces, up to its tables.
fn pieces(file: &str, adapter: Option<&str>, turns: usize) -> Outcome<()> {
    let scene = scene(file)?;
    let device = WgpuBackend::with_options(adapter, Options::default())?.open_scene(scene.clone())?;
    let cpu = CpuBackend::new(None)?.open_session(scene)?;
    let (weights, how) = (Weights::EXACT, Subdivision::robust(Weights::EXACT));
    let (mut found, mut equal, mut rays, mut count) = ([Vec::new(), Vec::new()], true, 0, 0);
    for turn in 0..=turns {
        let start = Instant::now();
        let mut task = device.first_shot_task(&how, weights)?;
        while task.step(true)? != Step::Done {}
        let ours = task.finish()?;
        let seconds = start.elapsed().as_secs_f64();
        let start = Instant::now();
        let theirs = cpu.make_first_shot(&how, weights)?;
        if turn > 0 {
            found[0].push(1e3 * seconds);
            found[1].push(1e3 * start.elapsed().as_secs_f64());
        }
        equal &= ours.1 == theirs.1 && ours.0.pieces() == theirs.0.pieces();
        (rays, count) = (ours.1, ours.0.pieces().len());
    }
    let same = if equal { "equal to the last bit" } else { "which differ" };
    print(
        &format!("first shot, {file}"),
        "ms",
        found.map(median),
        &format!("; {rays} rays, {count} pieces, {same}"),
    );
    Ok(())
}

/// Rays between patches, counted.
fn form_factors(file: &str, pair: [&dyn Backend; 2], turns: usize) -> Outcome<()> {
    let scene = scene(file)?;
    let sessions = [pair[0].open(scene.clone())?, pair[1].open(scene)?];
    let map = sessions[1].patches(&PatchSettings { count: PATCHES / 2, seed: 0 })?;
    let mut found = [Vec::new(), Vec::new()];
    let mut equal = true;
    for turn in 0..=turns {
        let job = FormFactorJob { seed: turn as u64, rays: 256, patches: 0..u32::MAX };
        let mut both = Vec::new();
        for (session, found) in sessions.iter().zip(&mut found) {
            let start = Instant::now();
            let rows = session.form_factors(&map, &job, &NoControl)?;
            let rays: f64 = rows.iter().map(|row| f64::from(row.rays)).sum();
            if turn > 0 {
                found.push(1e-6 * rays / start.elapsed().as_secs_f64());
            }
            both.push(rows);
        }
        equal &= both[0] == both[1];
    }
    let rows = if equal { "; rows equal" } else { "; rows differ" };
    let what = format!("form factors, {file}, {} patches", map.patches.len());
    print(&what, "M rays/s", found.map(median), rows);
    Ok(())
}

fn relight(pair: [&dyn Backend; 2], turns: usize) -> Outcome<()> {
    let scene = scene("colonnade/lamps.toml")?;
    let sessions = [pair[0].open(scene.clone())?, pair[1].open(scene)?];
    let settings = BakeSettings {
        patches: PatchSettings { count: PATCHES, seed: 0 },
        rays: 256,
        codec: Codec::Auto { max_error: 0.01 },
        ..BakeSettings::default()
    };
    let baked = bake(&*sessions[1], &settings, &Silent)?;
    let n = baked.operator.map.patches.len();
    let (passes, bytes) = (baked.operator.passes, baked.operator.bytes());
    let mut found = [Vec::new(), Vec::new()];
    let mut worst = 0.0_f64;
    for turn in 0..=turns {
        let light = vec![[1.0 + turn as f32, 2.0, 3.0]; n];
        let mut irradiance = [vec![[0.0_f32; 3]; n], vec![[0.0_f32; 3]; n]];
        for ((session, found), out) in sessions.iter().zip(&mut found).zip(&mut irradiance) {
            let mut rooms = Rooms::default();
            let start = Instant::now();
            baked.operator.transport.relight(&**session, (&light, &[]), out, passes, &mut rooms)?;
            if turn > 0 {
                found.push(1e3 * start.elapsed().as_secs_f64());
            }
        }
        let largest = irradiance[1].as_flattened().iter().fold(0.0_f32, |m, x| m.max(*x));
        let pairs = irradiance[0].as_flattened().iter().zip(irradiance[1].as_flattened());
        worst = pairs.fold(worst, |m, (a, b)| m.max(f64::from((a - b).abs() / largest)));
    }
    let ms = found.map(median);
    let rate = |ms: f64| 1e-6 * bytes as f64 * f64::from(passes) / ms;
    let more = format!(
        "; {:.2} and {:.2} GB/s of the operator's {:.1} MB, {passes} passes; largest difference {worst:.1e} of the largest irradiance",
        rate(ms[0]),
        rate(ms[1]),
        1e-6 * bytes as f64
    );
    print(&format!("relight, {n} patches"), "ms", ms, &more);
    Ok(())
}
