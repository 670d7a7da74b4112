//! Rays per second of each tree, and of the whole path tracer as a ratio to a bare loop over obvhs's traversal.
//!
//! `cargo bench --bench rays -- [SCENE]`: all contenders take turns within one run, ratios are medians over the turns,
//! so that a machine's drift hits all alike. One thread. The rays of the bare loop are those that the path tracer
//! asked for, recorded once: the same origins, directions and lengths, in the same order.
#![allow(missing_docs, clippy::disallowed_methods, reason = "a program that prints, no library")]

use etendue::core::geometry::{Hit, Intersector, Ray};
use etendue::core::scene::{CompiledScene, compile};
use etendue::core::transport::TransportCode;
use etendue::core::with_path_tracer;
use etendue::cpu::tree::{Bvh2Tree, CwbvhTree, Tree, WalkTree};
use etendue::io::load_scene;
use std::cell::RefCell;
use std::path::PathBuf;
use std::time::Instant;

const TURNS: usize = 7;
/// Camera paths whose rays are recorded.
const WIDTH: u32 = 256;
const HEIGHT: u32 = 192;
const SAMPLES: u32 = 2;

enum Kind {
    Closest,
    Shadow,
}

/// Answers through a tree and notes every question.
struct Recorder<'a> {
    tree: &'a Tree,
    rays: RefCell<Vec<(Kind, Ray)>>,
}

impl Intersector for Recorder<'_> {
    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        self.rays.borrow_mut().push((Kind::Closest, *ray));
        self.tree.closest_hit(ray)
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.rays.borrow_mut().push((Kind::Shadow, *ray));
        self.tree.occluded(ray)
    }
}

fn paths<I: Intersector>(scene: &CompiledScene, intersector: &I, code: TransportCode) -> (f64, u64) {
    with_path_tracer!(code, scene, u32::MAX, |tracer| {
        let (mut sum, mut rays) = (0.0, 0);
        for y in 0..HEIGHT {
            for x in 0..WIDTH {
                let (mean, n) = tracer.pixel_block(intersector, [x, y], 1, 0, SAMPLES);
                sum += mean[0];
                rays += n;
            }
        }
        (sum, rays)
    })
}

/// Asks every recorded ray; the sum keeps the work from being optimised away.
fn trace<I: Intersector>(tree: &I, rays: &[(Kind, Ray)]) -> f64 {
    let mut sum = 0.0;
    for (kind, ray) in rays {
        sum += match kind {
            Kind::Closest => tree.closest_hit(ray).map_or(0.0, |h| f64::from(h.t.min(1e3))),
            Kind::Shadow => f64::from(u8::from(tree.occluded(ray))),
        };
    }
    sum
}

fn seconds(work: impl FnOnce() -> f64) -> f64 {
    let start = Instant::now();
    std::hint::black_box(work());
    start.elapsed().as_secs_f64()
}

fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut v: Vec<f64> = values.into_iter().collect();
    v.sort_by(f64::total_cmp);
    v[v.len() / 2]
}

fn main() {
    let scene_file = std::env::args().skip(1).find(|a| !a.starts_with('-')).map(PathBuf::from);
    let default = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/colonnade/colonnade.toml");
    let file = scene_file.unwrap_or_else(|| default.into());
    let loaded = load_scene(&file).unwrap_or_else(|e| panic!("{e}"));
    let (mut scene, _) = compile(&loaded.desc).unwrap_or_else(|e| panic!("{e}"));
    scene.camera = Some(scene.camera.expect("the bench needs a camera").with_resolution(WIDTH, HEIGHT));
    let primitives = scene.primitives();
    println!("{}: {} primitives", file.display(), primitives.count());

    let built = |name: &str, s: f64| println!("  build {name:>8}  {:.4} s", s);
    let start = Instant::now();
    let bvh2 = Bvh2Tree::build(&primitives);
    built("bvh2", start.elapsed().as_secs_f64());
    let start = Instant::now();
    let cwbvh = CwbvhTree::build(&primitives);
    built("cwbvh", start.elapsed().as_secs_f64());
    let start = Instant::now();
    let walk = WalkTree::build(&primitives);
    built("walk", start.elapsed().as_secs_f64());

    let recorder = Recorder { tree: &walk, rays: RefCell::new(Vec::new()) };
    let code = TransportCode::of(&scene.needs);
    paths(&scene, &recorder, code);
    let rays = recorder.rays.into_inner();
    let shadow = rays.iter().filter(|r| matches!(r.0, Kind::Shadow)).count();
    println!("  {} rays of paths, {shadow} of them shadow rays", rays.len());

    let mut table: Vec<[f64; 5]> = Vec::new();
    for turn in 0..=TURNS {
        let row = [
            seconds(|| trace(&bvh2, &rays)),
            seconds(|| trace(&cwbvh, &rays)),
            seconds(|| trace(&walk, &rays)),
            seconds(|| paths(&scene, &walk, code).0),
            seconds(|| paths(&scene, &walk, TransportCode::FULL).0),
        ];
        // The first turn warms the caches.
        if turn > 0 {
            table.push(row);
        }
    }
    let rate = |i: usize| median(table.iter().map(|r| rays.len() as f64 / r[i] * 1e-6));
    println!("  contender                     M rays/s   ratio to obvhs's faster walk");
    for (i, name) in ["obvhs bvh2", "obvhs cwbvh", "walk (ours)", "path tracer", "path tracer, all code"]
        .iter()
        .enumerate()
    {
        let ratio = median(table.iter().map(|r| r[0].min(r[1]) / r[i]));
        println!("  {name:<28} {:>9.3}   {ratio:.3}", rate(i));
    }
}
