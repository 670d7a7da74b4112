//! `cargo run --release -p etendue-benches --bin needs [-- ADAPTER]`: what shaders save by leaving out what a scene does not need.
//!
//! The closed Cornell box by paths, with the code that it needs, and with that of media, grids, lobes and all else: bytes of the shaders, seconds of a first image beyond those of a
//! later one (which a driver takes to compile), and rays per second. Code that is not needed does not change the image; with media it is another tracer's, of the same light.
#![allow(clippy::disallowed_methods, reason = "a program that prints")]

use etendue::core::backend::{Backend, NoControl, PathJob, Session, image_film_settings};
use etendue::core::film::Film;
use etendue::core::scene::{CompiledScene, compile};
use etendue::io::load_scene;
use etendue::wgpu::{Options, WgpuBackend};
use etendue_benches::timing::median;
use std::error::Error;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

const TURNS: usize = 5;
const SIDE: u32 = 96;
const SAMPLES: u32 = 16;

type Outcome<T> = Result<T, Box<dyn Error>>;

/// Seconds, rays and the image.
fn image(session: &dyn Session) -> Outcome<(f64, u64, Film)> {
    let job = PathJob { seed: 1, block_length: SAMPLES, blocks: 0..1, max_depth: u32::MAX };
    let mut film = Film::new(image_film_settings(session.scene(), &job)?);
    let start = Instant::now();
    let stats = session.path_image(&job, &NoControl, &mut film)?;
    Ok((start.elapsed().as_secs_f64(), stats.rays, film))
}

fn main() -> Outcome<()> {
    let wanted = std::env::args().nth(1);
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/cornell/closed.toml");
    let (mut scene, _) = compile(&load_scene(&file)?.desc)?;
    scene.camera = scene.camera.map(|c| c.with_resolution(SIDE, SIDE));
    let with = |change: &dyn Fn(&mut CompiledScene)| {
        let mut scene = scene.clone();
        change(&mut scene);
        Arc::new(scene)
    };
    let lobes = |scene: &mut CompiledScene| {
        let needs = &mut scene.needs;
        (needs.mirrors, needs.glossy, needs.rough, needs.plastic) = (true, true, true, true);
        (needs.textures, needs.shading_normals) = (true, true);
    };
    let scenes = [
        ("what the scene needs", with(&|_| ())),
        ("and media", with(&|scene| scene.needs.media = true)),
        ("and all finishes, bitmaps and normals, no media", with(&lobes)),
        (
            "and both",
            with(&|scene| {
                lobes(scene);
                (scene.needs.media, scene.needs.grids) = (true, true);
            }),
        ),
    ];
    let mut first: Option<Film> = None;
    for (name, scene) in scenes {
        let backend = WgpuBackend::with_options(wanted.as_deref(), Options::default())?;
        let session = backend.open(scene)?;
        let (cold, rays, film) = image(&*session)?;
        let mut warm = Vec::new();
        for _ in 0..TURNS {
            warm.push(image(&*session)?.0);
        }
        let warm = median(warm);
        let bytes: usize = backend.shaders().iter().filter(|s| s.0.starts_with("path")).map(|s| s.2).sum();
        println!(
            "{name}: {:.1} kB of shaders, {:.2} s to compile, {:.3} M rays/s{}",
            1e-3 * bytes as f64,
            cold - warm,
            1e-6 * rays as f64 / warm,
            if first.as_ref().is_none_or(|f| *f == film) {
                ""
            } else {
                "; another tracer, so another image of the same light"
            }
        );
        first.get_or_insert(film);
    }
    Ok(())
}
