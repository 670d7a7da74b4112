//! Rays per second of every tree, of Embree where it is at hand, and of the whole path tracer.
//!
//! `ETENDUE_EMBREE=libembree4.so cargo bench --bench rays -- [SCENE.toml]`: all contenders take turns within one run;
//! ratios are medians over the turns, so that a machine's drift hits all alike. Two rooms with bumpy balls (69 000 and 995 000
//! triangles) and the scene, where one is given; then the path tracer on it, or on the colonnade.
#![allow(missing_docs, clippy::disallowed_methods, reason = "a program that prints, no library")]

mod embree;
mod paths;
mod sets;

use embree::Embree;
use etendue::core::geometry::{Intersector, Primitives, Ray};
use etendue::core::math::Vec3;
use etendue::core::scene::{CompiledScene, compile};
use etendue::cpu::tree::{CwbvhTree, Effort, Isa, WalkTree, WideTree};
use etendue::io::load_scene;
use sets::{Mesh, Set};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

pub(crate) const TURNS: usize = 7;

pub(crate) fn seconds(work: impl FnOnce() -> f64) -> f64 {
    let start = Instant::now();
    std::hint::black_box(work());
    start.elapsed().as_secs_f64()
}

pub(crate) fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut v: Vec<f64> = values.into_iter().collect();
    v.sort_by(f64::total_cmp);
    v[v.len() / 2]
}

/// Answers rays; the sum keeps the work from being optimised away.
fn ask<T: Intersector>(tree: &T, rays: &[Ray], closest: bool) -> f64 {
    let first = |r: &Ray| tree.closest_hit(r).map_or(0.0, |h| f64::from(h.t.min(1e3)));
    let any = |r: &Ray| f64::from(u8::from(tree.occluded(r)));
    if closest { rays.iter().map(first).sum() } else { rays.iter().map(any).sum() }
}

/// The same by batches.
fn ask_batch(tree: &WideTree, rays: &[Ray], closest: bool) -> f64 {
    if closest {
        let mut hits = vec![None; rays.len()];
        tree.closest_hits(rays, &mut hits);
        hits.iter().map(|h| h.map_or(0.0, |h| f64::from(h.t.min(1e3)))).sum()
    } else {
        let mut occluded = vec![false; rays.len()];
        tree.any_hits(rays, &mut occluded);
        occluded.iter().map(|o| f64::from(u8::from(*o))).sum()
    }
}

fn ask_embree(scene: &embree::Scene, rays: &[Ray], closest: bool) -> f64 {
    let first = |r: &Ray| scene.closest(r).map_or(0.0, |t| f64::from(t.min(1e3)));
    let any = |r: &Ray| f64::from(u8::from(scene.occluded(r)));
    if closest { rays.iter().map(first).sum() } else { rays.iter().map(any).sum() }
}

/// Answers rays in one way.
type Work<'a> = Box<dyn Fn(&[Ray], bool) -> f64 + Sync + 'a>;

struct Contender<'a> {
    name: &'static str,
    work: Work<'a>,
    threads: usize,
}

impl Contender<'_> {
    fn answer(&self, set: &Set) -> f64 {
        if self.threads == 1 {
            return (self.work)(&set.rays, set.closest);
        }
        // Threads take blocks in turn, so that none waits for another.
        let next = AtomicUsize::new(0);
        std::thread::scope(|scope| {
            for _ in 0..self.threads {
                scope.spawn(|| {
                    while let Some(block) = set.rays.chunks(4096).nth(next.fetch_add(1, Ordering::Relaxed)) {
                        std::hint::black_box((self.work)(block, set.closest));
                    }
                });
            }
        });
        0.0
    }
}

fn print_build(name: &str, tree: &WideTree, [obvhs, converted]: [Duration; 2], primitives: &Primitives<'_>) {
    println!(
        "  {name}: obvhs {:.3} s, conversion {:.3} s; {:.1} bytes a triangle; nodes, blocks, depth {:?}",
        obvhs.as_secs_f64(),
        converted.as_secs_f64(),
        tree.bytes() as f64 / primitives.count() as f64,
        tree.counts()
    );
}

/// All trees on one mesh: a row a contender, a column a set, each cell the ratio to the first contender of as many threads.
fn mesh_table(mesh: &Mesh, embree: Option<&Embree>, all: &mut Vec<f64>) {
    let p = mesh.primitives();
    println!("\n{}", mesh.name);
    let [quick, mut wide, thorough] = [Effort::Quick, Effort::Standard, Effort::Thorough].map(|effort| {
        let (tree, times) = WideTree::build_timed(&p, effort);
        print_build(&format!("{effort:?}"), &tree, times, &p);
        tree
    });
    let refit = seconds(|| wide.refit(&p).map_or(0.0, |()| wide.cost()));
    println!("  refit {refit:.3} s");
    let mut embrees = Vec::new();
    for robust in [false, true] {
        let start = Instant::now();
        embrees.extend(embree.map(|e| e.scene(&p, robust)));
        if embree.is_some() {
            println!(
                "  Embree{}: {:.3} s",
                if robust { " robust" } else { "" },
                start.elapsed().as_secs_f64()
            );
        }
    }
    let cwbvh = CwbvhTree::build(&p);
    let walk = WalkTree::build(&p);
    let portable = wide.clone().with_isa(Isa::Portable);
    let sets = sets::sets(mesh, &wide);
    let mut contenders: Vec<Contender<'_>> = Vec::new();
    let (wide, quick, thorough, portable) = (&wide, &quick, &thorough, &portable);
    for threads in [1, 2] {
        let mut add = |name, work| contenders.push(Contender { name, work, threads });
        for (name, scene) in ["Embree", "Embree robust"].into_iter().zip(&embrees) {
            add(name, Box::new(move |r, c| ask_embree(scene, r, c)));
        }
        if threads == 1 {
            add("obvhs cwbvh", Box::new(|r, c| ask(&cwbvh, r, c)));
            add("binary walk", Box::new(|r, c| ask(&walk, r, c)));
            add("wide, portable", Box::new(move |r, c| ask(portable, r, c)));
            add("wide, quick", Box::new(move |r, c| ask(quick, r, c)));
        }
        add("wide", Box::new(move |r, c| ask(wide, r, c)));
        if threads == 1 {
            add("wide, thorough", Box::new(move |r, c| ask(thorough, r, c)));
            add("wide, batches", Box::new(move |r, c| ask_batch(wide, r, c)));
        }
    }
    let mut cells = vec![vec![Vec::new(); sets.len()]; contenders.len()];
    for turn in 0..=TURNS {
        for (column, set) in sets.iter().enumerate() {
            for (row, contender) in contenders.iter().enumerate() {
                contender.answer(set);
                let s = seconds(|| contender.answer(set));
                if turn > 0 {
                    cells[row][column].push(set.rays.len() as f64 * 1e-6 / s);
                }
            }
        }
    }
    println!(
        "  {:<20}{}",
        "M rays/s (ratio)",
        sets.iter().map(|s| format!("{:>18}", s.name)).collect::<String>()
    );
    let mut first = 0;
    for (row, Contender { name, threads, .. }) in contenders.iter().enumerate() {
        if *threads != contenders[first].threads {
            first = row;
        }
        let mut line = format!("  {name:<17}x{threads} ");
        for (mine, first) in cells[row].iter().zip(&cells[first]) {
            let rate = median(mine.iter().copied());
            let ratio = median(mine.iter().zip(first).map(|(a, b)| a / b));
            line += &format!("{rate:>10.2} ({ratio:>5.2})");
            if *name == "wide" && *threads == 1 {
                all.push(ratio);
            }
        }
        println!("{line}");
    }
    for set in &sets {
        let hits = |work: &dyn Fn(&Ray) -> bool| set.rays.iter().filter(|r| work(r)).count();
        let mut line = format!("  {} rays, hits: wide {}", set.rays.len(), hits(&|r| wide.occluded(r)));
        if let Some(e) = embrees.first() {
            line += &format!(", Embree {}", hits(&|r| e.occluded(r)));
        }
        println!("{line} ({})", set.name);
    }
}

fn mesh_of(scene: &CompiledScene, name: &Path) -> Mesh {
    let p = scene.primitives();
    let camera = scene.camera.expect("the bench needs a camera");
    let axis = camera.sample_ray(camera.width / 2, camera.height / 2, [0.5; 2], [0.5; 2]);
    let (mut lo, mut hi) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for x in p.positions {
        (lo, hi) = (lo.min(Vec3::from_array(*x)), hi.max(Vec3::from_array(*x)));
    }
    let d = hi - lo;
    // A lamp above the middle of the scene.
    let corner = Vec3::new(lo.x + 0.4 * d.x, hi.y + 0.05 * d.y, lo.z + 0.4 * d.z);
    Mesh {
        name: format!("{}, {} triangles", name.display(), p.triangles.len()),
        positions: p.positions.to_vec(),
        triangles: p.triangles.to_vec(),
        eye: axis.origin,
        target: axis.origin + axis.direction,
        lamp: [corner, Vec3::new(0.2 * d.x, 0.0, 0.0), Vec3::new(0.0, 0.0, 0.2 * d.z)],
        short: 1.5,
    }
}

fn load(file: &Path) -> CompiledScene {
    let loaded = load_scene(file).unwrap_or_else(|e| panic!("{e}"));
    compile(&loaded.desc).unwrap_or_else(|e| panic!("{e}")).0
}

fn main() {
    let asked = std::env::args().skip(1).find(|a| !a.starts_with('-')).map(PathBuf::from);
    let embree = Embree::open();
    if embree.is_none() {
        println!(
            "no Embree: set ETENDUE_EMBREE to the path of libembree4.so to have it among the contenders"
        );
    }
    let mut all = Vec::new();
    if let Some(file) = &asked {
        mesh_table(&mesh_of(&load(file), file), embree.as_ref(), &mut all);
    }
    mesh_table(&Mesh::room(38), embree.as_ref(), &mut all);
    mesh_table(&Mesh::room(144), embree.as_ref(), &mut all);
    let geometric = (all.iter().map(|x| x.ln()).sum::<f64>() / all.len() as f64).exp();
    let worst = all.iter().copied().fold(f64::INFINITY, f64::min);
    println!("\nwide over the first contender: geometric mean {geometric:.3}, worst cell {worst:.3}");
    let colonnade = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/colonnade/colonnade.toml");
    paths::table(&asked.unwrap_or_else(|| colonnade.into()));
}
